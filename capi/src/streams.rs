//! Strided numbers in the caller's memory, brought to the slices that core takes.
//!
//! Where a stride is one number, core works on the caller's memory itself. Other arrays are copied in and out in blocks of
//! 64, by single reads and writes, so that numbers of other meaning may stand in between.
#![allow(unsafe_code)]

use crate::guard::Failure;
use crate::pointers::{check, check_apart, check_extent};
use crate::status::SRBF_STATUS_STRIDE;
use core::mem::MaybeUninit;
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

/// Where n samples go; see `srbf_sample`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_samples_out {
    /// Incident directions, unit vectors in the caller's shading frame.
    pub direction: srbf_vectors_out,
    /// Density of the whole mixture at the direction; 1/sr. 0 where nothing was drawn, else above 0.
    pub pdf: srbf_numbers_out,
    /// `f cos / pdf`, linear sRGB.
    pub weight: srbf_vectors_out,
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

/// Numbers a block: the numbers that are copied at a time where strides are wide.
pub(crate) const BLOCK: usize = 64;
pub(crate) const NUMBER: usize = size_of::<f32>();

/// One array of numbers, `stride` bytes apart.
#[derive(Clone, Copy)]
pub(crate) struct Stream {
    start: *mut f32,
    stride: usize,
}

impl srbf_vectors {
    #[inline(always)]
    pub(crate) fn streams(&self) -> [Stream; 3] {
        let of = |start: *const f32| Stream { start: start.cast_mut(), stride: self.stride };
        [of(self.x), of(self.y), of(self.z)]
    }
}

impl srbf_vectors_out {
    #[inline(always)]
    pub(crate) fn streams(&self) -> [Stream; 3] {
        let of = |start: *mut f32| Stream { start, stride: self.stride };
        [of(self.x), of(self.y), of(self.z)]
    }
}

impl srbf_numbers_out {
    #[inline(always)]
    pub(crate) fn stream(&self) -> Stream {
        Stream { start: self.values, stride: self.stride }
    }

    /// The one array, beside the three of vectors.
    #[inline(always)]
    pub(crate) fn only(&self) -> [Stream; 1] {
        [self.stream()]
    }
}

impl Stream {
    pub(crate) const NONE: Self = Self { start: core::ptr::null_mut(), stride: 0 };

    #[inline(always)]
    pub(crate) fn start(&self) -> usize {
        self.start.addr()
    }

    #[inline(always)]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

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

impl Stream {
    /// Whether a number lies upon one of the objects of `size` bytes, `stride` bytes apart. Those of different stride count as such.
    pub(crate) fn meets(&self, start: usize, size: usize, stride: usize) -> bool {
        let distance = (self.start.addr() as isize).wrapping_sub(start as isize).rem_euclid(stride as isize);
        self.stride != stride || (distance as usize) < size || distance as usize + NUMBER > stride
    }
}

/// Parts of one array; those that are not dense are copied.
impl Stream {
    #[inline(always)]
    pub(crate) fn is_dense(&self) -> bool {
        self.stride == NUMBER
    }

    /// Numbers to read, where they are.
    ///
    /// # Safety
    /// The array is dense, or `len` is 1 and `from` 0. It has been checked for at least `from + len` numbers, which are readable for
    /// as long as `'a`.
    #[inline(always)]
    pub(crate) unsafe fn slice<'a>(&self, from: usize, len: usize) -> &'a [f32] {
        // SAFETY: the caller's word.
        unsafe { core::slice::from_raw_parts(self.start.add(from), len) }
    }

    /// Numbers to write, where they are.
    ///
    /// # Safety
    /// As [`slice`](Self::slice); the numbers are writable, and nobody else uses them.
    #[inline(always)]
    pub(crate) unsafe fn slice_mut<'a>(&self, from: usize, len: usize) -> &'a mut [f32] {
        // SAFETY: the caller's word. The memory is a valid f32 before it is overwritten, whatever its bits.
        unsafe { core::slice::from_raw_parts_mut(self.start.add(from), len) }
    }

    /// Copies numbers from `from` on.
    ///
    /// # Safety
    /// The array has been checked for that many, which are readable.
    #[inline(always)]
    pub(crate) unsafe fn read(&self, from: usize, to: &mut [MaybeUninit<f32>]) {
        for (i, number) in to.iter_mut().enumerate() {
            // SAFETY: the caller's word.
            number.write(unsafe { self.start.byte_add((from + i) * self.stride).read() });
        }
    }

    /// Copies numbers to the array, from `from` on.
    ///
    /// # Safety
    /// The array has been checked for that many, which are writable.
    #[inline(always)]
    pub(crate) unsafe fn write(&self, from: usize, numbers: &[f32]) {
        for (i, &number) in numbers.iter().enumerate() {
            // SAFETY: the caller's word.
            unsafe { self.start.byte_add((from + i) * self.stride).write(number) };
        }
    }
}

/// Checked arrays that a call reads, and writes none.
pub(crate) struct Inputs<const I: usize> {
    count: usize,
    streams: [Stream; I],
}

impl<const I: usize> Inputs<I> {
    /// Checks pointers and strides. `count` is not 0: a call for none looks at no pointer.
    ///
    /// # Safety
    /// The header's contract: the arrays are readable and nobody writes them during the call.
    pub unsafe fn new(count: usize, streams: [Stream; I]) -> Result<Self, Failure> {
        streams.iter().try_for_each(|stream| stream.check(count))?;
        Ok(Self { count, streams })
    }

    /// Refuses arrays within bytes that the call writes.
    pub fn check_outside(&self, place: &Range<usize>) -> Result<(), Failure> {
        self.streams.iter().try_for_each(|stream| check_apart(place, &stream.extent(self.count)))
    }

    /// Calls with slices until every element has been read.
    pub fn run<E>(&self, mut call: impl FnMut([&[f32]; I]) -> Result<(), E>) -> Result<(), E> {
        let is_dense = self.streams.iter().all(Stream::is_dense);
        let most = if is_dense { self.count } else { BLOCK };
        let mut blocks = [[MaybeUninit::uninit(); BLOCK]; I];
        for from in (0..self.count).step_by(most) {
            let len = most.min(self.count - from);
            let mut slices: [&[f32]; I] = [&[]; I];
            for ((slice, stream), block) in slices.iter_mut().zip(&self.streams).zip(&mut blocks) {
                if stream.is_dense() {
                    // SAFETY: `new` has checked the arrays, of which `from + len` is no further than the end; the word given to it.
                    *slice = unsafe { stream.slice(from, len) };
                    continue;
                }
                let block = &mut block[..len];
                // SAFETY: as above.
                unsafe { stream.read(from, block) };
                // SAFETY: all of them have been set.
                *slice = unsafe { &*(&raw const *block as *const [f32]) };
            }
            call(slices)?;
        }
        Ok(())
    }
}
