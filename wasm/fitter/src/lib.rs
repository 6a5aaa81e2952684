//! The fitter as a WebAssembly module, for the worker of a page. Its only import is `srbf.progress`, which is told the share of a fit.
//!
//! A caller writes a name and a file into memory of `fitter_allocate`, calls `fitter_open` or `fitter_export`, and reads the answer where
//! `fitter_answer` says. To stop a fit is to end the worker.

use srbf_web::{export, open};
use std::cell::RefCell;

#[link(wasm_import_module = "srbf")]
unsafe extern "C" {
    /// Told the share of the work that is done, 0 to 1.
    fn progress(share: f64);
}

/// The parts of an answer: a material or a file, and a text in JSON or an error.
#[derive(Default)]
struct Answer {
    bytes: Vec<u8>,
    text: String,
}

thread_local! {
    static ANSWER: RefCell<Answer> = RefCell::default();
}

/// Gives memory for a text or a file, which the next call takes over.
#[unsafe(no_mangle)]
pub extern "C" fn fitter_allocate(size: usize) -> *mut u8 {
    Box::leak(vec![0; size].into_boxed_slice()).as_mut_ptr()
}

/// Takes a block of `fitter_allocate` over.
///
/// # Safety
/// `size` bytes at `block` are a block of `fitter_allocate`, and in no other call.
unsafe fn taken(block: *mut u8, size: usize) -> Vec<u8> {
    // SAFETY: the caller's word; capacity and length of a boxed slice are one.
    unsafe { Vec::from_raw_parts(block, size, size) }
}

/// Keeps an answer; 0 for success, 1 for an error.
fn answer(found: Result<Answer, String>) -> u32 {
    let is_error = found.is_err();
    let answer = found.unwrap_or_else(|text| Answer { text, bytes: Vec::new() });
    ANSWER.set(answer);
    u32::from(is_error)
}

/// Opens a file: a material as it is, or a measurement, which is fitted. 0, or 1 with an error as the text of the answer.
///
/// # Safety
/// Name and file are blocks of `fitter_allocate`, which end here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fitter_open(
    name: *mut u8,
    name_size: usize,
    file: *mut u8,
    file_size: usize,
) -> u32 {
    // SAFETY: the caller's word.
    let (name, file) = unsafe { (taken(name, name_size), taken(file, file_size)) };
    // SAFETY: the function takes a number, and gives nothing.
    let opened = open(&String::from_utf8_lossy(&name), &file, |share| unsafe { progress(share) });
    answer(opened.map(|opened| Answer { text: opened.json.to_string(), bytes: opened.bytes }))
}

/// Writes a material in a format: `rgl`, `merl`, or a curve. 0, or 1 with an error as the text of the answer.
///
/// # Safety
/// Format and material are blocks of `fitter_allocate`, which end here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fitter_export(
    format: *mut u8,
    format_size: usize,
    material: *mut u8,
    material_size: usize,
) -> u32 {
    // SAFETY: the caller's word.
    let (format, material) = unsafe { (taken(format, format_size), taken(material, material_size)) };
    let written = export(&material, &String::from_utf8_lossy(&format));
    answer(written.map(|bytes| Answer { bytes, text: String::new() }))
}

/// Where a part of the last answer is: 0 for the bytes, 1 for the text.
#[unsafe(no_mangle)]
pub extern "C" fn fitter_answer(part: u32) -> *const u8 {
    ANSWER.with_borrow(|answer| if part == 0 { answer.bytes.as_ptr() } else { answer.text.as_ptr() })
}

/// Bytes of a part of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn fitter_answer_size(part: u32) -> usize {
    ANSWER.with_borrow(|answer| if part == 0 { answer.bytes.len() } else { answer.text.len() })
}
