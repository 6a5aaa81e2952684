//! A mixture with a defensive component, and how techniques are combined.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::convert::{direction, uniform};
use crate::guard::{Named, guard};
use crate::pointers::{Out, read_array};
use crate::single::drawn;
use crate::single::srbf_sample;
use crate::status::srbf_status;
use crate::storage::mixture;
use crate::storage::srbf_mixture;
use srbf_core::Defensive;

/// Draws an incident direction: with probability `share` one of the cosine, else one of the mixture.
///
/// For a renderer that keeps another function as the truth, a measured table for example, and samples it by the mixture: where the
/// mixture misses the table, the weight is at most `pi / share` times the BRDF. A `share` of 0.02 to 0.05 serves well. A mixture on
/// the whole sphere has a uniform direction in place of one of the cosine.
/// To combine techniques A and B, of `n` samples each with density `p`, A's sample weighs `n_a p_a / (n_a p_a + n_b p_b)` (the
/// balance heuristic), or the same of the squares (the power heuristic, for techniques of which one is much the better).
/// Shapes: `u` and `sample` as in `srbf_mixture_sample`; the density is the whole one, the weight the mixture's value over it.
/// Status: `SRBF_STATUS_ARGUMENT` for a share outside [0, 1].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_defensive(
    mixture: *const srbf_mixture,
    share: f32,
    u: *const f32,
    sample: *mut srbf_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, u, out) = unsafe {
            (self::mixture(mixture)?, read_array(u).of(Argument::U)?, Out::new(sample).of(Argument::Sample)?)
        };
        let u = uniform(u).of(Argument::U)?;
        let sample = Defensive::new(mixture, share)?.sample(u);
        out.set(drawn(Some(sample)));
        Ok(())
    })
}

/// Evaluates the density of `srbf_mixture_sample_defensive` at a direction; 1/sr.
///
/// Shapes: `wi` [3], unit vector; `pdf` one number, overwritten. Status as there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_pdf_defensive(
    mixture: *const srbf_mixture,
    share: f32,
    wi: *const f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (mixture, wi, out) = unsafe {
            (self::mixture(mixture)?, read_array(wi).of(Argument::Wi)?, Out::new(pdf).of(Argument::Pdf)?)
        };
        let wi = direction(wi).of(Argument::Wi)?;
        out.set(Defensive::new(mixture, share)?.pdf(wi));
        Ok(())
    })
}
