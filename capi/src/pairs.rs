//! Pairs: n directions, each with its own mixture, as a renderer has them that sorts its hits into streams.
#![allow(unsafe_code)]

use crate::guard::{Failure, guard};
use crate::pointers::{check_extent, read};
use crate::single::draw;
use crate::storage::{AnyMixture, check_storage, mixture, with_mixture};
use crate::streams::{Batch, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use crate::{SRBF_MIXTURE_ALIGNMENT, SRBF_STATUS_STRIDE, srbf_mixture, srbf_samples_out, srbf_status};
use core::ops::Range;
use srbf_core::Vec3;

/// n mixtures, one behind the other; those that `srbf_material_prepare_into` makes.
struct Mixtures {
    start: *const u8,
    count: usize,
    stride: usize,
}

impl Mixtures {
    fn new(start: *const srbf_mixture, count: usize, stride: usize) -> Result<Self, Failure> {
        let start = start.cast::<u8>();
        check_storage(start.cast_mut())?;
        if stride == 0 || !stride.is_multiple_of(SRBF_MIXTURE_ALIGNMENT) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(start.addr(), count, stride)?;
        Ok(Self { start, count, stride })
    }

    fn extent(&self) -> Range<usize> {
        self.start.addr()..self.start.addr() + self.count * self.stride
    }

    /// # Safety
    /// The header's contract: there is a mixture at every multiple of the stride; `index` is below the count.
    #[inline(always)]
    unsafe fn get<'a>(&self, index: usize) -> Result<AnyMixture<'a>, Failure> {
        // SAFETY: within the extent that `new` has checked; the rest is the caller's word.
        unsafe { mixture(self.start.byte_add(index * self.stride).cast()) }
    }
}

/// Evaluates `f cos` for n pairs of a mixture and a direction; 1/sr.
///
/// Mixture i is at `(const srbf_mixture *)((const char *)mixtures + i * mixture_stride)`.
/// Shapes: `mixtures` [n], `mixture_stride` bytes apart; `wi` n unit vectors; `value` n colours in linear sRGB,
/// overwritten. n = 0 looks at no pointer. What is not a unit vector gives an unspecified value.
/// Status: `SRBF_STATUS_OBJECT` if one of them is no mixture; the values are unspecified then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_evaluate_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    wi: *const srbf_vectors,
    value: *const srbf_vectors_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        let mixtures = Mixtures::new(mixtures, n, mixture_stride)?;
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, read(wi)?.streams(), read(value)?.streams(), mixtures.extent())? };
        let mut first = 0;
        batch.run(|wi, [red, green, blue]| {
            for i in 0..wi[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let wi = Vec3::new(wi[0][i], wi[1][i], wi[2][i]);
                let value = with_mixture!(AnyMixture: &mixture, m => m.evaluate(wi));
                [red[i], green[i], blue[i]] = value.to_array();
            }
            first += wi[0].len();
            Ok(())
        })
    })
}

/// Evaluates the density of sampling for n pairs of a mixture and a direction; 1/sr.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `pdf` n numbers, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_pdf_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    wi: *const srbf_vectors,
    pdf: *const srbf_numbers_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        let mixtures = Mixtures::new(mixtures, n, mixture_stride)?;
        // SAFETY: the header's contract.
        let batch = unsafe { Batch::new(n, read(wi)?.streams(), [read(pdf)?.stream()], mixtures.extent())? };
        let mut first = 0;
        batch.run(|wi, [pdf]| {
            for i in 0..wi[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let wi = Vec3::new(wi[0][i], wi[1][i], wi[2][i]);
                pdf[i] = with_mixture!(AnyMixture: &mixture, m => m.pdf(wi));
            }
            first += wi[0].len();
            Ok(())
        })
    })
}

/// Draws one direction from each of n mixtures.
///
/// Shapes and status as in `srbf_mixture_evaluate_pairs_into`; `u` and `samples` as in `srbf_mixture_sample_into`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_mixture_sample_pairs_into(
    mixtures: *const srbf_mixture,
    mixture_stride: usize,
    n: usize,
    u: *const srbf_vectors,
    samples: *const srbf_samples_out,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        let mixtures = Mixtures::new(mixtures, n, mixture_stride)?;
        // SAFETY: the header's contract.
        let batch =
            unsafe { Batch::new(n, read(u)?.streams(), read(samples)?.streams(), mixtures.extent())? };
        let mut first = 0;
        batch.run(|u, [x, y, z, pdf, red, green, blue]| {
            for i in 0..u[0].len() {
                // SAFETY: first + i < n.
                let mixture = unsafe { mixtures.get(first + i)? };
                let u = [u[0][i], u[1][i], u[2][i]];
                let sample = with_mixture!(AnyMixture: &mixture, m => draw(m, u));
                [x[i], y[i], z[i]] = sample.direction;
                pdf[i] = sample.pdf;
                [red[i], green[i], blue[i]] = sample.weight;
            }
            first += u[0].len();
            Ok(())
        })
    })
}
