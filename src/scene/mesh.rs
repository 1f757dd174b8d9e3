//! Triangle meshes.

use glam::Vec3;

/// A triangle mesh in the world. Triangles are counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    /// Unit normals per vertex, interpolated for shading; empty for flat triangles.
    pub normals: Vec<Vec3>,
    /// Vertex numbers, all below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
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
