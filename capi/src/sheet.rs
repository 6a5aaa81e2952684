//! Sheets: thin surfaces that reflect light and let some through, of up to four materials.
#![allow(unsafe_code)]

use crate::arguments::Argument;
use crate::arrays::Arrays;
use crate::convert::{direction, uniform};
use crate::guard::{Failure, Named, guard};
use crate::material::Bytes;
use crate::pointers::{Out, bytes_of, check, put_in_storage, read_array, slice};
use crate::request::srbf_request;
use crate::single::{drawn, srbf_sample};
use crate::status::{SRBF_STATUS_OBJECT, srbf_status};
use core::ffi::c_char;
use core::ops::Range;
use srbf_core::{MAX_LOBES, Quarter, Sheet, SheetMixture};

/// Bytes of storage for a sheet that `srbf_sheet_borrow` makes.
pub const SRBF_SHEET_SIZE: usize = 768;
/// Alignment of that storage.
pub const SRBF_SHEET_ALIGNMENT: usize = 16;

/// A sheet: reflection and transmission, seen from the front and from the back, read in place from `.srbf` bytes.
///
/// Directions are unit vectors in the frame of the sheet, whose front is +z; `wo` and `wi` may lie in front or behind. It never changes, so any
/// number of threads may use one at once.
pub struct srbf_sheet {
    tag: u32,
    sheet: Sheet<Bytes>,
    /// This library put it on the heap, with its bytes.
    #[cfg(feature = "std")]
    is_owned: bool,
}

/// What stands at the start of every sheet that this library made, and nothing that it has released.
const TAG: u32 = 0x5ee7_91b3;

const _: () =
    assert!(size_of::<srbf_sheet>() <= SRBF_SHEET_SIZE && align_of::<srbf_sheet>() <= SRBF_SHEET_ALIGNMENT);

impl srbf_sheet {
    fn new(bytes: Bytes) -> Result<Self, Failure> {
        Ok(Self {
            tag: TAG,
            #[cfg(feature = "std")]
            is_owned: matches!(bytes, Bytes::Owned(_)),
            sheet: Sheet::from_bytes(bytes)?,
        })
    }

    /// The bytes that it lies in, and the `.srbf` bytes that it reads.
    fn extents(&self) -> [Range<usize>; 2] {
        let start = core::ptr::from_ref(self).addr();
        [start..start + size_of::<Self>(), bytes_of(self.sheet.bytes())]
    }
}

/// Borrows a sheet of the caller.
///
/// # Safety
/// The header's contract: a pointer that is not NULL points to a sheet.
#[inline(always)]
unsafe fn sheet<'a>(sheet: *const srbf_sheet) -> Result<&'a srbf_sheet, Failure> {
    check(sheet).of(Argument::Sheet)?;
    // SAFETY: not NULL and aligned; readable by the contract. The tag is looked at through the pointer, before there is a
    // reference to a whole that may not be one.
    if unsafe { (&raw const (*sheet).tag).read() } != TAG {
        return Err(SRBF_STATUS_OBJECT).of(Argument::Sheet);
    }
    // SAFETY: the tag says that this library wrote a sheet here; it never changes.
    Ok(unsafe { &*sheet })
}

/// Properties of a sheet.
///
/// Its quarters are reflection and transmission seen from the front, then those seen from the back. Each is a material, which
/// `srbf_material_borrow` makes of its bytes; directions of the material lie above the horizon: of one behind the sheet the height changes
/// its sign.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct srbf_sheet_info {
    /// The `.srbf` bytes of each quarter, which live as long as the sheet; NULL of one that is black.
    pub quarters: [*const u8; 4],
    /// Number of bytes of each.
    pub quarter_byte_counts: [usize; 4],
    /// 1 if the back is like the front, whose quarters it has then; else 0.
    pub is_symmetric: u32,
    /// Most lobes of a quarter.
    pub lobes: usize,
    /// The `.srbf` bytes of the sheet.
    pub bytes: *const u8,
    /// Number of bytes.
    pub byte_count: usize,
    /// Where the sheet comes from: UTF-8 without a zero at the end.
    pub provenance: *const c_char,
    /// Length of the provenance in bytes.
    pub provenance_length: usize,
}

/// Makes a sheet of `.srbf` bytes where they are, of any alignment: nothing is copied, nothing allocated.
///
/// The bytes must stay as they are for as long as the sheet is used. It needs no release.
/// Shapes: `bytes` [byte_count]; `storage` [storage_size], at least `SRBF_SHEET_SIZE`, aligned to `SRBF_SHEET_ALIGNMENT`; `sheet` one pointer,
/// which is set to the storage. None of the three may overlap another.
/// Status: `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if the bytes are not a sheet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_borrow(
    bytes: *const u8,
    byte_count: usize,
    storage: *mut core::ffi::c_void,
    storage_size: usize,
    sheet: *mut *mut srbf_sheet,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (bytes, out) =
            unsafe { (slice(bytes, byte_count).of(Argument::Bytes)?, Out::new(sheet).of(Argument::Sheet)?) };
        let room = [SRBF_SHEET_SIZE, SRBF_SHEET_ALIGNMENT];
        // SAFETY: the header's contract: the storage is writable.
        unsafe {
            put_in_storage(bytes, storage.cast(), storage_size, room, &out, || {
                srbf_sheet::new(Bytes::Borrowed(bytes))
            })
        }
    })
}

/// Reads a sheet from a `.srbf` file. Release it with `srbf_sheet_free`.
///
/// `path` is UTF-8 with a zero at the end, of a regular file. Status: `SRBF_STATUS_FILE` if it cannot be read, with the reason in
/// `srbf_last_message`; `SRBF_STATUS_MAGIC` to `SRBF_STATUS_FIELD` if it holds no sheet. Every message names the file.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_load(path: *const c_char, sheet: *mut *mut srbf_sheet) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (path, out) =
            unsafe { (crate::heap::text(path).of(Argument::Path)?, Out::new(sheet).of(Argument::Sheet)?) };
        let read = || {
            let bytes = srbf_core::read_file(std::path::Path::new(path))?;
            let made = srbf_sheet::new(Bytes::Owned(bytes.into_boxed_slice()))?;
            out.set(std::boxed::Box::into_raw(std::boxed::Box::new(made)));
            Ok(())
        };
        read().map_err(|failure: Failure| failure.about(path))
    })
}

/// Releases a sheet; NULL is allowed and does nothing.
///
/// A sheet that `srbf_sheet_borrow` made is only marked as none. Nobody may use the sheet during or after the call.
/// Status: `SRBF_STATUS_OBJECT` if it is not a sheet.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_free(sheet: *mut srbf_sheet) -> srbf_status {
    guard(|| {
        if sheet.is_null() {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let is_owned = unsafe { self::sheet(sheet)? }.is_owned;
        // SAFETY: a sheet, by its tag, that nobody else uses by the contract.
        unsafe { (*sheet).tag = 0 };
        if is_owned {
            // SAFETY: `srbf_sheet_load` made the box, and the tag was still there: it has not been released yet.
            drop(unsafe { std::boxed::Box::from_raw(sheet) });
        }
        Ok(())
    })
}

/// Gives the properties of a sheet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_query(
    sheet: *const srbf_sheet,
    info: *mut srbf_sheet_info,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (sheet, out) = unsafe { (&self::sheet(sheet)?.sheet, Out::new(info).of(Argument::Info)?) };
        let mut all = ([core::ptr::null(); 4], [0; 4]);
        for quarter in Quarter::ALL {
            if let Some(material) = sheet.quarter(quarter) {
                let bytes = material.bytes();
                (all.0[quarter as usize], all.1[quarter as usize]) = (bytes.as_ptr(), bytes.len());
            }
        }
        let (bytes, provenance) = (sheet.bytes(), sheet.provenance());
        out.set(srbf_sheet_info {
            quarters: all.0,
            quarter_byte_counts: all.1,
            is_symmetric: u32::from(sheet.is_symmetric()),
            lobes: sheet.lobe_count(),
            bytes: bytes.as_ptr(),
            byte_count: bytes.len(),
            provenance: provenance.as_ptr().cast(),
            provenance_length: provenance.len(),
        });
        Ok(())
    })
}

/// Integrates `f |cos|` over all incident directions: how much of the light that goes back along `wo` is reflected, and how much is
/// transmitted.
///
/// Shapes: `wo` [3], unit vector towards the viewer; `reflected` and `transmitted` [3], linear sRGB, overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_albedos(
    sheet: *const srbf_sheet,
    wo: *const f32,
    reflected: *mut f32,
    transmitted: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let (object, wo) = unsafe { (self::sheet(sheet)?, read_array(wo).of(Argument::Wo)?) };
        // SAFETY: the header's contract.
        let outs = unsafe {
            (
                Out::<[f32; 3]>::array(reflected).of(Argument::Reflected)?,
                Out::<[f32; 3]>::array(transmitted).of(Argument::Transmitted)?,
            )
        };
        let mut pair = SheetMixture::<MAX_LOBES>::empty();
        object.sheet.prepare(direction(wo).of(Argument::Wo)?, &mut pair)?;
        let [reflected, transmitted] = pair.albedos();
        outs.0.set(reflected.to_array());
        outs.1.set(transmitted.to_array());
        Ok(())
    })
}

/// Evaluates `f |cos|` and the density of `srbf_sheet_sample` in one pass; 1/sr.
///
/// Shapes: `wo` and `wi` [3], unit vectors in the frame of the sheet; `value` [3], linear sRGB, and `pdf`, one number; both overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_evaluate_and_pdf(
    sheet: *const srbf_sheet,
    wo: *const f32,
    wi: *const f32,
    value: *mut f32,
    pdf: *mut f32,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::sheet(sheet)? };
        // SAFETY: the header's contract.
        let (wo, wi) = unsafe { (read_array(wo).of(Argument::Wo)?, read_array(wi).of(Argument::Wi)?) };
        // SAFETY: the header's contract.
        let (value_out, pdf_out) =
            unsafe { (Out::<[f32; 3]>::array(value).of(Argument::Value)?, Out::new(pdf).of(Argument::Pdf)?) };
        let (value, pdf) =
            object.sheet.evaluate_and_pdf(direction(wo).of(Argument::Wo)?, direction(wi).of(Argument::Wi)?);
        value_out.set(value.to_array());
        pdf_out.set(pdf);
        Ok(())
    })
}

/// Draws an incident direction, on either side of the sheet.
///
/// Where nothing is reflected or transmitted it gives the normal with density 0 and weight 0, and `SRBF_STATUS_OK`.
/// Shapes: `wo` [3], unit vector; `u` [3], uniform numbers in [0, 1): the first chooses the side and the lobe, the others the direction in it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_sample(
    sheet: *const srbf_sheet,
    wo: *const f32,
    u: *const f32,
    sample: *mut srbf_sample,
) -> srbf_status {
    guard(|| {
        // SAFETY: the header's contract.
        let object = unsafe { self::sheet(sheet)? };
        // SAFETY: the header's contract.
        let (wo, u, out) = unsafe {
            (
                read_array(wo).of(Argument::Wo)?,
                read_array(u).of(Argument::U)?,
                Out::new(sample).of(Argument::Sample)?,
            )
        };
        let (wo, u) = (direction(wo).of(Argument::Wo)?, uniform(u).of(Argument::U)?);
        out.set(drawn(object.sheet.sample(wo, u)));
        Ok(())
    })
}

/// Draws and evaluates for n hits of a sheet, each with an outgoing direction of its own: outputs that are given are wanted.
///
/// The answers of `srbf_sheet_sample` and `srbf_sheet_evaluate_and_pdf` within rounding, in less time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn srbf_sheet_ask(
    sheet: *const srbf_sheet,
    n: usize,
    request: *const srbf_request,
) -> srbf_status {
    guard(|| {
        if n == 0 {
            return Ok(());
        }
        // SAFETY: the header's contract.
        let (object, arrays) = unsafe { (self::sheet(sheet)?, Arrays::new(request, n, true)?) };
        object.extents().iter().try_for_each(|place| arrays.check_object(place))?;
        // SAFETY: the header's contract.
        unsafe {
            arrays.each(n, &mut |_, wo, request| {
                object.sheet.ask(wo, request)?;
                Ok(())
            })
        }
    })
}
