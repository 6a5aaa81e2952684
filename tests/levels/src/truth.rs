//! Values of a mixture in f64 from their definition.

use srbf_core::{Domain, Mixture, Vec3};

/// `f cos` at a direction, and what its error is divided by: the sum over the lobes of value times `2 + |t|`, `t` the
/// exponent, as rounding `t` alone costs that much.
pub struct Truth {
    pub value: [f64; 3],
    pub scale: [f64; 3],
}

impl Truth {
    pub fn luminance(&self) -> f64 {
        luminance(self.value)
    }
    pub fn luminance_scale(&self) -> f64 {
        luminance(self.scale)
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
    let mut sum = Truth { value: [0.0; 3], scale: [0.0; 3] };
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
    for (c, rho) in m.diffuse().to_array().into_iter().enumerate() {
        let value = f64::from(rho) * z / core::f64::consts::PI;
        sum.value[c] += value;
        sum.scale[c] += 2.0 * value;
    }
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
            for (c, a) in lobe.amplitude.to_array().into_iter().enumerate() {
                let value = f64::from(a) * libm::exp(t) * change;
                sum.value[c] += value;
                // Below 2^-100 of its amplitude a lobe is 0.
                let may_be_0 = t < -69.3;
                sum.scale[c] += value * if may_be_0 { 1e7 } else { 2.0 - t };
            }
        };
        add(axis[2]);
        if m.domain() == Domain::Hemisphere {
            add(-axis[2]);
        }
    }
    sum
}
