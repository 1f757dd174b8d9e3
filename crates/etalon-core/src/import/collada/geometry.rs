//! Geometry: the course's spheres, and polygons to triangles in the world.

use super::super::place::POSITIVE;
use super::document::{Document, Element, course_profile, elements, find, is};
use crate::error::Result;
use crate::import::shape::{fan, simplest, sphere};
use crate::import::transform::in_range;
use crate::memory;
use crate::scene::{Mesh, Shape};
use glam::{DMat4, DVec3, Vec3};
use std::sync::Arc;

/// Most vertices and triangles in a scene, each counted as often as it is instanced.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// The shape of a `<geometry>` element in a node. `budget` is the number of vertices and triangles that the scene may still have.
pub fn shape<'a>(document: &Document<'a>, node: Element<'a>, to_world: &DMat4, budget: &mut usize) -> Result<Shape> {
    if let Some(node) = course_profile(node).and_then(|profile| find(profile, "sphere")) {
        let [radius] = document.exactly(document.require(node, "radius")?, &POSITIVE)?;
        return sphere(radius, to_world, || document.at(node)).map(Shape::Sphere);
    }
    let mesh = mesh(document, document.require(node, "mesh")?, to_world)?;
    *budget = budget.checked_sub(mesh.positions.len() + mesh.triangles.len()).ok_or_else(|| {
        crate::Error::limit(document.path(), format!("more than {MAX_TRIANGLES} vertices and triangles"))
    })?;
    // Its normals.
    memory::grow(size_of_val(&mesh.positions[..]), || document.path().display().to_string())?;
    // Only what bends is shaded as bent: a rectangle's normals are those of its plane.
    Ok(match simplest(mesh) {
        Shape::Mesh(mut mesh) => {
            Arc::make_mut(&mut mesh).smooth();
            Shape::Mesh(mesh)
        }
        flat => flat,
    })
}

/// The first polygons of a mesh. Their normals and texture coordinates are not read: the course's renderer makes its
/// own normals.
fn mesh<'a>(document: &Document<'a>, node: Element<'a>, to_world: &DMat4) -> Result<Mesh> {
    let faces = find(node, "polylist").or_else(|| find(node, "triangles")).ok_or_else(|| {
        document.at(node).unsupported("a mesh without <polylist> or <triangles>").with_hint("triangulate it on export")
    })?;
    let others = ["polylist", "triangles", "polygons", "trifans", "tristrips", "lines", "linestrips"];
    for other in elements(node).filter(|other| *other != faces && others.iter().any(|name| is(*other, name))) {
        document.warn(other, &format!("<{}>: only a mesh's first polygons are read", other.tag_name().name()));
    }
    let input = |semantic: &str| elements(faces).find(|i| is(*i, "input") && i.attribute("semantic") == Some(semantic));
    let vertex = input("VERTEX").ok_or_else(|| document.at(faces).input("no <input> with the semantic VERTEX"))?;
    let positions = positions(document, document.follow(vertex, "source", "vertices")?, to_world)?;
    let triangles = triangles(document, faces, vertex, positions.len())?;
    Ok(Mesh { positions, triangles, ..Mesh::default() })
}

/// The positions that a `<vertices>` element names, in the world.
fn positions<'a>(document: &Document<'a>, vertices: Element<'a>, to_world: &DMat4) -> Result<Vec<Vec3>> {
    let input = elements(vertices).find(|i| is(*i, "input") && i.attribute("semantic") == Some("POSITION"));
    let input = input.ok_or_else(|| document.at(vertices).input("no <input> with the semantic POSITION"))?;
    let source = document.follow(input, "source", "source")?;
    let array = document.require(source, "float_array")?;
    if let Some(accessor) = find(source, "technique_common/accessor")
        && (accessor.attribute("stride").is_some_and(|stride| stride != "3")
            || accessor.attribute("offset").is_some_and(|offset| offset != "0"))
    {
        return Err(document.at(accessor).unsupported("positions must be 3 numbers each, from the first on"));
    }
    let numbers = document.numbers(array)?;
    check_count(document, array, numbers.len(), "numbers")?;
    let (points, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(document.at(array).input(format!("{} numbers are no points of 3 each", numbers.len())));
    }
    let place = |&point: &[f64; 3]| {
        let point = to_world.transform_point3(DVec3::from_array(point));
        let message = || document.at(array).input(format!("a point at {point} is out of range"));
        in_range(point).then(|| point.as_vec3()).ok_or_else(message)
    };
    memory::grow(size_of_val(points) / 2, || document.path().display().to_string())?;
    points.iter().map(place).collect()
}

/// The polygons of a `<polylist>` or `<triangles>`, cut into fans; `vertex` is its input that names the positions.
fn triangles<'a>(
    document: &Document<'a>,
    faces: Element<'a>,
    vertex: Element<'a>,
    points: usize,
) -> Result<Vec<[u32; 3]>> {
    let list = document.require(faces, "p")?;
    let numbers = document.indices(list)?;
    let sizes = if is(faces, "polylist") { Some(document.require(faces, "vcount")?) } else { None };
    let (stride, offset) = layout(document, faces, vertex)?;
    let sizes = match sizes {
        Some(node) => {
            let sizes = document.indices(node)?;
            if let Some(bad) = sizes.iter().find(|&&size| size < 3) {
                return Err(document.at(node).input(format!("a face of {bad} corners")));
            }
            sizes
        }
        None => memory::filled(numbers.len() / (3 * stride), 3, || document.path().display().to_string())?,
    };
    check_count(document, faces, sizes.len(), "faces")?;
    let corners = sizes.iter().try_fold(0usize, |sum, &size| sum.checked_add(size as usize));
    if corners.and_then(|corners| corners.checked_mul(stride)) != Some(numbers.len()) {
        let message = format!("<p> has {} numbers, which are not {stride} for each corner of its faces", numbers.len());
        return Err(document.at(list).input(message));
    }
    // The corners, and fewer triangles than these.
    memory::grow(sizes.iter().map(|&size| 16 * size as usize).sum(), || document.path().display().to_string())?;
    let corners: Vec<u32> = numbers.iter().skip(offset).step_by(stride).copied().collect();
    if let Some(bad) = corners.iter().find(|&&corner| corner as usize >= points) {
        return Err(document.at(list).input(format!("vertex {bad} of {points}, counted from 0, does not exist")));
    }
    let mut rest = corners.as_slice();
    let mut triangles = Vec::with_capacity(corners.len() - 2 * sizes.len());
    for size in sizes {
        let (face, next) = rest.split_at(size as usize);
        triangles.extend(fan(face));
        rest = next;
    }
    Ok(triangles)
}

/// How many numbers each corner has, and which of them is its vertex: as far as the inputs' largest offset.
fn layout<'a>(document: &Document<'a>, faces: Element<'a>, vertex: Element<'a>) -> Result<(usize, usize)> {
    let offset = |input: Element<'a>| {
        let offset = input.attribute("offset").and_then(|text| text.parse().ok()).filter(|&offset: &usize| offset < 64);
        offset.ok_or_else(|| document.at(input).input("<input> needs an offset, a whole number from 0 to 63"))
    };
    let mut stride = 0;
    for input in elements(faces).filter(|child| is(*child, "input")) {
        stride = stride.max(offset(input)? + 1);
    }
    Ok((stride, offset(vertex)?))
}

/// Checks the `count` that an element claims, if it does.
fn check_count<'a>(document: &Document<'a>, node: Element<'a>, found: usize, what: &str) -> Result<()> {
    match node.attribute("count") {
        Some(count) if count.trim().parse() != Ok(found) => {
            Err(document.at(node).input(format!("count=\"{count}\", but there are {found} {what}")))
        }
        _ => Ok(()),
    }
}
