//! Many paths side by side, component by component, so that loops over them vectorize.

use crate::math::Rgb;
use crate::render::film::PathClass;
use glam::Vec3;

/// How many paths are followed at once: their arrays fit the nearest caches.
pub const LANES: usize = 256;

/// One number per path.
pub type Lane = [f32; LANES];
/// A vector or colour per path, component by component.
pub type Lane3 = [Lane; 3];

/// Lanes that a loop with many intermediate values processes at a time, in local arrays: the compiler then knows that
/// nothing overlaps and vectorizes, and few paths cost little. Of the last block, results beyond the last path are
/// undefined.
pub const BLOCK: usize = 32;

/// One number per path of a block.
pub type Block = [f32; BLOCK];
/// A vector or colour per path of a block.
pub type Block3 = [Block; 3];

/// Zeros.
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

/// Stores a block.
#[inline(always)]
pub fn put<const N: usize>(lanes: &mut [Lane; N], number: usize, block: &[Block; N]) {
    for axis in 0..N {
        lanes[axis].as_chunks_mut().0[number] = block[axis];
    }
}

/// The prefix of a camera path, as far as light tracing depends on it: light paths contribute by way of surfaces that are
/// not diffuse to a diffuse surface that the camera sees, or to one before it.
pub mod caustic {
    /// It has hit nothing yet.
    pub const CAMERA: u32 = 3;
    /// It has left the diffuse surface that the camera sees.
    pub const FIRST_DIFFUSE: u32 = 2;
    /// It has left the second one, or surfaces that are not diffuse after either: emission found next is light traced.
    pub const CHAIN: u32 = 1;
    /// Light tracing contributes nothing along this path.
    pub const NONE: u32 = 0;

    /// The state after a diffuse surface.
    #[inline(always)]
    pub fn after_diffuse(state: u32) -> u32 {
        state.saturating_sub(1)
    }

    /// The state after another surface.
    #[inline(always)]
    pub fn after_other(state: u32) -> u32 {
        if is_light_traced(state) { CHAIN } else { NONE }
    }

    /// Whether light tracing contributes the emission that the path finds next.
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
    /// Where they start.
    pub origin: Lane3,
    /// Of unit length.
    pub direction: Lane3,
}

/// What [`Rays`] hit.
pub struct Hits {
    /// Distance along the ray.
    pub t: Lane,
    /// Number of the object in [`super::geometry::Geometry`], or [`NOTHING`].
    pub object: [u32; LANES],
    /// For meshes: index of the triangle in the tree.
    pub place: [u32; LANES],
    /// Barycentric weight of the triangle's second corner.
    pub u: Lane,
    /// Barycentric weight of its third corner.
    pub v: Lane,
}

/// Paths in flight: the ray of each, and its state.
#[derive(Clone)]
pub struct Paths {
    /// How many entries are in use.
    pub count: usize,
    /// Their rays.
    pub rays: Rays,
    /// Product of BSDF times cosine over pdf so far.
    pub throughput: Lane3,
    /// Pdf of the ray's direction, for the MIS weight against light samples: infinite where light samples cannot find the
    /// same light, 0 where they already have.
    pub pdf: Lane,
    /// The MIS weight of the environment's radiance if the ray leaves the scene.
    pub environment_share: Lane,
    /// The camera sample that the path belongs to.
    pub slot: [u32; LANES],
    /// The kinds of scattering so far.
    pub path_class: [PathClass; LANES],
    /// Of camera paths: see [`caustic`]. Of light paths: whether a diffuse surface has scattered them.
    pub caustic: [u32; LANES],
}

/// Points on diffuse surfaces, with the throughput of their paths.
pub struct Points {
    /// How many entries are in use.
    pub count: usize,
    /// Offset from the surface to the side of the viewer, against self-intersection.
    pub position: Lane3,
    /// Unit normal on the side of the viewer.
    pub normal: Lane3,
    /// Throughput of the path times the surface's albedo.
    pub weight: Lane3,
    /// Of the camera sample.
    pub slot: [u32; LANES],
    /// Scatterings so far.
    pub path_class: [PathClass; LANES],
    /// [`Paths::caustic`] of the paths that continue from here.
    pub caustic: [u32; LANES],
}

/// Rays towards light samples, and the radiance that each adds to its sample if it is not occluded.
pub struct Shadows {
    /// How many entries are in use.
    pub count: usize,
    /// Their rays.
    pub rays: Rays,
    /// Distance of the light.
    pub limit: Lane,
    /// Radiance times throughput.
    pub value: Lane3,
    /// Of the camera sample.
    pub slot: [u32; LANES],
    /// Scatterings so far.
    pub path_class: [PathClass; LANES],
}

/// Zeros.
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
    /// Adds a path with MIS weight 1 for all emission that it finds next.
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

    /// Removes the paths for which `keep` is false.
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
                    (self.slot[j], self.path_class[j], self.caustic[j]) =
                        (self.slot[i], self.path_class[i], self.caustic[i]);
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
