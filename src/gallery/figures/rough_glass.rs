//! Glass of increasing roughness: `rough-glass`.

use crate::error::Error;
use crate::gallery::prelude::*;
use crate::render::Settings;
use crate::scene::{Camera, Projection, Request};
use crate::study::rough_glass::{GlassRow, render_glass, with_area_lights};
use crate::view::renders as view;
use glam::DVec3;

/// Widths of the distribution of normals; with the first the glass is smooth, with the second it must look so.
const ALPHAS: [f32; 6] = [0.0, 0.001, 0.03, 0.1, 0.25, 0.5];
/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// One figure with an image for each α.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "rough-glass",
        title: "Glass of increasing roughness",
        report: Report::Neither,
        reproduces: "the second report's Cornell box, with a rough boundary of its glass sphere, and one area light in the place of its panel and its light",
        shows: "The glass sphere of the Cornell box from near. The wider the distribution of microfacet normals (GGX), the less is seen through the sphere, and the wider and \
                dimmer is its caustic. Smooth glass and glass of α = 0.001 look alike. Bright pixels within rough glass are noise: light that is reflected inside the sphere \
                reaches the camera on few paths. The error of a pixel (column `noise`) halves with four times the 64 samples per pixel.",
        matters: "A rough dielectric has to agree with smooth glass at one end and lose its caustic at the other, and both ends are where its pdf is easiest to get wrong.",
        papers: &[papers::WALTER],
        command: Some("etalon render cornell-spheres --alpha 0.1 -s 64 -l 1 -m 7".into()),
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let (scene, _) = inputs.spheres();
    let mut scene = with_area_lights(scene);
    scene.camera = close_up(&scene.camera)?;
    let side = inputs.effort.of(100, 50);
    let request = Request { width: side, height: side, spp: 64, light_samples: 1, max_depth: 7 };
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
    let caption = |row: &GlassRow| if row.alpha == 0.0 { "smooth".to_owned() } else { format!("α = {}", row.alpha) };
    let cells: Vec<_> = renders.iter().map(|render| (caption(&render.row), &render.image)).collect();
    Content::new(view::grid("Glass of increasing roughness", 3, 0.0, &cells), &rows, checks)
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
