//! Shapes: spheres and triangle meshes, in the world and with their outside where pbrt has it.

use super::params::Params;
use crate::error::{Error, Result};
use crate::import::mesh;
use crate::import::place::At;
use crate::import::shape::{corner_uv, simplest};
use crate::import::transform::{self, in_range, in_size_range};
use crate::scene::{Mesh, Shape, Sphere};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};
use std::path::Path;

/// The graphics state for a shape.
pub struct Setting<'a> {
    /// Object to world.
    pub to_world: &'a DMat4,
    /// Whether the orientation is reversed, with an effect on the image.
    pub reversed: bool,
    /// The folder that names of files are relative to.
    pub folder: &'a Path,
    /// How many more bytes of mesh files may be read.
    pub mesh_bytes: &'a mut u64,
}

/// Most bytes in a scene's mesh files, all together (a file counts each time it is named).
pub const MAX_MESH_BYTES: u64 = 512 << 20;

/// A shape.
pub fn shape(p: Params, mut setting: Setting, warnings: &mut Vec<String>) -> Result<Shape> {
    match p.kind.as_str() {
        "sphere" => sphere(p, &setting, warnings).map(Shape::Sphere),
        "trianglemesh" => triangle_mesh(p, &setting, warnings).map(simplest),
        "plymesh" => ply_mesh(p, &mut setting, warnings).map(simplest),
        _ => Err(p.unsupported_kind("sphere, trianglemesh, plymesh")),
    }
}

/// A whole sphere. A mirror image changes nothing.
fn sphere(mut p: Params, setting: &Setting, warnings: &mut Vec<String>) -> Result<Sphere> {
    let radius = p.float("radius", |x| x > 0.0, "positive")?.unwrap_or(1.0);
    p.only_float("zmin", |z| z <= -radius, "a whole sphere")?;
    p.only_float("zmax", |z| z >= radius, "a whole sphere")?;
    p.only_float("phimax", |phi| phi >= 360.0, "a whole sphere")?;
    let Some((_, scale)) = transform::similarity(setting.to_world) else {
        return Err(p
            .at
            .unsupported("a sphere that its transform makes an ellipsoid is not supported")
            .with_hint("scale all three axes alike"));
    };
    if setting.reversed {
        return Err(p
            .at
            .unsupported("ReverseOrientation of a sphere that emits light or is of glass is not supported"));
    }
    let (centre, radius) = (setting.to_world.w_axis.truncate(), radius * scale);
    if !in_range(centre) || !in_size_range(radius) {
        return Err(p.at.input(format!("a sphere of radius {radius} at {centre} is out of range")));
    }
    p.finish(&[], warnings)?;
    Ok(Sphere { centre: centre.as_vec3(), radius: radius as f32 })
}

/// A mesh in the scene file itself.
fn triangle_mesh(mut p: Params, setting: &Setting, warnings: &mut Vec<String>) -> Result<Mesh> {
    let (at, owner) = (p.at.clone(), p.owner.clone());
    let missing = |what: &str| at.input(format!("{owner} needs {what}"));
    let (indices_at, normals_at) = (p.place("indices"), p.place("N"));
    let positions = p.groups::<3>("P", &["point", "point3"])?.ok_or_else(|| missing("\"point3 P\""))?;
    let normals = p.groups::<3>("N", &["normal", "normal3"])?.unwrap_or_default();
    let triangles = match p.groups::<3>("indices", &["integer"])? {
        Some(indices) => indices,
        // As in pbrt-v4: one triangle needs no indices.
        None if positions.len() == 3 => vec![[0.0, 1.0, 2.0]],
        None => return Err(missing("\"integer indices\"")),
    };
    let (uv_at, mut uv) = (p.place("uv"), p.groups::<2>("uv", &["point2", "float"])?.unwrap_or_default());
    p.finish(&["st", "S", "faceIndices"], warnings)?;
    if !normals.is_empty() && normals.len() != positions.len() {
        return Err(normals_at.input(format!("{owner} has {} P, but {} N", positions.len(), normals.len())));
    }
    let is_index = |i: f64| i.fract() == 0.0 && (0.0..positions.len() as f64).contains(&i);
    if let Some(bad) = triangles.iter().flatten().find(|&&i| !is_index(i)) {
        let message = format!("vertex {bad} of {}, counted from 0, does not exist", positions.len());
        return Err(indices_at.input(format!("{owner}: {message}")));
    }
    if !uv.is_empty() && uv.len() != positions.len() {
        let message = format!("{owner} has {} P, but {} uv, which are left out", positions.len(), uv.len());
        warnings.push(uv_at.warning(&message));
        uv.clear();
    }
    let triangles: Vec<_> = triangles.into_iter().map(|triangle| triangle.map(|i| i as u32)).collect();
    let uv = corner_uv(&triangles, |i| uv.get(i as usize).map(|&[u, v]| Vec2::new(u as f32, v as f32)));
    place(&positions, &normals, triangles, uv, setting, &at)
}

/// A mesh in another file.
fn ply_mesh(mut p: Params, setting: &mut Setting, warnings: &mut Vec<String>) -> Result<Mesh> {
    let at = p.place("filename");
    let name = p.text("filename")?.ok_or_else(|| at.input(format!("{} needs a \"string filename\"", p.owner)))?;
    p.finish(&[], warnings)?;
    let path = setting.folder.join(name);
    let size = std::fs::metadata(&path).map_or(0, |file| file.len());
    *setting.mesh_bytes = setting.mesh_bytes.checked_sub(size).ok_or_else(|| {
        Error::limit(&path, format!("with this, the scene's mesh files exceed {} MiB", MAX_MESH_BYTES >> 20))
    })?;
    let mesh = mesh::read(&path, warnings).map_err(|e| match e {
        Error::Io { source, .. } => at.input(format!("cannot read {}: {source}", path.display())),
        other => other,
    })?;
    let numbers = |vectors: &[Vec3]| vectors.iter().map(|v| v.as_dvec3().to_array()).collect::<Vec<_>>();
    place(&numbers(&mesh.positions), &numbers(&mesh.normals), mesh.triangles, mesh.uv, setting, &at)
}

/// Transforms a mesh to the world. Its outside is where its normals point; without normals, where its corners run
/// counter-clockwise before the transform. `ReverseOrientation` exchanges outside and inside.
fn place(
    positions: &[[f64; 3]],
    normals: &[[f64; 3]],
    mut triangles: Vec<[u32; 3]>,
    mut uv: Vec<[Vec2; 3]>,
    setting: &Setting,
    at: &At,
) -> Result<Mesh> {
    let point = |&p: &[f64; 3]| {
        let p = setting.to_world.transform_point3(DVec3::from_array(p));
        in_range(p).then(|| p.as_vec3()).ok_or_else(|| at.input(format!("a vertex at {p} is out of range")))
    };
    // Normals transform by the inverse transpose.
    let linear = DMat3::from_mat4(*setting.to_world);
    let (across, side) = (linear.inverse().transpose(), if setting.reversed { -1.0 } else { 1.0 });
    let normal = |&n: &[f64; 3]| {
        let n = (across * DVec3::from_array(n)).try_normalize();
        n.map(|n| (side * n).as_vec3()).ok_or_else(|| at.input("a normal has no direction"))
    };
    let positions: Vec<Vec3> = positions.iter().map(point).collect::<Result<_>>()?;
    let normals: Vec<Vec3> = normals.iter().map(normal).collect::<Result<_>>()?;
    // Orient each triangle by its normals, or by the handedness of the transform.
    let mirrored = linear.determinant() < 0.0;
    for (i, triangle) in triangles.iter_mut().enumerate() {
        let inside_out = if normals.is_empty() {
            setting.reversed != mirrored
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
