//! Triangle meshes.

use crate::error::{Error, Result};
use glam::{DVec3, Vec2, Vec3};

/// A triangle mesh in the world. The corners of a triangle are counter-clockwise from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    /// Unit normals per vertex, interpolated for shading; empty for flat triangles.
    pub normals: Vec<Vec3>,
    /// Vertex numbers, all below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates (u, v) of the corners of each triangle; empty without. Corners, not vertices, have them: a
    /// seam of the texture splits no vertex, so that it does not show in [`smooth`](Self::smooth) normals.
    pub uv: Vec<[Vec2; 3]>,
}

/// A point on a triangle of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// In the world.
    pub point: Vec3,
    /// Unit normal of the triangle, to the side from which it is counter-clockwise.
    pub normal: Vec3,
    /// Unit normal interpolated from the vertices; that of the triangle where there are none.
    pub shading: Vec3,
}

impl Surface {
    /// The point of a triangle with the barycentric weights 1 − u − v, u, v.
    #[inline]
    pub(super) fn on(corners: [Vec3; 3], normal: Vec3, corner_normals: [Vec3; 3], [u, v]: [f32; 2]) -> Self {
        // In f64, so that only the result is rounded.
        let [a, b, c] = in_f64(corners);
        let point = (a + f64::from(u) * (b - a) + f64::from(v) * (c - a)).as_vec3();
        let [na, nb, nc] = corner_normals;
        let shading = na * (1.0 - u - v) + nb * u + nc * v;
        Self { point, normal, shading: shading.try_normalize().unwrap_or(normal) }
    }
}

impl Mesh {
    /// Largest coordinate, of either sign: sums of products of two coordinates stay finite by far.
    pub const FARTHEST: f32 = 1e15;

    /// The texture coordinates of a triangle without any.
    pub const DEFAULT_UV: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::ONE];

    /// A mesh as described at the fields.
    ///
    /// # Errors
    /// As [`validate`](Self::validate).
    pub fn new(positions: Vec<Vec3>, normals: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let mesh = Self { positions, normals, triangles, uv: Vec::new() };
        mesh.validate()?;
        Ok(mesh)
    }

    /// Checks the invariants of the fields.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a position that is not finite or beyond ±[`FARTHEST`](Self::FARTHEST), a triangle with
    /// a vertex that does not exist, normals in another number than positions or not of unit length (to 10⁻³), texture
    /// coordinates for another number of triangles or not finite.
    pub fn validate(&self) -> Result<()> {
        let refuse = |message: String| Err(Error::parameter("mesh", message));
        if let Some(i) = self.positions.iter().position(|p| !usable(*p)) {
            let hint = format!("coordinates must be within ±{:e}", Self::FARTHEST);
            return refuse(format!("vertex {i} is at {}", self.positions[i])).map_err(|e| e.with_hint(hint));
        }
        if !self.normals.is_empty() && self.normals.len() != self.positions.len() {
            return refuse(format!("{} normals for {} vertices", self.normals.len(), self.positions.len()));
        }
        // Also for NaN.
        if let Some(i) = self.normals.iter().position(|n| !(0.999..=1.001).contains(&n.length())) {
            return refuse(format!("normal {i}, {}, is not of unit length", self.normals[i]));
        }
        let count = self.positions.len();
        if let Some(i) = self.triangles.iter().position(|t| t.iter().any(|&i| i as usize >= count)) {
            return refuse(format!("triangle {i} has the vertices {:?}, but there are {count}", self.triangles[i]));
        }
        if !self.uv.is_empty() && self.uv.len() != self.triangles.len() {
            return refuse(format!("texture coordinates of {} triangles for {}", self.uv.len(), self.triangles.len()));
        }
        if let Some(i) = self.uv.iter().position(|corners| corners.iter().any(|uv| !uv.is_finite())) {
            return refuse(format!("triangle {i} has the texture coordinates {:?}", self.uv[i]));
        }
        Ok(())
    }

    /// Corners and unit normal of a triangle; `None` when a corner does not exist, is not where
    /// [`validate`](Self::validate) allows, or all are on a line.
    #[inline]
    pub fn facet(&self, triangle: u32) -> Option<([Vec3; 3], Vec3)> {
        let [a, b, c] = *self.triangles.get(triangle as usize)?;
        let at = |i: u32| self.positions.get(i as usize).copied();
        let corners = [at(a)?, at(b)?, at(c)?];
        Some((corners, normal_of(corners)?))
    }

    /// The normals for shading at the corners of a triangle whose own normal is given.
    #[inline]
    pub(super) fn corner_normals(&self, triangle: u32, normal: Vec3) -> [Vec3; 3] {
        let [a, b, c] = self.triangles.get(triangle as usize).copied().unwrap_or_default();
        let at = |i: u32| self.normals.get(i as usize).copied().unwrap_or(normal);
        [at(a), at(b), at(c)]
    }

    /// The point of `triangle` with the barycentric weights 1 − u − v, u, v; `None` where there is no
    /// [`facet`](Self::facet).
    #[inline]
    pub fn surface(&self, triangle: u32, u: f32, v: f32) -> Option<Surface> {
        let (corners, normal) = self.facet(triangle)?;
        Some(Surface::on(corners, normal, self.corner_normals(triangle, normal), [u, v]))
    }

    /// The unit tangent ∂p/∂u of a triangle: in its plane, towards greater u. `None` without texture coordinates, where
    /// they do not map the triangle one to one, and where there is no [`facet`](Self::facet): any direction
    /// perpendicular to the normal will do then.
    ///
    /// Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 6.5.4.
    pub fn tangent(&self, triangle: u32) -> Option<Vec3> {
        let ([a, b, c], _) = self.facet(triangle)?;
        let [uv_a, uv_b, uv_c] = self.uv.get(triangle as usize)?.map(Vec2::as_dvec2);
        let (p_ab, p_ac) = ((b.as_dvec3() - a.as_dvec3()), (c.as_dvec3() - a.as_dvec3()));
        let (uv_ab, uv_ac) = (uv_b - uv_a, uv_c - uv_a);
        // Solve p_ab = uv_ab.x ∂p/∂u + uv_ab.y ∂p/∂v, and the same for c, by Cramer's rule. Only the direction is
        // asked for, so of the determinant only its sign matters.
        let determinant = uv_ab.perp_dot(uv_ac);
        let tangent = (uv_ac.y * p_ab - uv_ab.y * p_ac) * determinant.signum();
        if determinant == 0.0 { None } else { Some(tangent.try_normalize()?.as_vec3()) }
    }

    /// The texture coordinates of the point of `triangle` with the barycentric weights 1 − u − v, u, v. Without texture
    /// coordinates those of the corners are (0, 0), (1, 0) and (1, 1), as in pbrt.
    pub fn uv_at(&self, triangle: u32, u: f32, v: f32) -> Vec2 {
        let [a, b, c] = self.uv.get(triangle as usize).copied().unwrap_or(Self::DEFAULT_UV);
        a * (1.0 - u - v) + b * u + c * v
    }

    /// Least and largest coordinates of the triangles that have an area; `None` without any.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        let corners = (0..self.triangles.len() as u32).filter_map(|i| self.facet(i)).flat_map(|f| f.0);
        corners.map(|p| [p, p]).reduce(|[min, max], [p, _]| [min.min(p), max.max(p)])
    }

    /// The mesh scaled, by the same factor along all axes, to fill a box of the given size, and set down in it with the
    /// middle of its bottom at `foot`.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the mesh has no extent, or the sizes are not above 0 and finite.
    pub fn fitted(mut self, foot: Vec3, size: Vec3) -> Result<Self> {
        if !(size.min_element() > 0.0 && size.is_finite() && foot.is_finite()) {
            return Err(Error::parameter("size", format!("cannot fit a mesh into a box of {size} at {foot}")));
        }
        let [min, max] = self.bounds().unwrap_or_default().map(Vec3::as_dvec3);
        let scale = (size.as_dvec3() / (max - min)).min_element();
        if !scale.is_finite() {
            return Err(Error::parameter("mesh", "it has no triangle with an area"));
        }
        let from = DVec3::new((min.x + max.x) / 2.0, min.y, (min.z + max.z) / 2.0);
        for p in &mut self.positions {
            *p = (scale * (p.as_dvec3() - from) + foot.as_dvec3()).as_vec3();
        }
        Ok(self)
    }

    /// Replaces the vertex normals by the means of the adjoining triangles' normals, weighted by area. A vertex whose
    /// triangles cancel or are degenerate gets the normal of any of them, else +y.
    pub fn smooth(&mut self) {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        let across = |[a, b, c]: [u32; 3]| {
            let at = |i: u32| self.positions[i as usize];
            (at(b) - at(a)).cross(at(c) - at(a))
        };
        for &triangle in &self.triangles {
            for i in triangle {
                normals[i as usize] += across(triangle);
            }
        }
        for &triangle in &self.triangles {
            for i in triangle {
                let normal = &mut normals[i as usize];
                if normal.try_normalize().is_none() {
                    *normal = across(triangle);
                }
            }
        }
        self.normals = normals.into_iter().map(|n| n.try_normalize().unwrap_or(Vec3::Y)).collect();
    }
}

/// The unit normal of a triangle; `None` when a corner is not where [`Mesh::validate`] allows, or all are on a line.
#[inline]
pub(super) fn normal_of(corners: [Vec3; 3]) -> Option<Vec3> {
    if !corners.into_iter().all(usable) {
        return None;
    }
    // In f64 no product under- or overflows.
    let [a, b, c] = in_f64(corners);
    Some((b - a).cross(c - a).try_normalize()?.as_vec3())
}

/// The corners in double precision. Here and in the other loops over all triangles each element is written out: compilers do not
/// always inline `map` of arrays, and the preparation of a mesh then takes a quarter longer.
#[inline(always)]
fn in_f64([a, b, c]: [Vec3; 3]) -> [DVec3; 3] {
    [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()]
}

fn usable(position: Vec3) -> bool {
    position.abs().max_element() <= Mesh::FARTHEST && !position.is_nan()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(corners: [Vec3; 3]) -> Mesh {
        Mesh::new(corners.to_vec(), vec![], vec![[0, 1, 2]]).unwrap()
    }

    #[test]
    fn points_and_normals_of_a_triangle() {
        let mut mesh = triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let surface = mesh.surface(0, 0.25, 0.5).unwrap();
        assert_eq!(surface, Surface { point: Vec3::new(0.25, 0.5, 0.0), normal: Vec3::Z, shading: Vec3::Z });
        mesh.normals = vec![Vec3::Z, Vec3::X, Vec3::Y];
        assert_eq!(mesh.surface(0, 1.0, 0.0).unwrap().shading, Vec3::X);
        let middle = mesh.surface(0, 0.25, 0.25).unwrap();
        assert_eq!((middle.normal, middle.shading), (Vec3::Z, Vec3::new(0.25, 0.25, 0.5).normalize()));
        assert!(mesh.surface(1, 0.0, 0.0).is_none());
        // Areas that f32 does not know.
        let tiny = triangle([Vec3::ZERO, 1e-30 * Vec3::X, 1e-30 * Vec3::Y]);
        assert_eq!(tiny.surface(0, 0.0, 0.0).unwrap().normal, Vec3::Z);
        let flat = triangle([Vec3::ZERO, Vec3::X, 2.0 * Vec3::X]);
        assert!(flat.surface(0, 0.5, 0.0).is_none());
    }

    #[test]
    fn tangents_follow_u() {
        let corners = [Vec3::ZERO, 2.0 * Vec3::X, Vec3::new(1.0, 3.0, 0.0)];
        let with = |uv: [[f32; 2]; 3]| Mesh { uv: vec![uv.map(Vec2::from)], ..triangle(corners) };
        // u and v as linear functions of x and y, with the gradient of u given: ∂p/∂u is where v stands still.
        let mapped = |gu: Vec2, gv: Vec2| with(corners.map(|p| [p.truncate().dot(gu), p.truncate().dot(gv)]));
        assert_eq!(mapped(Vec2::X, Vec2::Y).tangent(0), Some(Vec3::X));
        assert_eq!(mapped(-Vec2::X, Vec2::Y).tangent(0), Some(-Vec3::X), "mirrored");
        assert_eq!(mapped(Vec2::Y, Vec2::X).tangent(0), Some(Vec3::Y));
        let skewed = mapped(Vec2::new(1.0, 0.5), Vec2::new(-1.0, 1.0)).tangent(0).unwrap();
        assert!(skewed.distance(Vec3::new(1.0, 1.0, 0.0).normalize()) < 1e-6, "{skewed}");
        assert!(mapped(1e-20 * Vec2::X, 1e-20 * Vec2::Y).tangent(0).is_some());
        assert_eq!(triangle(corners).tangent(0), None);
        assert_eq!(with([[0.5, 0.5]; 3]).tangent(0), None);
        assert_eq!(mapped(Vec2::X, Vec2::X).tangent(0), None, "only one direction");
        assert_eq!(mapped(Vec2::X, Vec2::Y).tangent(1), None);
        assert!(with([[0.0; 2]; 3]).validate().is_ok());
        assert!(with([[0.0, f32::NAN]; 3]).validate().is_err());
        assert!(Mesh { uv: vec![[Vec2::ZERO; 3]; 2], ..triangle(corners) }.validate().is_err());
    }

    #[test]
    fn meshes_are_scaled_and_placed_on_the_floor() {
        let corners = [Vec3::new(10.0, 20.0, 30.0), Vec3::new(14.0, 20.0, 30.0), Vec3::new(10.0, 22.0, 31.0)];
        let mesh = triangle(corners).fitted(Vec3::new(1.0, 0.5, 0.0), Vec3::new(2.0, 8.0, 4.0)).unwrap();
        assert_eq!(mesh.bounds(), Some([Vec3::new(0.0, 0.5, -0.25), Vec3::new(2.0, 1.5, 0.25)]));
        let upright = triangle([Vec3::ZERO, Vec3::X, Vec3::Y]).fitted(Vec3::ZERO, Vec3::ONE).unwrap();
        assert_eq!(upright.bounds(), Some([Vec3::new(-0.5, 0.0, 0.0), Vec3::new(0.5, 1.0, 0.0)]), "no depth");
        assert!(triangle([Vec3::ONE; 3]).fitted(Vec3::ZERO, Vec3::ONE).is_err(), "a point");
        assert!(Mesh::default().fitted(Vec3::ZERO, Vec3::ONE).is_err());
        assert!(triangle(corners).fitted(Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)).is_err());
    }

    #[test]
    fn impossible_meshes_are_refused() {
        let new = |p: Vec3, n: Vec<Vec3>, last| Mesh::new(vec![Vec3::X, Vec3::Y, p], n, vec![[0, 1, last]]);
        assert!(new(Vec3::Z, vec![], 2).is_ok());
        assert!(new(Vec3::Z, vec![Vec3::Y; 3], 2).is_ok());
        assert!(new(Vec3::Z, vec![Vec3::Y; 2], 2).is_err());
        assert!(new(Vec3::Z, vec![Vec3::NAN; 3], 2).is_err());
        assert!(new(Vec3::Z, vec![], 3).unwrap_err().to_string().contains("triangle 0"));
        for p in [Vec3::NAN, Vec3::new(0.0, f32::NAN, 0.0), Vec3::INFINITY, Vec3::new(0.0, 0.0, -2e15)] {
            assert!(new(p, vec![], 2).unwrap_err().hint().is_some(), "{p}");
        }
    }
}
