//! Cost per camera sample, and of the preparation, against the number of lights, spheres and triangles: `scaling`.

use crate::figure::{Axis, Drawing, Panel, Plot, theme};
use crate::gallery::prelude::*;
use etalon_bench::converge::doubling::{Deadline, Doubling};
use etalon_bench::fit::log_log_slope;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{
    Camera, Emission, EmitterVisibility, Light, Material, Mesh, Object, PixelFilter, Projection, Rectangle, Request,
    Scene, Shape, Sphere,
};
use etalon_render::{Sampling, Settings};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::f32::consts::PI;
use std::sync::Arc;

/// Most primitives of a full run and of a quick one, as powers of ten.
fn largest(many: Many, inputs: &Inputs) -> u32 {
    match many {
        Many::Lights => inputs.effort.of(4, 3),
        Many::Spheres | Many::Triangles => inputs.effort.of(6, 4),
    }
}

pub fn figures() -> Vec<Maker> {
    vec![maker("scaling", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let (side, spp) = (inputs.effort.of(64, 32), 4);
    let mut costs: Vec<Cost> = Vec::new();
    let mut checks = Vec::new();
    for many in Many::ALL {
        let from = costs.len();
        for power in 0..=largest(many, inputs) {
            costs.push(cost(many, 10usize.pow(power), side, spp, inputs.seed)?);
        }
        // Logarithmic growth has a slope that falls towards 0, linear growth one of 1.
        let points: Vec<[f64; 2]> =
            costs[from + 1..].iter().map(|c| [c.count as f64, c.microseconds_per_sample]).collect();
        checks.push(Check::at_most(
            format!("exponent of the time per sample over the number of {}, from 10 on", many.name()),
            log_log_slope(&points),
            0.5,
        ));
    }
    Content::new(drawing(&costs), &costs, checks)
}

/// What there are many of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
enum Many {
    /// Spherical area lights above a floor.
    #[default]
    Lights,
    /// Diffuse spheres in a cube, under a directional light.
    Spheres,
    /// Triangles of one mesh, in their place.
    Triangles,
}

impl Many {
    /// All of them.
    const ALL: [Self; 3] = [Self::Lights, Self::Spheres, Self::Triangles];

    /// Its name.
    #[must_use]
    fn name(self) -> &'static str {
        match self {
            Self::Lights => "lights",
            Self::Spheres => "spheres",
            Self::Triangles => "triangles",
        }
    }
}

/// The cost of a render of n primitives. Field names are the CSV columns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
struct Cost {
    /// Kind of primitive.
    many: Many,
    /// How many.
    count: usize,
    /// Processor time of a camera sample, in microseconds.
    microseconds_per_sample: f64,
    /// Processor time of the preparation, in seconds.
    preparation_seconds: f64,
}

/// Renders `count` primitives at `side` × `side` pixels with `spp` samples, rounded up to a power of 2.
///
/// # Errors
/// Those of the render.
fn cost(many: Many, count: usize, side: usize, spp: u32, seed: u64) -> Result<Cost> {
    let scene = scene(many, count, seed)?;
    let request = Request { width: side, height: side, spp, light_samples: 1, max_depth: 2 };
    // Camera paths: the same work with any number of primitives.
    let settings = Settings { sampling: Sampling::Mis, seed, ..Settings::default() };
    let mut render = Doubling::new(&scene, &request, &settings)?;
    let forever = Deadline::after(3600.0);
    while render.spp() < spp && render.double(&forever) {}
    let samples = (side * side) as f64 * f64::from(render.spp());
    let microseconds_per_sample = 1e6 * render.times.cpu / samples;
    Ok(Cost { many, count, microseconds_per_sample, preparation_seconds: render.preparation.cpu })
}

/// A cube of primitives that fill 1 % of it, or a floor under lights of the same power in all.
fn scene(many: Many, count: usize, seed: u64) -> Result<Scene> {
    let place = |i: usize| {
        let stream = Independent::new(seed, i as u64, 0);
        let ([x, y], [z, _]) = (stream.pair(0), stream.pair(1));
        2.0 * Vec3::new(x as f32, y as f32, z as f32) - 1.0
    };
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) };
    // 8 · 0.01 = count · 4/3 π r³
    let radius = (0.06 / (PI * count as f32)).cbrt();
    let sphere = |i| Shape::Sphere(Sphere { centre: place(i), radius });
    let mut lights = vec![Light::Directional { direction: Vec3::new(-0.48, -0.6, -0.64), irradiance: Rgb::ONE }];
    let objects = match many {
        Many::Spheres => (0..count).map(|i| Object::new(sphere(i), diffuse.clone())).collect(),
        Many::Triangles => {
            let corner = |i: usize| place(i / 3) + 2.0 * radius * place(count + i);
            let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = Mesh::new((0..3 * count).map(corner).collect(), Vec::new(), triangles)?;
            vec![Object::new(Shape::Mesh(Arc::new(mesh)), diffuse)]
        }
        Many::Lights => {
            lights.clear();
            let radiance = Rgb::splat(1.0 / (count as f32 * radius * radius));
            let emission = Emission { radiance, two_sided: false, visibility: EmitterVisibility::Sampled };
            let light = |i| Object { emission: Some(emission), ..Object::new(sphere(i), diffuse.clone()) };
            let floor = Rectangle::new(1.2 * Vec3::NEG_Y, 3.0 * Vec3::Z, 3.0 * Vec3::X);
            let floor = floor.map(|floor| Object::new(Shape::Rectangle(floor), diffuse.clone()));
            floor.into_iter().chain((0..count).map(light)).collect()
        }
    };
    let projection = Projection::Perspective { tan_half_width: 0.5, tan_half_height: 0.5 };
    let camera = Camera {
        position: DVec3::new(0.0, 0.0, 3.5),
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection,
        filter: PixelFilter::default(),
    };
    Ok(Scene { name: format!("{count} {}", many.name()), camera, objects, lights, environment: None })
}

/// Time per camera sample, and time to prepare, over the number of primitives.
fn drawing(costs: &[Cost]) -> Drawing {
    let panel = |title: &str, label: &str, value: fn(&Cost) -> f64| {
        let panel = Panel::new(Axis::log("number of primitives"), Axis::log(label)).title(title);
        Many::ALL
            .into_iter()
            .enumerate()
            .fold(panel, |panel, (i, many)| {
                let of = costs.iter().filter(|cost| cost.many == many);
                panel.dotted_line(
                    many.name(),
                    theme::series(i),
                    of.map(|c| [c.count as f64, value(c)]).collect::<Vec<_>>(),
                )
            })
            .with_names_on_curves()
    };
    Plot::new([
        panel("Cost of a camera sample", "processor time (µs per sample)", |cost| cost.microseconds_per_sample),
        panel("Cost of the preparation", "processor time (s)", |cost| cost.preparation_seconds),
    ])
    .draw()
}
