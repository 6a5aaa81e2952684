//! The thesis's equation 9: between views, the mixtures of the nearest ones are added up, each weighing the inverse of its
//! distance.
//!
//! The views of an isotropic material lie on one meridian, so the geodesic distance is the difference of angles. The
//! thesis takes "3 or 4": here the three nearest, and the fourth where it is as near as the third. So the result does not depend
//! on the order of the views. At a view its own mixture is all there is.

use srbf_core::Material;
use srbf_fit::FitError;
use srbf_fit::judge::method::{Fitted, FittedView};
use srbf_fit::view_angles;

/// Distances closer than this are the same, radians.
const SAME: f64 = 1e-6;

/// How many views are blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbours {
    /// The three nearest, or four: the thesis.
    ThreeOrFour,
    /// The nearest on either side: linear interpolation, which on one meridian is kinder to the scheme.
    Two,
}

/// Numbers and weights of the views that are blended at an angle; the weights sum to 1. `thetas` rise.
pub(crate) fn weights(thetas: &[f64], theta: f64, neighbours: Neighbours) -> Vec<(usize, f64)> {
    let mut by_distance: Vec<(usize, f64)> =
        thetas.iter().enumerate().map(|(n, t)| (n, (t - theta).abs())).collect();
    match neighbours {
        Neighbours::Two => {
            let after = thetas.partition_point(|&t| t < theta);
            by_distance.retain(|(n, _)| *n == after || n + 1 == after);
        }
        Neighbours::ThreeOrFour => {
            by_distance.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            let tie = by_distance.len() > 3 && by_distance[3].1 - by_distance[2].1 < SAME;
            by_distance.truncate(if tie { 4 } else { 3 });
        }
    }
    if let Some(&(n, _)) = by_distance.iter().find(|(_, distance)| *distance < SAME) {
        return vec![(n, 1.0)];
    }
    let sum: f64 = by_distance.iter().map(|(_, distance)| 1.0 / distance).sum();
    by_distance.into_iter().map(|(n, distance)| (n, 1.0 / distance / sum)).collect()
}

/// Our lobes, cross-faded between the stored views as in the thesis. The difference is the worth of tracking.
pub struct BlendedViews<'a> {
    lobes: &'a dyn Fitted,
    thetas: Vec<f64>,
    neighbours: Neighbours,
}

impl<'a> BlendedViews<'a> {
    /// Takes the mixtures at the stored views of a fit.
    pub fn new(lobes: &'a Material<impl AsRef<[u8]> + Sync>, neighbours: Neighbours) -> Self {
        Self { lobes, thetas: view_angles(lobes), neighbours }
    }
}

impl Fitted for BlendedViews<'_> {
    fn view(&self, theta: f64) -> Result<Box<dyn FittedView + '_>, FitError> {
        let share = |(n, weight): (usize, f64)| Ok((weight, self.lobes.view(self.thetas[n])?));
        let shares = weights(&self.thetas, theta, self.neighbours).into_iter().map(share);
        Ok(Box::new(BlendedView { shares: shares.collect::<Result<_, FitError>>()? }))
    }
}

struct BlendedView<'a> {
    shares: Vec<(f64, Box<dyn FittedView + 'a>)>,
}

impl FittedView for BlendedView<'_> {
    fn f_cos(&self, direction: [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (weight, view) in &self.shares {
            let value = view.f_cos(direction);
            (0..3).for_each(|c| sum[c] += weight * value[c]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_inverse_distances_of_the_nearest() {
        let thetas = [0.0, 0.1, 0.2, 0.3, 0.4];
        let near = |theta, n| {
            let mut weights = weights(&thetas, theta, n);
            weights.sort_by_key(|w| w.0);
            weights
        };
        let expect = |found: Vec<(usize, f64)>, expected: &[(usize, f64)]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (f, e) in found.iter().zip(expected) {
                assert!(f.0 == e.0 && (f.1 - e.1).abs() < 1e-9, "{found:?} {expected:?}");
            }
        };
        // Halfway: 1 : 3 : 3 : 1, four of them.
        expect(near(0.15, Neighbours::ThreeOrFour), &[(0, 0.125), (1, 0.375), (2, 0.375), (3, 0.125)]);
        // Off the middle the fourth is further than the third: distances 0.01, 0.09, 0.11.
        let sum = 1.0 / 0.01 + 1.0 / 0.09 + 1.0 / 0.11;
        expect(
            near(0.11, Neighbours::ThreeOrFour),
            &[(0, 1.0 / 0.11 / sum), (1, 1.0 / 0.01 / sum), (2, 1.0 / 0.09 / sum)],
        );
        expect(near(0.125, Neighbours::Two), &[(1, 0.75), (2, 0.25)]);
        // At a view, and past the ends.
        expect(near(0.2, Neighbours::ThreeOrFour), &[(2, 1.0)]);
        expect(near(0.6, Neighbours::Two), &[(4, 1.0)]);
        assert_eq!(near(0.6, Neighbours::ThreeOrFour).len(), 3);
        expect(weights(&[0.3], 0.7, Neighbours::ThreeOrFour), &[(0, 1.0)]);
        expect(weights(&[0.3], 0.1, Neighbours::Two), &[(0, 1.0)]);
    }
}
