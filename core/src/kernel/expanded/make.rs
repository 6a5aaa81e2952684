//! Expands a material: prepares it exactly at the angle of each row.

use super::super::between_views::{Place, at_place, views_passed};
use super::table::{
    DIFFUSE, DIFFUSE_POWER, Expanded, INVERSE_SQUEEZE, LOBES_ALBEDO, LOBES_POWER, Shape, angles, expanded_len,
};
use crate::color::luminance;
use crate::error::Error;
use crate::material::borrowed::{Material, MaterialRef};
use crate::mixture::complete::LEAST_WITHOUT_SERIES;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::row;
use crate::mixture::rows::{Domain, Mixture};
use crate::simd::detect::Level;
use crate::simd::lanes::{Numbers, WIDEST};
use crate::squeeze::Squeeze;
use core::f32::consts::{FRAC_PI_2, PI};
use glam::Vec3;

/// Largest square of the distance of an axis at two neighbouring rows at which one step of Newton's makes the axes between them
/// unit vectors: it leaves 3/8 (1e-3 / 4)^2.
const FINE: f32 = 1e-3;

/// A power below this is none: its products would be subnormals, 150 cycles each on Intel. A lobe goes by its
/// luminance first, which then stays positive without the channels that are this small: a channel may be
/// negative, and one left alone would make a density negative.
const LEAST_POWER: f32 = 1e-30;

impl<'m> Expanded<'m> {
    /// Whether a material can be expanded, and into this number of rows.
    ///
    /// # Errors
    /// [`Error::Anisotropic`] and [`Error::Rows`], as [`new`](Self::new).
    pub fn check(material: &Material<impl AsRef<[u8]>>, rows: usize) -> Result<(), Error> {
        check(material.borrowed(), rows)
    }

    /// Expands a material into `memory`, of at least [`Material::expanded_len`] numbers of any value, which
    /// is borrowed from then on. It takes a few microseconds a row, and is the same for every [`Level`].
    ///
    /// # Errors
    /// [`Error::Anisotropic`] for an anisotropic material, [`Error::Rows`] for less than 2 or more than
    /// [`MAX_ROWS`](Self::MAX_ROWS) rows, [`Error::Memory`] for too little memory.
    pub fn new(
        material: &'m Material<impl AsRef<[u8]>>,
        rows: usize,
        memory: &'m mut [f32],
    ) -> Result<Self, Error> {
        Self::make(material.borrowed(), rows, memory)
    }

    /// The same, compiled here, whoever owns the bytes of the material.
    fn make(material: MaterialRef<'m>, rows: usize, memory: &'m mut [f32]) -> Result<Self, Error> {
        check(material, rows)?;
        let (needed, available) = (expanded_len(material.header, rows), memory.len());
        if available < needed {
            return Err(Error::Memory { needed, available });
        }
        let shape = Shape::new(material.header, rows);
        let skip = memory.as_ptr().align_offset(4 * WIDEST).min(WIDEST - 1);
        let (chunks, _) = memory[skip..].as_chunks_mut::<WIDEST>();
        let (knots, chunks) = chunks.split_at_mut(3 * shape.knot_chunks);
        let chunks = &mut chunks[..rows * shape.stride];
        let knots = knots.as_flattened_mut();
        knots.fill(0.0);
        let (from_knots, rest) = knots.split_at_mut(WIDEST * shape.knot_chunks);
        let (to_knots, per_radian) = rest.split_at_mut(WIDEST * shape.knot_chunks);

        let mut first = 0;
        for k in 0..shape.knots {
            let from = knot(material, shape, k);
            // The material stays as it is beyond its last view.
            let (next, to) = if k + 1 < shape.knots {
                let to = knot(material, shape, k + 1);
                (row_of_knot(material, shape, rows, k + 1, first), to)
            } else {
                (rows, from)
            };
            if to > from {
                let rows_per_radian = (next - first) as f32 / (to - from);
                (from_knots[k], to_knots[k], per_radian[k]) = (from, to, rows_per_radian);
            }
            for row in first..next {
                let beyond = (row - first) as f32 / (next - first) as f32;
                let chunks = &mut chunks[row * shape.stride..][..shape.stride];
                fill_row(material, shape, beyond * (to - from) + from, chunks);
            }
            first = next;
        }
        let any_diffuse = chunks.chunks_exact(shape.stride).any(|row| row[0][DIFFUSE_POWER] > 0.0);
        let is_plain = is_plain(shape, chunks);
        let stride = shape.stride;
        let (knots, knot_count) = ([&*from_knots, to_knots, per_radian], shape.knots - 1);
        let material = material.to_material();
        Ok(Self { material, knots, knot_count, chunks, rows, stride, is_plain, any_diffuse })
    }
}

fn check(material: MaterialRef<'_>, rows: usize) -> Result<(), Error> {
    if !material.header.is_isotropic() {
        return Err(Error::Anisotropic);
    }
    if !(2..=Expanded::MAX_ROWS).contains(&rows) {
        return Err(Error::Rows);
    }
    Ok(())
}

/// Angle of a knot, radians.
fn knot(material: MaterialRef<'_>, shape: Shape, k: usize) -> f32 {
    if shape.knots == material.header.views {
        material.header.angle(material.bytes, k)
    } else {
        angles(material)[k.min(1)]
    }
}

/// The row of a knot but the first: the rows before it have its share of the whole angle. There is at least one more than before
/// the last knot, whose row is `before`, and every knot to come has one.
fn row_of_knot(material: MaterialRef<'_>, shape: Shape, rows: usize, k: usize, before: usize) -> usize {
    let share = knot(material, shape, k) / angles(material)[1];
    let most = rows - shape.knots + k;
    ((share * (rows - 1) as f32 + 0.5) as usize).clamp((before + 1).min(most), most)
}

/// Prepares a material at an angle of the outgoing direction, and stores the numbers that are interpolated.
fn fill_row(material: MaterialRef<'_>, shape: Shape, theta: f32, chunks: &mut [Numbers]) {
    let mut m = Mixture::<64>::empty();
    m.begin(Level::Scalar, Domain::Hemisphere, Squeeze::NONE);
    let place = Place::after(material, views_passed::<f32>(material, theta), theta);
    at_place::<f32, false>(material, [1.0, 0.0], place, LeaveOut::default(), &mut m);
    m.sum_up();

    let (head, groups) = chunks.split_at_mut(1);
    let head = &mut head[0];
    *head = [0.0; WIDEST];
    head[INVERSE_SQUEEZE] = m.head.squeeze.inverse;
    head[DIFFUSE..DIFFUSE + 3].copy_from_slice(&m.head.diffuse.to_array());
    head[DIFFUSE_POWER] = m.head.diffuse_power;

    let (stored, mirrored) = (material.header.lobes, material.header.mirrored);
    for (g, group) in groups.chunks_exact_mut(shape.width).enumerate() {
        for j in 0..WIDEST {
            let k = WIDEST * g + j;
            // A place without a lobe: along the normal, of no power.
            let (mut axis, mut sharpness, mut power) = (Vec3::Z, 1.0, [0.0; 3]);
            if k < m.head.count {
                axis =
                    Vec3::new(m.number(row::AXIS_X, k), m.number(row::AXIS_Y, k), m.number(row::AXIS_Z, k));
                // An axis below the horizon, which the mixture has mirrored up, goes back: there is no
                // straight line between axes on either side of a fold.
                let of = if k < stored { k } else { k - mirrored };
                if place.lobe_angle(material, of).abs() > FRAC_PI_2 {
                    axis.z = -axis.z;
                }
                sharpness = m.number(row::SHARPNESS, k);
                let integral = 2.0 * PI * m.number(row::INSIDE, k) * m.number(row::INVERSE_SHARPNESS, k);
                let of_each = [
                    m.number(row::RED, k) * integral,
                    m.number(row::GREEN, k) * integral,
                    m.number(row::BLUE, k) * integral,
                ];
                if luminance(Vec3::from_array(of_each)) >= LEAST_POWER {
                    power = of_each.map(|power| if power.abs() < LEAST_POWER { 0.0 } else { power });
                }
                head[LOBES_POWER] += luminance(Vec3::from_array(power));
                for i in 0..3 {
                    head[LOBES_ALBEDO + i] += power[i];
                }
            }
            let numbers = [axis.x, axis.z, sharpness, power[0], power[1], power[2], axis.y];
            for (chunk, number) in group.iter_mut().zip(numbers) {
                chunk[j] = number;
            }
        }
    }
}

/// Whether no axis of a lobe with a power turns far from one row to the next, and no lobe is wide.
fn is_plain(shape: Shape, chunks: &[Numbers]) -> bool {
    let axis = |group: &[Numbers], j: usize| {
        let y = if group.len() > super::table::IN_PLANE { group[6][j] } else { 0.0 };
        Vec3::new(group[0][j], y, group[1][j])
    };
    let power = |group: &[Numbers], j: usize| (3..6).any(|i| group[i][j] != 0.0);
    chunks.chunks_exact(shape.stride).zip(chunks.chunks_exact(shape.stride).skip(1)).all(|(a, b)| {
        let groups = a[1..].chunks_exact(shape.width).zip(b[1..].chunks_exact(shape.width));
        groups.into_iter().all(|(a, b)| {
            (0..WIDEST).all(|j| {
                let moves = power(a, j) || power(b, j);
                let is_fine = !moves || axis(a, j).distance_squared(axis(b, j)) <= FINE;
                is_fine && a[2][j].min(b[2][j]) >= LEAST_WITHOUT_SERIES
            })
        })
    })
}
