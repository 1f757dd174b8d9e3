//! Glass of increasing roughness, what is seen through it, and its caustic: `rough-glass`.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::object_ids::{Kind, ObjectIdBuffer, PixelMean, inside};
use etalon_bench::roughness::brightest_percent;
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::scene::{
    Camera, Emission, EmitterVisibility, Light, Material, Object, Projection, Request, Scene, Shape,
};
use etalon_render::{Kernel, Sampling, Settings, Silent, render};
use glam::DVec3;
use serde::Serialize;

/// Widths of the distribution of normals; with the first the glass is smooth, with the second it must look so.
const ALPHAS: [f32; 7] = [0.0, 0.001, 0.05, 0.1, 0.2, 0.3, 0.5];
/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

pub fn figures() -> Vec<Maker> {
    vec![maker("rough-glass", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let (scene, _) = inputs.spheres();
    let mut scene = with_area_lights(scene);
    scene.camera = close_up(&scene.camera)?;
    let side = inputs.effort.of(150, 50);
    let request = Request { width: side, height: side, spp: 96, light_samples: 1, max_depth: 7 };
    let settings = Settings { adaptive: true, ..inputs.settings() };
    let renders = ALPHAS.map(|alpha| render_glass(&scene, &request, &settings, alpha));
    let renders = renders.into_iter().collect::<Result<Vec<_>>>()?;
    let rows: Vec<GlassRow> = renders.iter().map(|render| render.row).collect();

    let mut checks: Vec<Check> = rows.iter().flat_map(agreement).collect();
    let alike = renders[1].glass.z(&renders[0].glass);
    checks.push(Check::within("glass of α = 0.001 minus smooth glass (standard errors)", 0.0, alike, SIGMAS));
    for pair in rows[1..].windows(2) {
        let [before, row] = [pair[0], pair[1]];
        let name = format!(
            "share of the walls' light in the brightest hundredth of their pixels, α = {}, at most that of α = {}",
            row.alpha, before.alpha
        );
        checks.push(Check::at_most(name, row.brightest_percent, before.brightest_percent));
    }
    let caption = |row: &GlassRow| {
        if row.alpha == 0.0 { "smooth".to_owned() } else { format!("/{{α}}\u{a0}=\u{a0}{}", row.alpha) }
    };
    let shown = renders.iter().filter(|render| render.row.alpha != ALPHAS[1]);
    let shown: Vec<_> = shown.map(|render| (caption(&render.row), view::without_specks(&render.image))).collect();
    let cells: Vec<_> = shown.iter().map(|(caption, image)| (caption.clone(), image)).collect();
    Content::new(view::grid("The rougher the glass, the less is seen through it", 3, 0.0, &cells), &rows, checks)
}

/// The camera turned towards the glass sphere and its caustic, with a field of view that they fill.
fn close_up(camera: &Camera) -> Result<Camera> {
    let projection = Projection::Perspective { tan_half_width: 0.1, tan_half_height: 0.1 };
    Camera::look_at(camera.position, DVec3::new(0.4, 0.31, 0.3), DVec3::Y, projection)
        .ok_or_else(|| Error::parameter("camera", "it is in the glass sphere"))
}

fn agreement(row: &GlassRow) -> [Check; 2] {
    let name = format!("glass minus that of the reference path tracer (standard errors), α = {}", row.alpha);
    [
        Check::within(name, 0.0, row.z, SIGMAS),
        Check::equal(format!("dropped samples, α = {}", row.alpha), 0.0, row.dropped as f64),
    ]
}

/// Results of one roughness: a row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
struct GlassRow {
    /// Width of the distribution of normals.
    alpha: f32,
    /// Samples per pixel.
    spp: u32,
    glass_pixels: usize,
    /// Their mean radiance, of all channels.
    glass: f64,
    /// The root mean square of the standard errors of these pixels, over their mean radiance.
    noise: f64,
    /// The same by the reference path tracer, with fewer samples.
    glass_by_reference: f64,
    /// The difference in standard errors, of the channel where it is largest.
    z: f64,
    /// Share of the light on the walls that comes from the brightest hundredth of their pixels, where the caustic is.
    brightest_percent: f64,
    /// Samples that were not finite or negative.
    dropped: u64,
}

/// An image with its statistics.
struct GlassRender {
    row: GlassRow,
    /// The glass's mean radiance.
    glass: PixelMean,
    image: Image,
}

/// The scene with its rectangular lights as area lights, in the place of emitters that light samples do not know.
///
/// The second report's file has a panel that is only seen, and a light that no ray finds, turned by 90° against it. A facet distribution of
/// α = 0.001 needs rays that find the light: a light sample meets its lobe once in 10⁵ times. And smooth glass would show the panel, rough glass the light.
#[must_use]
fn with_area_lights(mut scene: Scene) -> Scene {
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
fn with_alpha(scene: &Scene, alpha: f32) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        if let Material::Dielectric(glass) = &mut object.material {
            glass.alpha = [alpha; 2];
        }
    }
    scene
}

/// Renders the scene with glass of roughness `alpha`, and 1/16 of the samples with the reference path tracer.
///
/// # Errors
/// Those of the renders.
fn render_glass(scene: &Scene, request: &Request, settings: &Settings, alpha: f32) -> Result<GlassRender> {
    let scene = with_alpha(scene, alpha);
    let rendered = render(&scene, request, settings, &Silent)?;
    let objects = ObjectIdBuffer::new(&scene, request);
    let mask = objects.mask(Kind::Glass);
    let glass = PixelMean::of(rendered.part.film.estimates(), &mask);
    let fewer = Request { spp: (request.spp / 16).max(2), ..*request };
    let seed = settings.seed.wrapping_add(1);
    let by_reference = Settings { kernel: Kernel::Reference, sampling: Sampling::Mis, seed, ..*settings };
    let reference = PixelMean::of(render(&scene, &fewer, &by_reference, &Silent)?.part.film.estimates(), &mask);
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
