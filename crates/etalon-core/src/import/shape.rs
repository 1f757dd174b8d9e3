//! Spheres in the world; vertices of meshes; triangles as the shape that is traced fastest: two that form a rectangle become one.

use super::place::At;
use super::transform::{in_range, in_size_range, similarity};
use crate::error::Result;
use crate::scene::{Mesh, Rectangle, Shape, Sphere};
use glam::{DMat4, DVec3, Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

/// Largest distance between a vertex normal and the plane's normal, both unit vectors, for a flat shape.
const FLAT: f32 = 1e-4;

/// The sphere around the origin, in the world. A mirror image changes nothing.
pub fn sphere(radius: f64, to_world: &DMat4, at: impl Fn() -> At) -> Result<Sphere> {
    let Some((_, scale)) = similarity(to_world) else {
        return Err(at()
            .unsupported("a sphere that its transform makes an ellipsoid is not supported")
            .with_hint("scale all three axes alike"));
    };
    let (centre, radius) = (to_world.w_axis.truncate(), radius * scale);
    if !in_range(centre) || !in_size_range(radius) {
        return Err(at().input(format!("a sphere of radius {radius} at {centre} is out of range")));
    }
    Ok(Sphere { centre: centre.as_vec3(), radius: radius as f32 })
}

/// A point in single precision; `None` when it is not finite or too far away to render.
pub fn point(coordinates: [f64; 3]) -> Option<Vec3> {
    let point = DVec3::from_array(coordinates);
    in_range(point).then(|| point.as_vec3())
}

/// Normals of unit length; none, with a warning, when one of them has no direction.
pub fn unit_normals(path: &Path, normals: &[[f64; 3]], warnings: &mut Vec<String>) -> Vec<Vec3> {
    let unit: Option<Vec<Vec3>> =
        normals.iter().map(|&n| Some(DVec3::from_array(n).try_normalize()?.as_vec3())).collect();
    unit.unwrap_or_else(|| {
        warnings.push(format!("{}: a normal has no direction: all normals are left out", path.display()));
        Vec::new()
    })
}

/// The triangles of a polygon: a fan around its first corner.
pub fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}

/// Texture coordinates of the corners of triangles, from those of the vertices; none unless all corners have finite ones.
pub fn corner_uv<T>(triangles: &[[T; 3]], of_vertex: impl Fn(T) -> Option<Vec2>) -> Vec<[Vec2; 3]>
where
    T: Copy,
{
    let corner = |vertex: T| of_vertex(vertex).filter(|uv| uv.is_finite());
    triangles
        .iter()
        .map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]))
        .collect::<Option<_>>()
        .unwrap_or_default()
}

/// The mesh, or the rectangle that it forms: two triangles of the same orientation with a common edge, whose vertex
/// normals are those of the plane. The rectangle's front is where its corners run counter-clockwise.
pub fn simplest(mesh: Mesh) -> Shape {
    match rectangle(&mesh) {
        Some(rectangle) => Shape::Rectangle(rectangle),
        None => Shape::Mesh(Arc::new(mesh)),
    }
}

fn rectangle(mesh: &Mesh) -> Option<Rectangle> {
    let &[one, two] = mesh.triangles.as_slice() else { return None };
    let [one, two] = [one, two].map(|triangle| triangle.map(|i| mesh.positions[i as usize]));
    // The common side runs from p to q in the first triangle and back in the second.
    let turns = |[a, b, c]: [Vec3; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let (p, q, r, s) = turns(one).into_iter().find_map(|[p, q, r]| {
        turns(two).into_iter().find(|[a, b, _]| (*a, *b) == (q, p)).map(|[_, _, s]| (p, q, r, s))
    })?;
    let rectangle = Rectangle::from_corners([p, s, q, r])?;
    let flat = |&i: &u32| mesh.normals.get(i as usize).is_none_or(|n| n.distance(rectangle.normal()) <= FLAT);
    mesh.triangles.iter().flatten().all(flat).then_some(rectangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];

    fn shape(positions: &[Vec3], triangles: &[[u32; 3]], normals: &[Vec3]) -> Option<Rectangle> {
        let (positions, normals, triangles) = (positions.into(), normals.into(), triangles.into());
        let mesh = Mesh { positions, normals, triangles, ..Mesh::default() };
        match simplest(mesh) {
            Shape::Rectangle(rectangle) => Some(rectangle),
            _ => None,
        }
    }

    #[test]
    fn fans_keep_the_winding() {
        assert_eq!(fan(&[7, 8, 9, 4]).collect::<Vec<_>>(), [[7, 8, 9], [7, 9, 4]]);
        assert_eq!(fan(&[1, 2]).count(), 0);
    }

    #[test]
    fn two_triangles_are_a_rectangle_however_they_are_written() {
        for one in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            for two in [[0, 2, 3], [2, 3, 0], [3, 0, 2]] {
                for triangles in [[one, two], [two, one]] {
                    let r = shape(&SQUARE, &triangles, &[]).unwrap();
                    assert_eq!((r.centre(), r.normal(), r.area()), (Vec3::new(0.5, 1.0, 0.0), Vec3::Z, 2.0));
                }
            }
        }
        let back = shape(&SQUARE, &[[0, 2, 1], [0, 3, 2]], &[]).unwrap();
        assert_eq!(back.normal(), Vec3::NEG_Z);
        // Corners that are written twice.
        let six = [0, 1, 2, 0, 2, 3].map(|i: usize| SQUARE[i]);
        assert!(shape(&six, &[[0, 1, 2], [3, 4, 5]], &[]).is_some());
        assert!(shape(&SQUARE, &[[0, 1, 2], [0, 2, 3]], &[Vec3::Z; 4]).is_some());
    }

    #[test]
    fn anything_else_stays_a_mesh() {
        let whole = [[0, 1, 2], [0, 2, 3]];
        assert!(shape(&SQUARE, &[[0, 1, 2], [0, 3, 2]], &[]).is_none(), "wound both ways");
        assert!(shape(&SQUARE, &whole[..1], &[]).is_none(), "one triangle");
        assert!(shape(&SQUARE, &[whole[0], whole[0]], &[]).is_none(), "the same triangle twice");
        assert!(shape(&SQUARE, &whole, &[Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Z]).is_none(), "shaded as if bent");
        let mut bent = SQUARE;
        bent[3].z = 1.0;
        assert!(shape(&bent, &whole, &[]).is_none());
        let mut kite = SQUARE;
        kite[2].y = 3.0;
        assert!(shape(&kite, &whole, &[]).is_none());
        assert!(shape(&[Vec3::ZERO; 4], &whole, &[]).is_none());
    }
}
