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

/// Hits whose draws, whose values, or whose both come from one quarter, as the quarter has them, and the answers.
struct Hits<'a> {
    /// Which hits they are.
    numbers: [usize; TOGETHER],
    materials: [MaterialRef<'a>; TOGETHER],
    wo: Vectors,
    u: Vectors,
    wi: Vectors,
    /// Shares of the draws, and whether directions that are drawn lie behind.
    shares: [f32; TOGETHER],
    is_flipped: [bool; TOGETHER],
    direction: Vectors,
    weight: Vectors,
    value: Vectors,
    /// Densities of draws, and towards `wi`.
    pdf: [[f32; TOGETHER]; 2],
    count: usize,
}

/// The question of a hit to a quarter.
#[derive(Clone, Copy, Default)]
struct Question {
    u: Vec3,
    is_flipped: bool,
    wi: Vec3,
}

/// The first numbers of three slices.
fn first(vectors: &Vectors, count: usize) -> [&[f32]; 3] {
    vectors.each_ref().map(|s| &s[..count])
}

fn first_mut(vectors: &mut Vectors, count: usize) -> [&mut [f32]; 3] {
    vectors.each_mut().map(|s| &mut s[..count])
}

/// Writes a vector over a number.
fn store(to: &mut [&mut [f32]; 3], i: usize, from: &Vectors, n: usize, over: f32) {
    to.iter_mut().zip(from).for_each(|(to, from)| to[i] = from[n] / over);
}

impl<'a> Hits<'a> {
    fn new(material: MaterialRef<'a>) -> Self {
        const NONE: Vectors = [[0.0; TOGETHER]; 3];
        Self {
            numbers: [0; TOGETHER],
            materials: [material; TOGETHER],
            wo: NONE,
            u: NONE,
            wi: NONE,
            shares: [1.0; TOGETHER],
            is_flipped: [false; TOGETHER],
            direction: NONE,
            weight: NONE,
            value: NONE,
            pdf: [[0.0; TOGETHER]; 2],
            count: 0,
        }
    }

    /// Adds a hit; one that sees nothing has no outgoing direction, which reflects nothing.
    #[inline(never)]
    fn put(&mut self, number: usize, seen: Option<Seen<'a>>, question: Question) {
        let i = self.count;
        let (wo, share) = match seen {
            Some(seen) => {
                self.materials[i] = seen.material;
                (seen.wo, seen.share)
            }
            None => (Vec3::ZERO, 1.0),
        };
        (self.numbers[i], self.shares[i], self.is_flipped[i]) = (number, share, question.is_flipped);
        for k in 0..3 {
            self.wo[k][i] = wo[k];
            self.u[k][i] = question.u[k];
            self.wi[k][i] = question.wi[k];
        }
        self.count = i + 1;
    }

    /// Asks for all wanted outputs, writes the answers, and has no hit left.
    #[inline(never)] // three calls: less code
    fn answer(&mut self, request: &mut Request<'_>, [is_drawn, is_looked]: [bool; 2]) {
        let n = core::mem::take(&mut self.count);
        let [of_draw, of_wi] = self.pdf.each_mut().map(|pdf| &mut pdf[..n]);
        let drawn = request.draw.as_ref().filter(|_| is_drawn).map(|draws| Draws {
            u: first(&self.u, n),
            direction: first_mut(&mut self.direction, n),
            pdf: draws.pdf.is_some().then_some(of_draw),
            weight: draws.weight.is_some().then(|| first_mut(&mut self.weight, n)),
        });
        let looked = request.evaluate.as_ref().filter(|_| is_looked).map(|towards| Towards {
            wi: first(&self.wi, n),
            value: towards.value.is_some().then(|| first_mut(&mut self.value, n)),
            pdf: towards.pdf.is_some().then_some(of_wi),
        });
        let wo = first(&self.wo, n);
        ask_materials(&self.materials[..n], wo, &mut Request { draw: drawn, evaluate: looked });
        for (k, (&i, &share)) in self.numbers[..n].iter().zip(&self.shares).enumerate() {
            if let Some(Draws { direction, pdf, weight, .. }) = request.draw.as_mut().filter(|_| is_drawn) {
                store(direction, i, &self.direction, k, 1.0);
                if self.is_flipped[k] {
                    direction[2][i] = -direction[2][i];
                }
                if let Some(pdf) = pdf {
                    let own = self.pdf[0][k];
                    pdf[i] = if own > 0.0 { drawn_share(own, share) } else { own };
                }
                if let Some(weight) = weight {
                    store(weight, i, &self.weight, k, share);
                }
            }
            if let Some(Towards { value, pdf, .. }) = request.evaluate.as_mut().filter(|_| is_looked) {
                if let Some(value) = value {
                    store(value, i, &self.value, k, 1.0);
                }
                if let Some(pdf) = pdf {
                    pdf[i] = share * self.pdf[1][k];
                }
            }
        }
    }
}

impl<B: AsRef<[u8]>> Sheet<B> {
    /// Draws and evaluates for n hits, each with an outgoing direction of its own: outputs that are given are wanted.
    ///
    /// The answers of [`sample`](Self::sample) and [`evaluate_and_pdf`](Self::evaluate_and_pdf), one by one, within rounding and in less
    /// time. A hit asks one mixture where it draws from the quarter that it is evaluated in, and else two. Shapes: `wo` x, y, z, each
    /// `[n]`; every slice of the request `[n]`.
    ///
    /// # Errors
    /// [`Error::Length`] if the slices are not all of one length; nothing is written then.
    pub fn ask(&self, wo: [&[f32]; 3], mut request: Request<'_>) -> Result<(), Error> {
        let n = one_length(&wo)?;
        request.check(n)?;
        let Some(any) = self.head.any(self.bytes()) else { return Ok(()) };
        // Hits whose draw and whose value are of one quarter, and those of two.
        let (mut one, mut two) = (Hits::new(any), Hits::new(any));
        for from in (0..n).step_by(TOGETHER) {
            let to = n.min(from + TOGETHER);
            let is_both = request.draw.is_some() && request.evaluate.is_some();
            for i in from..to {
                let drawn = request.draw.as_ref().map(|draws| self.question(at(&wo, i), at(&draws.u, i)));
                let wi = request.evaluate.as_ref().map(|towards| at(&towards.wi, i));
                let is_apart =
                    drawn.as_ref().zip(wi).is_some_and(|((_, drawn), wi)| (wi.z < 0.0) != drawn.is_flipped);
                let (hits, looked) = if is_apart { (&mut two, None) } else { (&mut one, wi) };
                let looked_up = looked.map_or(Vec3::ZERO, upward);
                match drawn {
                    Some((seen, question)) => hits.put(i, seen, Question { wi: looked_up, ..question }),
                    None => {
                        let seen = wi.and_then(|wi| self.towards(at(&wo, i), wi));
                        hits.put(i, seen, Question { wi: looked_up, ..Question::default() });
                    }
                }
            }
            one.answer(&mut request, [true, true]);
            if is_both && two.count > 0 {
                let apart = two.numbers;
                let count = two.count;
                two.answer(&mut request, [true, false]);
                if let Some(towards) = &request.evaluate {
                    for i in &apart[..count] {
                        let (wo, wi) = (at(&wo, *i), at(&towards.wi, *i));
                        two.put(*i, self.towards(wo, wi), Question { wi: upward(wi), ..Question::default() });
                    }
                }
                two.answer(&mut request, [false, true]);
            }
        }
        Ok(())
    }

    /// The quarter that a draw chooses, and its question.
    fn question(&self, wo: Vec3, u: Vec3) -> (Option<Seen<'_>>, Question) {
        let (seen, is_transmission, first) = self.drawn(wo, u.x);
        let is_flipped = (wo.z < 0.0) != is_transmission;
        (seen, Question { u: Vec3::new(first, u.y, u.z), is_flipped, wi: Vec3::ZERO })
    }
}
