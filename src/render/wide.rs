//! Loops compiled for wide vectors.

use pulp::{Arch, Simd, WithSimd};

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
