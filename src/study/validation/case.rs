//! A named test, ready to run: what a suite is a list of.

use crate::error::Result;
use crate::interrupt;
use crate::memory;
use crate::sampling::hash;
use etalon_stats::{Density, Domain, Outcome, Protocol, Sampler, examine};

/// One round of a test; see [`examine`].
type Test = dyn Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync;

/// A test with its name: words separated by `/`, from the general to the special (`normals/beckmann/visible/0.05/60`).
pub struct Case {
    pub name: String,
    test: Box<Test>,
    /// What has to be there before tests run side by side.
    preparation: Option<Box<dyn Fn() + Send + Sync>>,
    /// Bytes that its tables take.
    memory: usize,
}

/// Tests whose tables take more bytes than this are run one after the other.
const LARGE: usize = 1 << 26;

impl Case {
    /// A test of any kind.
    pub fn new(
        name: impl Into<String>,
        test: impl Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), test: Box::new(test), preparation: None, memory: 0 }
    }

    /// Adds the making of what the test shares with others, which is then not made twice by tests side by side.
    #[must_use]
    pub fn with_preparation(self, preparation: impl Fn() + Send + Sync + 'static) -> Self {
        Self { preparation: Some(Box::new(preparation)), ..self }
    }

    /// Says how many bytes the tables of the test take, if they are many.
    #[must_use]
    pub fn with_memory(self, memory: usize) -> Self {
        Self { memory, ..self }
    }

    /// Whether the test is to be run while no other is: it uses all threads by itself.
    pub(super) fn is_large(&self) -> bool {
        self.memory > LARGE
    }

    /// The test of a sampler against its pdf. `make` builds both, when the test runs and not before: tables of large maps
    /// need not all exist at once.
    pub fn of<D, S, P>(name: impl Into<String>, domain: D, make: impl Fn() -> (S, P) + Send + Sync + 'static) -> Self
    where
        D: Domain + Send + Sync + 'static,
        S: Sampler<D::Point>,
        P: Density<D::Point>,
    {
        Self::new(name, move |protocol, round| {
            let (sampler, density) = make();
            Ok(examine(&domain, &sampler, &density, protocol, round)?)
        })
    }

    /// Makes what the test shares with others.
    pub fn prepare(&self) {
        if let Some(prepare) = &self.preparation {
            prepare();
        }
    }

    /// Runs one round, until the process is asked to stop. The random numbers depend on the name and the seed alone, not on
    /// what else is in the run.
    pub fn examine(&self, protocol: &Protocol, round: u64) -> Result<Outcome> {
        memory::request(self.memory, || format!("the tables of the test {}", self.name))?;
        let seed = self.name.bytes().fold(protocol.seed, |key, byte| hash::mix64(key ^ u64::from(byte)));
        (self.test)(&Protocol { seed, cancelled: interrupt::requested, ..*protocol }, round)
    }
}
