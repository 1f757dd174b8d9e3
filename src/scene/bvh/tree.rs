//! The tree as the traversal reads it: nodes and triangles in packs of eight, component by component.

use super::build::{Bounds, Branch};
use super::lanes::WIDTH;
use crate::sampling::prefetch::prefetch;
use crate::scene::mesh::Surface;
use glam::Vec3;

/// Set in the number of a child that is a pack of triangles; the other bits tell which.
pub const LEAF: u32 = 1 << 31;

/// Up to [`WIDTH`] boxes and what is in them.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Node {
    /// Least x, y, z, then largest x, y, z. Unused boxes are inside out: no ray meets them.
    pub faces: [[f32; WIDTH]; 6],
    /// Number of a node, or [`LEAF`] and the number of a pack.
    pub child: [u32; WIDTH],
}

/// Up to [`WIDTH`] triangles.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Pack {
    /// By corner and axis. Unused triangles are NaN: no ray meets them.
    pub corner: [[[f32; WIDTH]; 3]; 3],
    /// Unit normals, by axis.
    pub normal: [[f32; WIDTH]; 3],
    pub triangle: [u32; WIDTH],
}

/// A triangle as it goes into a pack.
#[derive(Debug, Clone, Copy, Default)]
pub struct Facet {
    pub corners: [Vec3; 3],
    pub normal: Vec3,
    pub corner_normals: [Vec3; 3],
}

/// All nodes, the root first; none for no triangles.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    pub nodes: Vec<Node>,
    pub packs: Vec<Pack>,
    /// Unit normals for shading at the corners of the packs' triangles, [`WIDTH`] to a pack.
    corner_normals: Vec<[Vec3; 3]>,
    /// Largest absolute coordinate of a triangle.
    pub extent: f32,
}

impl Tree {
    /// Lays out the tree `root`; `facet` tells what there is to know of a triangle.
    pub fn new(root: Branch, facet: impl Fn(u32) -> Facet) -> Self {
        let mut tree = Self::default();
        let root = match root {
            Branch::Leaf(triangles) if triangles.is_empty() => return tree,
            Branch::Node(children) => children,
            // The root is always a node.
            leaf @ Branch::Leaf(_) => vec![(Bounds { min: Vec3::MIN, max: Vec3::MAX }, leaf)],
        };
        tree.node(root, &facet);
        for pack in &tree.packs {
            for &x in pack.corner.as_flattened().as_flattened() {
                // Passes over NaN.
                tree.extent = tree.extent.max(x.abs());
            }
        }
        tree
    }

    /// Prefetches a node or pack.
    #[inline(always)]
    pub fn prefetch(&self, child: u32) {
        // A line of the cache holds two rows of eight.
        if child & LEAF == 0 {
            if let Some(node) = self.nodes.get(child as usize) {
                prefetch(&node.faces, 0);
                prefetch(&node.faces, 2);
                prefetch(&node.faces, 4);
                prefetch(&node.child, 0);
            }
        } else if let Some(pack) = self.packs.get((child & !LEAF) as usize) {
            let rows = pack.corner.as_flattened();
            prefetch(rows, 0);
            prefetch(rows, 2);
            prefetch(rows, 4);
            prefetch(rows, 6);
            prefetch(rows, 8);
        }
    }

    /// Prefetches what [`Tree::surface`] reads at a place.
    #[inline(always)]
    pub fn prefetch_surface(&self, place: u32) {
        prefetch(&self.corner_normals, place as usize);
    }

    /// The point with the barycentric weights u and v on the triangle at a place: eight times the number of its pack
    /// and the number there.
    #[inline]
    pub fn surface(&self, place: u32, weights: [f32; 2]) -> Surface {
        let (pack, i) = (&self.packs[place as usize / WIDTH], place as usize % WIDTH);
        let at = |rows: &[[f32; WIDTH]; 3]| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let normals = self.corner_normals[place as usize];
        Surface::on(pack.corner.each_ref().map(at), at(&pack.normal), normals, weights)
    }

    fn node(&mut self, children: Vec<(Bounds, Branch)>, facet: &impl Fn(u32) -> Facet) -> u32 {
        let number = self.nodes.len();
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        self.nodes.push(Node { faces: [low, low, low, high, high, high], child: [0; WIDTH] });
        for (i, (bounds, branch)) in children.into_iter().enumerate() {
            let child = match branch {
                Branch::Leaf(triangles) => LEAF | self.pack(&triangles, facet),
                Branch::Node(children) => self.node(children, facet),
            };
            let node = &mut self.nodes[number];
            node.child[i] = child;
            for axis in 0..3 {
                node.faces[axis][i] = bounds.min[axis];
                node.faces[axis + 3][i] = bounds.max[axis];
            }
        }
        number as u32
    }

    fn pack(&mut self, triangles: &[u32], facet: &impl Fn(u32) -> Facet) -> u32 {
        let unused = [[f32::NAN; WIDTH]; 3];
        let first = self.corner_normals.len();
        self.corner_normals.resize(first + WIDTH, [Vec3::ZERO; 3]);
        let mut pack = Pack { corner: [unused; 3], normal: unused, triangle: [0; WIDTH] };
        for (i, &triangle) in triangles.iter().enumerate() {
            let Facet { corners, normal, corner_normals } = facet(triangle);
            for axis in 0..3 {
                pack.normal[axis][i] = normal[axis];
                for (to, from) in pack.corner.iter_mut().zip(corners) {
                    to[axis][i] = from[axis];
                }
            }
            pack.triangle[i] = triangle;
            self.corner_normals[first + i] = corner_normals;
        }
        self.packs.push(pack);
        self.packs.len() as u32 - 1
    }
}
