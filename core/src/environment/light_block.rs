//! Sixteen samples of the light, drawn once and used at many surfaces.

use super::draw::EnvironmentSample;
use super::light::{LIGHT_BLOCK, LightRows, LightSource};
use crate::simd::prefetch;
use glam::Vec3;

/// Sixteen samples of a light as rows, each a cache line: what [`reflect`](crate::AnyMixture::reflect)
/// reads.
///
/// Blocks are made before rendering, as many as the caller has memory for, 448 bytes each. A *tile* is a few
/// thousand of them, made of the points of one evenly spread sequence. A surface takes one of them. Where the
/// block that sample `i` of a pixel takes is `i` or `i` with some bits flipped, the pixel's blocks are evenly
/// spread too.
///
/// ```
/// use srbf_core::{Environment, LightBlock, environment_len};
///
/// let map = [[2.0; 3], [2.0; 3], [0.5; 3], [0.5; 3]];
/// let environment = Environment::new(2, &map, vec![0; environment_len(2, 2)?])?;
/// let even: [f32; 16] = std::array::from_fn(|i| (i as f32 + 0.5) / 16.0);
/// let block = LightBlock::new(&environment, [&even, &[0.0; 16], &even]);
/// assert!(block.pdf.iter().all(|&pdf| pdf > 0.0));
/// # Ok::<(), srbf_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct LightBlock {
    /// Unit vectors in the world, towards the light: x, y, z.
    pub direction: [[f32; LIGHT_BLOCK]; 3],
    /// Radiance from there over the density: red, green, blue; linear sRGB.
    pub light: [[f32; LIGHT_BLOCK]; 3],
    /// Densities, above 0; 1/sr.
    pub pdf: [f32; LIGHT_BLOCK],
}

impl LightBlock {
    /// Draws a block, three uniform numbers in [0, 1) a sample. Of a light that is no map, the light is an estimate; a draw that
    /// finds nothing brings none.
    pub fn new(light: &impl LightSource, u: [&[f32; LIGHT_BLOCK]; 3]) -> Self {
        if let Some(environment) = light.environment() {
            return Self::of(|i| environment.sample([u[0][i], u[1][i], u[2][i]]));
        }
        let mut rows = LightRows::NONE;
        light.sample_into(u.map(|u| &u[..]), &mut rows);
        rows.mend(true);
        let LightRows { direction, radiance, pdf } = rows;
        Self::of(|i| EnvironmentSample {
            direction: Vec3::new(direction[0][i], direction[1][i], direction[2][i]),
            // Any density above 0 does for what brings no light.
            pdf: if pdf[i] > 0.0 { pdf[i] } else { 1.0 },
            radiance: Vec3::new(radiance[0][i], radiance[1][i], radiance[2][i]),
        })
    }

    /// Of sixteen samples that were drawn, each by itself with the density that it tells.
    pub fn of(mut drawn: impl FnMut(usize) -> EnvironmentSample) -> Self {
        let zero = [0.0; LIGHT_BLOCK];
        let mut block = Self { direction: [zero; 3], light: [zero; 3], pdf: zero };
        for i in 0..LIGHT_BLOCK {
            let EnvironmentSample { direction, pdf, radiance } = drawn(i);
            let light: Vec3 = radiance / pdf;
            for k in 0..3 {
                (block.direction[k][i], block.light[k][i]) = (direction[k], light[k]);
            }
            block.pdf[i] = pdf;
        }
        block
    }

    /// Asks the processor for the block, which will be read soon. Changes no result.
    #[inline]
    pub fn prefetch(&self) {
        self.direction.iter().chain(&self.light).chain([&self.pdf]).for_each(prefetch);
    }
}
