//! Brushed metal by the widths of its distribution of normals along the tangent and across it: `anisotropy`.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::object_ids::PixelMean;
use etalon_core::error::Result;
use etalon_core::raster::Image;
use etalon_core::scene::{Environment, FirstHit, Material, Mesh, Object, Request, Scene, Shape, builtin};
use etalon_render::{Kernel, Sampling, Settings, Silent, render};
use glam::{DVec2, Vec2Swizzles};
use serde::Serialize;
use std::sync::Arc;

/// Widths, along the tangent by column and across it by row.
const ALPHAS: [f32; 3] = [0.05, 0.15, 0.4];
/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

pub fn figures() -> Vec<Maker> {
    vec![maker("anisotropy", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let environment = Environment::upright(inputs.map.map.clone(), &inputs.map.name, builtin::BRUSHED_METAL_SCALE);
    let (scene, request) = builtin::brushed_metal(environment);
    let request = Request { spp: 64, ..request };
    let (scene, request) = scene.resized(request, inputs.effort.of([240, 120], [80, 40]));
    let mut renders = Vec::new();
    for alpha_y in ALPHAS {
        for alpha_x in ALPHAS {
            renders.push(render_pair(&scene, &request, &inputs.settings(), [alpha_x, alpha_y])?);
        }
    }
    let rows: Vec<PairRow> = renders.iter().map(|render| render.row).collect();
    let mut checks: Vec<Check> = rows.iter().flat_map(agreement).collect();
    for same_y in rows.chunks_exact(ALPHAS.len()) {
        for pair in same_y.windows(2) {
            let [narrow, wide] = [pair[0], pair[1]];
            let name =
                format!("width over height of the sphere's highlights, {} over {}", widths(&narrow), widths(&wide));
            checks.push(Check::at_most(name, narrow.elongation / wide.elongation, 1.0));
        }
    }
    let caption = |PairRow { alpha_x, alpha_y, .. }: &PairRow| {
        format!("/{{α}} = {alpha_x} along the grooves, {alpha_y} across").replace(" = ", "\u{a0}=\u{a0}")
    };
    let images: Vec<Image> = renders.iter().map(|render| view::without_specks(&render.image)).collect();
    let cells: Vec<_> = rows.iter().map(caption).zip(&images).collect();
    Content::new(
        view::grid("Highlights on brushed copper stretch along the larger /{α}", 3, 0.0, &cells),
        &rows,
        checks,
    )
}

fn widths(row: &PairRow) -> String {
    format!("α = ({}, {})", row.alpha_x, row.alpha_y)
}

fn agreement(row: &PairRow) -> [Check; 3] {
    let of = widths(row);
    let reference = format!("disc minus that of the reference path tracer (standard errors), {of}");
    let turned = format!("disc minus that of turned tangents and exchanged widths (standard errors), {of}");
    [
        Check::within(reference, 0.0, row.z_reference, SIGMAS),
        Check::within(turned, 0.0, row.z_turned, SIGMAS),
        Check::equal(format!("dropped samples, {of}"), 0.0, row.dropped as f64),
    ]
}

/// Results of one pair of widths: a row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
struct PairRow {
    /// Width of the distribution of normals along the tangent.
    alpha_x: f32,
    /// Across it.
    alpha_y: f32,
    /// Samples per pixel.
    spp: u32,
    /// Mean radiance of the metal disc, of all channels.
    disc: f64,
    /// The disc minus the same by the reference path tracer with fewer samples, in standard errors.
    z_reference: f64,
    /// The disc minus one whose widths are exchanged and whose tangents are turned by 90°, in standard errors.
    z_turned: f64,
    /// Root mean square width of the area lights' highlights on the sphere over their height.
    elongation: f64,
    /// Samples that were not finite or negative.
    dropped: u64,
}

/// An image with its statistics.
struct PairRender {
    row: PairRow,
    image: Image,
}

/// Renders `builtin::brushed_metal` or a scene like it, with one disc (a mesh) and one sphere of metal, for a pair of widths;
/// and for comparison 1/32 of the samples with the reference path tracer, and as many with other tangents.
///
/// # Errors
/// Those of the renders.
fn render_pair(scene: &Scene, request: &Request, settings: &Settings, alpha: [f32; 2]) -> Result<PairRender> {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        set(object, alpha);
    }
    let rendered = render(&scene, request, settings, &Silent)?;
    let disc = pixels(&scene, request, |shape| matches!(shape, Shape::Mesh(_)));
    let mean = PixelMean::of(rendered.part.film.estimates(), &disc);
    // Other random numbers: independent means.
    let fewer = Request { spp: (request.spp / 32).max(2), ..*request };
    let other = Settings { seed: settings.seed.wrapping_add(1), ..*settings };
    let z = |scene: &Scene, settings: &Settings| {
        Result::Ok(mean.z(&PixelMean::of(render(scene, &fewer, settings, &Silent)?.part.film.estimates(), &disc)))
    };
    let by_reference = Settings { kernel: Kernel::Reference, sampling: Sampling::Mis, ..other };
    let row = PairRow {
        alpha_x: alpha[0],
        alpha_y: alpha[1],
        spp: request.spp,
        disc: mean.mean_rgb(),
        z_reference: z(&scene, &by_reference)?,
        z_turned: z(&turned(&scene, [alpha[1], alpha[0]]), &other)?,
        elongation: elongation(&scene, &fewer, &other)?,
        dropped: rendered.dropped.total(),
    };
    Ok(PairRender { row, image: rendered.image })
}

fn set(object: &mut Object, alpha: [f32; 2]) {
    if let Material::Conductor(metal) = &mut object.material {
        metal.alpha = alpha;
    }
}

/// The scene with these widths of the disc, and with u and v of its texture coordinates exchanged.
fn turned(scene: &Scene, alpha: [f32; 2]) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        if let Shape::Mesh(mesh) = &object.shape {
            let uv = mesh.uv.iter().map(|corners| corners.map(|uv| uv.yx())).collect();
            object.shape = Shape::Mesh(Arc::new(Mesh { uv, ..Mesh::clone(mesh) }));
            set(object, alpha);
        }
    }
    scene
}

/// Which pixels show metal of this shape at their centre.
fn pixels(scene: &Scene, request: &Request, is_shape: impl Fn(&Shape) -> bool) -> Vec<bool> {
    let objects = FirstHit::new(scene);
    let shows = |i: usize| {
        let (x, y) = ((i % request.width) as f64 + 0.5, (i / request.width) as f64 + 0.5);
        let object = objects.along(&scene.camera.ray(x / request.width as f64, y / request.height as f64));
        object.is_some_and(|object| is_shape(&object.shape) && matches!(object.material, Material::Conductor(_)))
    };
    (0..request.width * request.height).map(shows).collect()
}

/// The width of the highlights on the sphere over their height: of direct light from the area lights.
fn elongation(scene: &Scene, request: &Request, settings: &Settings) -> Result<f64> {
    let lit = Scene { environment: None, ..scene.clone() };
    let image = render(&lit, &Request { max_depth: 1, ..*request }, settings, &Silent)?.image;
    let sphere = pixels(scene, request, |shape| matches!(shape, Shape::Sphere(_)));
    let place = |i: usize| DVec2::new((i % request.width) as f64, (i / request.width) as f64);
    let (mut sum, mut first, mut second) = (0.0, DVec2::ZERO, DVec2::ZERO);
    for (i, pixel) in image.pixels().iter().enumerate().filter(|(i, _)| sphere[*i]) {
        let light = f64::from(pixel.element_sum());
        sum += light;
        first += light * place(i);
        second += light * place(i) * place(i);
    }
    let variance = second / sum - (first / sum) * (first / sum);
    Ok((variance.x / variance.y).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::EnvMap;
    use etalon_core::scene::{Environment, builtin};

    #[test]
    fn turned_tangents_need_other_widths() {
        let map = Arc::new(EnvMap::new(Image::from_fn(4, 2, |x, _| etalon_core::math::Rgb::splat(x as f32))));
        let (scene, request) = builtin::brushed_metal(Environment::upright(map, "test", 1.0));
        let (scene, request) = scene.resized(Request { spp: 64, ..request }, [80, 40]);
        let alpha = [0.05, 0.4];
        let right = render_pair(&scene, &request, &Settings::default(), alpha).unwrap().row;
        assert!(right.z_turned.abs() < 4.0 && right.z_reference.abs() < 4.0, "{right:?}");
        assert!(right.elongation < 1.0 && right.dropped == 0, "{right:?}");
        // The same widths with other tangents are another surface.
        let other = render_pair(&turned(&scene, alpha), &request, &Settings::default(), alpha).unwrap().row;
        assert!((other.disc / right.disc - 1.0).abs() > 0.1, "{} {}", other.disc, right.disc);
    }
}
