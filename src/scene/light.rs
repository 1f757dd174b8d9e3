//! Lights without a visible surface.

use super::Rectangle;
use crate::math::Rgb;
use glam::Vec3;

/// A light that nothing can hit: rays pass through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Radiance from the front of a rectangle.
    Rectangle {
        /// Where it is.
        rectangle: Rectangle,
        /// W/(m² sr), the same in every direction.
        radiance: Rgb,
    },
    /// Intensity (power per solid angle) from a point.
    Point {
        /// In the world.
        position: Vec3,
        /// W/sr, the same in every direction.
        intensity: Rgb,
        /// How the irradiance depends on the distance.
        falloff: Falloff,
    },
    /// Light from one direction.
    Directional {
        /// The way that the light travels, of unit length.
        direction: Vec3,
        /// W/m² on a surface that faces it.
        irradiance: Rgb,
    },
    /// The same radiance from everywhere above the horizon (+y).
    Hemisphere {
        /// W/(m² sr).
        radiance: Rgb,
    },
}

impl Light {
    /// A point of the light, or its middle; `None` of light from infinity.
    pub(super) fn position(&self) -> Option<Vec3> {
        match self {
            Self::Rectangle { rectangle, .. } => Some(rectangle.centre()),
            Self::Point { position, .. } => Some(*position),
            Self::Directional { .. } | Self::Hemisphere { .. } => None,
        }
    }
}

/// How the light of a point grows weaker with distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Falloff {
    /// With the square of the distance, as light does.
    #[default]
    InverseSquare,
    /// Not at all: what the CS184 renderer does.
    None,
}
