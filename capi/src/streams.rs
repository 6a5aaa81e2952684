//! Strided numbers in the caller's memory: the batches of the C interface, brought to the slices that core takes.
//!
//! Where every stride is one number, core works on the caller's memory itself. Otherwise blocks of 64 are copied in
//! and out, by single reads and writes, so that numbers of other meaning may stand in between.
#![allow(unsafe_code)]

use crate::guard::Failure;
use crate::pointers::{apart, check, check_apart, check_extent};
use crate::status::{SRBF_STATUS_OVERLAP, SRBF_STATUS_STRIDE};
use core::ops::Range;

/// n vectors to read.
///
/// Structure of arrays: three arrays and a stride of `sizeof(float)`, which is the fastest. Array of structures:
/// `{&v[0].x, &v[0].y, &v[0].z, sizeof v[0]}`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_vectors {
    /// The first x.
    pub x: *const f32,
    /// The first y.
    pub y: *const f32,
    /// The first z.
    pub z: *const f32,
    /// Bytes from one number to the next of the same array; a multiple of 4, at least 4.
    pub stride: usize,
}

/// n vectors to write; laid out as `srbf_vectors`.
///
/// Colours are vectors too: red, green and blue in the place of x, y and z.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_vectors_out {
    /// The first x.
    pub x: *mut f32,
    /// The first y.
    pub y: *mut f32,
    /// The first z.
    pub z: *mut f32,
    /// Bytes from one number to the next of the same array; a multiple of 4, at least 4.
    pub stride: usize,
}

/// n numbers to write.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_numbers_out {
    /// The first number.
    pub values: *mut f32,
    /// Bytes from one number to the next; a multiple of 4, at least 4.
    pub stride: usize,
}

/// Numbers a block: what is copied at a time where strides are wide.
pub(crate) const BLOCK: usize = 64;
const NUMBER: usize = size_of::<f32>();

/// One array of numbers, `stride` bytes apart.
#[derive(Clone, Copy)]
pub(crate) struct Stream {
    start: *mut f32,
    stride: usize,
}

impl srbf_vectors {
    #[inline]
    pub(crate) fn streams(&self) -> [Stream; 3] {
        [self.x, self.y, self.z].map(|start| Stream { start: start.cast_mut(), stride: self.stride })
    }
}

impl srbf_vectors_out {
    #[inline]
    pub(crate) fn streams(&self) -> [Stream; 3] {
        [self.x, self.y, self.z].map(|start| Stream { start, stride: self.stride })
    }
}

impl srbf_numbers_out {
    #[inline]
    pub(crate) fn stream(&self) -> Stream {
        Stream { start: self.values, stride: self.stride }
    }
}

impl Stream {
    pub(crate) fn check(&self, count: usize) -> Result<(), Failure> {
        check(self.start)?;
        if self.stride < NUMBER || !self.stride.is_multiple_of(NUMBER) {
            return Err(SRBF_STATUS_STRIDE.into());
        }
        check_extent(self.start.addr(), count, self.stride)
    }

    /// The bytes from the first number to the last.
    pub(crate) fn extent(&self, count: usize) -> Range<usize> {
        let start = self.start.addr();
        start..start + (count - 1) * self.stride + NUMBER
    }

    /// Whether two streams whose extents meet share a number. Those of different stride count as such.
    pub(crate) fn shares_with(&self, other: &Self) -> bool {
        // Aligned numbers of one stride either coincide or are apart, by the remainder of their distance.
        self.stride != other.stride
            || self.start.addr().abs_diff(other.start.addr()).is_multiple_of(self.stride)
    }
}

/// A part of one array, of at most [`BLOCK`] numbers: the caller's memory where it is dense, a copy elsewhere.
impl Stream {
    /// Numbers to read.
    ///
    /// # Safety
    /// The array has been checked for at least `from + len` numbers, which are readable for as long as `'a`.
    #[inline(always)]
    pub(crate) unsafe fn read<'a>(&self, from: usize, len: usize, block: &'a mut [f32; BLOCK]) -> &'a [f32] {
        // SAFETY: the caller's word.
        unsafe {
            if self.stride == NUMBER {
                return core::slice::from_raw_parts(self.start.add(from), len);
            }
            for (i, number) in block[..len].iter_mut().enumerate() {
                *number = self.start.byte_add((from + i) * self.stride).read();
            }
        }
        &block[..len]
    }

    /// A place to write numbers to, which [`write_back`](Self::write_back) is to be told of.
    ///
    /// # Safety
    /// As [`read`](Self::read); the numbers are writable, and nobody else uses them.
    #[inline(always)]
    pub(crate) unsafe fn place<'a>(
        &self,
        from: usize,
        len: usize,
        block: &'a mut [f32; BLOCK],
    ) -> &'a mut [f32] {
        if self.stride == NUMBER {
            // SAFETY: the caller's word. What the memory holds before it is overwritten is a valid f32 whatever its bits.
            return unsafe { core::slice::from_raw_parts_mut(self.start.add(from), len) };
        }
        &mut block[..len]
    }

    /// Writes the numbers that were put into the block, if they were.
    ///
    /// # Safety
    /// As [`place`](Self::place).
    #[inline(always)]
    pub(crate) unsafe fn write_back(&self, from: usize, len: usize, block: &[f32; BLOCK]) {
        if self.stride != NUMBER {
            for (i, &number) in block[..len].iter().enumerate() {
                // SAFETY: the caller's word.
                unsafe { self.start.byte_add((from + i) * self.stride).write(number) };
            }
        }
    }
}

/// The checked arrays of one batch.
pub(crate) struct Batch<const I: usize, const O: usize> {
    count: usize,
    inputs: [Stream; I],
    outputs: [Stream; O],
}

impl<const I: usize, const O: usize> Batch<I, O> {
    /// Checks pointers, strides and overlaps; `objects` are the bytes that the call reads beside the inputs.
    ///
    /// `count` is not 0: a batch of none looks at no pointer.
    ///
    /// # Safety
    /// The header's contract: the inputs are readable and nobody writes them during the call, the outputs are writable
    /// and nobody else uses them.
    pub unsafe fn new<const K: usize>(
        count: usize,
        inputs: [Stream; I],
        outputs: [Stream; O],
        objects: [Range<usize>; K],
    ) -> Result<Self, Failure> {
        for stream in inputs.iter().chain(&outputs) {
            stream.check(count)?;
        }
        // Extents first, each once: in most batches none meets another.
        let read = inputs.each_ref().map(|stream| stream.extent(count));
        let written = outputs.each_ref().map(|stream| stream.extent(count));
        // Plain loops of known length, which the compiler unrolls: chained iterators took half the time of a batch of 16.
        let mut meeting = false;
        for (o, extent) in written.iter().enumerate() {
            for place in &objects {
                meeting |= !apart(extent, place);
            }
            for place in &read {
                meeting |= !apart(extent, place);
            }
            for place in &written[..o] {
                meeting |= !apart(extent, place);
            }
        }
        if meeting {
            for (index, (output, extent)) in outputs.iter().zip(&written).enumerate() {
                let earlier = outputs[..index].iter().zip(&written);
                let overlaps = |(other, place): (&Stream, &Range<usize>)| {
                    !apart(extent, place) && output.shares_with(other)
                };
                let upon_object = objects.iter().any(|place| !apart(extent, place));
                if upon_object || inputs.iter().zip(&read).chain(earlier).any(overlaps) {
                    return Err(SRBF_STATUS_OVERLAP.into());
                }
            }
        }
        Ok(Self { count, inputs, outputs })
    }

    /// Refuses inputs within bytes that the call writes in another way.
    pub fn check_inputs_outside(&self, place: &Range<usize>) -> Result<(), Failure> {
        self.inputs.iter().try_for_each(|stream| check_apart(place, &stream.extent(self.count)))
    }

    /// Calls with slices until every element has been worked on.
    #[inline(always)]
    pub fn run<E>(
        self,
        mut call: impl FnMut([&[f32]; I], [&mut [f32]; O]) -> Result<(), E>,
    ) -> Result<(), E> {
        let is_dense = self.inputs.iter().chain(&self.outputs).all(|stream| stream.stride == NUMBER);
        if is_dense {
            // SAFETY: `new` has checked that each array is not NULL, aligned, within the address space, and that no
            // output meets another array; readable, writable and initialised by the word given to `new`. What the
            // caller's memory holds before it is overwritten is a valid f32 whatever its bits.
            let inputs = self.inputs.map(|s| unsafe { core::slice::from_raw_parts(s.start, self.count) });
            // SAFETY: as above.
            let outputs =
                self.outputs.map(|s| unsafe { core::slice::from_raw_parts_mut(s.start, self.count) });
            return call(inputs, outputs);
        }
        self.run_in_blocks(call)
    }

    fn run_in_blocks<E>(
        self,
        mut call: impl FnMut([&[f32]; I], [&mut [f32]; O]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut read = [[0f32; BLOCK]; I];
        let mut written = [[0f32; BLOCK]; O];
        let mut done = 0;
        while done < self.count {
            let n = BLOCK.min(self.count - done);
            for (block, stream) in read.iter_mut().zip(&self.inputs) {
                for (i, number) in block[..n].iter_mut().enumerate() {
                    // SAFETY: element done + i < count of an array that `new` has checked.
                    *number = unsafe { stream.start.byte_add((done + i) * stream.stride).read() };
                }
            }
            call(read.each_ref().map(|b| &b[..n]), written.each_mut().map(|b| &mut b[..n]))?;
            for (block, stream) in written.iter().zip(&self.outputs) {
                for (i, &number) in block[..n].iter().enumerate() {
                    // SAFETY: as above; no reference to the caller's memory is alive.
                    unsafe { stream.start.byte_add((done + i) * stream.stride).write(number) };
                }
            }
            done += n;
        }
        Ok(())
    }
}
