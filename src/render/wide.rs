//! Loops compiled for wide vectors.

use pulp::{Arch, Simd, WithSimd};

/// Runs `body` in code compiled for the widest vectors that the machine has (AVX2 at most), if the closure is marked
/// `#[inline(always)]`. Nothing is contracted or reordered, so every machine gets the same bits.
#[inline]
pub fn wide(arch: Arch, body: impl FnMut()) {
    arch.dispatch(Body(body));
}

struct Body<F>(F);

impl<F: FnMut()> WithSimd for Body<F> {
    type Output = ();

    // A direct call of the closure: by way of pulp's own closure support it would not be inlined.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        (self.0)();
    }
}
