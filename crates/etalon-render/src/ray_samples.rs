//! The random numbers of many camera samples at once: of each depth, by what they are for.
//!
//! A number is a function of seed, pixel, sample and purpose, never of the order in which numbers are asked for.

use super::lanes::{LANES, fill};
use etalon_core::sampling::stream::{DIMENSIONS, Independent, Sobol, Stream, StreamKind};

/// The streams of the camera samples (or light paths) in flight, by slot.
pub struct Streams {
    kind: StreamKind,
    seed: u64,
    key: [u64; LANES],
    sample: [u32; LANES],
}

impl Streams {
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

    pub fn film(&self) -> Dimension<'_> {
        Dimension { streams: self, dimension: 0 }
    }
}

/// Which of several random numbers for one purpose, and how many there are.
#[derive(Debug, Clone, Copy)]
pub struct SubSample {
    pub index: u32,
    pub count: u32,
}

impl SubSample {
    pub const ONLY: Self = Self { index: 0, count: 1 };
}

/// The random numbers of one depth: a pair for each purpose. Depth 0 is the first hit.
#[derive(Clone, Copy)]
pub struct RaySamples<'a> {
    /// The direction in which a path continues.
    pub bsdf: Dimension<'a>,
    /// The choice of a lobe, and Russian roulette. At the start of a light path the choice of light and target.
    pub choice: Dimension<'a>,
    /// Directions of direct light that are sampled without regard to the lights. At the start of a light path the place on
    /// the light.
    pub direct: Dimension<'a>,
    pub environment: Dimension<'a>,
    pub light_choice: Dimension<'a>,
}

impl<'a> RaySamples<'a> {
    /// Purposes besides one per round of light samples.
    const OTHERS: u32 = 5;

    /// The first dimension of light paths.
    const LIGHT_PATHS: u32 = DIMENSIONS / 2;

    /// Those of camera paths, with that many rounds of light samples at each hit. Dimension 0 is the position on the film.
    pub fn of_camera_paths(streams: &'a Streams, depth: u32, rounds: usize) -> Self {
        let each = Self::OTHERS + rounds as u32;
        Self::from(streams, depth.wrapping_mul(each).wrapping_add(1))
    }

    /// Those of light paths after n scatterings, 0 for their start: beyond those of camera paths.
    pub fn of_light_paths(streams: &'a Streams, scatterings: u32) -> Self {
        Self::from(streams, Self::LIGHT_PATHS + scatterings * Self::OTHERS)
    }

    fn from(streams: &'a Streams, first: u32) -> Self {
        let [bsdf, choice, direct, environment, light_choice] =
            [0, 1, 2, 3, 4].map(|i| Dimension { streams, dimension: first + i });
        Self { bsdf, choice, direct, environment, light_choice }
    }

    /// Light samples of a round.
    pub fn light(self, round: usize) -> Dimension<'a> {
        Dimension { dimension: self.bsdf.dimension + Self::OTHERS + round as u32, ..self.bsdf }
    }

    /// Whether camera paths of that depth stay below the dimensions of light paths.
    pub fn suffice(max_depth: u32, rounds: usize) -> bool {
        (u64::from(max_depth) + 1) * (u64::from(Self::OTHERS) + rounds as u64) < u64::from(Self::LIGHT_PATHS)
    }
}

/// A dimension of the samples: the pairs of random numbers for one purpose.
#[derive(Clone, Copy)]
pub struct Dimension<'a> {
    streams: &'a Streams,
    dimension: u32,
}

impl Dimension<'_> {
    /// The pairs of the given slots, in single precision as [`Stream::short_pair_of`] has them and in double precision as
    /// [`Stream::pair_of`] has.
    #[inline(always)]
    pub fn get_2d_lanes<T: Precision>(self, slots: &[u32], sub: SubSample) -> [[T; LANES]; 2] {
        let mut out = [[T::default(); LANES]; 2];
        match self.streams.kind {
            StreamKind::Sobol => self.fill::<Sobol, T>(slots, sub, &mut out),
            StreamKind::Independent => self.fill::<Independent, T>(slots, sub, &mut out),
        }
        out
    }

    fn fill<S: Stream, T: Precision>(self, slots: &[u32], sub: SubSample, out: &mut [[T; LANES]; 2]) {
        let Self { streams, dimension } = self;
        let (mut key, mut sample) = ([0; LANES], [0; LANES]);
        // Neighbours mostly belong to one pixel.
        let mut last = None;
        for (i, &slot) in slots.iter().enumerate() {
            let slot = slot as usize % LANES;
            let prepared = match last {
                Some((from, prepared)) if from == streams.key[slot] => prepared,
                _ => S::in_dimension(streams.key[slot], dimension),
            };
            last = Some((streams.key[slot], prepared));
            (key[i], sample[i]) = (prepared, streams.sample[slot]);
        }
        let (key, sample) = (&key, &sample);
        fill(
            slots.len(),
            out.each_mut(),
            #[inline(always)]
            move |i| T::pair::<S>(key[i], sample[i], dimension, sub),
        );
    }

    /// The pair of one slot.
    #[inline]
    pub fn get_2d<T: Precision>(self, slot: u32, sub: SubSample) -> [T; 2] {
        let Self { streams, dimension } = self;
        let (key, sample) = (streams.key[slot as usize % LANES], streams.sample[slot as usize % LANES]);
        match streams.kind {
            StreamKind::Sobol => T::pair::<Sobol>(Sobol::in_dimension(key, dimension), sample, dimension, sub),
            StreamKind::Independent => {
                T::pair::<Independent>(Independent::in_dimension(key, dimension), sample, dimension, sub)
            }
        }
    }
}

/// A precision of random numbers.
pub trait Precision: Copy + Default {
    /// The pair of a stream, from its parts.
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, sub: SubSample) -> [Self; 2];
}

impl Precision for f32 {
    #[inline(always)]
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, SubSample { index, count }: SubSample) -> [Self; 2] {
        S::short_pair(key, sample, dimension, index, count)
    }
}

impl Precision for f64 {
    #[inline(always)]
    fn pair<S: Stream>(key: u64, sample: u32, dimension: u32, SubSample { index, count }: SubSample) -> [Self; 2] {
        S::long_pair(key, sample, dimension, index, count)
    }
}
