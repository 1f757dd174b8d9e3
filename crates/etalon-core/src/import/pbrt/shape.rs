//! Shapes: spheres and triangle meshes, in the world and with their outside where pbrt has it.

use super::flat::{Flat, disk, parallelograms};
use super::params::Params;
use super::reader::{LEAST_BYTES, MAX_MESH_BYTES, Reader};
use crate::error::{Error, Result};
use crate::import::mesh;
use crate::import::number::POSITIVE;
use crate::import::place::At;
use crate::import::shape::{corner_uv, simplest, sphere};
use crate::import::transform::{directions, in_range};
use crate::memory;
use crate::scene::{Mesh, Object, Shape, Sphere};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3};

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
