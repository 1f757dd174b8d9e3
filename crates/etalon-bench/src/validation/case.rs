//! A named test, ready to run: the element of a suite.

use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_core::memory;
use etalon_core::sampling::hash;
use etalon_stats::{
    Density, DensityFn, Domain, NoInverse, Outcome, Point, Protocol, Sample, Sampler, SamplerFn, density, examine,
    sampler,
};
use glam::DVec3;

/// One round of a test; see [`examine`].
type Test = dyn Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync;

/// A test with a name.
pub struct Case {
    /// Words separated by `/`, from the general to the special (`normals/beckmann/visible/0.05/60`).
    pub name: String,
    pub(super) test: Box<Test>,
    /// Computes values that the test shares with others, so that parallel tests do not repeat it.
    pub(super) preparation: Option<Box<dyn Fn() + Send + Sync>>,
    /// Bytes of its tables, if they are large.
    pub(super) memory: usize,
}

/// A sampler of directions without an inverse.
pub type DirectionSampler<F> = SamplerFn<F, NoInverse>;

/// The sampler of directions from two random numbers.
pub fn direction_sampler<F: Fn([f64; 2]) -> Option<DVec3> + Sync>(
    sample: F,
) -> DirectionSampler<impl Fn(&[f64]) -> Option<Sample> + Sync + use<F>> {
    sampler(2, move |u| sample([u[0], u[1]]).map(|w| Sample::new(w.to_array())))
}

/// The [`density`] of directions whose pdf per solid angle is `pdf`.
pub fn direction_density<F: Fn(DVec3) -> f64 + Sync>(pdf: F) -> DensityFn<impl Fn(Point) -> f64 + Sync + use<F>> {
    density(move |w: [f64; 3]| pdf(DVec3::from_array(w)))
}

/// Tests with tables of more bytes than this run one after the other.
const LARGE: usize = 1 << 26;

impl Case {
    /// A test of any kind.
    pub fn new(
        name: impl Into<String>,
        test: impl Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), test: Box::new(test), preparation: None, memory: 0 }
    }

    /// Whether no other test must run beside this one, which uses all threads itself.
    pub(super) fn is_large(&self) -> bool {
        self.memory > LARGE
    }

    /// The test of a sampler against its pdf. `make` builds both, when the test runs and not before: tables of large maps
    /// need not all exist at once.
    pub fn of<D, S, P>(name: impl Into<String>, domain: D, make: impl Fn() -> (S, P) + Send + Sync + 'static) -> Self
    where
        D: Domain + Send + Sync + 'static,
        S: Sampler,
        P: Density,
    {
        Self::new(name, move |protocol, round| {
            let (sampler, density) = make();
            Ok(examine(&domain, &sampler, &density, protocol, round)?)
        })
    }

    /// Computes the values that the test shares with others.
    pub fn prepare(&self) {
        if let Some(prepare) = &self.preparation {
            prepare();
        }
    }

    /// Runs one round. The random numbers depend on the name and the seed alone, not on the other tests of the run.
    ///
    /// # Errors
    /// [`Error::Interrupted`](etalon_core::error::Error::Interrupted) if the process is asked to stop; too little memory for the
    /// tables; those of [`examine`].
    pub fn examine(&self, protocol: &Protocol, round: u64) -> Result<Outcome> {
        memory::request(self.memory, || format!("the tables of the test {}", self.name))?;
        let seed = self.name.bytes().fold(protocol.seed, |key, byte| hash::mix64(key ^ u64::from(byte)));
        (self.test)(&Protocol { seed, cancelled: interrupt::requested, ..*protocol }, round)
    }
}
