//! Readers of samplers that left files: their samples, and tables of densities.

use etalon::Result;
use etalon::import::sampler::files::{GridDensity, Row, SampleFile};
use etalon::stats::{Directions, Discrete, Line, Pole, Protocol, Samples, Square, examine};
use std::path::Path;
use std::sync::Arc;

/// A test that needs few values of a density. It tells nothing about a sampler, but uses all that is read.
pub const BRIEF: Protocol = Protocol { seed: 1, samples: Samples::Count(1), level: 0.01, tests: 1, cells: 2 };

pub fn samples(path: &Path) -> Result<()> {
    files(path, &path.with_file_name("grid.csv"))
}

pub fn grid(path: &Path) -> Result<()> {
    files(&path.with_file_name("samples.csv"), path)
}

/// Tests samples against a grid over every domain; good if one of the tests can be done.
fn files(samples: &Path, grid: &Path) -> Result<()> {
    let all = [
        over(Directions::sphere(Pole::Z), samples, grid),
        over(Directions::hemisphere(Pole::Z), samples, grid),
        over(Square, samples, grid),
        over(Line::UNIT, samples, grid),
        over(Discrete { outcomes: 3 }, samples, grid),
    ];
    all.into_iter().reduce(Result::or).unwrap_or(Ok(()))
}

fn over<D: Row + Send + Sync>(domain: D, samples: &Path, grid: &Path) -> Result<()> {
    let density = Arc::new(GridDensity::read_csv(domain, grid)?);
    let sampler = SampleFile::open(samples, Arc::clone(&density))?;
    examine(&domain, &sampler, &*density, &BRIEF, 0).map(drop)
}
