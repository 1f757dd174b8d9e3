//! Light from infinity: a lat-long map, turned and scaled into the scene.

use crate::envmap::EnvMap;
use crate::math::Rgb;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// An environment map in a scene.
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
    #[must_use]
    pub fn upright(map: Arc<EnvMap>, source: impl Into<String>, scale: f32) -> Self {
        Self { map, source: source.into(), scale: Rgb::splat(scale), to_world: DMat3::IDENTITY }
    }

    /// The direction in the map's own frame.
    #[inline]
    #[must_use]
    pub fn to_map(&self, world: DVec3) -> DVec3 {
        self.to_world.transpose() * world
    }

    /// The texel of the map in a world direction.
    #[inline]
    #[must_use]
    pub fn texel(&self, world: DVec3) -> (usize, usize) {
        self.map.geometry().texel(self.to_map(world))
    }

    /// Radiance that arrives from the directions in a texel.
    #[inline]
    #[must_use]
    pub fn radiance_in_texel(&self, (x, y): (usize, usize)) -> Rgb {
        self.map.texel(x, y) * self.scale
    }

    /// Radiance that arrives from a world direction.
    #[inline]
    #[must_use]
    pub fn radiance(&self, world: DVec3) -> Rgb {
        self.radiance_in_texel(self.texel(world))
    }
}
