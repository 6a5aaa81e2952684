//! The same lobes by the formulas of a textbook and libm's functions, as one would write them first: neither fold, squeeze,
//! colour differences nor a direction of two numbers. The verbs of `core` are measured against it.

use srbf_core::{Material, PlaneLobe};

/// Lobes that the preset makes.
const MOST: usize = 12;

/// Lobes of one outgoing direction.
#[derive(Default)]
pub struct Lobes {
    count: usize,
    axis: [[f32; 3]; MOST],
    sharpness: [f32; MOST],
    rgb: [[f32; 3]; MOST],
    /// The running sum of the integrals of the green amplitude.
    running: [f32; MOST],
    /// `1 - exp(-2 s)`.
    inside: [f32; MOST],
}

impl Lobes {
    /// Interpolates the lobes between two views; returns their power.
    pub fn prepare(&mut self, material: &Material<&'static [u8]>, wo: [f32; 3]) -> f32 {
        let theta = libm::atan2f(libm::sqrtf(wo[0] * wo[0] + wo[1] * wo[1]), wo[2]);
        let azimuth = libm::atan2f(-wo[1], -wo[0]);
        let (sin_azimuth, cos_azimuth) = (libm::sinf(azimuth), libm::cosf(azimuth));
        let (mut before, mut from, mut to) = (0, 0.0, 0.0);
        for view in 1..material.view_count() {
            to = material.view_theta(view).unwrap_or_default();
            before = view - 1;
            if to > theta {
                break;
            }
            from = to;
        }
        let blend = ((theta - from) / (to - from)).clamp(0.0, 1.0);
        let mut power = 0.0;
        self.count = 0;
        for stored in 0..material.view_lobe_count() {
            let pair = (material.view_lobe(before, stored), material.view_lobe(before + 1, stored));
            let (Some(a), Some(b)) = pair else { continue };
            let between = |number: fn(&PlaneLobe) -> f32| number(&a) + blend * (number(&b) - number(&a));
            let (angle, off_plane) = (between(|l| l.angle), between(|l| l.off_plane));
            let sharpness = libm::exp2f(between(|l| l.log2_sharpness));
            let luminance = libm::exp2f(between(|l| l.log2_luminance));
            let [red, blue] =
                [between(|l| l.color_differences[0]), between(|l| l.color_differences[1])].map(|d| 1.0 + d);
            let is_mirrored = stored + material.mirrored_count() >= material.view_lobe_count();
            for side in [off_plane, -off_plane].into_iter().take(if is_mirrored { 2 } else { 1 }) {
                if self.count >= MOST {
                    break;
                }
                let (x, y) = (libm::sinf(angle) * libm::cosf(side), libm::sinf(side));
                let k = self.count;
                self.axis[k] = [
                    x * cos_azimuth - y * sin_azimuth,
                    x * sin_azimuth + y * cos_azimuth,
                    libm::cosf(angle) * libm::cosf(side),
                ];
                self.sharpness[k] = sharpness;
                self.rgb[k] = [red * luminance, luminance, blue * luminance];
                self.inside[k] = -libm::expm1f(-2.0 * sharpness);
                power += luminance * core::f32::consts::TAU * self.inside[k] / sharpness;
                self.running[k] = power;
                self.count += 1;
            }
        }
        power
    }

    /// The sum of the lobes.
    pub fn value(&self, wi: [f32; 3]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for k in 0..self.count.min(MOST) {
            let [x, y, z] = self.axis[k];
            let g = libm::expf(self.sharpness[k] * (x * wi[0] + y * wi[1] + z * wi[2] - 1.0));
            for channel in 0..3 {
                sum[channel] += g * self.rgb[k][channel];
            }
        }
        sum
    }

    /// A direction, and its density.
    pub fn draw(&self, u: [f32; 3]) -> ([f32; 3], f32) {
        let last = self.count.clamp(1, MOST) - 1;
        let target = u[0] * self.running[last];
        let k = self.running[..last].iter().take_while(|running| **running <= target).count();
        let w = 1.0 + libm::logf(1.0 - u[1] * self.inside[k]) / self.sharpness[k];
        let across = libm::sqrtf((1.0 - w * w).max(0.0));
        let phi = core::f32::consts::TAU * u[2];
        let (p, q) = (across * libm::cosf(phi), across * libm::sinf(phi));
        let [x, y, z] = self.axis[k];
        let a = -1.0 / (1.0 + z.abs());
        let b = x * y * a;
        let sign = if z < 0.0 { -1.0 } else { 1.0 };
        let tangent = [1.0 + sign * x * x * a, sign * b, -sign * x];
        let bitangent = [b, sign + y * y * a, -y];
        let mut direction = [0.0; 3];
        for i in 0..3 {
            direction[i] = p * tangent[i] + q * bitangent[i] + w * self.axis[k][i];
        }
        (direction, self.value(direction)[1] / self.running[last])
    }
}
