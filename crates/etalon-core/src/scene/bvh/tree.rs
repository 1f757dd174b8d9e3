//! The tree as the traversal reads it: nodes, triangles and spheres in packs of eight, component by component.

use super::build::{Bounds, Branch, Id, Kind};
use super::lanes::WIDTH;
use crate::sampling::prefetch;
use crate::scene::Plane;
use crate::scene::description::Shape;
use crate::scene::mesh::normal_of;
use crate::scene::sphere::Sphere;
use glam::Vec3;

/// Set in the number of a child that is a pack.
pub const LEAF: u32 = 1 << 31;

/// Set besides in that of a pack of spheres.
pub const SPHERES: u32 = 1 << 30;

/// The bits that tell which node or pack it is.
pub const NUMBER: u32 = SPHERES - 1;

/// By how much boxes are larger than what is in them, relative to their largest coordinate, and, for each ray, to that
/// of its origin: more than the rounding of the tests. That of boxes makes up to ten roundings of 2⁻²⁴, that of
/// triangles as many. A hit that the test of spheres reports may lie outside of the sphere, or in front of it along the
/// ray, by at most 75 of them times the distance between centre and origin.
pub const MARGIN: f32 = 64.0 * f32::EPSILON;

/// Up to [`WIDTH`] boxes and what is in them.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Node {
    /// Least x, y, z, then largest x, y, z, with a margin. Unused boxes are inside out: no ray meets them.
    pub faces: [[f32; WIDTH]; 6],
    /// Number of a node, or of a pack with the bits that say so.
    pub child: [u32; WIDTH],
}

/// Up to [`WIDTH`] triangles.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Triangles {
    /// By corner and axis. Unused triangles are NaN: no ray meets them.
    pub corner: [[[f32; WIDTH]; 3]; 3],
    /// Unit normals, by axis.
    pub normal: [[f32; WIDTH]; 3],
    /// Height of their planes.
    pub height: [f32; WIDTH],
    /// [`Plane::error`].
    pub error: [f32; WIDTH],
    /// Numbers of the shapes.
    pub shape: [u32; WIDTH],
    /// Numbers in the shapes.
    pub triangle: [u32; WIDTH],
}

/// Up to [`WIDTH`] spheres.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Spheres {
    /// By axis. Unused spheres are NaN: no ray meets them.
    pub centre: [[f32; WIDTH]; 3],
    pub radius: [f32; WIDTH],
    /// Numbers of the shapes.
    pub shape: [u32; WIDTH],
}

/// A triangle as it goes into a pack.
#[derive(Debug, Clone, Copy)]
pub struct Facet {
    pub corners: [Vec3; 3],
    pub plane: Plane,
    pub corner_normals: [Vec3; 3],
}

impl Facet {
    /// A triangle of a mesh, or one of the two of a rectangle; `None` if it has no area or no use.
    pub fn of(shape: &Shape, triangle: u32) -> Option<Self> {
        match shape {
            Shape::Mesh(mesh) => {
                let (corners, normal) = mesh.facet(triangle)?;
                let corner_normals = mesh.corner_normals(triangle, normal);
                Some(Self { corners, plane: Plane::through(corners[0], normal), corner_normals })
            }
            Shape::Rectangle(rectangle) => {
                // They share the corners a and c to the bit, so that no ray passes between them.
                let [a, b, c, d] = rectangle.corners();
                let corners = if triangle == 0 { [a, b, c] } else { [a, c, d] };
                normal_of(corners)?;
                Some(Self { corners, plane: rectangle.plane(), corner_normals: [rectangle.normal(); 3] })
            }
            Shape::Sphere(_) => None,
        }
    }
}

/// All nodes, the root first; none for no primitives.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    pub nodes: Vec<Node>,
    pub triangles: Vec<Triangles>,
    pub spheres: Vec<Spheres>,
    /// Unit normals for shading at the corners of the triangles, [`WIDTH`] to a pack.
    pub corner_normals: Vec<[Vec3; 3]>,
}

impl Tree {
    /// Lays out a tree over primitives of `shapes`.
    pub fn new(root: Branch, shapes: &[&Shape]) -> Self {
        let mut tree = Self::default();
        let root = match root {
            Branch::Leaf(_, ids) if ids.is_empty() => return tree,
            Branch::Node(children) => children,
            // The root is always a node.
            leaf @ Branch::Leaf(..) => vec![(Bounds { min: Vec3::MIN, max: Vec3::MAX }, leaf)],
        };
        tree.node(root, shapes);
        tree
    }

    #[inline(always)]
    pub fn prefetch(&self, child: u32) {
        let number = (child & NUMBER) as usize;
        // A line of the cache holds two rows of eight.
        if child & LEAF == 0 {
            if let Some(node) = self.nodes.get(number) {
                prefetch(&node.faces, 0);
                prefetch(&node.faces, 2);
                prefetch(&node.faces, 4);
                prefetch(&node.child, 0);
            }
        } else if child & SPHERES == 0 {
            if let Some(pack) = self.triangles.get(number) {
                let rows = pack.corner.as_flattened();
                prefetch(rows, 0);
                prefetch(rows, 2);
                prefetch(rows, 4);
                prefetch(rows, 6);
                prefetch(rows, 8);
            }
        } else if let Some(pack) = self.spheres.get(number) {
            prefetch(&pack.centre, 0);
            prefetch(&pack.centre, 2);
        }
    }

    /// Prefetches what [`Bvh::surface`](super::Bvh::surface) reads at a place.
    #[inline(always)]
    pub fn prefetch_surface(&self, place: u32) {
        prefetch(&self.corner_normals, place as usize);
    }

    fn node(&mut self, children: Vec<(Bounds, Branch)>, shapes: &[&Shape]) -> u32 {
        let number = self.nodes.len();
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        self.nodes.push(Node { faces: [low, low, low, high, high, high], child: [0; WIDTH] });
        for (i, (bounds, branch)) in children.into_iter().enumerate() {
            let child = match branch {
                Branch::Leaf(Kind::Triangle, ids) => LEAF | self.pack_triangles(&ids, shapes),
                Branch::Leaf(Kind::Sphere, ids) => LEAF | SPHERES | self.pack_spheres(&ids, shapes),
                Branch::Node(children) => self.node(children, shapes),
            };
            let node = &mut self.nodes[number];
            node.child[i] = child;
            let margin = MARGIN * bounds.min.abs().max(bounds.max.abs()).max_element();
            for axis in 0..3 {
                node.faces[axis][i] = bounds.min[axis] - margin;
                node.faces[axis + 3][i] = bounds.max[axis] + margin;
            }
        }
        number as u32
    }

    fn pack_triangles(&mut self, ids: &[Id], shapes: &[&Shape]) -> u32 {
        let unused = [[f32::NAN; WIDTH]; 3];
        let first = self.corner_normals.len();
        self.corner_normals.resize(first + WIDTH, [Vec3::ZERO; 3]);
        let mut pack = Triangles {
            corner: [unused; 3],
            normal: unused,
            height: unused[0],
            error: unused[0],
            shape: [0; WIDTH],
            triangle: [0; WIDTH],
        };
        for (i, id) in ids.iter().enumerate() {
            let Some(facet) = Facet::of(shapes[id.shape as usize], id.triangle) else { continue };
            for axis in 0..3 {
                pack.normal[axis][i] = facet.plane.normal[axis];
                for (to, from) in pack.corner.iter_mut().zip(facet.corners) {
                    to[axis][i] = from[axis];
                }
            }
            pack.height[i] = facet.plane.height;
            pack.error[i] = facet.plane.error(&facet.corners);
            (pack.shape[i], pack.triangle[i]) = (id.shape, id.triangle);
            self.corner_normals[first + i] = facet.corner_normals;
        }
        self.triangles.push(pack);
        self.triangles.len() as u32 - 1
    }

    fn pack_spheres(&mut self, ids: &[Id], shapes: &[&Shape]) -> u32 {
        let mut pack = Spheres { centre: [[f32::NAN; WIDTH]; 3], radius: [f32::NAN; WIDTH], shape: [0; WIDTH] };
        for (i, id) in ids.iter().enumerate() {
            let Shape::Sphere(Sphere { centre, radius }) = *shapes[id.shape as usize] else { continue };
            for axis in 0..3 {
                pack.centre[axis][i] = centre[axis];
            }
            (pack.radius[i], pack.shape[i]) = (radius, id.shape);
        }
        self.spheres.push(pack);
        self.spheres.len() as u32 - 1
    }
}
