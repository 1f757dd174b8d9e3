//! A ray's way through the tree, and where it meets triangles.
//!
//! The answer depends on the triangles alone, not on the tree, the processor or the number of threads: triangles are
//! tested by the same operations in the same order everywhere, boxes are passed over only when nothing in them can be
//! hit, and of two hits at the same distance the lower number counts.

use super::MeshHit;
use super::lanes::{Lanes, WIDTH};
use super::tree::{LEAF, Node, Pack, Tree};
use crate::scene::camera::Ray;
use crate::scene::mesh::Mesh;
use glam::Vec3;

/// Boxes still to be looked into: the distance to each and its number.
pub type Stack = Vec<(f32, u32)>;

/// The nearest hit with 0 < t < `t_max`; with `ANY` the first one that is found.
#[inline(always)]
pub fn trace<L: Lanes, const ANY: bool>(
    l: L,
    tree: &Tree,
    ray: &Ray,
    t_max: f32,
    stack: &mut Stack,
) -> Option<MeshHit> {
    // Within these limits no operation on boxes gives NaN.
    let sound = ray.origin.abs().cmple(Vec3::splat(Mesh::FARTHEST)).all() && ray.direction.is_finite();
    if tree.nodes.is_empty() || !(sound && t_max > 0.0) {
        return None;
    }
    let slabs = Slabs::new(l, ray, tree.extent);
    let shear = Shear::new(l, ray);
    let mut best = MeshHit { t: t_max, triangle: 0, u: 0.0, v: 0.0 };
    let mut found = false;
    stack.clear();
    let mut current = 0;
    loop {
        if current & LEAF == 0 {
            let node = &tree.nodes[current as usize];
            let (distance, mut boxes) = slabs.meet(l, node, best.t);
            if boxes.is_power_of_two() {
                current = node.child[boxes.trailing_zeros() as usize % WIDTH];
                continue;
            }
            let base = stack.len();
            while boxes != 0 {
                let i = boxes.trailing_zeros() as usize % WIDTH;
                boxes &= boxes - 1;
                stack.push((distance[i], node.child[i]));
                if !ANY {
                    // The nearest on top.
                    let mut at = stack.len() - 1;
                    while at > base && stack[at - 1].0 < stack[at].0 {
                        stack.swap(at - 1, at);
                        at -= 1;
                    }
                }
            }
        } else {
            let pack = &tree.packs[(current & !LEAF) as usize];
            found |= shear.hit(l, pack, &mut best);
            if ANY && found {
                break;
            }
        }
        match std::iter::from_fn(|| stack.pop()).find(|next| next.0 <= best.t) {
            Some(next) => current = next.1,
            None => break,
        }
    }
    found.then_some(best)
}

/// One value per axis. Unlike those of the standard library it is inlined for certain, without which the closure
/// would be compiled without AVX2.
#[inline(always)]
fn axes<T>(f: impl Fn(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}

/// What the test against boxes needs of a ray. Every box is taken larger by more than the rounding errors of this test
/// and of the one against triangles.
struct Slabs<L: Lanes> {
    /// One over the direction, per axis.
    inverse: [L::F; 3],
    /// Origin over direction, the origin moved so that the near and the far faces move outwards.
    near: [L::F; 3],
    far: [L::F; 3],
    /// Which of a node's faces are met first.
    first: [usize; 3],
}

/// Components of a direction below this are taken as this: they move a ray by less than the margin of the boxes.
const FLATTEST: f32 = 1e-18;

/// Relative margin of the boxes: the tests make up to ten roundings of 2⁻²⁴ each.
const MARGIN: f32 = 8.0 * f32::EPSILON;

impl<L: Lanes> Slabs<L> {
    #[inline(always)]
    fn new(l: L, ray: &Ray, extent: f32) -> Self {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let margin = MARGIN * (origin.iter().fold(0.0, |m: f32, x| m.max(x.abs())) + extent);
        let inverse = axes(|i| 1.0 / direction[i].abs().max(FLATTEST).copysign(direction[i]));
        let moved =
            |sign: f32| axes(|i| l.splat((origin[i] + (sign * margin).copysign(sign * inverse[i])) * inverse[i]));
        Self {
            inverse: axes(|i| l.splat(inverse[i])),
            near: moved(1.0),
            far: moved(-1.0),
            first: axes(|i| if inverse[i] < 0.0 { i + 3 } else { i }),
        }
    }

    /// The boxes met before `limit`, as bits, and the distance to each.
    #[inline(always)]
    fn meet(&self, l: L, node: &Node, limit: f32) -> ([f32; WIDTH], u32) {
        let face = |i: usize, origin: [L::F; 3], axis: usize| {
            l.mul_sub(l.load(&node.faces[i]), self.inverse[axis], origin[axis])
        };
        let enter = |axis: usize| face(self.first[axis], self.near, axis);
        let leave = |axis: usize| face((self.first[axis] + 3) % 6, self.far, axis);
        let from = l.max(l.max(enter(0), enter(1)), l.max(enter(2), l.splat(0.0)));
        let to = l.min(l.min(leave(0), leave(1)), l.min(leave(2), l.splat(limit)));
        (l.store(from), l.le(from, to))
    }
}

/// What the test against triangles needs of a ray: the shear that makes it the z axis.
///
/// The edge functions of the sheared triangle have the right sign or are 0: they are differences of two rounded
/// products, rounding keeps the order of the products, and the difference of two floats has the right sign. An edge
/// has the same function in both its triangles, up to sign, and 0 counts as inside: so no ray slips between
/// triangles, and a triangle without area, or seen edge on, is not hit. Source: Woop, Benthin, Wald, "Watertight
/// ray/triangle intersection", *Journal of Computer Graphics Techniques* 2(1), 2013 (the edge functions; the paper takes
/// those that are 0 again in double precision).
struct Shear<L: Lanes> {
    /// The axes, the last one that along which the direction is longest.
    order: [usize; 3],
    origin: [L::F; 3],
    direction: [L::F; 3],
    x: L::F,
    y: L::F,
    z: L::F,
}

impl<L: Lanes> Shear<L> {
    #[inline(always)]
    fn new(l: L, ray: &Ray) -> Self {
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
            origin: axes(|k| l.splat(origin[order[k]])),
            direction: axes(|k| l.splat(d[order[k]])),
            x: l.splat(d[order[0]] * inverse),
            y: l.splat(d[order[1]] * inverse),
            z: l.splat(inverse),
        }
    }

    /// Replaces `best` by a hit in front of it, if there is one.
    #[inline(always)]
    fn hit(&self, l: L, pack: &Pack, best: &mut MeshHit) -> bool {
        let relative = |i: usize| axes(|k| l.sub(l.load(&pack.corner[i][self.order[k]]), self.origin[k]));
        let sheared = |[x, y, z]: [L::F; 3]| [l.sub(x, l.mul(self.x, z)), l.sub(y, l.mul(self.y, z)), z];
        let origin_to_a = relative(0);
        let [a, b, c] = [sheared(origin_to_a), sheared(relative(1)), sheared(relative(2))];
        let edge = |p: [L::F; 3], q: [L::F; 3]| l.sub(l.mul(p[0], q[1]), l.mul(p[1], q[0]));
        let [w, u, v] = [edge(c, b), edge(a, c), edge(b, a)];
        let zero = l.splat(0.0);
        let inside = l.le(zero, l.min(l.min(u, v), w)) | l.le(l.max(l.max(u, v), w), zero);
        if inside == 0 {
            return false;
        }
        let dot = |p: [L::F; 3], q: [L::F; 3]| l.add(l.add(l.mul(p[0], q[0]), l.mul(p[1], q[1])), l.mul(p[2], q[2]));
        // Infinite when the triangle is seen edge on; its t is then NaN.
        let scale = l.div(l.splat(1.0), l.add(l.add(u, v), w));
        let (w, u, v) = (l.mul(w, scale), l.mul(u, scale), l.mul(v, scale));
        let t = l.mul(dot([w, u, v], [a[2], b[2], c[2]]), self.z);
        // The weights of a sliver are not accurate, so its t may come out above 0 for a ray that starts just in front of
        // it. The side on which the ray starts is certain.
        let normal = axes(|k| l.load(&pack.normal[self.order[k]]));
        let ahead = l.mul(dot(normal, origin_to_a), dot(normal, self.direction));
        let mut hits = inside & !l.le(ahead, zero) & !l.le(t, zero) & l.le(t, l.splat(best.t));
        if hits == 0 {
            return false;
        }
        let (t, u, v) = (l.store(t), l.store(u), l.store(v));
        let mut found = false;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize % WIDTH;
            hits &= hits - 1;
            let triangle = pack.triangle[i];
            if t[i] < best.t || (t[i] == best.t && triangle < best.triangle) {
                *best = MeshHit { t: t[i], triangle, u: u[i], v: v[i] };
                found = true;
            }
        }
        found
    }
}
