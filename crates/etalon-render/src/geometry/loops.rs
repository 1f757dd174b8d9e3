//! Loops over rays against one shape or box, which vectorize.

use crate::lanes::{Hits, LANES, Lane, Rays, Wide, at};
use crate::solids::Solid;
use glam::Vec3;

/// The loop over all rays that looks for the nearest hit.
pub struct Nearest<'a, S> {
    pub solid: &'a S,
    pub object: u32,
    pub rays: &'a Rays,
    pub count: usize,
    pub hits: &'a mut Hits,
}

impl<S: Solid> Wide for Nearest<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { solid, object, rays, count, hits } = self;
        let (t, objects) = (&mut hits.t, &mut hits.object);
        for i in 0..count.min(LANES) {
            let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
            let hit = (found >= 0.0) & (found < t[i]);
            t[i] = if hit { found } else { t[i] };
            objects[i] = if hit { object } else { objects[i] };
        }
    }
}

/// The loop over all rays that looks for any hit.
pub struct Blocked<'a, S> {
    pub solid: &'a S,
    pub rays: &'a Rays,
    pub count: usize,
    pub limit: &'a Lane,
    pub blocked: &'a mut [u32; LANES],
}

impl<S: Solid> Wide for Blocked<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { solid, rays, count, limit, blocked } = self;
        for i in 0..count.min(LANES) {
            let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
            blocked[i] |= u32::from((found >= 0.0) & (found < limit[i]));
        }
    }
}

/// The loop over all rays that asks which of them reach a box: `reach` is the distance up to which
/// the tree is to be searched, 0 if not at all.
pub struct Reach<'a> {
    pub bounds: [Vec3; 2],
    pub rays: &'a Rays,
    pub count: usize,
    pub limit: &'a Lane,
    pub reach: &'a mut Lane,
}

impl Wide for Reach<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { bounds: [low, high], rays, count, limit, reach } = self;
        for i in 0..count.min(LANES) {
            let (origin, inverse) = (at(&rays.origin, i), at(&rays.direction, i).recip());
            let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
            // 0 · ∞ on the face of a slab is NaN, which max and min pass over.
            let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
            let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z)).min(limit[i]);
            reach[i] = if near <= far { limit[i] } else { 0.0 };
        }
    }
}
