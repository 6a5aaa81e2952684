//! Quarters of a sheet, and the way from directions of the sheet to those of a quarter.

use crate::material::borrowed::MaterialRef;
use glam::Vec3;

/// One of the materials of a [`Sheet`](crate::Sheet), by the side that is seen and by the light that it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quarter {
    /// Viewer and light in front.
    FrontReflection,
    /// The viewer in front, the light behind.
    FrontTransmission,
    /// Viewer and light behind.
    BackReflection,
    /// The viewer behind, the light in front.
    BackTransmission,
}

impl Quarter {
    /// All, in the order of the bytes.
    pub const ALL: [Self; 4] =
        [Self::FrontReflection, Self::FrontTransmission, Self::BackReflection, Self::BackTransmission];

    /// Whether the light comes through the sheet.
    pub const fn is_transmission(self) -> bool {
        matches!(self, Self::FrontTransmission | Self::BackTransmission)
    }

    /// Whether the viewer is behind the sheet, where z is negative.
    pub const fn is_back(self) -> bool {
        matches!(self, Self::BackReflection | Self::BackTransmission)
    }

    /// The quarter for a side and a light.
    pub(super) const fn of(is_back: bool, is_transmission: bool) -> Self {
        Self::ALL[2 * is_back as usize + is_transmission as usize]
    }
}

/// The question of a viewer to a quarter: its material, the outgoing direction there, and the share of draws.
pub(super) struct Seen<'a> {
    pub material: MaterialRef<'a>,
    pub wo: Vec3,
    pub share: f32,
}

/// A direction as a quarter has it: above the horizon.
pub(super) fn upward(direction: Vec3) -> Vec3 {
    Vec3::new(direction.x, direction.y, if direction.z < 0.0 { -direction.z } else { direction.z })
}

/// Whether two directions lie on two sides.
pub(super) fn is_across(wo: Vec3, wi: Vec3) -> bool {
    (wo.z < 0.0) != (wi.z < 0.0)
}
