//! Loops over rays against one shape or box, which vectorize.

use crate::lanes::{Hits, LANES, Lane, Rays, at, fill, wide};
use crate::solids::Solid;
use glam::Vec3;
use pulp::Arch;

/// Looks for the nearest hit of each ray.
pub fn nearest(arch: Arch, solid: &impl Solid, object: u32, rays: &Rays, count: usize, hits: &mut Hits) {
    let (t, objects) = (&mut hits.t, &mut hits.object);
    wide(
        arch,
        #[inline(always)]
        move || {
            for i in 0..count.min(LANES) {
                let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
                let hit = (found >= 0.0) & (found < t[i]);
                t[i] = if hit { found } else { t[i] };
                objects[i] = if hit { object } else { objects[i] };
            }
        },
    );
}

/// Looks for any hit of each ray that is nearer than its `t_max`.
pub fn blocked(arch: Arch, solid: &impl Solid, rays: &Rays, count: usize, t_max: &Lane, blocked: &mut [u32; LANES]) {
    wide(
        arch,
        #[inline(always)]
        move || {
            for i in 0..count.min(LANES) {
                let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
                blocked[i] |= u32::from((found >= 0.0) & (found < t_max[i]));
            }
        },
    );
}

/// For each ray the distance up to which a tree in a box is to be searched: its `t_max`, or 0 if it does not reach the box.
pub fn reach(arch: Arch, [low, high]: [Vec3; 2], rays: &Rays, count: usize, t_max: &Lane) -> Lane {
    let mut reach = [0.0; LANES];
    fill(
        arch,
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
