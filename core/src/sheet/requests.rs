//! Many hits on a sheet: each asks the material of the quarter that it sees, all of them together.

use super::quarter::{Seen, upward};
use super::{Sheet, drawn_share};
use crate::error::Error;
use crate::kernel::request::{Draws, Request, Towards, at};
use crate::kernel::slices::one_length;
use crate::kernel::streamed::pairs::ask_materials;
use crate::material::borrowed::MaterialRef;
use glam::Vec3;

/// Hits that are taken together.
const TOGETHER: usize = 64;

/// Vectors of some hits, x, y, z.
type Vectors = [[f32; TOGETHER]; 3];

/// Directions of viewers, and second vectors, as the quarters of some hits have them.
struct Hits<'a> {
    materials: [MaterialRef<'a>; TOGETHER],
    wo: Vectors,
    with: Vectors,
    shares: [f32; TOGETHER],
    count: usize,
}

impl<'a> Hits<'a> {
    fn new(material: MaterialRef<'a>) -> Self {
        Self {
            materials: [material; TOGETHER],
            wo: [[0.0; TOGETHER]; 3],
            with: [[0.0; TOGETHER]; 3],
            shares: [1.0; TOGETHER],
            count: 0,
        }
    }

    /// Adds a hit; one that sees nothing has no outgoing direction, which reflects nothing.
    fn put(&mut self, i: usize, seen: Option<Seen<'a>>, with: Vec3) {
        let (wo, share) = match seen {
            Some(seen) => {
                self.materials[i] = seen.material;
                (seen.wo, seen.share)
            }
            None => (Vec3::ZERO, 1.0),
        };
        self.shares[i] = share;
        for k in 0..3 {
            self.wo[k][i] = wo[k];
            self.with[k][i] = with[k];
        }
        self.count = i + 1;
    }

    fn ask<'r>(&'r self, request: impl FnOnce([&'r [f32]; 3]) -> Request<'r>) {
        let part = |vectors: &'r Vectors| vectors.each_ref().map(|s| &s[..self.count]);
        ask_materials(&self.materials[..self.count], part(&self.wo), &mut request(part(&self.with)));
    }
}

/// A part of a slice that is written.
fn of<'s>(slice: &'s mut &mut [f32], from: usize, to: usize) -> &'s mut [f32] {
    &mut slice[from..to]
}

impl<B: AsRef<[u8]>> Sheet<B> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`sample`](Self::sample) and [`evaluate_and_pdf`](Self::evaluate_and_pdf), one by one, within rounding and in less
    /// time. Shapes: `wo` x, y, z, each `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        let Some(any) = self.head.any(self.bytes()) else { return Ok(()) };
        let mut hits = Hits::new(any);
        for from in (0..n).step_by(TOGETHER) {
            let to = n.min(from + TOGETHER);
            if let Some(draws) = &mut request.draw {
                self.draw(&mut hits, wo, draws, from, to);
            }
            if let Some(towards) = &mut request.evaluate {
                self.look(&mut hits, wo, towards, from, to);
            }
        }
        Ok(())
    }

    fn draw<'a>(
        &'a self,
        hits: &mut Hits<'a>,
        wo: [&[f32]; 3],
        draws: &mut Draws<'_>,
        from: usize,
        to: usize,
    ) {
        let mut is_flipped = [false; TOGETHER];
        for i in from..to {
            let (wo, u) = (at(&wo, i), at(&draws.u, i));
            let (seen, is_transmission, first) = self.drawn(wo, u.x);
            is_flipped[i - from] = (wo.z < 0.0) != is_transmission;
            hits.put(i - from, seen, Vec3::new(first, u.y, u.z));
        }
        hits.ask(|u| {
            let direction = draws.direction.each_mut().map(|s| of(s, from, to));
            let pdf = draws.pdf.as_mut().map(|s| of(s, from, to));
            let weight = draws.weight.as_mut().map(|w| w.each_mut().map(|s| of(s, from, to)));
            Draws { u, direction, pdf, weight }.into()
        });
        for i in from..to {
            let share = hits.shares[i - from];
            if is_flipped[i - from] {
                draws.direction[2][i] = -draws.direction[2][i];
            }
            if let Some(pdf) = &mut draws.pdf
                && pdf[i] > 0.0
            {
                pdf[i] = drawn_share(pdf[i], share);
            }
            if let Some(weight) = &mut draws.weight {
                weight.iter_mut().for_each(|channel| channel[i] /= share);
            }
        }
    }

    fn look<'a>(
        &'a self,
        hits: &mut Hits<'a>,
        wo: [&[f32]; 3],
        towards: &mut Towards<'_>,
        from: usize,
        to: usize,
    ) {
        for i in from..to {
            let (wo, wi) = (at(&wo, i), at(&towards.wi, i));
            hits.put(i - from, self.towards(wo, wi), upward(wi));
        }
        hits.ask(|wi| {
            let value = towards.value.as_mut().map(|v| v.each_mut().map(|s| of(s, from, to)));
            let pdf = towards.pdf.as_mut().map(|s| of(s, from, to));
            Towards { wi, value, pdf }.into()
        });
        if let Some(pdf) = &mut towards.pdf {
            pdf[from..to].iter_mut().zip(&hits.shares).for_each(|(pdf, share)| *pdf *= share);
        }
    }
}
