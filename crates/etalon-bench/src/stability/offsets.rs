//! Offsets of ray origins: rays that leave a triangle must not hit it again, at any scale.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Workload};
use etalon_core::error::Result;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{Bvh, Mesh, Plane, Ray, Shape, Surface};
use glam::Vec3;
use rayon::prelude::*;

pub const EXPERIMENT: Experiment = Experiment {
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
    run,
};

/// The fixed offset of many textbooks.
const FIXED: f32 = 1e-4;

fn run(workload: &Workload, seed: u64) -> Result<Vec<ErrorRow>> {
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
