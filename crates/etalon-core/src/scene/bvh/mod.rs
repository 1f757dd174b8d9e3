//! Which primitive or which object a ray hits first: a tree of boxes, eight to a node, over spheres, rectangles and triangles.

mod build;
mod lanes;
#[cfg(test)]
mod tests;
mod traverse;
mod tree;

use super::mesh::Surface;
use super::{Object, Plane, Ray, Scene, Shape};
use build::{Bounds, Id, Item, Kind};
use glam::Vec3;
use lanes::{Lanes, Portable, WIDTH};
use traverse::Search;
use tree::{Facet, Tree, Triangles};

/// The spheres and triangles of some shapes, sorted so that rays find them.
///
/// Spheres are hit where [`Sphere::distance`](super::Sphere::distance) says, to the bit. Triangles are hit from both
/// sides, and no ray passes between two that share an edge, unless it starts in their planes to within rounding. A
/// rectangle is two of them. Results are the same bits on every processor. A sphere without
/// [`bounds`](super::Sphere::bounds) is never hit, nor is a triangle without area, or with a corner that is missing,
/// not finite or farther out than [`Mesh::FARTHEST`](super::Mesh::FARTHEST), and a ray from there, or with NaN or
/// infinity in it, hits nothing.
#[derive(Debug, Clone)]
pub struct Bvh {
    tree: Tree,
    /// What this processor can do beyond the common instructions.
    #[cfg(target_arch = "x86_64")]
    avx2: Option<lanes::Avx2>,
}

impl Bvh {
    /// About the memory that building a tree takes for a shape.
    pub fn bytes(shape: &Shape) -> usize {
        128 + 256 * shape.triangles()
    }

    /// Builds the tree over `shapes`, on all threads. Below 32 levels boxes are halved, which bounds depth and time for
    /// any primitives.
    ///
    /// # Panics
    /// With 2²⁹ spheres and triangles or more.
    pub fn build(shapes: &[&Shape]) -> Self {
        let mut items = Vec::new();
        for (number, &shape) in (0..).zip(shapes) {
            if let Shape::Sphere(sphere) = shape {
                let id = Id { shape: number, triangle: 0 };
                let item = |[min, max]: [Vec3; 2]| Item { bounds: Bounds { min, max }, kind: Kind::Sphere, id };
                items.extend(sphere.bounds().map(item));
            }
            items.reserve(shape.triangles());
            for triangle in 0..shape.triangles() as u32 {
                if let Some(Facet { corners, .. }) = Facet::of(shape, triangle) {
                    let bounds = corners.into_iter().fold(Bounds::EMPTY, Bounds::with);
                    items.push(Item { bounds, kind: Kind::Triangle, id: Id { shape: number, triangle } });
                }
            }
        }
        assert!(items.len() < 1 << 29, "{} spheres and triangles", items.len());
        let root = build::build(&mut items);
        drop(items);
        Self {
            tree: Tree::new(root, shapes),
            #[cfg(target_arch = "x86_64")]
            avx2: lanes::Avx2::try_new(),
        }
    }

    /// The nearest hit with 0 < t < `t_max`, for spheres also with t = 0; of equally near ones that of the first shape,
    /// and of its first triangle.
    pub fn nearest(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        let mut hit = [None];
        self.nearest_many(single(ray, &t_max), &mut hit);
        hit[0]
    }

    /// Whether there is a hit as [`nearest`](Self::nearest) counts them.
    pub fn occluded(&self, ray: &Ray, t_max: f32) -> bool {
        let mut hit = [false];
        self.occluded_many(single(ray, &t_max), &mut hit);
        hit[0]
    }

    /// [`nearest`](Self::nearest) for each of the first `hits.len()` of `rays`, in less time than one by one.
    pub fn nearest_many(&self, rays: Rays, hits: &mut [Option<Hit>]) {
        self.each::<false, _>(rays, hits, |hit| hit);
    }

    /// [`occluded`](Self::occluded) for each of the first `hits.len()` of `rays`, in less time than one by one.
    pub fn occluded_many(&self, rays: Rays, hits: &mut [bool]) {
        self.each::<true, _>(rays, hits, |hit| hit.is_some());
    }

    /// The surface at a [`Hit`] of a triangle, from its [`place`](Hit::place), `u` and `v`: the same as
    /// [`Mesh::surface`](super::Mesh::surface), faster.
    #[inline]
    pub fn surface(&self, place: u32, u: f32, v: f32) -> Surface {
        let (pack, i) = self.at(place);
        let of = |rows: &[[f32; WIDTH]; 3]| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let (corners, normals) = (&pack.corner, self.tree.corner_normals[place as usize]);
        Surface::on([of(&corners[0]), of(&corners[1]), of(&corners[2])], of(&pack.normal), normals, [u, v])
    }

    /// The plane of the triangle at a [`Hit`], from its [`place`](Hit::place), and its [error](Plane::error). On which side of the triangle
    /// a ray starts is certain if it starts [`Plane::offset`] away, and of its neighbours if also more than the error.
    #[inline]
    pub fn plane(&self, place: u32) -> (Plane, f32) {
        let (pack, i) = self.at(place);
        (Plane { normal: Vec3::from(pack.normal.map(|axis| axis[i])), height: pack.height[i] }, pack.error[i])
    }

    /// [`Hit::triangle`] from the hit's [`place`](Hit::place).
    #[inline]
    pub fn triangle(&self, place: u32) -> u32 {
        let (pack, i) = self.at(place);
        pack.triangle[i]
    }

    /// The pack of a triangle by its place, and its number there.
    #[inline]
    fn at(&self, place: u32) -> (&Triangles, usize) {
        (&self.tree.triangles[place as usize / WIDTH], place as usize % WIDTH)
    }

    fn each<const ANY: bool, T>(&self, rays: Rays, out: &mut [T], keep: impl Fn(Option<Hit>) -> T) {
        if out.len() == 1 {
            self.alternately::<ANY, 1, _>(rays, out, keep);
        } else {
            self.alternately::<ANY, IN_FLIGHT, _>(rays, out, keep);
        }
    }

    fn alternately<const ANY: bool, const N: usize, T>(
        &self,
        rays: Rays,
        out: &mut [T],
        keep: impl Fn(Option<Hit>) -> T,
    ) {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.vectorize(
                #[inline(always)]
                || trace_each::<_, ANY, N, _>(avx2, &self.tree, rays, out, keep),
            );
        }
        trace_each::<_, ANY, N, _>(Portable, &self.tree, rays, out, keep);
    }
}

/// Rays that are traversed alternately: while one waits for memory, the others continue.
const IN_FLIGHT: usize = 8;

#[inline(always)]
fn trace_each<L: Lanes, const ANY: bool, const N: usize, T>(
    l: L,
    tree: &Tree,
    rays: Rays,
    out: &mut [T],
    keep: impl Fn(Option<Hit>) -> T,
) {
    let mut searches: [Search<ANY>; N] = std::array::from_fn(|_| Search::default());
    // Which ray each search is for; none at first, and none in the end.
    let mut ray = [usize::MAX; N];
    let mut next = 0;
    loop {
        let mut over = true;
        for k in 0..N {
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

fn single<'a>(ray: &'a Ray, t_max: &'a f32) -> Rays<'a> {
    let components = |v: &'a Vec3| [&v.x, &v.y, &v.z].map(std::slice::from_ref);
    Rays { origin: components(&ray.origin), direction: components(&ray.direction), t_max: std::slice::from_ref(t_max) }
}

/// Where a ray hits a primitive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// Number of the shape, in the order of [`Bvh::build`].
    pub shape: u32,
    /// Number of the triangle in its mesh; 0 for spheres, and 0 or 1 for the halves of a rectangle.
    pub triangle: u32,
    /// Where the tree keeps the triangle, for [`Bvh::surface`], [`Bvh::plane`] and
    /// [`Bvh::triangle`], which panic for one that no hit of a triangle had; 0 for spheres.
    pub place: u32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// That of its third corner.
    pub v: f32,
}

impl Hit {
    /// Whether a hit of this primitive at the distance `t` comes before this one.
    #[inline(always)]
    pub(super) fn is_beaten_by(&self, t: f32, shape: u32, triangle: u32) -> bool {
        t < self.t || (t == self.t && (shape, triangle) < (self.shape, self.triangle))
    }
}

/// Rays, component by component. The slices are of one length.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    pub origin: [&'a [f32]; 3],
    pub direction: [&'a [f32]; 3],
    /// Where each ray ends; one that is not above 0 hits nothing and costs nothing.
    pub t_max: &'a [f32],
}

impl Rays<'_> {
    /// Ray number `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        let at = |v: &[&[f32]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        Ray { origin: at(&self.origin), direction: at(&self.direction) }
    }
}

/// The objects of a scene in a tree.
pub struct FirstHit<'a> {
    objects: &'a [Object],
    bvh: Bvh,
}

impl<'a> FirstHit<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let shapes: Vec<&Shape> = scene.objects.iter().map(|object| &object.shape).collect();
        Self { objects: &scene.objects, bvh: Bvh::build(&shapes) }
    }

    /// The object that the ray meets first; `None` when it meets none.
    pub fn along(&self, ray: &Ray) -> Option<&'a Object> {
        self.bvh.nearest(ray, f32::INFINITY).map(|hit| &self.objects[hit.shape as usize])
    }
}
