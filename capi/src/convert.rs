//! Between C's plain numbers and core's types; core's errors as statuses.

use crate::guard::Failure;
use crate::status::{
    SRBF_STATUS_AMPLITUDE, SRBF_STATUS_ARGUMENT, SRBF_STATUS_AXIS, SRBF_STATUS_CAPACITY,
    SRBF_STATUS_CHECKSUM, SRBF_STATUS_DIRECTION, SRBF_STATUS_FIELD, SRBF_STATUS_FORMAT_VERSION,
    SRBF_STATUS_LENGTH, SRBF_STATUS_MAGIC, SRBF_STATUS_OBJECT, SRBF_STATUS_OTHER, SRBF_STATUS_SHARPNESS,
    SRBF_STATUS_SIMD_LEVEL, SRBF_STATUS_SIZE, SRBF_STATUS_SQUEEZE, SRBF_STATUS_SQUEEZED, SRBF_STATUS_UNIFORM,
    SRBF_STATUS_WEIGHT,
};
use srbf_core::{Error, FormatError, Vec3};

impl From<Error> for Failure {
    #[cold]
    fn from(error: Error) -> Self {
        let status = match error {
            Error::Axis => SRBF_STATUS_AXIS,
            Error::Sharpness => SRBF_STATUS_SHARPNESS,
            Error::Amplitude => SRBF_STATUS_AMPLITUDE,
            Error::Squeeze => SRBF_STATUS_SQUEEZE,
            Error::Capacity { .. } => SRBF_STATUS_CAPACITY,
            Error::Squeezed => SRBF_STATUS_SQUEEZED,
            Error::Direction => SRBF_STATUS_DIRECTION,
            Error::Level => SRBF_STATUS_SIMD_LEVEL,
            Error::Weight => SRBF_STATUS_WEIGHT,
            Error::Parts => SRBF_STATUS_ARGUMENT,
            Error::Share | Error::Rows | Error::Anisotropic | Error::Candidates | Error::Kappa => {
                SRBF_STATUS_ARGUMENT
            }
            Error::MapSize | Error::Radiance { .. } | Error::BlackMap => SRBF_STATUS_ARGUMENT,
            Error::Table => SRBF_STATUS_OBJECT,
            Error::Memory { .. } => SRBF_STATUS_SIZE,
            _ => SRBF_STATUS_OTHER,
        };
        Self::new(status, error)
    }
}

impl From<FormatError> for Failure {
    #[cold]
    fn from(error: FormatError) -> Self {
        let status = match error {
            FormatError::Magic => SRBF_STATUS_MAGIC,
            FormatError::Version(_) => SRBF_STATUS_FORMAT_VERSION,
            FormatError::Length { .. } => SRBF_STATUS_LENGTH,
            FormatError::Checksum => SRBF_STATUS_CHECKSUM,
            FormatError::Field { .. } | FormatError::Kind { .. } => SRBF_STATUS_FIELD,
            FormatError::Buffer { .. } => SRBF_STATUS_SIZE,
            _ => SRBF_STATUS_OTHER,
        };
        Self::new(status, error)
    }
}

/// Refuses a vector that is not a finite unit vector; a NaN too.
#[inline(always)]
pub(crate) fn direction(numbers: [f32; 3]) -> Result<Vec3, Failure> {
    let direction = Vec3::from_array(numbers);
    if (direction.length_squared() - 1.0).abs() <= 2e-3 {
        Ok(direction)
    } else {
        Err(SRBF_STATUS_DIRECTION.into())
    }
}

/// Refuses numbers outside [0, 1); a NaN too.
#[inline(always)]
pub(crate) fn uniform<const K: usize>(numbers: [f32; K]) -> Result<[f32; K], Failure> {
    if numbers.iter().all(|u| (0.0..1.0).contains(u)) { Ok(numbers) } else { Err(SRBF_STATUS_UNIFORM.into()) }
}
