//! The white furnace: spheres that absorb nothing, in a uniform environment of radiance 1, must have radiance 1.

use super::object_ids::{Kind, ObjectIdBuffer};
use super::pixel_mean::Mean;
use crate::error::Result;
use crate::render::{Settings, Silent, render};
use crate::scene::{Material, Request, builtin};

/// The mean radiance of one sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FurnaceSphere {
    /// Its material.
    pub material: &'static str,
    /// Over the pixels whose centre shows it.
    pub radiance: Mean,
}

/// Renders a diffuse, a mirror and a glass sphere at `spp` samples per pixel.
pub fn furnace(spp: u32, settings: &Settings) -> Result<[FurnaceSphere; 3]> {
    let (mut scene, request) = builtin::furnace();
    // Without the metal of the built-in scene, which absorbs and is reflected in the mirror.
    scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
    let rendered = render(&scene, &Request { spp, ..request }, settings, &Silent)?;
    let objects = ObjectIdBuffer::new(&scene, &request);
    let spheres = [(Kind::Diffuse, "diffuse"), (Kind::Mirror, "mirror"), (Kind::Glass, "glass")];
    Ok(spheres.map(|(kind, material)| FurnaceSphere {
        material,
        radiance: Mean::of(&rendered.part.film, &objects.mask(kind)),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sphere_gains_or_loses_light() {
        for sphere in furnace(4, &Settings::default()).unwrap() {
            let Mean { error, pixels, .. } = sphere.radiance;
            let error = error.into_iter().fold(0.0, f64::max);
            assert!(pixels > 100 && (sphere.radiance.mean_rgb() - 1.0).abs() < 4.0 * error + 1e-5, "{sphere:?}");
        }
    }
}
