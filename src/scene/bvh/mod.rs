//! Which triangle a ray hits first: a tree of boxes, eight to a node, over the triangles of any number of meshes.

mod build;
mod lanes;
mod query;
#[cfg(test)]
mod tests;
mod traverse;
mod tree;

use super::camera::Ray;
use super::mesh::{Mesh, Surface};
pub use query::{MeshHit, Rays};

use build::{Bounds, Item};
use glam::Vec3;
use lanes::{Lanes, Portable};
use traverse::Search;
use tree::{Facet, Tree};

/// The triangles of some meshes, sorted so that rays find them.
///
/// Triangles are hit from both sides, and no ray passes between two that share an edge, unless it starts in their planes
/// to within rounding. Results are the same bits on every processor. A triangle without area, or with a corner that is
/// missing, not finite or farther out than [`Mesh::FARTHEST`], is never hit, and a ray from there, or with NaN or
/// infinity in it, hits nothing.
#[derive(Debug, Clone)]
pub struct MeshBvh {
    tree: Tree,
    /// Number of the first triangle of each mesh.
    first: Vec<u32>,
    /// What this processor can do beyond the common instructions.
    #[cfg(target_arch = "x86_64")]
    avx2: Option<lanes::Avx2>,
}

impl MeshBvh {
    /// About the memory that building a tree takes for each triangle.
    pub const BYTES_PER_TRIANGLE: usize = 256;

    /// Builds the tree over the triangles of `meshes`, on all threads. Below 32 levels boxes are halved, which bounds depth and
    /// time for any triangles.
    ///
    /// # Panics
    /// With 2³¹ triangles or more.
    #[must_use]
    pub fn build(meshes: &[&Mesh]) -> Self {
        let total: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        assert!(total < tree::LEAF as usize, "{total} triangles");
        let first =
            meshes.iter().scan(0, |next, mesh| Some(std::mem::replace(next, *next + mesh.triangles.len() as u32)));
        let first: Vec<u32> = first.collect();
        let mut items = Vec::with_capacity(total);
        for (mesh, &first) in meshes.iter().zip(&first) {
            for local in 0..mesh.triangles.len() as u32 {
                if let Some((corners, _)) = mesh.facet(local) {
                    let bounds = corners.into_iter().fold(Bounds::EMPTY, Bounds::with);
                    items.push(Item { bounds, triangle: first + local });
                }
            }
        }
        let root = build::build(&mut items);
        drop(items);
        let tree = Tree::new(root, |triangle| {
            let (mesh, local) = locate(&first, triangle);
            let mesh = meshes[mesh as usize];
            let (corners, normal) = mesh.facet(local).unwrap_or_default();
            Facet { corners, normal, corner_normals: mesh.corner_normals(local, normal) }
        });
        Self {
            tree,
            first,
            #[cfg(target_arch = "x86_64")]
            avx2: lanes::Avx2::try_new(),
        }
    }

    /// The nearest hit with 0 < t < `t_max`, of equally near ones that of the lowest number.
    #[must_use]
    pub fn nearest(&self, ray: &Ray, t_max: f32) -> Option<MeshHit> {
        let mut hit = [None];
        self.nearest_many(single(ray, &t_max), &mut hit);
        hit[0]
    }

    /// Whether there is a hit with 0 < t < `t_max`.
    #[must_use]
    pub fn occluded(&self, ray: &Ray, t_max: f32) -> bool {
        let mut hit = [false];
        self.occluded_many(single(ray, &t_max), &mut hit);
        hit[0]
    }

    /// [`nearest`](Self::nearest) for each of the first `hits.len()` of `rays`, in less time than one by one.
    pub fn nearest_many(&self, rays: Rays, hits: &mut [Option<MeshHit>]) {
        self.each::<false, _>(rays, hits, |hit| hit);
    }

    /// [`occluded`](Self::occluded) for each of the first `hits.len()` of `rays`, in less time than one by one.
    pub fn occluded_many(&self, rays: Rays, hits: &mut [bool]) {
        self.each::<true, _>(rays, hits, |hit| hit.is_some());
    }

    /// Number of the mesh that `triangle` belongs to, in the order of [`build`](Self::build).
    #[inline]
    #[must_use]
    pub fn mesh_of(&self, triangle: u32) -> u32 {
        locate(&self.first, triangle).0
    }

    /// Number of `triangle` in its own mesh.
    #[inline]
    #[must_use]
    pub fn local(&self, triangle: u32) -> u32 {
        locate(&self.first, triangle).1
    }

    /// The surface at a [`MeshHit`], from its [`place`](MeshHit::place), `u` and `v`: the same as [`Mesh::surface`], faster.
    ///
    /// # Panics
    /// For a place that no hit had.
    #[inline]
    #[must_use]
    pub fn surface(&self, place: u32, u: f32, v: f32) -> Surface {
        self.tree.surface(place, [u, v])
    }

    fn each<const ANY: bool, T>(&self, rays: Rays, out: &mut [T], keep: impl Fn(Option<MeshHit>) -> T) {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.vectorize(
                #[inline(always)]
                || trace_each::<_, ANY, _>(avx2, &self.tree, rays, out, keep),
            );
        }
        trace_each::<_, ANY, _>(Portable, &self.tree, rays, out, keep);
    }
}

/// Rays traversed alternately: while one waits for memory, the others continue.
const IN_FLIGHT: usize = 8;

#[inline(always)]
fn trace_each<L: Lanes, const ANY: bool, T>(
    l: L,
    tree: &Tree,
    rays: Rays,
    out: &mut [T],
    keep: impl Fn(Option<MeshHit>) -> T,
) {
    let mut searches: [Search<ANY>; IN_FLIGHT] = Default::default();
    // Which ray each search is for; none at first, and none in the end.
    let mut ray = [usize::MAX; IN_FLIGHT];
    let mut next = 0;
    loop {
        let mut over = true;
        for k in 0..IN_FLIGHT {
            let search = &mut searches[k];
            if ray[k] < out.len() {
                over = false;
                if search.step(l, tree) {
                    continue;
                }
                let hit = search.result();
                if !ANY && let Some(hit) = &hit {
                    tree.prefetch_surface(hit.place);
                }
                out[ray[k]] = keep(hit);
                ray[k] = usize::MAX;
            }
            while next < out.len() && ray[k] == usize::MAX {
                // Most rays may have nothing to search.
                if rays.t_max[next] > 0.0 && search.begin(tree, &rays.get(next), rays.t_max[next]) {
                    (ray[k], over) = (next, false);
                } else {
                    out[next] = keep(None);
                }
                next += 1;
            }
        }
        if over {
            return;
        }
    }
}

/// One ray as a batch.
fn single<'a>(ray: &'a Ray, t_max: &'a f32) -> Rays<'a> {
    let components = |v: &'a Vec3| [&v.x, &v.y, &v.z].map(std::slice::from_ref);
    Rays { origin: components(&ray.origin), direction: components(&ray.direction), t_max: std::slice::from_ref(t_max) }
}

/// The mesh that `triangle` belongs to, and its number there.
fn locate(first: &[u32], triangle: u32) -> (u32, u32) {
    // Of meshes that begin at the same number only the last has triangles.
    let mesh = first.partition_point(|&f| f <= triangle) - 1;
    (mesh as u32, triangle - first[mesh])
}
