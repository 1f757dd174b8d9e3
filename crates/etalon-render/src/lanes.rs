//! Many paths side by side, component by component, so that loops over them vectorize.

use etalon_core::scene::Ray;
use glam::{Vec2, Vec3};
use pulp::{Arch, Simd, WithSimd};
use std::sync::LazyLock;

/// How many paths are followed at once: their arrays fit the nearest caches.
pub const LANES: usize = 256;

/// One number per path.
pub type Lane = [f32; LANES];
/// A vector or colour per path, component by component.
pub type Lane3 = [Lane; 3];

/// Numbers in single precision that the widest vectors hold.
const VECTOR: usize = 16;

/// Lanes that a loop with many intermediate values processes at a time, in local arrays: the compiler then knows that
/// nothing overlaps and vectorizes, and few paths cost little. Of the last block, results beyond the last path are
/// undefined.
pub const BLOCK: usize = 2 * VECTOR;

/// How many blocks `count` lanes fill.
#[inline(always)]
pub fn blocks(count: usize) -> usize {
    count.min(LANES).div_ceil(BLOCK)
}

/// A block of some lanes.
#[inline(always)]
pub fn block<const N: usize>(lanes: &[Lane; N], number: usize) -> [[f32; BLOCK]; N] {
    let mut out = [[0.0; BLOCK]; N];
    for axis in 0..N {
        out[axis] = lanes[axis].as_chunks().0[number];
    }
    out
}

#[inline(always)]
pub fn put<const N: usize>(lanes: &mut [Lane; N], number: usize, block: &[[f32; BLOCK]; N]) {
    for axis in 0..N {
        lanes[axis].as_chunks_mut().0[number] = block[axis];
    }
}

/// In place of the number of an object or a light: there is none.
pub const NONE: u32 = u32::MAX;

pub const ZERO3: Lane3 = [[0.0; LANES]; 3];

/// A value per path, and how those of all paths are stored: numbers and vectors component by component.
pub trait Item: Copy {
    type Column;
    const EMPTY: Self::Column;

    fn get(column: &Self::Column, i: usize) -> Self;

    fn set(column: &mut Self::Column, i: usize, value: Self);
}

impl Item for Vec3 {
    type Column = Lane3;
    const EMPTY: Lane3 = ZERO3;

    #[inline(always)]
    fn get(column: &Lane3, i: usize) -> Self {
        at(column, i)
    }

    #[inline(always)]
    fn set(column: &mut Lane3, i: usize, value: Self) {
        set(column, i, value);
    }
}

impl Item for Ray {
    type Column = Rays;
    const EMPTY: Rays = Rays { origin: ZERO3, direction: ZERO3 };

    #[inline(always)]
    fn get(column: &Rays, i: usize) -> Self {
        column.at(i)
    }

    #[inline(always)]
    fn set(column: &mut Rays, i: usize, value: Self) {
        column.set(i, value);
    }
}

/// Values that are stored one after the other.
macro_rules! plain_items {
    ($($item:ty = $empty:expr),* $(,)?) => { $(
        impl $crate::lanes::Item for $item {
            type Column = [Self; $crate::lanes::LANES];
            const EMPTY: Self::Column = [$empty; $crate::lanes::LANES];

            #[inline(always)]
            fn get(column: &Self::Column, i: usize) -> Self {
                column[i]
            }

            #[inline(always)]
            fn set(column: &mut Self::Column, i: usize, value: Self) {
                column[i] = value;
            }
        }
    )* };
}

/// Rows of values for many paths, of which the first are in use.
pub trait Rows {
    type Row;

    fn count_mut(&mut self) -> &mut usize;

    fn row(&self, i: usize) -> Self::Row;

    fn set_row(&mut self, i: usize, row: Self::Row);

    #[inline(always)]
    fn push(&mut self, row: Self::Row) {
        let count = *self.count_mut();
        self.set_row(count, row);
        *self.count_mut() += 1;
    }

    /// Removes the rows for which `keep` is false. It may change them.
    #[inline(always)]
    fn retain(&mut self, mut keep: impl FnMut(&mut Self, usize) -> bool) {
        let mut kept = 0;
        for i in 0..*self.count_mut() {
            if keep(self, i) {
                if i != kept {
                    self.set_row(kept, self.row(i));
                }
                kept += 1;
            }
        }
        *self.count_mut() = kept;
    }
}

/// Declares a structure of arrays, `Many`, and its row, `One`.
macro_rules! lanes {
    ($(#[$doc:meta])* pub struct $Many:ident of $One:ident { $($(#[$field_doc:meta])* $field:ident: $item:ty,)* }) => {
        $(#[$doc])*
        pub struct $Many {
            /// Rows in use.
            pub count: usize,
            $($(#[$field_doc])* pub $field: <$item as $crate::lanes::Item>::Column,)*
        }

        /// A row.
        #[derive(Clone, Copy)]
        pub struct $One {
            $($(#[$field_doc])* pub $field: $item,)*
        }

        impl Default for $Many {
            fn default() -> Self {
                Self { count: 0, $($field: <$item as $crate::lanes::Item>::EMPTY,)* }
            }
        }

        impl $crate::lanes::Rows for $Many {
            type Row = $One;

            #[inline(always)]
            fn count_mut(&mut self) -> &mut usize {
                &mut self.count
            }

            #[inline(always)]
            fn row(&self, i: usize) -> $One {
                $One { $($field: <$item as $crate::lanes::Item>::get(&self.$field, i),)* }
            }

            #[inline(always)]
            fn set_row(&mut self, i: usize, row: $One) {
                $(<$item as $crate::lanes::Item>::set(&mut self.$field, i, row.$field);)*
            }
        }
    };
}

pub(crate) use {lanes, plain_items};

plain_items! { f32 = 0.0, u32 = 0, bool = false, Vec2 = Vec2::ZERO }

/// Rays with unit directions.
#[derive(Clone)]
pub struct Rays {
    pub origin: Lane3,
    pub direction: Lane3,
}

impl Default for Rays {
    fn default() -> Self {
        Ray::EMPTY
    }
}

impl Rays {
    #[inline(always)]
    pub fn at(&self, i: usize) -> Ray {
        Ray { origin: at(&self.origin, i), direction: at(&self.direction, i) }
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, ray: Ray) {
        set(&mut self.origin, i, ray.origin);
        set(&mut self.direction, i, ray.direction);
    }
}

pub struct Hits {
    /// Distance along the ray.
    pub t: Lane,
    /// Number of the object in [`super::geometry::Geometry`], or [`NONE`].
    pub object: [u32; LANES],
    /// For meshes: index of the triangle in the tree. Like `u` and `v`, stale where anything else was hit.
    pub place: [u32; LANES],
    /// Barycentric weight of the triangle's second corner.
    pub u: Lane,
    /// Barycentric weight of its third corner.
    pub v: Lane,
}

impl Default for Hits {
    fn default() -> Self {
        Self { t: [0.0; LANES], object: [NONE; LANES], place: [0; LANES], u: [0.0; LANES], v: [0.0; LANES] }
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

/// The instruction set of this machine.
static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);

/// Runs a loop, compiled for the widest vectors that the machine has (AVX-512 at most). Nothing is contracted or reordered, so
/// that every machine gets the same bits.
///
/// The closure, and everything that it calls, must be `#[inline(always)]` to be part of that code. It takes its inputs by move and
/// writes to arrays of its own: the compiler then knows that nothing overlaps, which it needs to know to vectorize.
#[inline]
pub fn wide<R>(work: impl FnMut() -> R) -> R {
    ARCH.dispatch(Compiled(work))
}

/// Sets the first `count` values of N lanes to those that `each` finds, in code for wide vectors, [`VECTOR`] at a time;
/// a few beyond the last are unspecified. `each` must be `#[inline(always)]` and move what it reads.
#[inline]
pub fn fill<T: Copy + Default, const N: usize>(
    count: usize,
    out: [&mut [T; LANES]; N],
    each: impl Fn(usize) -> [T; N],
) {
    wide(
        #[inline(always)]
        move || {
            for number in 0..count.min(LANES).div_ceil(VECTOR) {
                let mut found = [[T::default(); VECTOR]; N];
                for k in 0..VECTOR {
                    let values = each(number * VECTOR + k);
                    for axis in 0..N {
                        found[axis][k] = values[axis];
                    }
                }
                for axis in 0..N {
                    out[axis].as_chunks_mut().0[number] = found[axis];
                }
            }
        },
    );
}

/// A loop that is called by reference: by value it would not be inlined.
struct Compiled<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Compiled<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
