//! Lights without a visible surface; and light from infinity, a lat-long map that is turned and scaled into the scene.

use super::Rectangle;
use crate::envmap::EnvMap;
use crate::math::Rgb;
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// A light that nothing can hit: rays pass through it.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Radiance from the front of a rectangle.
    Rectangle {
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

    /// Moves the light by a vector, if it is in a place.
    pub(super) fn translate(&mut self, by: Vec3) {
        match self {
            Self::Rectangle { rectangle, .. } => *rectangle = rectangle.centred_at(rectangle.centre() + by),
            Self::Point { position, .. } => *position += by,
            Self::Directional { .. } | Self::Hemisphere { .. } => {}
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

#[derive(Debug, Clone)]
pub struct Environment {
    /// Radiance by direction, in the map's own frame.
    pub map: Arc<EnvMap>,
    /// What the map is called: its file or built-in name.
    pub source: String,
    /// Factor on the map's radiance.
    pub scale: Rgb,
    /// Orthonormal matrix that takes directions of the map (row 0 at +y) to the world.
    pub to_world: DMat3,
}

impl Environment {
    /// A map as it stands, its zenith up.
    pub fn upright(map: Arc<EnvMap>, source: impl Into<String>, scale: f32) -> Self {
        Self { map, source: source.into(), scale: Rgb::splat(scale), to_world: DMat3::IDENTITY }
    }

    /// The direction in the map's own frame.
    #[inline]
    pub fn to_map(&self, world: DVec3) -> DVec3 {
        self.to_world.transpose() * world
    }

    /// The texel of the map in a world direction.
    #[inline]
    pub fn texel(&self, world: DVec3) -> (usize, usize) {
        self.map.geometry().texel(self.to_map(world))
    }

    /// Radiance that arrives from the directions in a texel.
    #[inline]
    pub fn radiance_in_texel(&self, (x, y): (usize, usize)) -> Rgb {
        self.map.texel(x, y) * self.scale
    }

    /// Radiance that arrives from a world direction.
    #[inline]
    pub fn radiance(&self, world: DVec3) -> Rgb {
        self.radiance_in_texel(self.texel(world))
    }
}
