//! Traversal of the tree, and intersection of triangles and spheres.
//!
//! The result depends on the primitives alone, not on the tree, the processor or the number of threads: they are tested
//! by the same operations in the same order everywhere, boxes are passed over only when nothing in them can be hit, and
//! of two hits at the same distance the lower number counts.

use super::Hit;
use super::lanes::{Lanes, WIDTH};
use super::tree::{LEAF, MARGIN, NUMBER, Node, SPHERES, Spheres, Tree, Triangles};
use crate::scene::camera::Ray;
use crate::scene::mesh::Mesh;
use glam::Vec3;

/// The traversal of one ray, a node or a pack at a time.
///
/// A step mostly waits for memory, so several rays are traversed alternately: see `trace_each`.
#[derive(Default)]
pub struct Search<const ANY: bool> {
    ray: Ray,
    slabs: Slabs,
    /// Computed when the ray reaches its first triangles: many rays never do.
    shear: Option<Shear>,
    best: Hit,
    found: bool,
    stack: Stack,
    current: u32,
}

impl<const ANY: bool> Search<ANY> {
    /// Begins a search for the nearest hit with 0 < t < `t_max`, which is above 0; with `ANY` for the first one that is
    /// found. Returns whether there is anything to search.
    #[inline(always)]
    pub fn begin(&mut self, tree: &Tree, ray: &Ray, t_max: f32) -> bool {
        // Within these limits no operation on boxes gives NaN.
        let sound = ray.origin.abs().cmple(Vec3::splat(Mesh::FARTHEST)).all() && ray.direction.is_finite();
        if tree.nodes.is_empty() || !sound {
            return false;
        }
        self.slabs = Slabs::new(ray);
        (self.ray, self.shear) = (*ray, None);
        self.best = Hit { t: t_max, ..Hit::default() };
        self.stack.waiting.clear();
        (self.found, self.current) = (false, 0);
        true
    }

    /// Tests the next box or pack and prefetches the one after it; `false` when the search is over.
    #[inline(always)]
    pub fn step<L: Lanes>(&mut self, l: L, tree: &Tree) -> bool {
        let mut next = None;
        if self.current & LEAF == 0 {
            let node = &tree.nodes[self.current as usize];
            let (distance, boxes) = self.slabs.meet(l, node, self.best.t);
            if boxes != 0 {
                next = Some(self.stack.push_all::<ANY>(&distance, boxes, &node.child));
            }
        } else {
            let number = self.current & NUMBER;
            self.found |= if self.current & SPHERES != 0 {
                hit_spheres(l, &self.ray, &tree.spheres[number as usize], &mut self.best)
            } else {
                let shear = self.shear.get_or_insert_with(
                    #[inline(always)]
                    || Shear::new(&self.ray),
                );
                shear.hit(l, &tree.triangles[number as usize], number, &mut self.best)
            };
            if ANY && self.found {
                return false;
            }
        }
        match next.or_else(
            #[inline(always)]
            || self.stack.pop(self.best.t),
        ) {
            Some(next) => {
                self.current = next;
                tree.prefetch(next);
                true
            }
            None => false,
        }
    }

    #[inline(always)]
    pub fn result(&self) -> Option<Hit> {
        self.found.then_some(self.best)
    }
}

/// Boxes still to be tested: the bits of the distance to each, which sort as the distances do, and its number.
#[derive(Default)]
struct Stack {
    waiting: Vec<u64>,
}

impl Stack {
    /// Returns the nearest of the given boxes and keeps the others; the nearer ones, unless it is `ANY`, on top.
    #[inline(always)]
    fn push_all<const ANY: bool>(&mut self, distance: &[f32; WIDTH], mut boxes: u32, child: &[u32; WIDTH]) -> u32 {
        let base = self.waiting.len();
        let mut nearest = u64::MAX;
        loop {
            let i = boxes.trailing_zeros() as usize % WIDTH;
            boxes &= boxes.wrapping_sub(1);
            let entry = u64::from(distance[i].to_bits()) << 32 | u64::from(child[i]);
            let far = nearest.max(entry);
            nearest = nearest.min(entry);
            if far != u64::MAX {
                self.waiting.push(far);
                let mut at = self.waiting.len() - 1;
                while !ANY && at > base && self.waiting[at - 1] < self.waiting[at] {
                    self.waiting.swap(at - 1, at);
                    at -= 1;
                }
            }
            if boxes == 0 {
                return nearest as u32;
            }
        }
    }

    /// The next box that is not beyond `limit`.
    #[inline(always)]
    fn pop(&mut self, limit: f32) -> Option<u32> {
        loop {
            let entry = self.waiting.pop()?;
            if f32::from_bits((entry >> 32) as u32) <= limit {
                return Some(entry as u32);
            }
        }
    }
}

/// One value per axis. Unlike those of the standard library it is inlined for certain, without which the closure
/// would be compiled without AVX2.
#[inline(always)]
fn axes<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// What the test against boxes needs of a ray. Every box is taken larger by the ray's part of [`MARGIN`].
#[derive(Default)]
struct Slabs {
    /// One over the direction, per axis.
    inverse: [f32; 3],
    /// Origin over direction, the origin moved so that the near and the far faces move outwards.
    near: [f32; 3],
    far: [f32; 3],
    /// Which of a node's faces are met first, and which last.
    first: [usize; 3],
    last: [usize; 3],
}

/// Components of a direction below this are taken as this: they move a ray by less than the margin of the boxes.
const FLATTEST: f32 = 1e-18;

impl Slabs {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let margin = MARGIN * origin.iter().fold(0.0, |m: f32, x| m.max(x.abs()));
        let inverse = axes(|i| 1.0 / direction[i].abs().max(FLATTEST).copysign(direction[i]));
        let moved = |sign: f32| axes(|i| (origin[i] + (sign * margin).copysign(sign * inverse[i])) * inverse[i]);
        Self {
            inverse,
            near: moved(1.0),
            far: moved(-1.0),
            first: axes(|i| if inverse[i] < 0.0 { i + 3 } else { i }),
            last: axes(|i| if inverse[i] < 0.0 { i } else { i + 3 }),
        }
    }

    /// The boxes met before `limit`, as bits, and the distance to each.
    #[inline(always)]
    fn meet<L: Lanes>(&self, l: L, node: &Node, limit: f32) -> ([f32; WIDTH], u32) {
        let face = |i: usize, origin: [f32; 3], axis: usize| {
            l.mul_sub(l.load(&node.faces[i]), l.splat(self.inverse[axis]), l.splat(origin[axis]))
        };
        let enter = |axis: usize| face(self.first[axis], self.near, axis);
        let exit = |axis: usize| face(self.last[axis], self.far, axis);
        let from = l.max(l.max(enter(0), enter(1)), l.max(enter(2), l.splat(0.0)));
        let to = l.min(l.min(exit(0), exit(1)), l.min(exit(2), l.splat(limit)));
        (l.store(from), l.le(from, to))
    }
}

/// What the test against triangles needs of a ray: the shear that makes it the z axis.
///
/// The edge functions of the sheared triangle have the right sign or are 0: they are differences of two rounded
/// products, rounding keeps the order of the products, and the difference of two floats has the right sign. An edge has
/// the same function in both its triangles, up to sign, and 0 counts as inside: so no ray slips between triangles, and
/// a triangle without area, or edge on, is not hit. Source: Woop, Benthin, Wald, "Watertight ray/triangle
/// intersection", *Journal of Computer Graphics Techniques* 2(1), 2013 (the edge functions; the paper takes those that
/// are 0 again in double precision).
#[derive(Default)]
struct Shear {
    /// The axes, the last one that along which the direction is longest.
    order: [usize; 3],
    origin: [f32; 3],
    direction: [f32; 3],
    x: f32,
    y: f32,
    z: f32,
}

impl Shear {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let (origin, d) = (ray.origin.to_array(), ray.direction.to_array());
        let size = axes(|i| d[i].abs());
        let z = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        let order = [(z + 1) % 3, (z + 2) % 3, z];
        let inverse = 1.0 / d[z];
        Self {
            order,
            origin: axes(|k| origin[order[k]]),
            direction: axes(|k| d[order[k]]),
            x: d[order[0]] * inverse,
            y: d[order[1]] * inverse,
            z: inverse,
        }
    }

    /// Replaces `best` by a hit in front of it, if there is one in this pack of that number.
    #[inline(always)]
    fn hit<L: Lanes>(&self, l: L, pack: &Triangles, number: u32, best: &mut Hit) -> bool {
        let origin = axes(|k| l.splat(self.origin[k]));
        let direction = axes(|k| l.splat(self.direction[k]));
        let (x_per_z, y_per_z) = (l.splat(self.x), l.splat(self.y));
        let relative = |i: usize| axes(|k| l.sub(l.load(&pack.corner[i][self.order[k]]), origin[k]));
        let sheared = |[x, y, z]: [L::F; 3]| [l.sub(x, l.mul(x_per_z, z)), l.sub(y, l.mul(y_per_z, z)), z];
        let [a, b, c] = [sheared(relative(0)), sheared(relative(1)), sheared(relative(2))];
        let edge = |p: [L::F; 3], q: [L::F; 3]| l.sub(l.mul(p[0], q[1]), l.mul(p[1], q[0]));
        let [w, u, v] = [edge(c, b), edge(a, c), edge(b, a)];
        let zero = l.splat(0.0);
        let inside = l.le(zero, l.min(l.min(u, v), w)) | l.le(l.max(l.max(u, v), w), zero);
        if inside == 0 {
            return false;
        }
        let dot = |p: [L::F; 3], q: [L::F; 3]| l.add(l.add(l.mul(p[0], q[0]), l.mul(p[1], q[1])), l.mul(p[2], q[2]));
        // Infinite when the triangle is edge on; its t is then NaN.
        let scale = l.div(l.splat(1.0), l.add(l.add(u, v), w));
        let (w, u, v) = (l.mul(w, scale), l.mul(u, scale), l.mul(v, scale));
        let t = l.mul(dot([w, u, v], [a[2], b[2], c[2]]), l.splat(self.z));
        // The weights of a sliver are not accurate, so its t may come out above 0 for a ray that starts just in front
        // of it. The side of the plane on which the ray starts is certain.
        let normal = axes(|k| l.load(&pack.normal[self.order[k]]));
        let ahead = l.mul(l.sub(l.load(&pack.height), dot(normal, origin)), dot(normal, direction));
        let mut hits = inside & !l.le(ahead, zero) & !l.le(t, zero) & l.le(t, l.splat(best.t));
        if hits == 0 {
            return false;
        }
        let (t, u, v) = (l.store(t), l.store(u), l.store(v));
        let mut found = false;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize % WIDTH;
            hits &= hits - 1;
            let (shape, triangle) = (pack.shape[i], pack.triangle[i]);
            if best.is_beaten_by(t[i], shape, triangle) {
                *best = Hit { t: t[i], shape, triangle, place: number * WIDTH as u32 + i as u32, u: u[i], v: v[i] };
                found = true;
            }
        }
        found
    }
}

/// Replaces `best` by a hit in front of it, if there is one in this pack: [`Sphere::distance`] operation by operation.
///
/// [`Sphere::distance`]: crate::scene::Sphere::distance
#[inline(always)]
fn hit_spheres<L: Lanes>(l: L, ray: &Ray, pack: &Spheres, best: &mut Hit) -> bool {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    let dot = |p: [L::F; 3], q: [L::F; 3]| l.add(l.add(l.mul(p[0], q[0]), l.mul(p[1], q[1])), l.mul(p[2], q[2]));
    let f = axes(|k| l.sub(l.splat(origin[k]), l.load(&pack.centre[k])));
    let direction = axes(|k| l.splat(direction[k]));
    let radius = l.load(&pack.radius);
    // Times −1 and not 0 minus it, which has another sign where it is 0.
    let b = l.mul(dot(f, direction), l.splat(-1.0));
    let closest = axes(|k| l.add(f[k], l.mul(b, direction[k])));
    let discriminant = l.sub(l.mul(radius, radius), dot(closest, closest));
    let zero = l.splat(0.0);
    if l.le(zero, discriminant) == 0 {
        return false;
    }
    let c = l.sub(dot(f, f), l.mul(radius, radius));
    let q = l.add(b, l.copysign(l.sqrt(discriminant), b));
    let other = l.div(c, q);
    let t = l.positive_or(l.min(other, q), l.max(q, other));
    let mut hits = l.le(zero, t) & l.le(t, l.splat(best.t));
    let t = l.store(t);
    let mut found = false;
    while hits != 0 {
        let i = hits.trailing_zeros() as usize % WIDTH;
        hits &= hits - 1;
        let shape = pack.shape[i];
        if best.is_beaten_by(t[i], shape, 0) {
            *best = Hit { t: t[i], shape, ..Hit::default() };
            found = true;
        }
    }
    found
}
