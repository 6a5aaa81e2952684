//! Sheets: surfaces that are thin, reflect light and let some through. Glass, cloth, paper, blinds.
//!
//! A sheet has up to four *quarters*, each a material: reflection and transmission, seen from the front and from the back. One number of
//! a draw chooses between reflection and transmission, by a share for the angle of `wo`. So a hit asks one material, and its density is
//! that share times the material's.
//!
//! [`bytes`] is the format, [`requests`] asks for many hits.
//! May import: `mixture`, `kernel`, `material`, `simd`, `error`.

mod bytes;
pub(crate) mod quarter;
mod requests;

use crate::error::Error;
use crate::kernel::draw::choose;
use crate::kernel::prepare::prepare;
use crate::kernel::streamed::one::{Asked, ask_one};
use crate::material::borrowed::{Material, MaterialRef};
use crate::material::format_error::FormatError;
use crate::mixture::leave_out::LeaveOut;
use crate::mixture::rows::{AnyMixture, Groups, Mixture, Room, Sample, drawn_density};
use crate::simd::detect::Level;
use bytes::Head;
use glam::Vec3;
use quarter::{Quarter, Seen, is_across, upward};

/// A sheet in `.srbf` bytes of any alignment, which are checked once: nothing is copied, nothing allocated.
///
/// Directions are unit vectors in the frame of the sheet, whose front is +z. Outgoing `wo` points to the viewer, incident `wi` to the
/// light, and either may lie in front or behind. Both media are the same. The verbs are those of a [`Material`].
///
/// # Examples
/// ```
/// use srbf_core::{Line, Material, PlaneLobe, Quarter, Sheet, View};
///
/// // A sheet that reflects a fifth of the light and lets half of it through, on the spot.
/// let material = |albedo: f32, out: &mut [u8]| {
///     let grey = [0.0; 2];
///     let lobe = PlaneLobe {
///         angle: 0.0,
///         off_plane: 0.0,
///         log2_sharpness: 5.0,
///         log2_luminance: -9.0,
///         color_differences: grey,
///     };
///     let view = View {
///         theta: 0.0,
///         log2_squeeze: 0.0,
///         log2_diffuse: albedo.log2(),
///         diffuse_color_differences: grey,
///         lobes: &[lobe],
///     };
///     Line { views: &[view], squeezed: 0, mirrored: 0, factors: None }.encode("", out)
/// };
/// let mut halves = [[0; 256]; 2];
/// let lengths = [material(0.2, &mut halves[0])?, material(0.5, &mut halves[1])?];
/// let [reflection, transmission] = [0, 1].map(|i| Material::from_bytes(&halves[i][..lengths[i]]).unwrap());
///
/// let quarters = [Some(&reflection), Some(&transmission), None, None];
/// let mut bytes = [0; 1024];
/// // The back is like the front.
/// let length = Sheet::encode(quarters, true, "an example", &mut bytes)?;
/// let sheet = Sheet::from_bytes(&bytes[..length])?;
///
/// let wo = [0.6, 0.0, 0.8];
/// let sample = sheet.sample(wo, [0.9, 0.6, 0.1]).expect("it reflects or transmits");
/// assert!(sample.direction.z < 0.0, "a large first number takes the way through");
/// let (value, pdf) = sheet.evaluate_and_pdf(wo, sample.direction);
/// assert!((value / pdf - sample.weight).abs().max_element() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sheet<B = &'static [u8]> {
    bytes: B,
    head: Head,
}

impl Sheet {
    /// Bytes that [`encode`](Self::encode) writes.
    pub fn encoded_len<B: AsRef<[u8]>>(quarters: [Option<&Material<B>>; 4], provenance: &str) -> usize {
        bytes::encoded_len(quarters.map(|material| material.map(Material::borrowed)), provenance)
    }

    /// Writes a sheet of up to four materials, in the order of [`Quarter::ALL`], and checks it as a reader would.
    ///
    /// A quarter that is `None` is black. `is_symmetric`: the back is like the front, and its quarters are not given. Directions of the
    /// materials lie above the horizon: see [`quarter`](Self::quarter). Shapes: `out` [[`encoded_len`](Self::encoded_len)], overwritten.
    /// Returns: the bytes written.
    ///
    /// # Errors
    /// [`FormatError::Buffer`] if `out` is too small; [`FormatError::Field`] for no quarter, for a quarter of the back of a symmetric
    /// sheet, and for a sheet of more than 4 GB.
    pub fn encode<B: AsRef<[u8]>>(
        quarters: [Option<&Material<B>>; 4],
        is_symmetric: bool,
        provenance: &str,
        out: &mut [u8],
    ) -> Result<usize, FormatError> {
        bytes::encode(
            quarters.map(|material| material.map(Material::borrowed)),
            is_symmetric,
            provenance,
            out,
        )
    }
}

impl<B: AsRef<[u8]>> Sheet<B> {
    /// Makes a sheet of `.srbf` bytes, after checking every field once.
    ///
    /// # Errors
    /// [`FormatError`], with the place; [`FormatError::Kind`] for the bytes of a material.
    pub fn from_bytes(bytes: B) -> Result<Self, FormatError> {
        let head = bytes::validate(bytes.as_ref())?;
        Ok(Self { bytes, head })
    }

    /// The bytes it was made from.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// The material of a quarter; `None` of one that is black. Its directions lie above the horizon: of a direction behind the sheet the
    /// height changes its sign. So straight through is the mirror direction.
    pub fn quarter(&self, quarter: Quarter) -> Option<Material<&[u8]>> {
        self.head.material(self.bytes(), quarter).map(MaterialRef::to_material)
    }

    /// Whether the back is like the front.
    pub fn is_symmetric(&self) -> bool {
        self.head.is_symmetric
    }

    /// Where the sheet comes from, as its maker wrote it.
    pub fn provenance(&self) -> &str {
        self.head.provenance(self.bytes())
    }

    /// Number of lobes that the storage of [`prepare`](Self::prepare) must have room for.
    pub fn lobe_count(&self) -> usize {
        let count = |q| self.head.material(self.bytes(), q).map_or(0, |m| m.header.lobe_count());
        Quarter::ALL.into_iter().map(count).max().unwrap_or(0)
    }

    /// Share of the draws that are reflected, 0 to 1.
    ///
    /// It follows the power of both materials by the angle of `wo`. The bytes have it for sixteen heights of `wo`.
    pub fn reflected_share(&self, wo: impl Into<Vec3>) -> f32 {
        self.head.reflected_share(self.bytes(), wo.into())
    }

    /// The quarter that a draw goes to, whether that is the way through, and the number that is left for its lobes.
    #[inline(always)]
    fn drawn(&self, wo: Vec3, u: f32) -> (Option<Seen<'_>>, bool, f32) {
        let reflected = self.reflected_share(wo);
        let (is_transmission, first) = chosen(reflected, u);
        (self.head.seen(self.bytes(), wo, is_transmission, reflected), is_transmission, first)
    }

    /// The quarter that a light is seen by.
    #[inline(always)]
    fn towards(&self, wo: Vec3, wi: Vec3) -> Option<Seen<'_>> {
        self.head.seen(self.bytes(), wo, is_across(wo, wi), self.reflected_share(wo))
    }

    /// Evaluates `f |cos|` for an outgoing and an incident direction, linear sRGB; 1/sr.
    #[inline]
    pub fn evaluate(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> Vec3 {
        self.evaluate_and_pdf(wo, wi).0
    }

    /// Evaluates the density of [`sample`](Self::sample) at an incident direction; 1/sr.
    #[inline]
    pub fn pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> f32 {
        self.evaluate_and_pdf(wo, wi).1
    }

    /// Value and density in one pass over the lobes.
    pub fn evaluate_and_pdf(&self, wo: impl Into<Vec3>, wi: impl Into<Vec3>) -> (Vec3, f32) {
        let (wo, wi) = (wo.into(), wi.into());
        let Some(seen) = self.towards(wo, wi) else { return (Vec3::ZERO, 0.0) };
        let asked = Asked { u: None, wi: Some(upward(wi).to_array()), colors: true };
        let answer = ask_one(seen.material, seen.wo, asked);
        (answer.value, seen.share * answer.pdf)
    }

    /// Draws an incident direction: reflection or transmission and the lobe by `u[0]`, the direction in it by `u[1]` and `u[2]`, uniform
    /// in [0, 1).
    ///
    /// `None` where nothing is reflected or transmitted.
    pub fn sample(&self, wo: impl Into<Vec3>, u: [f32; 3]) -> Option<Sample> {
        self.sample_and(wo.into(), u, None).0
    }

    /// A draw; and value and density towards a light that the same quarter shows.
    fn sample_and(&self, wo: Vec3, u: [f32; 3], wi: Option<Vec3>) -> (Option<Sample>, Option<(Vec3, f32)>) {
        let (seen, is_transmission, first) = self.drawn(wo, u[0]);
        let Some(Seen { material, wo: upper, share }) = seen else { return (None, None) };
        let wi = wi.filter(|wi| is_across(wo, *wi) == is_transmission);
        let to = wi.map(|wi| upward(wi).to_array());
        let answer = ask_one(material, upper, Asked { u: Some([first, u[1], u[2]]), wi: to, colors: true });
        let is_flipped = (wo.z < 0.0) != is_transmission;
        let sample = answer.sample.map(|sample| placed(sample, share, is_flipped));
        (sample, wi.map(|_| (answer.value, share * answer.pdf)))
    }

    /// Draws an incident direction, and evaluates value and density towards another one: what next-event estimation needs at every
    /// hit.
    pub fn sample_and_evaluate(
        &self,
        wo: impl Into<Vec3>,
        u: [f32; 3],
        wi: impl Into<Vec3>,
    ) -> (Option<Sample>, (Vec3, f32)) {
        let (wo, wi) = (wo.into(), wi.into());
        let (sample, towards) = self.sample_and(wo, u, Some(wi));
        (sample, towards.unwrap_or_else(|| self.evaluate_and_pdf(wo, wi)))
    }

    /// Makes the mixtures for an outgoing direction, in the caller's storage, which it overwrites. Where nothing is reflected, or
    /// nothing transmitted, a mixture is empty.
    ///
    /// # Errors
    /// As [`Material::prepare`].
    pub fn prepare<'a, const N: usize>(
        &'a self,
        wo: impl Into<Vec3>,
        pair: &mut SheetMixture<'a, N>,
    ) -> Result<(), Error>
    where
        Room<N>: Groups,
    {
        let wo = wo.into();
        pair.reflected_share = self.reflected_share(wo);
        pair.is_back = wo.z < 0.0;
        let reflected = pair.reflected_share;
        let prepare = |is_transmission, mixture: &mut AnyMixture<'a>| match self.head.seen(
            self.bytes(),
            wo,
            is_transmission,
            reflected,
        ) {
            Some(seen) => prepare(seen.material, seen.wo, LeaveOut::default(), Level::current(), mixture),
            None => mixture.copy_from(&Mixture::<16>::empty()),
        };
        prepare(false, &mut pair.reflected)?;
        prepare(true, &mut pair.transmitted)
    }
}

/// Whether a number of a draw takes the way through, and the number that is left of it for the lobes, uniform in [0, 1).
#[inline(always)]
fn chosen(reflected: f32, u: f32) -> (bool, f32) {
    let (way, first) = choose(&[reflected, 1.0 - reflected], u);
    (way == 1, first)
}

/// A draw of a quarter as one of the sheet, on the side that it belongs to.
#[inline(always)]
fn placed(sample: Sample, share: f32, is_flipped: bool) -> Sample {
    let mut direction = sample.direction;
    if is_flipped {
        direction.z = -direction.z;
    }
    Sample { direction, pdf: drawn_share(sample.pdf, share), weight: sample.weight / share }
}

/// The density of a draw, of that of its quarter: never below the least that is divided by.
#[inline(always)]
fn drawn_share(pdf: f32, share: f32) -> f32 {
    drawn_density(pdf * share)
}

/// The lobes of a [`Sheet`] for one outgoing direction: those of the reflected light and those of the light that comes through. For many
/// directions of one `wo`.
#[derive(Clone, Debug)]
pub struct SheetMixture<'m, const N: usize>
where
    Room<N>: Groups,
{
    reflected: Mixture<'m, N>,
    transmitted: Mixture<'m, N>,
    reflected_share: f32,
    is_back: bool,
}

impl<const N: usize> Default for SheetMixture<'_, N>
where
    Room<N>: Groups,
{
    fn default() -> Self {
        Self::empty()
    }
}

impl<'m, const N: usize> SheetMixture<'m, N>
where
    Room<N>: Groups,
{
    /// No lobes: values, densities and albedos are 0, and nothing can be drawn.
    pub const fn empty() -> Self {
        Self {
            reflected: Mixture::empty(),
            transmitted: Mixture::empty(),
            reflected_share: 1.0,
            is_back: false,
        }
    }

    /// The lobes of the reflected light, or of that which comes through. Their directions lie above the horizon; those of the sheet have
    /// the height of the light's side.
    pub fn half(&self, is_transmission: bool) -> &Mixture<'m, N> {
        if is_transmission { &self.transmitted } else { &self.reflected }
    }

    /// Reflected and transmitted share of the light, linear sRGB.
    pub fn albedos(&self) -> [Vec3; 2] {
        [self.reflected.albedo(), self.transmitted.albedo()]
    }

    fn share(&self, is_transmission: bool) -> f32 {
        if is_transmission { 1.0 - self.reflected_share } else { self.reflected_share }
    }

    /// Value `f |cos|`, linear sRGB, and density towards an incident direction; 1/sr.
    pub fn evaluate_and_pdf(&self, wi: impl Into<Vec3>) -> (Vec3, f32) {
        let wi = wi.into();
        let is_transmission = (wi.z < 0.0) != self.is_back;
        let (value, pdf) = self.half(is_transmission).evaluate_and_pdf(upward(wi));
        (value, self.share(is_transmission) * pdf)
    }

    /// Draws an incident direction, as [`Sheet::sample`].
    pub fn sample(&self, u: [f32; 3]) -> Option<Sample> {
        let (is_transmission, first) = chosen(self.reflected_share, u[0]);
        let sample = self.half(is_transmission).sample([first, u[1], u[2]])?;
        Some(placed(sample, self.share(is_transmission), self.is_back != is_transmission))
    }
}
