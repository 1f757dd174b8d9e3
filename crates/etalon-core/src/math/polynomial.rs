//! Evaluation of polynomials.

use num_traits::Float;

/// The polynomial of ascending coefficients, a multiple of four of them, at `t`.
///
/// Four Horner chains in t⁴ side by side take a third of the time of one.
#[inline(always)]
pub fn polynomial<T: Float, const N: usize>(coefficients: &[T; N], t: T) -> T {
    const { assert!(N.is_multiple_of(4)) };
    let t2 = t * t;
    let t4 = t2 * t2;
    let mut sums = [T::zero(); 4];
    for four in coefficients.as_chunks::<4>().0.iter().rev() {
        for i in 0..4 {
            sums[i] = sums[i] * t4 + four[i];
        }
    }
    (sums[0] + sums[1] * t) + t2 * (sums[2] + sums[3] * t)
}
