//! How light and material are sampled together: how many candidates, of which, and the weight of the path's
//! own ray.

use crate::error::Error;

/// Most candidates.
pub(super) const MAX_CANDIDATES: usize = 32;

/// How light and material are sampled together.
///
/// ```
/// use srbf_core::ProductSampling;
///
/// let sampling = ProductSampling::new(16, 0.5, 4.0)?;
/// assert_eq!((sampling.candidates(), sampling.lobe_candidates()), (16, 8));
/// // The path's own ray counts most where the lobes are dense and the light is even.
/// assert!(sampling.ray_weight(10.0, 0.1) > sampling.ray_weight(0.1, 10.0));
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProductSampling {
    pub(super) count: usize,
    /// Candidates of the lobes.
    pub(super) lobes: usize,
    /// Factors on the densities of lobes and environment in the weight of a candidate.
    pub(super) of_lobes: f32,
    pub(super) of_environment: f32,
    /// Factor on the density of the lobes in the weight of the path's own ray.
    of_ray: f32,
}

impl ProductSampling {
    /// Chooses a number of candidates, the share of them that is drawn from the lobes, and kappa.
    ///
    /// Range: `candidates` in [2, 32]: variance falls with them where nothing is occluded, and time grows: 32
    /// take about twice the time of 8. `lobe_share` in [0, 1], rounded to whole candidates: half serves well;
    /// under a sky of one radiance the lobes alone are the best, and light of a small window needs them
    /// least. Where the share rounds to none or to all of them, one density is never drawn from, and a weight has no bound. A
    /// sharp highlight may lie away from the light, or a small sun away from the highlight. The mean of tens of thousands of draws
    /// may then be half of the integral. `kappa` at least 1e-3: infinite where the candidates are to give all of the light; 4
    /// serves well where the path's own ray counts too, weighed by [`ray_weight`](Self::ray_weight).
    ///
    /// # Errors
    /// [`Error::Candidates`], [`Error::Share`], [`Error::Kappa`] for a number out of range, NaN too.
    pub const fn new(candidates: usize, lobe_share: f32, kappa: f32) -> Result<Self, Error> {
        if candidates < 2 || candidates > MAX_CANDIDATES {
            return Err(Error::Candidates);
        }
        if !(lobe_share >= 0.0 && lobe_share <= 1.0) {
            return Err(Error::Share);
        }
        if kappa.is_nan() || kappa < 1e-3 {
            return Err(Error::Kappa);
        }
        let count = candidates as f32;
        let lobes = (lobe_share * count + 0.5) as usize;
        let of_ray = count / kappa;
        let (of_lobes, of_environment) = (lobes as f32 + of_ray, (candidates - lobes) as f32);
        Ok(Self { count: candidates, lobes, of_lobes, of_environment, of_ray })
    }

    /// Number of candidates: a draw takes one triple of uniform numbers for each.
    #[inline]
    pub const fn candidates(&self) -> usize {
        self.count
    }

    /// How many of them are drawn from the lobes; the first ones.
    #[inline]
    pub const fn lobe_candidates(&self) -> usize {
        self.lobes
    }

    /// The factor on the light that a path meets along its own ray. The path drew the ray by
    /// [`AnyMixture::sample`](crate::AnyMixture::sample) with density `pdf`; the environment has
    /// [`Environment::pdf`](crate::Environment::pdf) `environment_pdf` there.
    ///
    /// `p_b / (p_b + kappa p)`, `p` the density of the candidates; 0 for an infinite kappa. In [0, 1] whatever
    /// the densities are: one that is negative or NaN counts as 0, an infinite one as the largest number.
    #[inline]
    pub fn ray_weight(&self, pdf: f32, environment_pdf: f32) -> f32 {
        // A comparison with NaN is false.
        if !(pdf > 0.0 && self.of_ray > 0.0) {
            return 0.0;
        }
        let environment_pdf = if environment_pdf > 0.0 { environment_pdf.min(f32::MAX) } else { 0.0 };
        // By the ratio of the densities: their products with the counts may overflow. So may the ratio itself, which
        // would be no number times a count of 0.
        let ratio = (environment_pdf / pdf.min(f32::MAX)).min(f32::MAX);
        self.of_ray / (self.of_lobes + self.of_environment * ratio)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_weight_of_the_own_ray_is_a_share_whatever_the_densities_are() {
        let ends = [
            0.0,
            -0.0,
            -1.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN_POSITIVE,
            1e-45,
            3.0,
        ];
        for share in [0.0, 0.01, 0.5, 1.0] {
            for kappa in [1e-3, 4.0, f32::MAX, f32::INFINITY] {
                for count in [2, 16, 32] {
                    let sampling = ProductSampling::new(count, share, kappa).unwrap();
                    for pdf in ends {
                        for environment_pdf in ends {
                            let weight = sampling.ray_weight(pdf, environment_pdf);
                            let place = || std::format!("{sampling:?}, {pdf}, {environment_pdf}: {weight}");
                            assert!((0.0..=1.0).contains(&weight), "{}", place());
                            assert!(weight == 0.0 || pdf > 0.0 && kappa < f32::INFINITY, "{}", place());
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_weight_of_the_own_ray_is_its_formula() {
        let sampling = ProductSampling::new(16, 0.5, 4.0).unwrap();
        for (pdf, environment_pdf) in [(0.3, 0.7), (100.0, 1e-3), (1e-20, 1e3)] {
            let [p, e] = [pdf, environment_pdf].map(f64::from);
            let expected = p / (p + 4.0 * 0.5 * (p + e));
            let error = f64::from(sampling.ray_weight(pdf, environment_pdf)) / expected - 1.0;
            assert!(error.abs() < 1e-6, "{pdf} {environment_pdf}: {error}");
        }
    }
}
