//! A planted fault: a test with a mistake and without it.

use super::super::case::Case;
use etalon_stats::{Density, Domain, Sampler};

/// A mistake in its setting.
pub struct PlantedFault {
    /// Family and mistake (`normals/missing-cosine`).
    pub name: &'static str,
    /// What the mistake is, and where it occurs.
    pub mistake: &'static str,
    /// The test of the sampler with the mistake.
    pub(super) faulty: Case,
    /// The same test without it.
    pub(super) sound: Case,
}

impl PlantedFault {
    /// `make` builds sampler and pdf with the mistake or without it.
    pub(super) fn of<D, S, P, F>(name: &'static str, domain: D, make: F) -> Self
    where
        D: Domain + Copy + Send + Sync + 'static,
        S: Sampler,
        P: Density,
        F: Fn(bool) -> (S, P) + Clone + Send + Sync + 'static,
    {
        let right = make.clone();
        Self {
            name,
            mistake: "",
            faulty: Case::of(format!("planted/{name}"), domain, move || make(true)),
            sound: Case::of(format!("sound/{name}"), domain, move || right(false)),
        }
    }

    pub(super) fn mistake(self, mistake: &'static str) -> Self {
        Self { mistake, ..self }
    }
}
