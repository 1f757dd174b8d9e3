//! Rays. Long paths that lose no energy: a closed white emitting box, and a walk over materials that absorb nothing. Offsets of ray
//! origins: rays that leave a triangle must not hit it again, at any scale.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Workload};
use etalon_core::bsdf::Scatter;
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{
    Bvh, Camera, Dielectric, Emission, EmitterVisibility, Material, Mesh, Object, PixelFilter, Plane, Projection, Ray,
    Rectangle, Request, ScatterModel, Scene, Shape, Surface,
};
use etalon_render::{Sampling, Settings, Silent, render};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

pub const PATHS: Experiment = Experiment {
    name: "paths",
    about: "energy after 10 000 bounces in a furnace (paths) and over materials (walks)",
    figure: "stability-worst",
    bounds: &[
        Bound {
            name: "energy drift in a furnace",
            limit: 0.0,
            reason: "a factor of 1 and a sum of fewer than 2^24 ones are exact",
            error: |row| (row.family == "paths").then_some(row.max_relative),
        },
        Bound {
            name: "energy drift of walks over materials, last places for each bounce",
            limit: 1.0,
            reason: "every third bounce is on glass, whose weight and product are rounded three times",
            error: |row| (row.family == "walks").then_some(row.max_ulp_per_condition),
        },
    ],
    run: run_paths,
};

fn run_paths(workload: &Workload, seed: u64) -> Result<Vec<ErrorRow>> {
    Ok(vec![furnace(workload, seed)?, walks(workload, seed)])
}

/// Every path vertex adds a radiance of 1 and loses nothing: n bounces give n + 1.
fn furnace(workload: &Workload, seed: u64) -> Result<ErrorRow> {
    let scene = closed_box()?;
    let request = Request { width: 16, height: 16, spp: 1, light_samples: 1, max_depth: workload.bounces };
    let settings = Settings { sampling: Sampling::Bsdf, seed, ..Settings::default() };
    let rendered = render(&scene, &request, &settings, &Silent)?;
    let exact = f64::from(workload.bounces) + 1.0;
    let mut row = ErrorRow::new("paths", STABLE, Precision::Single);
    for (i, pixel) in rendered.image.pixels().iter().enumerate() {
        row.compare(f64::from(pixel.x), exact, 1.0, || {
            format!("{} bounces from pixel ({}, {})", workload.bounces, i % request.width, i / request.width)
        });
    }
    row.out_of_range += rendered.dropped.total();
    Ok(row)
}

/// A cube of side 2.06 around the camera: no power of 2.
fn closed_box() -> Result<Scene> {
    const HALF: f32 = 1.03;
    let wall = |normal: Vec3, x: Vec3, y: Vec3| {
        let rectangle = Rectangle::new(normal * HALF, x * HALF, y * HALF);
        let shape =
            Shape::Rectangle(rectangle.ok_or_else(|| Error::parameter("wall", "its sides are not perpendicular"))?);
        let emission = Emission { radiance: Rgb::ONE, two_sided: true, visibility: EmitterVisibility::Sampled };
        Ok(Object { emission: Some(emission), ..Object::new(shape, Material::Diffuse { albedo: Rgb::ONE }) })
    };
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let walls = (0..6).map(|i| {
        let [normal, x, y] = std::array::from_fn(|k| axes[(i + k) % 3]);
        wall(if i < 3 { normal } else { -normal }, x, y)
    });
    let camera = Camera {
        position: DVec3::new(0.1, 0.2, 0.3),
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Perspective { tan_half_width: 1.0, tan_half_height: 1.0 },
        filter: PixelFilter::default(),
    };
    Ok(Scene {
        name: "closed box".into(),
        camera,
        objects: walls.collect::<Result<_>>()?,
        lights: Vec::new(),
        environment: None,
    })
}

const ETA: f32 = 1.5;

/// The product of the weights of directions sampled from white diffuse, mirror and glass surfaces, alternating. Radiance
/// scales by η² on the way into the glass, and by its inverse on the way out.
fn walks(workload: &Workload, seed: u64) -> ErrorRow {
    let white = Rgb::ONE;
    let materials = [
        Material::Diffuse { albedo: white },
        Material::Mirror { reflectance: white },
        Material::Dielectric(Dielectric::clear(ETA)),
    ]
    .map(|material| material.bsdf(ScatterModel::default()));
    let mut row = ErrorRow::new("walks", STABLE, Precision::Single);
    for walk in 0..64 {
        let (mut wo, mut inside, mut throughput) = (Vec3::new(0.6, 0.0, 0.8), false, 1f32);
        for bounce in 0..workload.bounces {
            let random = Independent::new(seed, walk, bounce);
            let [u, v] = random.pair(0).map(|u| u as f32);
            let uc = random.pair(1)[0] as f32;
            let glass = bounce % 3 == 2;
            // Opaque surfaces are hit from above, glass from the side that the path is on.
            wo.z = if glass && inside { -wo.z.abs() } else { wo.z.abs() };
            let Some(sample) = materials[bounce as usize % 3].sample(wo, uc, [u, v]) else { continue };
            throughput *= sample.weight.x;
            inside ^= glass && sample.wi.z * wo.z < 0.0;
            wo = -sample.wi;
        }
        let scale = if inside { f64::from(ETA).powi(2) } else { 1.0 };
        // The condition number of a product is the number of its factors.
        row.compare(f64::from(throughput) * scale, 1.0, f64::from(workload.bounces), || {
            format!("walk {walk} of {} bounces", workload.bounces)
        });
    }
    row
}

pub const OFFSETS: Experiment = Experiment {
    name: "offsets",
    about: "offsets of leaving rays, relative to the scene; out of range: rays that hit what they leave",
    figure: "stability-geometry",
    bounds: &[
        Bound::possible("rays that hit what they leave"),
        Bound {
            name: "offset over the size of the triangle",
            limit: 1.7e-4,
            reason: "8 ε times Σ |nᵢ pᵢ|, which is at most the distance from the origin, 177 sizes",
            error: |row| Some(row.max_relative),
        },
    ],
    run: run_offsets,
};

/// The fixed offset of many textbooks.
const FIXED: f32 = 1e-4;

fn run_offsets(workload: &Workload, seed: u64) -> Result<Vec<ErrorRow>> {
    let count = (workload.side * workload.side) as u64 * 16;
    let rows = [STABLE, TEXTBOOK].into_iter().map(|variant| {
        let row = || ErrorRow::new("offsets", variant, Precision::Single);
        let found = (0..count).into_par_iter().filter_map(|i| {
            let (mesh, [u, v], around, scale) = random(seed, i)?;
            let Surface { point, normal, .. } = mesh.surface(0, u, v)?;
            let plane = Plane::through(mesh.facet(0)?.0[0], normal);
            let (point, offset) = match variant {
                STABLE => (plane.project(point), plane.offset(point)),
                _ => (point, FIXED),
            };
            let bvh = Bvh::build(&[&Shape::from(mesh)]);
            let tangent = around.cross(normal).normalize();
            // Along a random direction, the normal, and almost along the surface.
            let directions = [around, normal, (tangent + 1e-4 * normal).normalize()];
            let again = directions.into_iter().filter(|direction| {
                let origin = point + normal * offset.copysign(normal.dot(*direction));
                bvh.nearest(&Ray { origin, direction: *direction }, f32::INFINITY).is_some()
            });
            let mut row = row();
            // The error is the distance from the surface.
            let away = 1.0 + f64::from(offset / scale);
            row.compare(away, 1.0, 1.0, || format!("triangle {i} of size {scale:e}"));
            row.out_of_range += again.count() as u64;
            Some(row)
        });
        found.reduce(row, ErrorRow::merge)
    });
    Ok(rows.collect())
}

/// A triangle of a size from 10⁻⁶ to 10⁶, from plump to a sliver of one part in 10⁶, near or far from the origin; a
/// place on it, a direction, and its size.
fn random(seed: u64, i: u64) -> Option<(Mesh, [f32; 2], Vec3, f32)> {
    let component = |j: u32| (2.0 * Independent::new(seed, i, j).pair(0)[0] - 1.0) as f32;
    let vector = |j: u32| Vec3::new(component(3 * j), component(3 * j + 1), component(3 * j + 2));
    // Size, distance from the origin in sizes, and thinness, by the index.
    let scale = 10f32.powi((i % 13) as i32 - 6);
    let away = [0.0, 3.0, 100.0][i as usize / 13 % 3] * vector(0);
    let thin = [1.0, 1e-2, 1e-4, 1e-6][i as usize / 39 % 4];
    let (p, q, r) = (vector(1), vector(2), vector(3));
    let corners = [p, q, p + 0.5 * (q - p) + thin * r].map(|corner| scale * (corner + away));
    let (u, v) = (component(12).abs(), component(13).abs());
    let inside = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
    let mesh = Mesh::new(corners.to_vec(), Vec::new(), vec![[0, 1, 2]]).ok()?;
    Some((mesh, inside, vector(5).try_normalize()?, scale))
}
