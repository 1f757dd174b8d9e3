//! A function of every element of an array.

/// `f` of every element. The standard library's `map` is not guaranteed to be inlined, and then the loop that calls it does not
/// vectorize.
#[inline(always)]
pub fn map_array<A: Copy, B: Copy, const N: usize>(a: [A; N], f: impl Fn(A) -> B) -> [B; N] {
    let mut all = [f(a[0]); N];
    for i in 1..N {
        all[i] = f(a[i]);
    }
    all
}
