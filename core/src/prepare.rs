//! From a material and an outgoing direction to a mixture: lanes are lobes.

use crate::anisotropic;
use crate::format::{self, Kind, f32_at};
use crate::lanes::{Lanes, atan2_positive, exp2, sin_cos};
use crate::simd::Routine;
use crate::squeeze::Squeeze;
use crate::{Domain, Error, Material, Mixture};
use glam::Vec3;

pub(crate) struct Prepare<'a, 'b, 'm, const N: usize> {
    pub material: &'a Material<'b>,
    pub wo: Vec3,
    pub mixture: &'m mut Mixture<N>,
}

impl<const N: usize> Routine for Prepare<'_, '_, '_, N> {
    type Output = Result<(), Error>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<(), Error> {
        prepare::<L, N>(self.material, self.wo, self.mixture)
    }
}

#[inline(always)]
pub(crate) fn prepare<L: Lanes, const N: usize>(
    material: &Material<'_>,
    wo: Vec3,
    mixture: &mut Mixture<N>,
) -> Result<(), Error> {
    let (bytes, header) = (material.bytes, &material.header);
    if let Kind::Grid(shape) = header.kind {
        return anisotropic::prepare::<L, N>(material, shape, wo, mixture);
    }
    mixture.begin(Domain::Hemisphere, Squeeze::NONE);
    let count = header.lobes;
    if count > N {
        return Err(Error::Capacity { needed: count, available: N });
    }
    // False for a NaN too.
    let across_squared = wo.x * wo.x + wo.y * wo.y;
    let is_unit = (across_squared + wo.z * wo.z - 1.0).abs() <= 2e-3;
    if !is_unit {
        return Err(Error::Direction);
    }
    if wo.z < 0.0 {
        return Ok(());
    }

    // +x of the view points away from wo, towards the mirror direction; at the normal any azimuth serves.
    let across = Lanes::sqrt(across_squared);
    let azimuth = if across > 0.0 {
        let inverse = 1.0 / across;
        [-wo.x * inverse, -wo.y * inverse]
    } else {
        [1.0, 0.0]
    };

    // The two views round wo, and how far between them it lies.
    let theta = atan2_positive(across, wo.z);
    let last = header.views - 1;
    let mut passed = 0;
    let mut view = 0;
    while view < last {
        // Bits of the views from here to the last but one that are at most theta; the first always is.
        let thetas = load_bytes::<L>(bytes, header.theta(view));
        let inner = (1u64 << (last - view).min(L::COUNT)) - 1;
        passed += (L::bits(L::splat(theta).ge(thetas)) & inner).count_ones() as usize;
        view += L::COUNT;
    }
    let after = passed.min(last);
    let before = after.saturating_sub(1);
    let (from, to) = (f32_at(bytes, header.theta(before)), f32_at(bytes, header.theta(after)));
    let blend = if to > from { ((theta - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };

    // The heads: squeeze and diffuse albedo.
    let mut head = [0.0; 16];
    let mut i = 0;
    while i < format::HEAD {
        let a = load_bytes::<L>(bytes, header.head(before) + 4 * i);
        let b = load_bytes::<L>(bytes, header.head(after) + 4 * i);
        exp2((b - a).mul_add(L::splat(blend), a)).store(&mut head[i..]);
        i += L::COUNT;
    }
    mixture.squeeze = Squeeze { azimuth, inverse: 1.0 / head[0], ..Squeeze::NONE };
    mixture.diffuse = Vec3::new(head[1], head[2], head[3]);

    let mut k = 0;
    while k < count && k + L::COUNT <= N {
        let valid = L::iota().lt(L::splat((count - k) as f32));
        let zero = L::splat(0.0);
        let mut rows = [zero; 5];
        for (row, value) in rows.iter_mut().enumerate() {
            let a = load_bytes::<L>(bytes, header.row(before, row) + 4 * k);
            let b = load_bytes::<L>(bytes, header.row(after, row) + 4 * k);
            *value = L::select(valid, (b - a).mul_add(L::splat(blend), a), zero);
        }
        let (sin, cos) = sin_cos(rows[0]);
        sin.store(&mut mixture.axis_x[k..]);
        zero.store(&mut mixture.axis_y[k..]);
        cos.store(&mut mixture.axis_z[k..]);
        exp2(rows[1]).store(&mut mixture.sharpness[k..]);
        L::select(valid, exp2(rows[2]), zero).store(&mut mixture.red[k..]);
        L::select(valid, exp2(rows[3]), zero).store(&mut mixture.green[k..]);
        L::select(valid, exp2(rows[4]), zero).store(&mut mixture.blue[k..]);
        k += L::COUNT;
    }
    mixture.finish::<L>(count, header.squeezed);
    Ok(())
}

/// Loads little-endian f32 from bytes of any alignment; what lies past the end reads as 0.
#[inline(always)]
pub(crate) fn load_bytes<L: Lanes>(bytes: &[u8], offset: usize) -> L {
    let rest = &bytes[offset..];
    if rest.len() >= 4 * L::COUNT {
        return L::load_bytes(rest);
    }
    let mut padded = [0; 64];
    padded[..rest.len()].copy_from_slice(rest);
    L::load_bytes(&padded)
}
