//! The arrays of a request: checked in one go, and brought to the slices that core takes.
//!
//! Most requests are for a few hits, so that a check of one array counts as much as a hit does. Extents come first, a vector's three
//! arrays as one: where none of them meets another, nothing can overlap. Members of one structure come next.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::guard::{Failure, Named, Outcome};
use crate::pointers::{apart, check_apart, read};
use crate::request::srbf_request;
use crate::status::{SRBF_STATUS_ARGUMENT, SRBF_STATUS_OVERLAP, SRBF_STATUS_SIZE};
use crate::streams::{BLOCK, NUMBER, Stream, srbf_numbers_out, srbf_vectors, srbf_vectors_out};
use core::iter::repeat_n;
use core::mem::MaybeUninit;
use core::ops::Range;
use srbf_core::{Draws, Request, Towards};

/// The most arrays: of wo, wi, u; of value, pdf, direction, its density, its weight.
const INPUTS: usize = 9;
const OUTPUTS: usize = 11;

/// Bytes from the first of some arrays to the end of the last.
#[derive(Clone, Copy)]
struct Span {
    start: usize,
    end: usize,
}

impl Span {
    /// Of no arrays: it meets nothing.
    const NONE: Self = Self { start: isize::MAX as usize, end: 0 };

    /// A negative number if they have a byte in common. Without branches; differences of the bounds are less than half the address
    /// space, as [`Seen`] has found.
    #[inline(always)]
    fn meets(&self, other: &Self) -> isize {
        (self.start.wrapping_sub(other.end) & other.start.wrapping_sub(self.end)) as isize
    }
}

/// What arrays have in common, gathered without branches.
struct Seen {
    count: usize,
    /// Bits of addresses and strides.
    bits: usize,
    /// Bits of strides.
    strides: usize,
    /// Bits beyond those of a dense stride.
    wide: usize,
    /// Negative if a pointer or a stride is 0, or if arrays meet.
    signs: isize,
}

impl Seen {
    #[inline(always)]
    fn span<const K: usize>(&mut self, streams: &[Stream; K]) -> Span {
        let (stride, first) = (streams[0].stride(), streams[0].start());
        let (mut low, mut high) = (first, first);
        self.bits |= first;
        for stream in &streams[1..] {
            low = low.min(stream.start());
            high = high.max(stream.start());
            self.bits |= stream.start();
        }
        self.strides |= stride;
        self.wide |= stride ^ NUMBER;
        self.signs |= low.wrapping_sub(1) as isize | stride.wrapping_sub(1) as isize;
        Span { start: low, end: high.wrapping_add(self.reach(stride)) }
    }

    /// Bytes from the first number of an array to the end of the last.
    #[inline(always)]
    fn reach(&self, stride: usize) -> usize {
        (self.count - 1).wrapping_mul(stride).wrapping_add(NUMBER)
    }

    /// Three arrays that are written.
    #[inline(always)]
    fn vectors(&mut self, streams: &[Stream; 3]) -> Span {
        let reach = self.reach(streams[0].stride());
        let of = |s: &Stream| Span { start: s.start(), end: s.start().wrapping_add(reach) };
        let (x, y, z) = (of(&streams[0]), of(&streams[1]), of(&streams[2]));
        self.signs |= x.meets(&y) | y.meets(&z) | x.meets(&z);
        self.span(streams)
    }

    /// An output among the spans before it.
    #[inline(always)]
    fn among<const K: usize>(&mut self, span: Span, before: [&Span; K]) {
        for other in before {
            self.signs |= span.meets(other);
        }
    }

    /// Whether nothing is wrong. `false` for addresses in the upper half of memory too, and for strides and counts beyond
    /// a quarter of its digits. The sums and products of these tests would overflow there.
    #[inline(always)]
    fn is_good(&self) -> bool {
        const LARGE: usize = isize::MIN as usize | 1 << (usize::BITS - 2);
        let is_far = (self.bits & LARGE) | ((self.strides | self.count) >> (usize::BITS / 2 - 2));
        let is_odd = (self.bits | self.strides) % NUMBER;
        is_far | is_odd == 0 && self.signs >= 0
    }
}

/// The arrays of a request that has been checked, as they lie in the caller's memory.
pub(crate) struct Arrays<'a> {
    request: &'a srbf_request,
    /// Outgoing directions are an input.
    looks_at_wo: bool,
    count: usize,
    checked: Checked,
}

/// The findings.
struct Checked {
    /// Nothing has to be copied.
    is_in_place: bool,
    /// From the first byte of any output to the last: most objects are outside.
    hull: Span,
}

impl<'a> Arrays<'a> {
    /// Checks pointers, strides and overlaps, but for the objects. `looks_at_wo`: outgoing directions are an input.
    ///
    /// # Safety
    /// The header's contract: inputs are readable and nobody writes them during the call, outputs are writable and nobody else
    /// uses them. `count` is not 0.
    #[inline(always)]
    pub unsafe fn new(
        request: *const srbf_request,
        count: usize,
        looks_at_wo: bool,
    ) -> Result<Self, Failure> {
        // SAFETY: the header's contract; of a request of another size no more than that is read.
        if unsafe { read(request.cast::<usize>()).of(Argument::Request)? } != size_of::<srbf_request>() {
            return Err(SRBF_STATUS_SIZE).of(Argument::RequestSize);
        }
        // In place: a copy would wait for the stores of the caller.
        // SAFETY: not NULL and aligned, as `read` has seen; readable by the header's contract. `checked` refuses outputs upon it.
        let request = unsafe { &*request };
        let checked = checked(request, count, looks_at_wo)?;
        Ok(Self { request, looks_at_wo, count, checked })
    }

    fn inputs(&self) -> impl Iterator<Item = Stream> {
        let Asked { wo, wi, u, .. } = Asked::of(self.request, self.looks_at_wo);
        let request = self.request;
        let of = move |is_there: bool, of: &srbf_vectors| of.streams().into_iter().filter(move |_| is_there);
        of(wo, &request.wo).chain(of(wi, &request.wi)).chain(of(u, &request.u))
    }

    /// In the order in which [`slices`](Self::slices) takes them.
    fn outputs(&self) -> impl Iterator<Item = Stream> {
        let Asked { value, pdf, u, density, weight, .. } = Asked::of(self.request, self.looks_at_wo);
        let (request, samples) = (self.request, &self.request.samples);
        let vectors =
            move |is_there: bool, of: &srbf_vectors_out| of.streams().into_iter().filter(move |_| is_there);
        let numbers =
            move |is_there: bool, of: &srbf_numbers_out| of.only().into_iter().filter(move |_| is_there);
        vectors(value, &request.value)
            .chain(numbers(pdf, &request.pdf))
            .chain(vectors(u, &samples.direction))
            .chain(numbers(density, &samples.pdf))
            .chain(vectors(weight, &samples.weight))
    }

    /// Names the fault, if there is one: the extent of an output may meet another array where no number of it does.
    #[inline(never)]
    fn check_each(&self) -> Outcome {
        let mut all = [Stream::NONE; INPUTS + OUTPUTS];
        let (mut n, inputs) = (0, self.inputs().count());
        for (stream, name) in self.inputs().chain(self.outputs()).zip(self.names()) {
            stream.check(self.count).of(name)?;
            all[n] = stream;
            n += 1;
        }
        let streams = &all[..n];
        if are_other_members(streams, inputs) {
            return Ok(());
        }
        for ((o, output), name) in streams.iter().enumerate().zip(self.names()).skip(inputs) {
            let extent = output.extent(self.count);
            for other in &streams[..o] {
                if !apart(&extent, &other.extent(self.count)) && output.shares_with(other) {
                    return Err(SRBF_STATUS_OVERLAP).of(name);
                }
            }
        }
        Ok(())
    }

    /// The member of the request that each array belongs to.
    fn names(&self) -> impl Iterator<Item = Argument> {
        let Asked { wo, wi, u, value, pdf, density, weight } = Asked::of(self.request, self.looks_at_wo);
        let members = [
            (Argument::RequestWo, wo, 3),
            (Argument::RequestWi, wi, 3),
            (Argument::RequestU, u, 3),
            (Argument::RequestValue, value, 3),
            (Argument::RequestPdf, pdf, 1),
            (Argument::SamplesDirection, u, 3),
            (Argument::SamplesPdf, density, 1),
            (Argument::SamplesWeight, weight, 3),
        ];
        members
            .into_iter()
            .flat_map(|(name, is_there, arrays)| repeat_n(name, if is_there { arrays } else { 0 }))
    }

    /// Refuses outputs upon bytes that are read.
    #[inline(always)]
    pub fn check_object(&self, object: &Range<usize>) -> Outcome {
        if apart(&(self.checked.hull.start..self.checked.hull.end), object) {
            return Ok(());
        }
        self.check_outputs(object)
    }

    #[inline(never)]
    fn check_outputs(&self, object: &Range<usize>) -> Outcome {
        self.outputs().try_for_each(|stream| check_apart(&stream.extent(self.count), object))
    }

    /// Refuses outputs upon objects of `size` bytes, `stride` bytes apart: of one stride, they may lie in between.
    pub fn check_between(&self, place: &Range<usize>, size: usize, stride: usize) -> Outcome {
        for output in self.outputs() {
            if !apart(&output.extent(self.count), place) && output.meets(place.start, size, stride) {
                return Err(SRBF_STATUS_OVERLAP.into());
            }
        }
        Ok(())
    }

    /// Calls with all arrays, at most `most` numbers at a time, and with where these begin; copies are of [`BLOCK`].
    ///
    /// # Safety
    /// The word given to [`new`](Self::new).
    #[inline(always)]
    pub unsafe fn each(&self, most: usize, call: Call<'_>) -> Outcome {
        if !self.checked.is_in_place {
            // SAFETY: the caller's word.
            return unsafe { self.each_copied(call) };
        }
        let mut from = 0;
        while from < self.count {
            let len = most.min(self.count - from);
            // SAFETY: `new` has checked the arrays, of which `from + len` is no further than the end.
            let (wo, request) = unsafe { self.slices(&mut InPlace { from, len }) };
            call(from..from + len, wo, request)?;
            from += len;
        }
        Ok(())
    }

    /// # Safety
    /// As [`each`](Self::each).
    #[inline(never)]
    unsafe fn each_copied(&self, call: Call<'_>) -> Outcome {
        let mut room = [const { [const { MaybeUninit::uninit() }; BLOCK] }; INPUTS + OUTPUTS];
        let inputs = self.inputs().count();
        for from in (0..self.count).step_by(BLOCK) {
            let len = BLOCK.min(self.count - from);
            // SAFETY: as in `each`; no output meets another array.
            let (wo, request) = unsafe { self.slices(&mut Copied { from, len, blocks: room.iter_mut() }) };
            call(from..from + len, wo, request)?;
            for (stream, block) in self.outputs().zip(&room[inputs..]).filter(|(s, _)| !s.is_dense()) {
                // SAFETY: as above; no slice of the caller's memory is alive. `slices` has set that many numbers of the block.
                unsafe { stream.write(from, &*(&raw const block[..len] as *const [f32])) };
            }
        }
        Ok(())
    }

    /// Outgoing directions, none if they are no input, and the rest.
    ///
    /// # Safety
    /// As [`each`](Self::each), of what `access` reaches.
    #[inline(always)]
    unsafe fn slices<'b>(&self, access: &mut impl Access<'b>) -> ([&'b [f32]; 3], Request<'b>) {
        // Without `map` of an array, which is a call that goes through memory.
        macro_rules! three {
            ($of:expr, $how:ident) => {{
                let [x, y, z] = $of.streams();
                // SAFETY: the caller's word.
                unsafe { [access.$how(x), access.$how(y), access.$how(z)] }
            }};
        }
        let (mut wo, mut wi, mut u) = ([&[] as &[f32]; 3], [&[] as &[f32]; 3], [&[] as &[f32]; 3]);
        let (asked, request, samples) =
            (Asked::of(self.request, self.looks_at_wo), self.request, &self.request.samples);
        if asked.wo {
            wo = three!(request.wo, read);
        }
        let mut evaluate = None;
        if asked.wi {
            wi = three!(request.wi, read);
        }
        if asked.u {
            u = three!(request.u, read);
        }
        if asked.wi {
            let value = if asked.value { Some(three!(request.value, place)) } else { None };
            // SAFETY: the caller's word.
            let pdf = if asked.pdf { Some(unsafe { access.place(request.pdf.stream()) }) } else { None };
            evaluate = Some(Towards { wi, value, pdf });
        }
        let mut draw = None;
        if asked.u {
            let direction = three!(samples.direction, place);
            // SAFETY: the caller's word.
            let pdf = if asked.density { Some(unsafe { access.place(samples.pdf.stream()) }) } else { None };
            let weight = if asked.weight { Some(three!(samples.weight, place)) } else { None };
            draw = Some(Draws { u, direction, pdf, weight });
        }
        (wo, Request { draw, evaluate })
    }
}

/// Which arrays there are. Directions are drawn if there is a `u`.
#[derive(Clone, Copy)]
struct Asked {
    wo: bool,
    wi: bool,
    u: bool,
    value: bool,
    pdf: bool,
    density: bool,
    weight: bool,
}

impl Asked {
    #[inline(always)]
    fn of(request: &srbf_request, looks_at_wo: bool) -> Self {
        let samples = &request.samples;
        let (value, pdf) = (!request.value.x.is_null(), !request.pdf.values.is_null());
        Self {
            wo: looks_at_wo,
            wi: value | pdf,
            u: !samples.direction.x.is_null(),
            value,
            pdf,
            density: !samples.pdf.values.is_null(),
            weight: !samples.weight.x.is_null(),
        }
    }
}

/// Checks all arrays, and that no output meets another array or the request. Not inlined: it is the same for all objects.
#[inline(never)]
fn checked(request: &srbf_request, count: usize, looks_at_wo: bool) -> Result<Checked, Failure> {
    let (asked, samples) = (Asked::of(request, looks_at_wo), &request.samples);
    // Densities and weights are of directions.
    if (asked.density | asked.weight) & !asked.u {
        return Err(SRBF_STATUS_ARGUMENT).of(Argument::SamplesDirection);
    }
    let mut seen = Seen { count, bits: 0, strides: 0, wide: 0, signs: 0 };
    let (mut wo, mut wi, mut u) = (Span::NONE, Span::NONE, Span::NONE);
    let (mut value, mut pdf) = (Span::NONE, Span::NONE);
    let (mut direction, mut density, mut weight) = (Span::NONE, Span::NONE, Span::NONE);
    if asked.wo {
        wo = seen.span(&request.wo.streams());
    }
    if asked.wi {
        wi = seen.span(&request.wi.streams());
    }
    if asked.u {
        u = seen.span(&request.u.streams());
    }
    if asked.value {
        value = seen.vectors(&request.value.streams());
        seen.among(value, [&wo, &wi, &u]);
    }
    if asked.pdf {
        pdf = seen.span(&request.pdf.only());
        seen.among(pdf, [&wo, &wi, &u, &value]);
    }
    if asked.u {
        direction = seen.vectors(&samples.direction.streams());
        seen.among(direction, [&wo, &wi, &u, &value, &pdf]);
    }
    if asked.density {
        density = seen.span(&samples.pdf.only());
        seen.among(density, [&wo, &wi, &u, &value, &pdf, &direction]);
    }
    if asked.weight {
        weight = seen.vectors(&samples.weight.streams());
        seen.among(weight, [&wo, &wi, &u, &value, &pdf, &direction, &density]);
    }
    let mut hull = value;
    for output in [pdf, direction, density, weight] {
        hull = Span { start: hull.start.min(output.start), end: hull.end.max(output.end) };
    }
    let place = core::ptr::from_ref(request).addr();
    let place = Span { start: place, end: place + size_of::<srbf_request>() };
    seen.among(hull, [&place]);
    let checked = Checked { is_in_place: count == 1 || seen.wide == 0, hull };
    if !seen.is_good() {
        let arrays = Arrays { request, looks_at_wo, count, checked };
        arrays.check_each()?;
        arrays.check_object(&(place.start..place.end))?;
        return Ok(arrays.checked);
    }
    Ok(checked)
}

/// Whether arrays of one wide stride are different members of structures of that size, which are at most 128 numbers: so
/// that no two of them meet but inputs. `false` where that cannot be said.
fn are_other_members(streams: &[Stream], inputs: usize) -> bool {
    let stride = streams.first().map_or(0, Stream::stride);
    if stride > 128 * NUMBER || streams.iter().any(|stream| stream.stride() != stride) {
        return false;
    }
    let first = streams.iter().map(Stream::start).min().unwrap_or(0);
    let (mut read, mut written, mut twice) = (0u128, 0u128, 0u128);
    for (i, stream) in streams.iter().enumerate() {
        let mut at = stream.start() - first;
        if at >= stride {
            at %= stride;
        }
        let member = 1 << (at / NUMBER);
        if i < inputs {
            read |= member;
        } else {
            twice |= written & member;
            written |= member;
        }
    }
    twice | read & written == 0
}

/// What answers a part of a request: its place among the hits, outgoing directions, the rest. Not generic, so that the mechanics are
/// compiled once.
pub(crate) type Call<'a> = &'a mut dyn FnMut(Range<usize>, [&[f32]; 3], Request<'_>) -> Outcome;

/// How a part of an array becomes a slice.
trait Access<'a> {
    /// # Safety
    /// The array has been checked for all that is asked of it, and is readable for as long as `'a`.
    unsafe fn read(&mut self, stream: Stream) -> &'a [f32];
    /// # Safety
    /// The same; it is writable, and nobody else uses it.
    unsafe fn place(&mut self, stream: Stream) -> &'a mut [f32];
}

/// `len` numbers from `from` on of dense arrays.
struct InPlace {
    from: usize,
    len: usize,
}

impl<'a> Access<'a> for InPlace {
    #[inline(always)]
    unsafe fn read(&mut self, stream: Stream) -> &'a [f32] {
        // SAFETY: the caller's word.
        unsafe { stream.slice(self.from, self.len) }
    }

    #[inline(always)]
    unsafe fn place(&mut self, stream: Stream) -> &'a mut [f32] {
        // SAFETY: the caller's word.
        unsafe { stream.slice_mut(self.from, self.len) }
    }
}

/// Room for the numbers of one array.
type Copies = [MaybeUninit<f32>; BLOCK];

/// The same of arrays of any stride: those that are not dense by a copy in the next block.
struct Copied<'a> {
    from: usize,
    len: usize,
    blocks: core::slice::IterMut<'a, Copies>,
}

impl<'a> Access<'a> for Copied<'a> {
    unsafe fn read(&mut self, stream: Stream) -> &'a [f32] {
        match self.blocks.next() {
            Some(block) if !stream.is_dense() => {
                let block = &mut block[..self.len];
                // SAFETY: the caller's word.
                unsafe { stream.read(self.from, block) };
                // SAFETY: all of them have been set.
                unsafe { &*(&raw const *block as *const [f32]) }
            }
            // SAFETY: as above.
            _ => unsafe { stream.slice(self.from, self.len) },
        }
    }

    unsafe fn place(&mut self, stream: Stream) -> &'a mut [f32] {
        match self.blocks.next() {
            Some(block) if !stream.is_dense() => {
                let block = &mut block[..self.len];
                block.fill(MaybeUninit::new(0.0));
                // SAFETY: all of them have been set.
                unsafe { &mut *(&raw mut *block as *mut [f32]) }
            }
            // SAFETY: the caller's word.
            _ => unsafe { stream.slice_mut(self.from, self.len) },
        }
    }
}
