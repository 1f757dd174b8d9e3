//! The course's area light: its irradiance decreases with the distance, not with its square, because a vector that is not a
//! unit vector is used as one.

use super::erratum::{Erratum, ErratumCurves, Suspect, curve};
use crate::errata::{Conventions, light::falloff_error};
use crate::math::Rgb;
use crate::render::{Sampling, Settings};
use crate::scene::{
    Camera, Light, Material, Object, PixelFilter, Projection, Rectangle, Request, ScatterModel, Scene, Shape,
};
use crate::study::validation::suite::renders::{RenderTest, Truth};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Half sides of the area light of the report's Cornell box.
const HALF: [f64; 2] = [0.3, 0.4];
const HEIGHT: f64 = 1.49;
/// The point of the floor in the image, (x, z).
const PLACE: [f64; 2] = [0.3, 0.2];
const ALBEDO: f64 = 0.6;

/// Irradiance of the floor at (x, z) by an area light of radiance 1, ∫ cos² θ/d² dA, times the distance if `too_bright`.
fn irradiance([x, z]: [f64; 2], too_bright: bool) -> f64 {
    const STEPS: usize = 200;
    let at = |i: usize, half: f64| half * ((2 * i + 1) as f64 / STEPS as f64 - 1.0);
    let area = 4.0 * HALF[0] * HALF[1] / (STEPS * STEPS) as f64;
    let mut sum = 0.0;
    for i in 0..STEPS {
        for k in 0..STEPS {
            // cos θ at both ends is HEIGHT/d.
            let d2 = (at(i, HALF[0]) - x).powi(2) + HEIGHT * HEIGHT + (at(k, HALF[1]) - z).powi(2);
            sum += HEIGHT * HEIGHT / (d2 * d2) * if too_bright { falloff_error(d2.sqrt()) } else { 1.0 };
        }
    }
    sum * area
}

/// The image of the floor under the area light, from close above.
fn floor(inverse_distance: bool) -> RenderTest {
    let rectangle = |centre, x, y| Rectangle::new(centre, x, y).expect("the sides are perpendicular");
    let ground = rectangle(Vec3::ZERO, 2.0 * Vec3::Z, 2.0 * Vec3::X);
    let panel = rectangle(Vec3::Y * HEIGHT as f32, HALF[0] as f32 * Vec3::X, HALF[1] as f32 * Vec3::Z);
    let camera = Camera {
        position: DVec3::new(PLACE[0], 0.5, PLACE[1]),
        right: DVec3::X,
        up: DVec3::NEG_Z,
        forward: DVec3::NEG_Y,
        projection: Projection::Orthographic { half_width: 5e-4, half_height: 5e-4 },
        filter: PixelFilter::default(),
    };
    let scene = Scene {
        name: "floor".into(),
        camera,
        objects: vec![Object::new(Shape::Rectangle(ground), Material::Diffuse { albedo: Rgb::splat(ALBEDO as f32) })],
        lights: vec![Light::Rectangle { rectangle: panel, radiance: Rgb::ONE }],
        environment: None,
    };
    let conventions = Conventions { inverse_distance, ..Conventions::CORRECT };
    let model = ScatterModel { conventions, ..ScatterModel::default() };
    RenderTest {
        scene,
        request: Request { width: 16, height: 16, spp: 1, light_samples: 1, max_depth: 1 },
        settings: Settings { sampling: Sampling::Light, model, ..Settings::default() },
        truth: Truth::Uniform(ALBEDO / PI * irradiance(PLACE, false)),
        plant: None,
    }
}

pub fn suspect() -> Suspect {
    // Over the report's floor, 2 by 2.
    const POINTS: usize = 12;
    let at = |i: usize| (2 * i + 1) as f64 / POINTS as f64 - 1.0;
    let mean = |too_bright| -> f64 {
        (0..POINTS * POINTS).map(|i| irradiance([at(i % POINTS), at(i / POINTS)], too_bright)).sum()
    };
    let along = |too_bright| curve(-1.0, 1.0, |x| irradiance([x, 0.0], too_bright));
    let erratum = Erratum {
        title: "light that falls off as 1/d",
        report: "second report (its course)",
        printed: "cos θ by a direction of length d: irradiance ∝ 1/d",
        right: "irradiance ∝ 1/d²",
        test: "Welch's t of the rendered floor against its exact radiance",
        error_in_picture: mean(true) / mean(false) - 1.0,
        error_of: "light on the floor",
        curves: ErratumCurves {
            x: "/{x} on the floor (scene's unit)",
            every: 0.5,
            y: "/{E} per /{L} (sr)",
            printed: along(true),
            right: along(false),
            scattered: false,
        },
        ..Erratum::default()
    };
    (erratum, [floor(true).case("audit/light/printed"), floor(false).case("audit/light/right")])
}
