//! The random numbers of many camera samples at once.

use super::lanes::{LANES, Wide, wide};
use etalon_core::sampling::stream::{Independent, Sobol, Stream, StreamKind};
use pulp::Arch;
use std::marker::PhantomData;

/// The streams of the camera samples in flight, by slot.
pub struct SampleLanes {
    kind: StreamKind,
    seed: u64,
    key: [u64; LANES],
    sample: [u32; LANES],
}

impl SampleLanes {
    /// Streams of this kind; no slot is assigned yet.
    pub fn new(kind: StreamKind, seed: u64) -> Self {
        Self { kind, seed, key: [0; LANES], sample: [0; LANES] }
    }

    /// Gives a slot to a camera sample of a pixel.
    #[inline]
    pub fn assign(&mut self, slot: usize, pixel: u64, sample: u32) {
        (self.key[slot], self.sample[slot]) = match self.kind {
            StreamKind::Sobol => Sobol::new(self.seed, pixel, sample).split(),
            StreamKind::Independent => Independent::new(self.seed, pixel, sample).split(),
        };
    }

    /// The pairs of a dimension for the given slots, in single precision as [`Stream::short_pair_of`] has them and in double
    /// precision as [`Stream::pair_of`] has; `sub_sample` is an index and their number.
    pub fn fill<T: Precision>(
        &self,
        arch: Arch,
        slots: &[u32],
        dimension: u32,
        sub_sample: (u32, u32),
        out: &mut [[T; LANES]; 2],
    ) {
        match self.kind {
            StreamKind::Sobol => self.fill_with::<Sobol, T>(arch, slots, dimension, sub_sample, out),
            StreamKind::Independent => self.fill_with::<Independent, T>(arch, slots, dimension, sub_sample, out),
        }
    }

    fn fill_with<S: Stream, T: Precision>(
        &self,
        arch: Arch,
        slots: &[u32],
        dimension: u32,
        sub_sample: (u32, u32),
        out: &mut [[T; LANES]; 2],
    ) {
        let mut key = [0; LANES];
        let mut sample = [0; LANES];
        // Neighbours mostly belong to one pixel.
        let mut last = None;
        for (i, &slot) in slots.iter().enumerate() {
            let slot = slot as usize % LANES;
            let prepared = match last {
                Some((from, prepared)) if from == self.key[slot] => prepared,
                _ => S::in_dimension(self.key[slot], dimension),
            };
            last = Some((self.key[slot], prepared));
            (key[i], sample[i]) = (prepared, self.sample[slot]);
        }
        let (key, sample, count, stream) = (&key, &sample, slots.len(), PhantomData::<S>);
        wide(arch, Fill { key, sample, count, dimension, sub_sample, out, stream });
    }

    /// The pair of a dimension for one slot.
    #[inline]
    pub fn pair(&self, slot: u32, dimension: u32, (index, count): (u32, u32)) -> [f64; 2] {
        let (key, sample) = (self.key[slot as usize % LANES], self.sample[slot as usize % LANES]);
        match self.kind {
            StreamKind::Sobol => Sobol::join(key, sample).pair_of(dimension, index, count),
            StreamKind::Independent => Independent::join(key, sample).pair_of(dimension, index, count),
        }
    }

    /// [`SampleLanes::pair`] rounded down to 24 bits.
    #[inline]
    pub fn short_pair(&self, slot: u32, dimension: u32, (index, count): (u32, u32)) -> [f32; 2] {
        let (key, sample) = (self.key[slot as usize % LANES], self.sample[slot as usize % LANES]);
        match self.kind {
            StreamKind::Sobol => Sobol::join(key, sample).short_pair_of(dimension, index, count),
            StreamKind::Independent => Independent::join(key, sample).short_pair_of(dimension, index, count),
        }
    }
}

/// A precision of random numbers.
pub trait Precision: Sized {
    /// The pair of a stream, from its parts.
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, sub_sample: (u32, u32)) -> [Self; 2];
}

impl Precision for f32 {
    #[inline(always)]
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, (index, count): (u32, u32)) -> [Self; 2] {
        S::short_pair(key, sample, dimension, index, count)
    }
}

impl Precision for f64 {
    #[inline(always)]
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, (index, count): (u32, u32)) -> [Self; 2] {
        S::long_pair(key, sample, dimension, index, count)
    }
}

struct Fill<'a, S, T> {
    key: &'a [u64; LANES],
    sample: &'a [u32; LANES],
    count: usize,
    dimension: u32,
    sub_sample: (u32, u32),
    out: &'a mut [[T; LANES]; 2],
    stream: PhantomData<S>,
}

impl<S: Stream, T: Precision> Wide for Fill<'_, S, T> {
    #[inline(always)]
    fn run(self) {
        let Self { key, sample, count, dimension, sub_sample, out, .. } = self;
        for i in 0..count.min(LANES) {
            [out[0][i], out[1][i]] = T::pair::<S>(key[i], sample[i], dimension, sub_sample);
        }
    }
}
