//! The squeeze: the sphere made narrower across the plane of incidence, so that round lobes make the streak
//! of a highlight towards grazing.
//!
//! In the frame of a view, +x in the plane of incidence and +y across it, a direction `d` is seen as
//!
//! ```text
//! u = (d.x, d.y / c, d.z) / r,    r = |(d.x, d.y / c, d.z)|
//! ```
//!
//! and `dw(u) = dw(d) / (c r^3)`: of the linear map M = diag(1, 1/c, 1) with determinant 1/c, a unit
//! direction's solid angle changes by `det M / |M d|^3`. A squeezed lobe is `G(u) / (c r^3)`, so its integral
//! is that of the round one. The map commutes with the mirror z -> -z, so it commutes with the fold. It is
//! the transform of linearly transformed cosines (Heitz, Dupuy, Hill and Neubelt 2016), kept to the one
//! diagonal entry that commutes with the fold.
//!
//! Rounding. `G` at sharpness `s` turns an error `e` across the direction into one of `sqrt(2 s |t|) e` in
//! the value, `t` its exponent: 1e-4 at s = 1e6 if `u` is rounded to f32. So the turned and squeezed
//! direction is carried as an unevaluated sum of two f32, by error-free transformations (Dekker 1971, Knuth
//! 1969). The error along the direction that remains in `1 / r` counts only squared.
//!
//! With fused operations `u` is not even made: `|u - a|^2 = |r u - r a|^2 / r^2`, in which `r u` needs no
//! division and `x - r a` rounds once. An error `e` of r is one along the direction again: of `e` relative to
//! the exponent, and of `s e^2`.
//!
//! Anisotropic materials squeeze by any symmetric matrix in (x, y), see `kernel/prepare_anisotropic.rs`: in
//! the frame of its eigenvectors it is diag(`along`, `inverse`), of determinant `along inverse`, and
//! everything above holds with that in place of `1 / c`.

#![allow(clippy::needless_range_loop)] // see simd/lanes.rs: kernels loop over array indices

use crate::simd::error_free::{half_excess, length_squared_minus_one, sum_of_products, two_product};
use crate::simd::lanes::{Lanes, TOGETHER, halves, of_halves, splat3};

/// The turn into the frame of a view, and the squeeze in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Squeeze {
    /// Cosine and sine of the azimuth, in the caller's frame, of the view's +x.
    pub azimuth: [f32; 2],
    /// Whether that is not (1, 0): turning loses digits.
    pub is_turned: bool,
    /// The excess of the length of these two over 1, by rounding.
    pub excess: f32,
    /// What x is multiplied by; 1 in isotropic materials.
    pub along: f32,
    /// What y is multiplied by, `1 / c`.
    pub inverse: f32,
    /// The same for one direction at a time.
    #[cfg(feature = "simd")]
    pub precise: Precise,
}

/// [`Squeeze`] in f64, where a processor with vectors spends less on one direction than on sums of two f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Precise {
    /// Cosine and sine of the azimuth, of length 1.
    pub azimuth: [f64; 2],
    /// What x and y are multiplied by.
    pub stretch: [f64; 2],
    /// The product of these.
    pub determinant: f32,
}

/// A direction as the lobes see it: `(high + low) / length`, `low` the part that f32 rounds away; of z none
/// with fused operations.
#[derive(Clone, Copy)]
pub(crate) struct Seen<L> {
    pub high: [L; 3],
    pub low: [L; 3],
    /// r, and 1 / r^2; 1 without fused operations, where the vector is made a unit vector.
    pub length: L,
    pub inverse_square: L,
    /// The height of the unit vector.
    pub height: L,
    /// Change of solid angle, `1 / (c r^3)`.
    pub scale: L,
}

/// How many numbers [`Seen`] is.
pub(crate) const NUMBERS: usize = 10;

impl Squeeze {
    pub const NONE: Self = Self {
        azimuth: [1.0, 0.0],
        is_turned: false,
        excess: 0.0,
        along: 1.0,
        inverse: 1.0,
        #[cfg(feature = "simd")]
        precise: Precise { azimuth: [1.0, 0.0], stretch: [1.0, 1.0], determinant: 1.0 },
    };

    /// `azimuth`: a unit vector but for rounding.
    #[inline(always)]
    pub fn new(azimuth: [f32; 2], along: f32, inverse: f32) -> Self {
        let excess = half_excess(azimuth);
        Self {
            azimuth,
            is_turned: azimuth != [1.0, 0.0],
            excess,
            along,
            inverse,
            #[cfg(feature = "simd")]
            precise: Precise::new(azimuth, excess, along, inverse),
        }
    }

    /// One direction as round and as squeezed lobes see it; lanes of `L` are lobes.
    #[inline(always)]
    pub fn see<L: Lanes>(&self, direction: [f32; 3]) -> [Sight; 2] {
        #[cfg(feature = "simd")]
        if L::COUNT > 1 {
            return self.precise.see(direction, L::FUSED);
        }
        let turned = self.turn(direction);
        [turned, self.squeeze(&turned)]
    }

    /// Whether squeezed lobes see what round ones do.
    pub fn is_round(&self) -> bool {
        self.along == 1.0 && self.inverse == 1.0
    }

    /// The direction as round lobes see it: turned only.
    #[inline(always)]
    pub fn turn<L: Lanes>(&self, [x, y, z]: [L; 3]) -> Seen<L> {
        let zero = L::splat(0.0);
        if !self.is_turned {
            return Seen::round([x, y, z], [zero; 3]);
        }
        if L::VECTORS > TOGETHER {
            let (parts, mut seen) = (halves([x, y, z]), halves([zero; NUMBERS]));
            for i in 0..2 {
                seen[i] = self.turn(parts[i]).to_numbers();
            }
            return Seen::from_numbers(of_halves(seen));
        }
        let (c, s) = (L::splat(self.azimuth[0]), L::splat(self.azimuth[1]));
        let (turned_x, low_x) = sum_of_products(x, c, y, s);
        let (turned_y, low_y) = sum_of_products(y, c, zero - x, s);
        // Cosine and sine are rounded, so that x and y come out too long or too short by up to 6e-8.
        let excess = L::splat(self.excess);
        let low_x = excess.neg_mul_add(turned_x, low_x);
        let low_y = excess.neg_mul_add(turned_y, low_y);
        Seen::round([turned_x, turned_y, z], [low_x, low_y, zero])
    }

    /// The direction as squeezed lobes see it, from the turned one.
    #[inline(always)]
    pub fn squeeze<L: Lanes>(&self, turned: &Seen<L>) -> Seen<L> {
        if L::VECTORS > TOGETHER {
            let mut seen = halves(turned.to_numbers());
            for i in 0..2 {
                seen[i] = self.squeeze(&Seen::from_numbers(seen[i])).to_numbers();
            }
            return Seen::from_numbers(of_halves(seen));
        }
        let inverse = L::splat(self.inverse);
        let [mut x, y, z] = turned.high;
        let mut x_low = turned.low[0];
        let (y, y_error) = two_product(y, inverse);
        let y_low = turned.low[1].mul_add(inverse, y_error);
        let mut determinant = inverse;
        if self.along != 1.0 {
            let along = L::splat(self.along);
            let (scaled, error) = two_product(x, along);
            (x, x_low) = (scaled, x_low.mul_add(along, error));
            determinant = along * inverse;
        }
        let length_squared = x.mul_add(x, y.mul_add(y, z * z));
        if L::FUSED {
            let length = length_squared.sqrt();
            let inverse_square = L::splat(1.0) / length_squared;
            let shrink = length * inverse_square;
            return Seen {
                high: [x, y, z],
                low: [x_low, y_low, L::splat(0.0)],
                length,
                inverse_square,
                height: z * shrink,
                scale: determinant * shrink * inverse_square,
            };
        }
        let shrink = L::splat(1.0) / length_squared.sqrt();
        let (high_x, low_x) = two_product(x, shrink);
        let (high_y, low_y) = two_product(y, shrink);
        let (high_z, low_z) = two_product(z, shrink);
        let high = [high_x, high_y, high_z];
        let mut low = [x_low.mul_add(shrink, low_x), y_low.mul_add(shrink, low_y), low_z];
        // The excess of the length over 1: at s = 1e8 even 1e-7 of it counts, by its square.
        let along = high_x.mul_add(low[0], high_y.mul_add(low[1], high_z * low[2]));
        let excess = length_squared_minus_one(high).mul_add(L::splat(0.5), along);
        for i in 0..3 {
            low[i] = excess.neg_mul_add(high[i], low[i]);
        }
        Seen { scale: determinant * shrink * (shrink * shrink), ..Seen::round(high, low) }
    }

    /// The direction whose squeezed image is along `u`, not normalised, still in the frame of the view.
    #[inline(always)]
    pub fn unsqueeze(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        [x / self.along, y / self.inverse, z]
    }

    /// Turns a direction from the frame of the view back to the caller's.
    #[inline(always)]
    pub fn turn_back(&self, d: [f32; 3]) -> [f32; 3] {
        turn_back(d, self.azimuth)
    }
}

impl Precise {
    /// Of the numbers of a [`Squeeze`].
    #[inline(always)]
    pub fn new(azimuth: [f32; 2], excess: f32, along: f32, inverse: f32) -> Self {
        let unit = 1.0 - f64::from(excess);
        Self {
            azimuth: [f64::from(azimuth[0]) * unit, f64::from(azimuth[1]) * unit],
            stretch: [f64::from(along), f64::from(inverse)],
            determinant: along * inverse,
        }
    }

    /// One direction as round and as squeezed lobes see it. `is_fused`: whether what sums the lobes has fused
    /// operations.
    #[inline(always)]
    pub fn see(&self, [x, y, z]: [f32; 3], is_fused: bool) -> [Sight; 2] {
        let ([c, s], [along, inverse]) = (self.azimuth, self.stretch);
        let (wide_x, wide_y) = (f64::from(x), f64::from(y));
        let (turned_x, turned_y) = (wide_x * c + wide_y * s, wide_y * c - wide_x * s);
        let round = Sight::split([turned_x, turned_y], z);
        let (squeezed_x, squeezed_y) = (turned_x * along, turned_y * inverse);
        if is_fused {
            let squeezed = Sight::split([squeezed_x, squeezed_y], z);
            let [x, y, _] = squeezed.high;
            let length_squared = x * x + (y * y + z * z);
            let length = Lanes::sqrt(length_squared);
            let inverse_square = 1.0 / length_squared;
            let shrink = length * inverse_square;
            let (height, scale) = (z * shrink, self.determinant * shrink * inverse_square);
            return [round, Seen { length, inverse_square, height, scale, ..squeezed }];
        }
        let wide_z = f64::from(z);
        let length_squared = squeezed_x * squeezed_x + squeezed_y * squeezed_y + wide_z * wide_z;
        let length = Lanes::sqrt(length_squared as f32);
        // One step of Newton from the f32 root: 1e-14.
        let root = f64::from(1.0 / length);
        let shrink = root * (1.5 - 0.5 * length_squared * (root * root));
        let scale = self.determinant * (shrink * shrink * shrink) as f32;
        let squeezed_z = wide_z * shrink;
        let mut squeezed = Sight::split([squeezed_x * shrink, squeezed_y * shrink], squeezed_z as f32);
        squeezed.low[2] = (squeezed_z - f64::from(squeezed.high[2])) as f32;
        [round, Seen { scale, ..squeezed }]
    }
}

/// Turns directions from the frame of a view, of such an azimuth, back to the caller's.
#[inline(always)]
pub(crate) fn turn_back<L: Lanes>([x, y, z]: [L; 3], [c, s]: [L; 2]) -> [L; 3] {
    [y.neg_mul_add(s, x * c), x.mul_add(s, y * c), z]
}

/// One direction as a squeezed lobe takes it.
pub(crate) type Sight = Seen<f32>;

impl<L: Lanes> Seen<L> {
    /// Of a unit vector.
    #[inline(always)]
    fn round(high: [L; 3], low: [L; 3]) -> Self {
        let one = L::splat(1.0);
        Self { high, low, length: one, inverse_square: one, height: high[2], scale: one }
    }

    /// As an array, for a structure of arrays.
    #[inline(always)]
    pub fn to_numbers(self) -> [L; NUMBERS] {
        let Self { high: [x, y, z], low: [x_low, y_low, z_low], length, inverse_square, height, scale } =
            self;
        [x, y, z, x_low, y_low, z_low, length, inverse_square, height, scale]
    }

    /// Of such an array.
    #[inline(always)]
    pub fn from_numbers(numbers: [L; NUMBERS]) -> Self {
        let [x, y, z, x_low, y_low, z_low, length, inverse_square, height, scale] = numbers;
        Self { high: [x, y, z], low: [x_low, y_low, z_low], length, inverse_square, height, scale }
    }
}

impl Sight {
    /// A vector of which x and y are in f64 as a sum of two f32, taken for a unit vector.
    #[inline(always)]
    fn split(xy: [f64; 2], z: f32) -> Self {
        let (mut high, mut low) = ([0.0, 0.0, z], [0.0; 3]);
        for i in 0..2 {
            high[i] = xy[i] as f32;
            low[i] = (xy[i] - f64::from(high[i])) as f32;
        }
        Self::round(high, low)
    }

    /// In every lane.
    #[inline(always)]
    pub fn splat<L: Lanes>(&self) -> Seen<L> {
        Seen {
            high: splat3(self.high),
            low: splat3(self.low),
            length: L::splat(self.length),
            inverse_square: L::splat(self.inverse_square),
            height: L::splat(self.height),
            scale: L::splat(self.scale),
        }
    }

    /// `yes` in the lanes of a mask, `no` in the others.
    #[inline(always)]
    pub fn splat_either<L: Lanes>(mask: L::Mask, yes: &Self, no: &Self) -> Seen<L> {
        let (yes, no) = (yes.to_numbers(), no.to_numbers());
        let mut numbers = [L::splat(0.0); NUMBERS];
        for n in 0..NUMBERS {
            numbers[n] = L::select(mask, L::splat(yes[n]), L::splat(no[n]));
        }
        Seen::from_numbers(numbers)
    }
}
