//! Glass of increasing roughness: what is seen through it, and its caustic.

use super::object_ids::{Kind, ObjectIdBuffer};
use super::pixel_mean::{Mean, inside};
use super::roughness::brightest_percent;
use crate::error::Result;
use crate::math::Rgb;
use crate::raster::Image;
use crate::render::{Kernel, Sampling, Settings, Silent, render};
use crate::scene::{Emission, EmitterVisibility, Light, Material, Object, Request, Scene, Shape};
use serde::Serialize;

/// Results of one roughness: a row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct GlassRow {
    /// Width of the distribution of normals.
    pub alpha: f32,
    /// Samples per pixel.
    pub spp: u32,
    /// Pixels that show glass.
    pub glass_pixels: usize,
    /// Their mean radiance, of all channels.
    pub glass: f64,
    /// The root mean square of the standard errors of these pixels, over their mean radiance.
    pub noise: f64,
    /// The same by the reference path tracer, with fewer samples.
    pub glass_by_reference: f64,
    /// The difference in standard errors, of the channel where it is largest.
    pub z: f64,
    /// Share of the light on the walls that comes from the brightest hundredth of their pixels, where the caustic is.
    pub brightest_percent: f64,
    /// Samples that were not finite or negative.
    pub dropped: u64,
}

/// An image with its statistics.
pub struct GlassRender {
    /// Its row of the table.
    pub row: GlassRow,
    /// The glass's mean radiance.
    pub glass: Mean,
    /// The render.
    pub image: Image,
}

/// The scene with its rectangular lights as area lights, in the place of emitters that light samples do not know.
///
/// The second report's file has a panel that is only seen, and a light that no ray finds, turned by 90° against it. A facet distribution of
/// α = 0.001 needs rays that find the light: a light sample meets its lobe once in 10⁵ times. And smooth glass would show the panel, rough glass the light.
#[must_use]
pub fn with_area_lights(mut scene: Scene) -> Scene {
    let (panels, others): (Vec<Light>, Vec<Light>) =
        scene.lights.into_iter().partition(|light| matches!(light, Light::Rectangle { .. }));
    scene.lights = others;
    if !panels.is_empty() {
        let is_sampled = |emission: Emission| emission.visibility == EmitterVisibility::Sampled;
        scene.objects.retain(|object| object.emission.is_none_or(is_sampled));
    }
    for panel in panels {
        let Light::Rectangle { rectangle, radiance } = panel else { continue };
        let emission = Some(Emission { radiance, two_sided: false, visibility: EmitterVisibility::Sampled });
        let black = Material::Diffuse { albedo: Rgb::ZERO };
        scene.objects.push(Object { emission, ..Object::new(Shape::Rectangle(rectangle), black) });
    }
    scene
}

/// A scene whose glass has the roughness `alpha`.
pub fn with_alpha(scene: &Scene, alpha: f32) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        if let Material::Dielectric(glass) = &mut object.material {
            glass.alpha = [alpha; 2];
        }
    }
    scene
}

/// Renders the scene with glass of roughness `alpha`, and with an eighth of the samples by the reference path tracer.
///
/// # Errors
/// Those of the renders.
pub fn render_glass(scene: &Scene, request: &Request, settings: &Settings, alpha: f32) -> Result<GlassRender> {
    let scene = with_alpha(scene, alpha);
    let rendered = render(&scene, request, settings, &Silent)?;
    let objects = ObjectIdBuffer::new(&scene, request);
    let mask = objects.mask(Kind::Glass);
    let glass = Mean::of(&rendered.part.film, &mask);
    let fewer = Request { spp: (request.spp / 8).max(2), ..*request };
    let seed = settings.seed.wrapping_add(1);
    let by_reference = Settings { kernel: Kernel::Reference, sampling: Sampling::Mis, seed, ..*settings };
    let reference = Mean::of(&render(&scene, &fewer, &by_reference, &Silent)?.part.film, &mask);
    let square = glass.error.iter().map(|error| error * error).sum::<f64>() / 3.0;
    let walls = objects.mask(Kind::Diffuse);
    let light = inside(rendered.image.pixels(), &walls).map(|p| f64::from(p.element_sum())).collect();
    let row = GlassRow {
        alpha,
        spp: request.spp,
        glass_pixels: glass.pixels,
        glass: glass.mean_rgb(),
        noise: (square * glass.pixels as f64).sqrt() / glass.mean_rgb(),
        glass_by_reference: reference.mean_rgb(),
        z: glass.z(&reference),
        brightest_percent: brightest_percent(light),
        dropped: rendered.dropped.total(),
    };
    Ok(GlassRender { row, glass, image: rendered.image })
}
