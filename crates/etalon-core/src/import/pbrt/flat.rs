//! Flat shapes as triangles: disks and planar patches.

use super::params::Params;
use crate::error::Result;
use crate::import::number::{ANY, POSITIVE};
use crate::memory;
use glam::{DVec3, Vec2};
use std::f64::consts::TAU;

/// Corners of a disk's polygon.
///
/// The polygon of N corners and the disk's area has a circumradius of r √((2π/N) / sin(2π/N)) ≈ r (1 + (2π/N)²/12): its
/// outline is within 2·10⁻⁴ r of the circle for N = 128, a tenth of a pixel where the disk is 1000 pixels wide.
const DISK_CORNERS: u32 = 128;

/// Triangles in the object's coordinates, each corner with its texture coordinates.
#[derive(Default)]
pub struct Flat {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub uv: Vec<[Vec2; 3]>,
}

/// `disk`: at z = `height`, its front towards +z; u runs around it and v from the rim to the centre.
pub fn disk(p: &Params, warnings: &mut Vec<String>) -> Result<Flat> {
    let radius = p.float("radius", &POSITIVE)?.unwrap_or(1.0);
    let height = p.float("height", &ANY)?.unwrap_or(0.0);
    p.only_float("innerradius", |r| r == 0.0, "0 (a whole disk)")?;
    p.only_float("phimax", |phi| phi >= 360.0, "a whole disk")?;
    let angle = TAU / f64::from(DISK_CORNERS);
    let outer = radius * (angle / angle.sin()).sqrt();
    // The centre is the last vertex.
    let rim = (0..DISK_CORNERS).map(|i| (f64::from(i) * angle).sin_cos());
    let mut positions: Vec<[f64; 3]> = rim.map(|(sin, cos)| [outer * cos, outer * sin, height]).collect();
    positions.push([0.0, 0.0, height]);
    let triangles = (0..DISK_CORNERS).map(|i| [i, (i + 1) % DISK_CORNERS, DISK_CORNERS]).collect();
    let u = |i: f32| i / DISK_CORNERS as f32;
    let corners = |i: f32| [Vec2::new(u(i), 0.0), Vec2::new(u(i + 1.0), 0.0), Vec2::new(u(i + 0.5), 1.0)];
    let uv = (0..DISK_CORNERS).map(|i| corners(i as f32)).collect();
    warnings.push(p.at.warning(&format!("{}: a polygon of {DISK_CORNERS} corners and the same area", p.owner)));
    Ok(Flat { positions, triangles, uv })
}

/// `bilinearmesh`, whose patches must be parallelograms: two triangles of each.
pub fn parallelograms(p: &Params) -> Result<Flat> {
    let missing = |what: &str| p.at.input(format!("{} needs {what}", p.owner));
    let positions = p.groups::<3>("P", &["point", "point3"])?.ok_or_else(|| missing("\"point3 P\""))?;
    let patches = match p.groups::<4>("indices", &["integer"])? {
        Some(indices) => indices,
        None if positions.len() == 4 => &[[0.0, 1.0, 2.0, 3.0]],
        None => return Err(missing("\"integer indices\"")),
    };
    let uv = p.groups::<2>("uv", &["point2", "float"])?;
    if let Some(uv) = uv.filter(|uv| uv.len() != positions.len()) {
        return Err(p.place("uv").input(format!("{} has {} P, but {} uv", p.owner, positions.len(), uv.len())));
    }
    let mut flat = Flat::default();
    let bytes = size_of_val(positions) + patches.len() * 2 * (size_of::<[u32; 3]>() + size_of::<[Vec2; 3]>());
    memory::grow(bytes, || p.at.to_string())?;
    for patch in patches {
        let is_vertex = |i: f64| i.fract() == 0.0 && (0.0..positions.len() as f64).contains(&i);
        if let Some(bad) = patch.iter().find(|&&i| !is_vertex(i)) {
            let message = format!("vertex {bad} of {}, counted from 0, does not exist", positions.len());
            return Err(p.place("indices").input(format!("{}: {message}", p.owner)));
        }
        // pbrt's order is (0, 0), (1, 0), (0, 1), (1, 1) in u and v.
        let [a, b, c, d] = patch.map(|i| i as u32);
        let [pa, pb, pc, pd] = [a, b, c, d].map(|i| DVec3::from_array(positions[i as usize]));
        let size = (pb - pa).length().max((pc - pa).length());
        let gap = (pb - pa + pc - pd).length();
        if gap.is_nan() || gap > 1e-4 * size {
            return Err(p
                .place("P")
                .unsupported(format!("{}: a patch that is no parallelogram is not supported", p.owner))
                .with_hint("write it as a trianglemesh"));
        }
        flat.triangles.extend([[a, b, d], [a, d, c]]);
        let [ua, ub, uc, ud] = match uv {
            Some(uv) => [a, b, c, d].map(|i| Vec2::from_array(uv[i as usize].map(|x| x as f32))),
            None => [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE],
        };
        flat.uv.extend([[ua, ub, ud], [ua, ud, uc]]);
    }
    flat.positions = positions.to_vec();
    Ok(flat)
}
