//! The C interface without std, and memory for its objects: `srbf_allocate` and `srbf_free`.
//!
//! The functions of `srbf.h` come from `srbf-capi`; `wasm/build` lists those that the module exports.
#![no_std]

extern crate srbf;

use core::arch::wasm32;
use core::cell::UnsafeCell;

/// Bytes of a page of linear memory.
const PAGE: usize = 65536;

/// Alignment of every block, which is that of the objects of `srbf.h`, and bytes of a block's head.
const UNIT: usize = 16;

/// Before every block: its size in bytes without the head, and the next free block, 0 for none.
#[repr(C)]
struct Head {
    size: usize,
    next: usize,
}

/// The first free block, and the end of the memory that was handed out.
struct Heap {
    free: UnsafeCell<usize>,
    end: UnsafeCell<usize>,
}

// SAFETY: the module has one thread.
unsafe impl Sync for Heap {}

static HEAP: Heap = Heap { free: UnsafeCell::new(0), end: UnsafeCell::new(0) };

/// Gives bytes of memory, aligned to 16, or null where there is no more: for files, objects, directions and values.
///
/// The smallest free block that is large enough is taken whole.
#[unsafe(no_mangle)]
pub extern "C" fn srbf_allocate(size: usize) -> *mut u8 {
    let Some(size) = size.max(1).checked_next_multiple_of(UNIT) else { return core::ptr::null_mut() };
    // SAFETY: one thread; every head in the list was written by this function, within memory that was grown for it.
    unsafe {
        let (mut link, mut best) = (HEAP.free.get(), core::ptr::null_mut::<usize>());
        while *link != 0 {
            let head = *link as *mut Head;
            if (*head).size >= size && (best.is_null() || (*head).size < (*(*best as *const Head)).size) {
                best = link;
            }
            link = &raw mut (*head).next;
        }
        if !best.is_null() {
            let head = *best as *mut Head;
            *best = (*head).next;
            return head.cast::<u8>().add(UNIT);
        }
        let start = match *HEAP.end.get() {
            0 => wasm32::memory_size(0) * PAGE,
            end => end,
        };
        let Some(end) = start.checked_add(UNIT).and_then(|start| start.checked_add(size)) else {
            return core::ptr::null_mut();
        };
        let have = wasm32::memory_size(0) * PAGE;
        if end > have && wasm32::memory_grow(0, (end - have).div_ceil(PAGE)) == usize::MAX {
            return core::ptr::null_mut();
        }
        *HEAP.end.get() = end;
        (start as *mut Head).write(Head { size, next: 0 });
        (start as *mut u8).add(UNIT)
    }
}

/// Takes back a block of `srbf_allocate`; null is no block.
///
/// # Safety
/// The block was given by `srbf_allocate`, and not taken back since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_free(block: *mut u8) {
    if block.is_null() {
        return;
    }
    // SAFETY: the head stands before every block.
    unsafe {
        let head = block.sub(UNIT).cast::<Head>();
        (*head).next = *HEAP.free.get();
        *HEAP.free.get() = head as usize;
    }
}
