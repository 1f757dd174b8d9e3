//! The scene's shapes laid out for many rays at once: which one a ray meets first, and whether any is in its way.
//!
//! Up to [`MOST_SOLIDS`] rectangles and spheres are intersected one by one, each with all rays in one vectorized loop, which is
//! faster than any tree. If a scene has more, only the large ones are. All others, and the triangles of all meshes, are in one
//! bounding volume hierarchy (BVH), built only if it holds anything.

#[cfg(test)]
mod tests;

use super::lanes::{Hits, LANES, Lane, NONE, Rays, at, fill};
use super::solids::{Solid, offset_of_sphere, solid_of};
use etalon_core::math::Frame;
use etalon_core::scene::bvh::{self, Bvh};
use etalon_core::scene::{Object, Scene, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A surface where a ray has met it.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    pub position: Vec3,
    /// Unit normal of the outside.
    pub normal: Vec3,
    /// Unit normal for shading; that of the surface unless it is a smooth mesh.
    pub shading: Vec3,
    /// How far along the normal a ray must start to be off the surface despite rounding.
    pub offset: f32,
}

impl Surface {
    pub const NONE: Self = Self { position: Vec3::ZERO, normal: Vec3::Z, shading: Vec3::Z, offset: 0.0 };

    /// The normal, and that for shading.
    #[inline(always)]
    pub fn normals(&self) -> [Vec3; 2] {
        [self.normal, self.shading]
    }

    /// Whether the normal for shading is that of the surface.
    #[inline(always)]
    pub fn is_flat(&self) -> bool {
        self.shading == self.normal
    }

    /// The surface with its normal on the side of `wo`, and the normal for shading on the side of that.
    #[inline]
    #[must_use]
    pub fn facing(self, wo: Vec3) -> Self {
        let normal = self.normal * 1f32.copysign(self.normal.dot(wo));
        let shading = self.shading * 1f32.copysign(self.shading.dot(normal));
        Self { normal, shading, ..self }
    }

    /// The shading frame for `wo`: about the geometric normal where the shading normal faces away.
    #[inline]
    pub fn frame(&self, wo: Vec3) -> Frame {
        Frame::from_normal(self.shading_for(wo))
    }

    /// The normal of [`Surface::frame`].
    #[inline]
    pub fn shading_for(&self, wo: Vec3) -> Vec3 {
        let same_side = self.shading.dot(wo) * self.normal.dot(wo) > 0.0;
        if same_side { self.shading } else { self.normal }
    }

    /// The origin of a ray towards `wi`, offset against self-intersection.
    #[inline]
    pub fn ray_origin(&self, wi: Vec3) -> Vec3 {
        self.position + self.normal * self.offset.copysign(self.normal.dot(wi))
    }
}

/// Most rectangles and spheres that are tried one by one. `cargo bench --bench bvh few` compares that with the
/// tree, for 256 incoherent rays and spheres that fill a ninth of a cube: 32 of them one by one are 1.6 times as fast
/// as the tree, 64 as fast, 128 0.7 times.
const MOST_SOLIDS: usize = 48;

/// The prepared shapes.
pub struct Geometry<'a> {
    objects: &'a [Object],
    /// What is tried one by one, each with the number of its object: rectangles, then spheres.
    solids: Vec<(Box<dyn Solid>, u32)>,
    /// All other shapes.
    tree: Option<Tree>,
    extent: f32,
}

/// The shapes that are not tried one by one.
struct Tree {
    bvh: Bvh,
    /// A box around all of them, with a margin for rounding.
    bounds: [Vec3; 2],
    /// The object that each shape is.
    object: Vec<u32>,
}

/// If a scene has more rectangles and spheres than that, those are intersected one by one whose bounding box has at least this
/// share of the surface area of the scene's bounding box: by the surface area heuristic, the share of rays that would test them
/// in the BVH.
const LARGE: f32 = 1.0 / 16.0;

fn is_outside_bvh(scene: &Scene) -> Vec<bool> {
    let is_solid = |&i: &usize| !matches!(scene.objects[i].shape, Shape::Mesh(_));
    let mut solids: Vec<usize> = (0..scene.objects.len()).filter(is_solid).collect();
    if solids.len() > MOST_SOLIDS {
        let boxes: Vec<_> = scene.objects.iter().map(|object| object.shape.bounds().unwrap_or(EMPTY)).collect();
        let least = LARGE * surface(boxes.iter().copied().fold(EMPTY, union));
        let area = |&i: &usize| surface(boxes[i]);
        solids.retain(|i| area(i) >= least);
        solids.sort_by(|i, j| area(j).total_cmp(&area(i)));
        solids.truncate(MOST_SOLIDS);
    }
    let mut alone = vec![false; scene.objects.len()];
    solids.into_iter().for_each(|i| alone[i] = true);
    alone
}

impl<'a> Geometry<'a> {
    pub fn needs_tree(scene: &Scene) -> bool {
        is_outside_bvh(scene).contains(&false)
    }

    /// Prepares the shapes; `with_tree` says whether to build the tree if nothing stands in it.
    pub fn new(scene: &'a Scene, with_tree: bool) -> Self {
        Self::prepare(scene, with_tree, &is_outside_bvh(scene))
    }

    fn prepare(scene: &'a Scene, with_tree: bool, outside_bvh: &[bool]) -> Self {
        let objects = &scene.objects;
        let (mut solids, mut spheres): (Vec<(Box<dyn Solid>, u32)>, _) = (Vec::new(), Vec::new());
        let (mut shapes, mut shape_objects) = (Vec::new(), Vec::new());
        let (mut whole, mut in_tree) = (EMPTY, EMPTY);
        for (i, object) in (0..).zip(objects) {
            let bounds = object.shape.bounds().unwrap_or(EMPTY);
            whole = union(whole, bounds);
            let is_alone = outside_bvh[i as usize];
            match &object.shape {
                Shape::Rectangle(rectangle) if is_alone => solids.push((solid_of(rectangle), i)),
                Shape::Sphere(sphere) if is_alone => spheres.extend(sphere.bounds().map(|_| (*sphere, i))),
                shape => {
                    in_tree = union(in_tree, bounds);
                    shapes.push(shape);
                    shape_objects.push(i);
                }
            }
        }
        let tree =
            with_tree.then(|| Tree { bvh: Bvh::build(&shapes), bounds: with_margin(in_tree), object: shape_objects });
        let extent = (whole[1] - whole[0]).length();
        solids.extend(spheres.into_iter().map(|(sphere, i)| (Box::new(sphere) as Box<dyn Solid>, i)));
        Self { objects, solids, tree, extent }
    }

    /// The nearest object of the first `count` rays.
    pub fn nearest(&self, rays: &Rays, count: usize, hits: &mut Hits) {
        hits.t[..count].fill(f32::INFINITY);
        hits.object[..count].fill(NONE);
        for (solid, object) in &self.solids {
            solid.nearest(*object, rays, count, hits);
        }
        if let Some(tree) = &self.tree {
            let reach = reach(tree.bounds, rays, count, &hits.t);
            let mut found = [None; LANES];
            tree.bvh.nearest_many(limited(rays, &reach, count), &mut found[..count]);
            for (i, hit) in found[..count].iter().enumerate() {
                if let Some(hit) = hit {
                    let object = tree.object[hit.shape as usize];
                    hits.t[i] = match &self.objects[object as usize].shape {
                        // Large triangles are not as accurate.
                        Shape::Rectangle(r) => r.plane().distance(at(&rays.origin, i), at(&rays.direction, i)).max(0.0),
                        _ => hit.t,
                    };
                    hits.object[i] = object;
                    hits.place[i] = hit.place;
                    (hits.u[i], hits.v[i]) = (hit.u, hit.v);
                }
            }
        }
    }

    /// Sets `blocked[i]` to nonzero where an object is nearer than `t_max[i]` along ray i. A ray towards a light must
    /// end in front of it: see [`short_of`](super::solids::short_of).
    pub fn occluded(&self, rays: &Rays, count: usize, t_max: &Lane, blocked: &mut [u32; LANES]) {
        blocked[..count].fill(0);
        for (solid, _) in &self.solids {
            solid.blocked(rays, count, t_max, blocked);
        }
        if let Some(tree) = &self.tree {
            let mut reach = reach(tree.bounds, rays, count, t_max);
            for (reach, &blocked) in reach[..count].iter_mut().zip(blocked.iter()) {
                // A ray that is stopped already needs no tree.
                *reach = if blocked == 0 { *reach } else { 0.0 };
            }
            let mut found = [false; LANES];
            tree.bvh.occluded_many(limited(rays, &reach, count), &mut found[..count]);
            for i in 0..count {
                blocked[i] |= u32::from(found[i]);
            }
        }
    }

    /// The diagonal of the box around all objects.
    pub fn extent(&self) -> f32 {
        self.extent
    }

    #[inline(always)]
    pub fn surface(&self, rays: &Rays, hits: &Hits, i: usize) -> Surface {
        let id = hits.object[i] as usize;
        let (origin, direction) = (at(&rays.origin, i), at(&rays.direction, i));
        let position = origin + hits.t[i] * direction;
        match &self.objects[id].shape {
            Shape::Rectangle(r) => {
                let plane = r.plane();
                // Back onto the plane: the error of the position no longer depends on t.
                let (position, normal) = (plane.project(position), plane.normal);
                Surface { position, normal, shading: normal, offset: plane.offset(position) }
            }
            Shape::Sphere(s) => {
                let normal = (origin - s.centre + hits.t[i] * direction).normalize();
                let position = s.centre + s.radius * normal;
                Surface { position, normal, shading: normal, offset: offset_of_sphere(s) }
            }
            Shape::Mesh(_) => {
                // Without a tree no mesh is ever hit.
                let Some(tree) = &self.tree else {
                    return Surface { position, normal: -direction, shading: -direction, offset: 0.0 };
                };
                let s = tree.bvh.surface(hits.place[i], hits.u[i], hits.v[i]);
                let (plane, error) = tree.bvh.plane(hits.place[i]);
                let position = plane.project(s.point);
                Surface { position, normal: s.normal, shading: s.shading, offset: plane.offset(position).max(error) }
            }
        }
    }

    /// The tangent ∂p/∂u, of any length, where ray `i` has hit a surface with this normal; 0 where a mesh has none. Only
    /// anisotropic materials ask for it. A sphere is parametrized by the angle around [`Object::axis`], a rectangle along
    /// its first edge.
    #[inline]
    pub fn tangent(&self, hits: &Hits, i: usize, normal: Vec3) -> Vec3 {
        let object = &self.objects[hits.object[i] as usize];
        match &object.shape {
            Shape::Sphere(_) => object.axis.cross(normal),
            Shape::Rectangle(rectangle) => rectangle.half_sides()[0],
            Shape::Mesh(mesh) => mesh.tangent(self.triangle(hits, i)).unwrap_or(Vec3::ZERO),
        }
    }

    /// The texture coordinates (u, v) of the surface that ray `i` has hit, at `position`. On a sphere u is the angle around
    /// [`Object::axis`] over 2π and v rises from 0 to 1 along the axis with the angle; on a rectangle both run from 0 to 1 along its
    /// sides; on a mesh see [`Mesh::uv_at`](etalon_core::scene::Mesh::uv_at).
    #[inline]
    pub fn uv(&self, hits: &Hits, i: usize, position: Vec3) -> Vec2 {
        let object = &self.objects[hits.object[i] as usize];
        match &object.shape {
            Shape::Sphere(sphere) => {
                let d = (position - sphere.centre) / sphere.radius;
                let [x, y] = object.meridians.map(|axis| axis.dot(d));
                let z = object.axis.dot(d).clamp(-1.0, 1.0);
                Vec2::new((y.atan2(x) / TAU).rem_euclid(1.0), 1.0 - z.acos() / PI)
            }
            Shape::Rectangle(rectangle) => {
                let d = position - rectangle.centre();
                Vec2::from(rectangle.half_sides().map(|half| 0.5 + 0.5 * d.dot(half) / half.length_squared()))
            }
            Shape::Mesh(mesh) => mesh.uv_at(self.triangle(hits, i), hits.u[i], hits.v[i]),
        }
    }

    /// The number, in its mesh, of the triangle that ray `i` has hit; 0 on other shapes.
    #[inline]
    pub fn triangle(&self, hits: &Hits, i: usize) -> u32 {
        match (&self.objects[hits.object[i] as usize].shape, &self.tree) {
            (Shape::Mesh(_), Some(tree)) => tree.bvh.triangle(hits.place[i]),
            _ => 0,
        }
    }
}

/// The first `count` rays up to the given distances.
fn limited<'a>(rays: &'a Rays, t_max: &'a Lane, count: usize) -> bvh::Rays<'a> {
    let part = |lanes: &'a [Lane; 3]| lanes.each_ref().map(|lane| &lane[..count]);
    bvh::Rays { origin: part(&rays.origin), direction: part(&rays.direction), t_max: &t_max[..count] }
}

/// A box around nothing.
const EMPTY: [Vec3; 2] = [Vec3::INFINITY, Vec3::NEG_INFINITY];

fn union([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> [Vec3; 2] {
    [a.min(c), b.max(d)]
}

/// The surface area of a box; 0 of one around nothing.
fn surface([low, high]: [Vec3; 2]) -> f32 {
    let Vec3 { x, y, z } = (high - low).max(Vec3::ZERO);
    2.0 * (x * y + y * z + z * x)
}

/// A box grown by more than the rounding of a ray's distances to what is in it.
fn with_margin([low, high]: [Vec3; 2]) -> [Vec3; 2] {
    let margin = 1e-4 * (high - low).max_element() + 1e-5 * low.abs().max(high.abs()).max_element();
    [low - margin, high + margin]
}

/// For each ray the distance up to which a tree in a box is to be searched: its `t_max`, or 0 if it does not reach the box.
fn reach([low, high]: [Vec3; 2], rays: &Rays, count: usize, t_max: &Lane) -> Lane {
    let mut reach = [0.0; LANES];
    fill(
        count,
        [&mut reach],
        #[inline(always)]
        move |i| {
            let (origin, inverse) = (at(&rays.origin, i), at(&rays.direction, i).recip());
            let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
            // 0 · ∞ on the face of a slab is NaN, which max and min pass over.
            let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
            let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z)).min(t_max[i]);
            [if near <= far { t_max[i] } else { 0.0 }]
        },
    );
    reach
}
