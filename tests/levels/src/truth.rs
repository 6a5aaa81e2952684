//! Values of a mixture in f64 from their definition.

use srbf_core::{Domain, Mixture, Vec3};

/// `f cos` at a direction, and what its error is divided by: the sum over the lobes of value times `2 + |t|`, `t` the
/// exponent, as rounding `t` alone costs that much.
pub struct Truth {
    /// Linear sRGB.
    pub value: [f64; 3],
    /// Of magnitudes: a channel of a lobe may be negative.
    pub scale: [f64; 3],
    /// Of luminances, which are positive.
    pub luminance_scale: f64,
}

impl Truth {
    /// Of the value.
    pub fn luminance(&self) -> f64 {
        luminance(self.value)
    }

    /// Adds the value of a lobe, and that times its unit.
    fn add(&mut self, value: [f64; 3], unit: f64) {
        for (c, v) in value.into_iter().enumerate() {
            self.value[c] += v;
            self.scale[c] += v.abs() * unit;
        }
        self.luminance_scale += luminance(value) * unit;
    }
}

fn luminance(rgb: [f64; 3]) -> f64 {
    rgb.iter().zip(srbf_core::LUMINANCE).map(|(v, w)| v * f64::from(w)).sum()
}

/// Whether a direction is where the mixture lives.
pub fn is_inside(m: &Mixture<64>, d: Vec3) -> bool {
    m.domain() == Domain::Sphere || d.z >= 0.0
}

/// The value of a mixture at a direction.
pub fn truth(m: &Mixture<64>, d: Vec3) -> Truth {
    let mut sum = Truth { value: [0.0; 3], scale: [0.0; 3], luminance_scale: 0.0 };
    if !is_inside(m, d) {
        return sum;
    }
    // A unit vector but for rounding.
    let [cos, sin] = m.azimuth_cos_sin().map(f64::from);
    let length = libm::hypot(cos, sin);
    let (cos, sin) = (cos / length, sin / length);
    let [x, y, z] = d.to_array().map(f64::from);
    let (x, y) = (x * cos + y * sin, y * cos - x * sin);
    let inverse = f64::from(1.0 / m.squeeze());
    let r = libm::sqrt(x * x + y * y * inverse * inverse + z * z);
    sum.add(m.diffuse().to_array().map(|rho| f64::from(rho) * z / core::f64::consts::PI), 2.0);
    for k in 0..m.len() {
        let lobe = m.lobe(k).expect("a lobe of the mixture");
        let axis = lobe.gaussian.axis.to_array().map(f64::from);
        let (u, change) = if k < m.squeezed_len() {
            ([x / r, y * inverse / r, z / r], inverse / (r * r * r))
        } else {
            ([x, y, z], 1.0)
        };
        let mut add = |axis_z: f64| {
            let (dx, dy, dz) = (u[0] - axis[0], u[1] - axis[1], u[2] - axis_z);
            let t = -0.5 * f64::from(lobe.gaussian.sharpness) * (dx * dx + dy * dy + dz * dz);
            // Below 2^-100 of its amplitude a lobe is 0.
            let unit = if t < -69.3 { 1e7 } else { 2.0 - t };
            sum.add(lobe.amplitude.to_array().map(|a| f64::from(a) * libm::exp(t) * change), unit);
        };
        add(axis[2]);
        if m.domain() == Domain::Hemisphere {
            add(-axis[2]);
        }
    }
    sum
}
