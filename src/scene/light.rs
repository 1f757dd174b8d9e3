//! Lights without a visible surface.

use super::Rectangle;
use crate::math::Rgb;
use glam::Vec3;

/// A light that nothing can hit: rays pass through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Radiance from the front of a rectangle.
    Rectangle { rectangle: Rectangle, radiance: Rgb },
    /// Intensity (power per solid angle) from a point.
    Point { position: Vec3, intensity: Rgb, falloff: Falloff },
    /// Irradiance, on surfaces that face it, from one direction; `direction` is the way that the light travels.
    Directional { direction: Vec3, irradiance: Rgb },
    /// The same radiance from everywhere above the horizon (+y).
    Hemisphere { radiance: Rgb },
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
