//! Point lights that replace a map: one for each region of a cut, with the region's flux, at its energy centroid.

use super::settings::{Sampling, Settings};
use crate::envmap::samplers::FixedLight;
use crate::error::{Error, Result};
use crate::scene::{Light, Scene};

/// The directional lights that the settings put in the place of the scene's environment, if they do.
///
/// # Errors
/// [`Error::Parameter`] for a cut that the map does not allow, and for strategies that would find the map's light once
/// more by the material's directions.
pub fn of(scene: &Scene, settings: &Settings) -> Result<Vec<Light>> {
    let Some(environment) = &scene.environment else { return Ok(Vec::new()) };
    if settings.map_sampling().has_fixed_lights() && settings.sampling != Sampling::Light {
        return Err(Error::parameter("density", "lights that stand for the map hold all of its light")
            .with_hint("light sampling only: the material's directions would find the map a second time"));
    }
    let light = |FixedLight { towards, irradiance }| Light::Directional {
        direction: -(environment.to_world * towards).as_vec3(),
        irradiance: irradiance.as_vec3() * environment.scale,
    };
    let lights = settings.map_sampling().fixed_lights(&environment.map)?;
    Ok(lights.unwrap_or_default().into_iter().map(light).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::samplers::{MapSampling, cut_lights::MEDIAN_CUT};
    use crate::envmap::synthetic::Synthetic;
    use crate::render::tests::sphere;
    use crate::render::{Silent, render};
    use crate::scene::Request;

    #[test]
    fn many_lights_are_the_map_and_few_are_not() {
        let (scene, request) = sphere(Synthetic::Sun.make());
        let image = |density, spp| {
            let settings = Settings { sampling: Sampling::Light, density: Some(density), ..Settings::default() };
            render(&scene, &Request { spp, light_samples: 1, ..request }, &settings, &Silent).unwrap().image
        };
        let map = image(MapSampling::COSINE, 512);
        let off = |count| {
            let lights = image(MapSampling::with_regions(MEDIAN_CUT, count), 16);
            crate::raster::compare(&lights, &map).unwrap().rmse
        };
        let (few, many) = (off(4), off(1024));
        assert!(many < 0.01 && few > 10.0 * many, "{few} {many}");
    }

    #[test]
    fn the_maps_light_is_not_brought_twice() {
        let (scene, request) = sphere(Synthetic::Sun.make());
        for sampling in [Sampling::Mis, Sampling::Bsdf] {
            let density = MapSampling::with_regions(MEDIAN_CUT, 16);
            let settings = Settings { sampling, density: Some(density), ..Settings::default() };
            assert!(render(&scene, &request, &settings, &Silent).is_err());
        }
        for regions in [0, u32::MAX] {
            let density = MapSampling::with_regions(MEDIAN_CUT, regions);
            let settings = Settings { sampling: Sampling::Light, density: Some(density), ..Settings::default() };
            assert!(render(&scene, &request, &settings, &Silent).is_err(), "{density}");
        }
    }
}
