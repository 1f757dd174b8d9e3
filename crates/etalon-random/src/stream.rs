//! Counter-based random numbers: (seed, pixel, sample, dimension) → random number, so that each is computed by itself.
//!
//! [`Independent`] hashes the counter. [`Sobol`] gives each dimension pair of each pixel its own Owen-scrambled
//! (0,2)-sequence in base 2, shuffled per pair ("padding"): every pair is well stratified over any 2ⁿ consecutive samples,
//! and pairs are independent of each other.
//! Source: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020.

use crate::hash::{GOLDEN, key, mix64, unit_f32, unit_f64};

/// Dimensions are below this number. A pixel takes fewer than 2³² pairs from each: samples times pairs of a sample.
pub const DIMENSIONS: u32 = 1 << 31;

/// A source of uniform random numbers in \[0, 1)² for one camera sample of one pixel.
pub trait Stream: Copy + Send + Sync {
    /// The stream of sample `sample` of pixel number `pixel` under `seed`.
    fn new(seed: u64, pixel: u64, sample: u32) -> Self;

    /// The parts of the stream, from which [`Stream::join`] makes it again.
    fn split(self) -> (u64, u32);

    /// The stream with these parts.
    fn join(key: u64, sample: u32) -> Self;

    /// The pair of random numbers of a dimension, the `index`-th of `count` that this sample takes from it.
    ///
    /// All pairs of a pixel from one dimension, over all its samples, belong to one sequence: 8 samples with 4 pairs each are
    /// as well stratified as 32 samples with one.
    #[inline]
    fn pair_of(&self, dimension: u32, index: u32, count: u32) -> [f64; 2] {
        let (key, sample) = self.split();
        Self::long_pair(Self::in_dimension(key, dimension), sample, dimension, index, count)
    }

    /// The pair of [`Stream::pair_of`] rounded down to 24 bits.
    #[inline]
    fn short_pair_of(self, dimension: u32, index: u32, count: u32) -> [f32; 2] {
        let (key, sample) = self.split();
        Self::short_pair(Self::in_dimension(key, dimension), sample, dimension, index, count)
    }

    /// The key of a dimension, shared by all samples of a pixel.
    fn in_dimension(key: u64, dimension: u32) -> u64;

    /// [`Stream::short_pair_of`] from the parts of the stream, its key [`in_dimension`](Stream::in_dimension).
    fn short_pair(key: u64, sample: u32, dimension: u32, index: u32, count: u32) -> [f32; 2];

    /// [`Stream::pair_of`] from the same parts.
    fn long_pair(key: u64, sample: u32, dimension: u32, index: u32, count: u32) -> [f64; 2];

    /// The pair of random numbers of a dimension from which each sample takes one pair.
    #[inline]
    fn pair(&self, dimension: u32) -> [f64; 2] {
        self.pair_of(dimension, 0, 1)
    }
}

/// Independent uniform random numbers of 53 bits: the words of SplitMix64 under the key of the pixel, each at a place of its own
/// by dimension, sample and index.
#[derive(Debug, Clone, Copy)]
pub struct Independent {
    key: u64,
    sample: u32,
}

impl Stream for Independent {
    #[inline]
    fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        Self { key: key([seed, pixel, 0]), sample }
    }

    #[inline(always)]
    fn split(self) -> (u64, u32) {
        (self.key, self.sample)
    }

    #[inline(always)]
    fn join(key: u64, sample: u32) -> Self {
        Self { key, sample }
    }

    #[inline(always)]
    fn in_dimension(key: u64, _dimension: u32) -> u64 {
        key
    }

    #[inline(always)]
    fn short_pair(key: u64, sample: u32, dimension: u32, index: u32, count: u32) -> [f32; 2] {
        let [a, b] = Self { key, sample }.words(dimension, index, count);
        [unit_f32((a >> 32) as u32), unit_f32((b >> 32) as u32)]
    }

    #[inline(always)]
    fn long_pair(key: u64, sample: u32, dimension: u32, index: u32, count: u32) -> [f64; 2] {
        let [a, b] = Self { key, sample }.words(dimension, index, count);
        [unit_f64(a), unit_f64(b)]
    }
}

impl Independent {
    /// The place of the first word of a pair; the second word follows it. From the top, 31 bits are the dimension, which is below
    /// [`DIMENSIONS`], and 32 bits the number of the pair among all that the pixel takes from the dimension, which is below 2³².
    /// Different pairs of a pixel therefore have different words.
    #[inline(always)]
    fn counter(&self, dimension: u32, index: u32, count: u32) -> u64 {
        debug_assert!(dimension < DIMENSIONS && index < count);
        u64::from(dimension) << 33 | u64::from(self.sample.wrapping_mul(count).wrapping_add(index)) << 1
    }

    #[inline(always)]
    fn words(&self, dimension: u32, index: u32, count: u32) -> [u64; 2] {
        let counter = self.counter(dimension, index, count);
        let at = |i: u64| mix64(self.key.wrapping_add((counter + i).wrapping_add(1).wrapping_mul(GOLDEN)));
        [at(0), at(1)]
    }
}

/// Owen-scrambled Sobol' pairs: 32 stratified bits, filled up to 53 with hashed ones.
#[derive(Debug, Clone, Copy)]
pub struct Sobol {
    key: u64,
    sample: u32,
}

impl Stream for Sobol {
    #[inline]
    fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        Self { key: key([seed, pixel, 0]), sample }
    }

    #[inline(always)]
    fn split(self) -> (u64, u32) {
        (self.key, self.sample)
    }

    #[inline(always)]
    fn join(key: u64, sample: u32) -> Self {
        Self { key, sample }
    }

    #[inline(always)]
    fn in_dimension(key: u64, dimension: u32) -> u64 {
        mix64(key.wrapping_add((u64::from(dimension) + 1).wrapping_mul(GOLDEN)))
    }

    #[inline(always)]
    fn short_pair(key: u64, sample: u32, _dimension: u32, index: u32, count: u32) -> [f32; 2] {
        let [a, b] = Self { key, sample }.words(key, index, count);
        [unit_f32(a), unit_f32(b)]
    }

    #[inline(always)]
    fn long_pair(key: u64, sample: u32, _dimension: u32, index: u32, count: u32) -> [f64; 2] {
        let [x, y] = Self { key, sample }.words(key, index, count);
        let low = mix64(key ^ u64::from(x)) as u32;
        [with_low_bits(x, low), with_low_bits(y, low.rotate_left(16))]
    }
}

impl Sobol {
    /// The stratified bits.
    #[inline(always)]
    fn words(&self, scramble: u64, index: u32, count: u32) -> [u32; 2] {
        let (shuffle, rest) = (scramble as u32, (scramble >> 32) as u32);
        // The shuffle only has to be nested in the index's bits from the top down to keep every prefix of 2ⁿ points.
        let i = owen_reversed(self.sample.wrapping_mul(count).wrapping_add(index).reverse_bits(), shuffle);
        let i = i.reverse_bits();
        let x = owen_reversed(i, rest).reverse_bits();
        let y = owen_reversed(pascal(i), rest ^ 0x5bd1_e995).reverse_bits();
        [x, y]
    }
}

/// 32 stratified bits and 21 hashed ones as a number in \[0, 1).
#[inline(always)]
fn with_low_bits(high: u32, low: u32) -> f64 {
    unit_f64((u64::from(high) << 32) | u64::from(low))
}

/// Owen's nested uniform scramble of a number whose bits are given in reverse (the most significant one lowest):
/// each bit is flipped by a hash of the bits below it, as carries of multiplication and addition do.
///
/// The constants are those of Laine & Karras as searched by Vegdahl (see Burley 2020, section 3).
#[inline(always)]
fn owen_reversed(mut x: u32, seed: u32) -> u32 {
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^ x.wrapping_mul(0x8d22_f6e6)
}

/// The second Sobol' dimension with its bits in reverse: the product of the index's bits with Pascal's triangle mod 2.
///
/// The triangle of size 2ⁿ is the n-fold Kronecker power of that of size 2, so five butterfly steps do it.
#[inline(always)]
fn pascal(mut i: u32) -> u32 {
    i ^= (i & 0xaaaa_aaaa) >> 1;
    i ^= (i & 0xcccc_cccc) >> 2;
    i ^= (i & 0xf0f0_f0f0) >> 4;
    i ^= (i & 0xff00_ff00) >> 8;
    i ^ ((i & 0xffff_0000) >> 16)
}

/// Which [`Stream`] to use, for parameters and file metadata.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StreamKind {
    /// [`Sobol`].
    #[default]
    Sobol,
    /// [`Independent`].
    Independent,
}

/// The sequence of one pixel and dimension as a [`rand`] generator, for distributions of that library.
#[derive(Debug, Clone)]
pub struct CounterRng {
    key: u64,
    counter: u64,
}

impl CounterRng {
    /// Generator number `stream` under `seed`.
    #[inline]
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { key: key([seed, stream, 1]), counter: 0 }
    }
}

impl rand::TryRng for CounterRng {
    type Error = std::convert::Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        self.try_next_u64().map(|x| (x >> 32) as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        self.counter += 1;
        Ok(mix64(self.key.wrapping_add(self.counter.wrapping_mul(GOLDEN))))
    }

    #[inline]
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Self::Error> {
        for chunk in bytes.chunks_mut(8) {
            let word = self.try_next_u64()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pascal_is_the_second_sobol_dimension() {
        for i in (0..1u32 << 12).chain([u32::MAX, 0x8000_0001, 0xdead_beef]) {
            // Direction numbers of the polynomial x + 1: v₁ = 1/2, vₖ₊₁ = vₖ ⊕ vₖ/2.
            let mut v = 1u32 << 31;
            let mut expected = 0;
            for bit in 0..32 {
                if i >> bit & 1 == 1 {
                    expected ^= v;
                }
                v ^= v >> 1;
            }
            assert_eq!(pascal(i).reverse_bits(), expected, "index {i}");
        }
    }

    #[test]
    fn sobol_stratifies_every_elementary_interval() {
        for (pixel, dimension, count) in [(0, 0, 1), (7, 3, 1), (123_456, 9, 4)] {
            let points: Vec<[f64; 2]> = (0..64 / count)
                .flat_map(|s| (0..count).map(move |i| Sobol::new(5, pixel, s).pair_of(dimension, i, count)))
                .collect();
            for bits in 0..=6 {
                let (columns, rows) = (1usize << bits, 1usize << (6 - bits));
                let mut hit = [false; 64];
                for [x, y] in &points {
                    let cell = (x * columns as f64) as usize * rows + (y * rows as f64) as usize;
                    assert!(!std::mem::replace(&mut hit[cell], true), "two points in a {columns}x{rows} cell");
                }
            }
        }
    }

    #[test]
    fn sobol_goes_on_beyond_two_to_the_sixteen() {
        let n = 1 << 17;
        let mut seen = std::collections::HashSet::new();
        for s in 0..n {
            let [x, y] = Sobol::new(1, 2, s).pair(3);
            assert!(seen.insert((x.to_bits(), y.to_bits())), "sample {s} repeats a point");
        }
    }

    #[test]
    fn pairs_of_a_pixel_have_different_counters() {
        // Places near every end of the ranges, as few and as many pairs a sample as there may be.
        let dimensions = [0, 1, 2, 6, 0x3fff_ffff, 0x4000_0000, 0x4000_0001, DIMENSIONS - 1];
        for count in [1u32, 3, 4, 1 << 16] {
            let most = (1u64 << 32) / u64::from(count);
            let samples = [0, 1, 2, most / 2, most - 2, most - 1].map(|sample| sample as u32);
            let mut seen = std::collections::HashMap::new();
            for dimension in dimensions {
                for sample in samples {
                    for index in [0, 1, 2, count / 2, count - 1].into_iter().filter(|&index| index < count) {
                        let stream = Independent::new(1, 2, sample);
                        let first = stream.counter(dimension, index, count);
                        for word in [first, first + 1] {
                            let place = (dimension, sample, index, word - first);
                            let other = *seen.entry(word).or_insert(place);
                            assert_eq!(other, place, "one word for two numbers, {count} pairs a sample");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn streams_are_pure_functions_in_the_unit_square() {
        fn check<S: Stream>() -> f64 {
            let mut sum = 0.0;
            for i in 0..4096u32 {
                let a = S::new(1, u64::from(i / 16), i % 16).pair(2);
                assert_eq!(a, S::new(1, u64::from(i / 16), i % 16).pair(2));
                assert!(a.iter().all(|u| (0.0..1.0).contains(u)));
                let short = S::new(1, u64::from(i / 16), i % 16).short_pair_of(2, 0, 1);
                let floor = |u: f64| ((u * f64::from(1 << 24)).floor() / f64::from(1 << 24)) as f32;
                assert_eq!(short, a.map(floor));
                assert_ne!(a, S::new(2, u64::from(i / 16), i % 16).pair(2), "the seed matters");
                assert_ne!(a, S::new(1, u64::from(i / 16), i % 16).pair(3), "the dimension matters");
                sum += a[0];
            }
            sum / 4096.0
        }
        // Five standard errors of a mean of 4096 uniform numbers.
        let bound = 5.0 / (12.0f64 * 4096.0).sqrt();
        assert!((check::<Independent>() - 0.5).abs() < bound);
        assert!((check::<Sobol>() - 0.5).abs() < bound);
    }
}
