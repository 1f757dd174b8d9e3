//! Many paths side by side, component by component, so that loops over them vectorize, and are compiled for wide vectors.

use glam::Vec3;
use pulp::{Arch, Simd, WithSimd};

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

/// A loop whose iterations do not depend on each other.
pub trait Wide {
    /// Runs the loop. Everything that it calls must be `#[inline(always)]`, so as to become part of [`wide`].
    fn run(self);
}

/// Runs a loop in code compiled for the widest vectors that the machine has (AVX-512 at most).
///
/// Nothing is contracted or reordered, so every machine gets the same bits.
#[inline]
pub fn wide(arch: Arch, work: impl Wide) {
    arch.dispatch(Compiled(work));
}

struct Compiled<W>(W);

impl<W: Wide> WithSimd for Compiled<W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.run();
    }
}
