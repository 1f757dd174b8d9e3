//! Shapes: spheres and triangle meshes, in the world and with their outside where pbrt has it; flat shapes, disks and planar
//! patches, as triangles.

use super::super::mesh;
use super::super::place::{ANY, At, POSITIVE};
use super::super::shape::{corner_uv, simplest, sphere};
use super::super::transform::{directions, in_range};
use super::params::Params;
use super::reader::{LEAST_BYTES, MAX_MESH_BYTES, Reader};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::{Mesh, Object, Shape, Sphere};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// How a shape is placed.
#[derive(Clone, Copy)]
struct Setting<'a> {
    to_world: &'a DMat4,
    /// Whether the orientation is reversed with an effect on the image.
    reversed: bool,
    /// Whether triangles need texture coordinates.
    needs_uv: bool,
}

impl Reader<'_> {
    pub(super) fn shape(&mut self, p: &Params) -> Result<()> {
        let (material, emission, to_world) = (self.state.material.clone(), self.state.emission, self.state.transform);
        // Only emission and glass depend on the orientation.
        let depends = emission.is_some() || material.is_transmitting();
        let anisotropic = material.is_anisotropic();
        let needs_uv = anisotropic || material.is_textured();
        let setting = Setting { to_world: &to_world, reversed: self.state.reversed && depends, needs_uv };
        let shape = match p.kind.as_str() {
            "sphere" => Shape::Sphere(whole_sphere(p, setting)?),
            "trianglemesh" => triangles(triangle_mesh(p, setting, &mut self.warnings)?, setting),
            "plymesh" => triangles(self.ply_mesh(p, setting)?, setting),
            "disk" => triangles(placed(disk(p, &mut self.warnings)?, setting, &p.at)?, setting),
            "bilinearmesh" => triangles(placed(parallelograms(p)?, setting, &p.at)?, setting),
            _ => return Err(p.unsupported_kind("sphere, disk, trianglemesh, bilinearmesh (parallelograms), plymesh")),
        };
        if anisotropic && p.groups::<3>("S", &["vector", "vector3"])?.is_some() {
            return Err(p
                .place("S")
                .unsupported(format!("{}: tangents are those of the texture coordinates", p.owner)));
        }
        p.finish(if p.kind == "trianglemesh" { &["S", "faceIndices"] } else { &[] }, &mut self.warnings)?;
        let [x, y, axis] = directions(&to_world);
        let object = Object { emission, axis, meridians: [x, y], ..Object::new(shape, material) };
        memory::push(&mut self.objects, object, || p.at.to_string())
    }

    /// A mesh in another file.
    fn ply_mesh(&mut self, p: &Params, setting: Setting) -> Result<Mesh> {
        let at = p.place("filename");
        let name = p.text("filename")?.ok_or_else(|| at.input(format!("{} needs a \"string filename\"", p.owner)))?;
        let path = self.folder.join(name);
        let size = std::fs::metadata(&path).map_or(0, |file| file.len()).max(LEAST_BYTES);
        self.mesh_bytes = self.mesh_bytes.checked_sub(size).ok_or_else(|| {
            Error::limit(&path, format!("with this, the scene's mesh files exceed {} MiB", MAX_MESH_BYTES >> 20))
        })?;
        let mesh = mesh::read(&path, &mut self.warnings).map_err(|e| at.cannot_read(e))?;
        let [positions, normals] = [&mesh.positions, &mesh.normals].map(|vectors| vectors.iter().map(|v| v.as_dvec3()));
        place(positions, normals, mesh.triangles, mesh.uv, setting, at)
    }
}

/// The simplest shape of the triangles. Those of a surface that is anisotropic or has textures stay a mesh, which has
/// texture coordinates.
fn triangles(mesh: Mesh, setting: Setting) -> Shape {
    if setting.needs_uv { mesh.into() } else { simplest(mesh) }
}

/// A whole sphere. A mirror image changes nothing.
fn whole_sphere(p: &Params, setting: Setting) -> Result<Sphere> {
    let radius = p.float("radius", &POSITIVE)?.unwrap_or(1.0);
    p.only_float("zmin", |z| z <= -radius, "a whole sphere")?;
    p.only_float("zmax", |z| z >= radius, "a whole sphere")?;
    p.only_float("phimax", |phi| phi >= 360.0, "a whole sphere")?;
    if setting.reversed {
        let message = "ReverseOrientation of a sphere that emits light or is of glass is not supported";
        return Err(p.at.unsupported(message));
    }
    sphere(radius, setting.to_world, || p.at.clone())
}

/// A mesh in the scene file itself.
fn triangle_mesh(p: &Params, setting: Setting, warnings: &mut Vec<String>) -> Result<Mesh> {
    let owner = &p.owner;
    let missing = |what: &str| p.at.input(format!("{owner} needs {what}"));
    let positions = p.groups::<3>("P", &["point", "point3"])?.ok_or_else(|| missing("\"point3 P\""))?;
    let normals = p.groups::<3>("N", &["normal", "normal3"])?.unwrap_or_default();
    let triangles = match p.groups::<3>("indices", &["integer"])? {
        Some(indices) => indices,
        // As in pbrt-v4: one triangle needs no indices.
        None if positions.len() == 3 => &[[0.0, 1.0, 2.0]],
        None => return Err(missing("\"integer indices\"")),
    };
    let mut uv = p.groups::<2>("uv", &["point2", "float"])?;
    // The older name.
    if uv.is_none() {
        uv = p.groups::<2>("st", &["point2", "float"])?;
    }
    let mut uv = uv.unwrap_or_default();
    if !normals.is_empty() && normals.len() != positions.len() {
        return Err(p.place("N").input(format!("{owner} has {} P, but {} N", positions.len(), normals.len())));
    }
    let is_index = |i: f64| i.fract() == 0.0 && (0.0..positions.len() as f64).contains(&i);
    if let Some(bad) = triangles.iter().flatten().find(|&&i| !is_index(i)) {
        let message = format!("vertex {bad} of {}, counted from 0, does not exist", positions.len());
        return Err(p.place("indices").input(format!("{owner}: {message}")));
    }
    if !uv.is_empty() && uv.len() != positions.len() {
        let message = format!("{owner} has {} P, but {} uv, which are left out", positions.len(), uv.len());
        warnings.push(p.place("uv").warning(&message));
        uv = &[];
    }
    memory::grow(triangles.len() * (size_of::<[u32; 3]>() + size_of::<[Vec2; 3]>()), || p.at.to_string())?;
    let triangles: Vec<_> = triangles.iter().map(|triangle| triangle.map(|i| i as u32)).collect();
    let uv = corner_uv(&triangles, |i| uv.get(i as usize).map(|&[u, v]| Vec2::new(u as f32, v as f32)));
    place(vectors(positions), vectors(normals), triangles, uv, setting, &p.at)
}

fn placed(flat: Flat, setting: Setting, at: &At) -> Result<Mesh> {
    place(vectors(&flat.positions), vectors(&[]), flat.triangles, flat.uv, setting, at)
}

fn vectors(numbers: &[[f64; 3]]) -> impl ExactSizeIterator<Item = DVec3> {
    numbers.iter().map(|&v| DVec3::from_array(v))
}

/// Transforms a mesh to the world. Its outside is where its normals point; without normals, where its corners run
/// counter-clockwise before the transform. `ReverseOrientation` exchanges outside and inside.
fn place(
    positions: impl ExactSizeIterator<Item = DVec3>,
    normals: impl ExactSizeIterator<Item = DVec3>,
    mut triangles: Vec<[u32; 3]>,
    mut uv: Vec<[Vec2; 3]>,
    Setting { to_world, reversed, needs_uv }: Setting,
    at: &At,
) -> Result<Mesh> {
    let default_uv = if needs_uv && uv.is_empty() { triangles.len() } else { 0 };
    let bytes = (positions.len() + normals.len()) * size_of::<Vec3>() + default_uv * size_of::<[Vec2; 3]>();
    memory::grow(bytes, || at.to_string())?;
    if default_uv > 0 {
        uv = vec![Mesh::DEFAULT_UV; triangles.len()];
    }
    let point = |p: DVec3| {
        let p = to_world.transform_point3(p);
        in_range(p).then(|| p.as_vec3()).ok_or_else(|| at.input(format!("a vertex at {p} is out of range")))
    };
    // Normals transform by the inverse transpose.
    let linear = DMat3::from_mat4(*to_world);
    let (across, side) = (linear.inverse().transpose(), if reversed { -1.0 } else { 1.0 });
    let normal = |n: DVec3| {
        let n = (across * n).try_normalize();
        n.map(|n| (side * n).as_vec3()).ok_or_else(|| at.input("a normal has no direction"))
    };
    let positions: Vec<Vec3> = positions.map(point).collect::<Result<_>>()?;
    let normals: Vec<Vec3> = normals.map(normal).collect::<Result<_>>()?;
    // Orient each triangle by its normals, or by the handedness of the transform.
    let mirrored = linear.determinant() < 0.0;
    for (i, triangle) in triangles.iter_mut().enumerate() {
        let inside_out = if normals.is_empty() {
            reversed != mirrored
        } else {
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            let outwards: Vec3 = triangle.iter().map(|&i| normals[i as usize]).sum();
            (b - a).cross(c - a).dot(outwards) < 0.0
        };
        if inside_out {
            triangle.swap(1, 2);
            if let Some(corners) = uv.get_mut(i) {
                corners.swap(1, 2);
            }
        }
    }
    Ok(Mesh { positions, normals, triangles, uv })
}

/// Corners of a disk's polygon.
///
/// The polygon of N corners and the disk's area has a circumradius of r √((2π/N) / sin(2π/N)) ≈ r (1 + (2π/N)²/12): its
/// outline is within 2·10⁻⁴ r of the circle for N = 128, a tenth of a pixel where the disk is 1000 pixels wide.
const DISK_CORNERS: u32 = 128;

/// Triangles in the object's coordinates, each corner with its texture coordinates.
#[derive(Default)]
struct Flat {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub uv: Vec<[Vec2; 3]>,
}

/// `disk`: at z = `height`, its front towards +z; u runs around it and v from the rim to the centre.
fn disk(p: &Params, warnings: &mut Vec<String>) -> Result<Flat> {
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
fn parallelograms(p: &Params) -> Result<Flat> {
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
