//! Hash functions of the counter-based random streams.

/// SplitMix64's output function: a bijection of 64-bit words in which every input bit reaches every output bit.
///
/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (variant 13 of Stafford).
#[inline(always)]
#[must_use]
pub fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A bijection of 32-bit words in which every input bit reaches every output bit.
///
/// Source: Wellons, "Prospecting for hash functions", 2018 (`lowbias32`).
#[inline]
#[must_use]
pub fn mix32(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// 2⁶⁴ divided by the golden ratio: steps of a counter that [`mix64`] turns into a generator.
pub const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A key from several words, in which their order matters.
#[inline]
#[must_use]
pub fn key(words: [u64; 3]) -> u64 {
    words.iter().fold(0, |k, &w| mix64(k.wrapping_add(GOLDEN) ^ w))
}

/// The 53 top bits of `x` as a number in \[0, 1).
#[inline(always)]
#[must_use]
pub fn unit_f64(x: u64) -> f64 {
    (x >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// The 24 top bits of `x` as a number in \[0, 1).
#[inline(always)]
#[must_use]
pub fn unit_f32(x: u32) -> f32 {
    // Convert through i32, for which there is a vector instruction.
    (x >> 8) as i32 as f32 * (1.0 / (1 << 24) as f32)
}
