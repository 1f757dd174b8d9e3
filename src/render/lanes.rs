//! Many paths side by side, component by component, so that loops over them vectorize.

use crate::math::Rgb;
use crate::render::film::PathClass;
use glam::Vec3;

/// How many paths are followed at once: their arrays fit the nearest caches.
pub const LANES: usize = 256;

pub type Lane = [f32; LANES];
pub type Lane3 = [Lane; 3];

/// Lanes that a loop with much to remember takes at a time, in local arrays: the compiler then knows that nothing
/// overlaps, which it needs to know to vectorize, and few paths cost little. The last block may be filled in part; what
/// comes out behind the last path means nothing.
pub const BLOCK: usize = 32;

pub type Block = [f32; BLOCK];
pub type Block3 = [Block; 3];

pub const ZERO_BLOCK3: Block3 = [[0.0; BLOCK]; 3];

/// How many blocks `count` lanes fill.
#[inline(always)]
pub fn blocks(count: usize) -> usize {
    count.min(LANES).div_ceil(BLOCK)
}

/// A block of some lanes.
#[inline(always)]
pub fn block<const N: usize>(lanes: &[Lane; N], number: usize) -> [Block; N] {
    let mut out = [[0.0; BLOCK]; N];
    for axis in 0..N {
        out[axis] = lanes[axis].as_chunks().0[number];
    }
    out
}

/// Puts a block back.
#[inline(always)]
pub fn put<const N: usize>(lanes: &mut [Lane; N], number: usize, block: &[Block; N]) {
    for axis in 0..N {
        lanes[axis].as_chunks_mut().0[number] = block[axis];
    }
}

/// States of a camera path while paths from the lamps may bring the light along it: by way of surfaces that are not
/// diffuse to one that the camera sees, or to one that is seen from there.
pub mod caustic {
    /// It has met nothing.
    pub const CAMERA: u32 = 3;
    /// It comes from the diffuse surface that the camera sees.
    pub const FIRST_DIFFUSE: u32 = 2;
    /// It comes from the second one, or from surfaces that are not diffuse after either: these bring the lamps' light.
    pub const CHAIN: u32 = 1;
    /// Paths from the lamps bring none of its light.
    pub const NONE: u32 = 0;

    /// After a diffuse surface.
    #[inline(always)]
    pub fn after_diffuse(state: u32) -> u32 {
        state.saturating_sub(1)
    }

    /// After another one.
    #[inline(always)]
    pub fn after_other(state: u32) -> u32 {
        if is_light_traced(state) { CHAIN } else { NONE }
    }

    /// Whether light of the lamps that the path meets next is brought.
    #[inline(always)]
    pub fn is_light_traced(state: u32) -> bool {
        state == FIRST_DIFFUSE || state == CHAIN
    }
}

/// No object: the ray left the scene.
pub const NOTHING: u32 = u32::MAX;

/// Rays with unit directions.
#[derive(Clone)]
pub struct Rays {
    pub origin: Lane3,
    pub direction: Lane3,
}

/// What [`Rays`] hit.
pub struct Hits {
    pub t: Lane,
    /// Number of the object in [`super::geometry::Geometry`], or [`NOTHING`].
    pub object: [u32; LANES],
    /// For meshes: where the tree keeps the triangle, and the place on it.
    pub place: [u32; LANES],
    pub u: Lane,
    pub v: Lane,
}

/// Paths that go on: the ray of each, and what it has been through.
#[derive(Clone)]
pub struct Paths {
    pub count: usize,
    pub rays: Rays,
    pub throughput: Lane3,
    /// Density with which the ray's direction was sampled, for weighing the light it finds against light samples:
    /// infinite when no light sample could have found the same light, 0 when that light was sampled already.
    pub pdf: Lane,
    /// The share of the environment's light that the ray brings if it leaves the scene; the rest was sampled already.
    pub environment_share: Lane,
    /// The camera sample that the path belongs to.
    pub slot: [u32; LANES],
    /// What scattered the path so far.
    pub path_class: [PathClass; LANES],
    /// Whether the lamps' light along this path is brought by paths from the lamps, see [`caustic`]. Of those themselves:
    /// whether a diffuse surface has scattered them.
    pub caustic: [u32; LANES],
}

/// Points on surfaces, with the light that their paths still carry.
pub struct Points {
    pub count: usize,
    /// Just off the surface on the side of the viewer, so that no ray from here meets it by rounding.
    pub position: Lane3,
    /// Unit normal on the side of the viewer.
    pub normal: Lane3,
    /// Throughput of the path times the surface's albedo.
    pub weight: Lane3,
    pub slot: [u32; LANES],
    pub path_class: [PathClass; LANES],
    /// [`Paths::caustic`] of the paths that go on from here.
    pub caustic: [u32; LANES],
}

/// Rays towards light samples, and what each brings if nothing is in its way.
pub struct Shadows {
    pub count: usize,
    pub rays: Rays,
    /// Where the light is.
    pub limit: Lane,
    pub value: Lane3,
    pub slot: [u32; LANES],
    pub path_class: [PathClass; LANES],
}

pub const ZERO3: Lane3 = [[0.0; LANES]; 3];

impl Default for Rays {
    fn default() -> Self {
        Self { origin: ZERO3, direction: ZERO3 }
    }
}

impl Default for Hits {
    fn default() -> Self {
        Self { t: [0.0; LANES], object: [NOTHING; LANES], place: [0; LANES], u: [0.0; LANES], v: [0.0; LANES] }
    }
}

impl Default for Paths {
    fn default() -> Self {
        Self {
            count: 0,
            rays: Rays::default(),
            throughput: ZERO3,
            pdf: [0.0; LANES],
            environment_share: [0.0; LANES],
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
            caustic: [0; LANES],
        }
    }
}

impl Default for Points {
    fn default() -> Self {
        Self {
            count: 0,
            position: ZERO3,
            normal: ZERO3,
            weight: ZERO3,
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
            caustic: [0; LANES],
        }
    }
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            count: 0,
            rays: Rays::default(),
            limit: [0.0; LANES],
            value: ZERO3,
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
        }
    }
}

impl Paths {
    /// Adds a path whose ray finds all the light that it meets.
    #[inline(always)]
    pub fn push(&mut self, origin: Vec3, direction: Vec3, throughput: Rgb, slot: u32, path_class: PathClass) {
        let i = self.count;
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        set(&mut self.throughput, i, throughput);
        self.pdf[i] = f32::INFINITY;
        self.environment_share[i] = 1.0;
        self.slot[i] = slot;
        self.path_class[i] = path_class;
        self.caustic[i] = 0;
        self.count += 1;
    }

    /// Drops those paths that `keep` does not want.
    pub fn retain(&mut self, mut keep: impl FnMut(&mut Self, usize) -> bool) {
        let count = std::mem::take(&mut self.count);
        for i in 0..count {
            if keep(self, i) {
                let j = self.count;
                if i != j {
                    for lane in self.rays.origin.iter_mut().chain(&mut self.rays.direction).chain(&mut self.throughput)
                    {
                        lane[j] = lane[i];
                    }
                    (self.pdf[j], self.environment_share[j]) = (self.pdf[i], self.environment_share[i]);
                    (self.slot[j], self.path_class[j], self.caustic[j]) = (self.slot[i], self.path_class[i], self.caustic[i]);
                }
                self.count += 1;
            }
        }
    }
}

impl Shadows {
    /// Adds a ray.
    #[inline(always)]
    pub fn push(&mut self, origin: Vec3, direction: Vec3, limit: f32, value: Rgb, slot: u32, path_class: PathClass) {
        let i = self.count;
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        set(&mut self.value, i, value);
        self.limit[i] = limit;
        self.slot[i] = slot;
        self.path_class[i] = path_class;
        self.count += 1;
    }
}

/// Component `i` of three lanes.
#[inline(always)]
pub fn at<const N: usize>(lanes: &[[f32; N]; 3], i: usize) -> Vec3 {
    Vec3::new(lanes[0][i], lanes[1][i], lanes[2][i])
}

/// Sets component `i` of three lanes.
#[inline(always)]
pub fn set<const N: usize>(lanes: &mut [[f32; N]; 3], i: usize, value: Vec3) {
    lanes[0][i] = value.x;
    lanes[1][i] = value.y;
    lanes[2][i] = value.z;
}
