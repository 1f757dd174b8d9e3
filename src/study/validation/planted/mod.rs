//! Planted faults: mistakes that people make, each in a sampler or a pdf small enough to read, which the suite must
//! reject. Without its mistake each is a test of its own that must be accepted, so that the rejection is not due to the
//! setting.

mod findings;
mod glass;
mod hemispheres;
mod lamps;
mod maps;
mod normals;
mod reflection;
mod renders;
mod tables;

pub use findings::{By, Finding, Findings, run};

use super::Case;
use etalon_stats::{Density, Domain, Sampler};

/// A mistake in its setting.
pub struct Planted {
    /// Family and mistake (`normals/missing-cosine`).
    pub name: &'static str,
    /// What the mistake is, and who makes it.
    pub mistake: &'static str,
    faulty: Case,
    sound: Case,
}

impl Planted {
    /// `make` builds sampler and pdf with the mistake or without it.
    fn of<D, S, P, F>(name: &'static str, mistake: &'static str, domain: D, make: F) -> Self
    where
        D: Domain + Copy + Send + Sync + 'static,
        S: Sampler<D::Point>,
        P: Density<D::Point>,
        F: Fn(bool) -> (S, P) + Clone + Send + Sync + 'static,
    {
        let right = make.clone();
        Self {
            name,
            mistake,
            faulty: Case::of(format!("planted/{name}"), domain, move || make(true)),
            sound: Case::of(format!("sound/{name}"), domain, move || right(false)),
        }
    }
}

/// All of them, family by family.
#[must_use]
pub fn all() -> Vec<Planted> {
    [
        hemispheres::faults(),
        lamps::faults(),
        tables::faults(),
        maps::faults(),
        normals::faults(),
        reflection::faults(),
        glass::faults(),
        renders::faults(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
