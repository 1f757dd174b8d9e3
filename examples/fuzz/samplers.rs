//! Readers of samplers that left files: their samples, and tables of densities.

use etalon::Result;
use etalon::import::sampler::files::{GridDensity, Row, SampleFile};
use etalon::import::sampler::{Coordinates, Space, Visitor};
use etalon_stats::{Protocol, SampleCount, examine};
use std::path::Path;
use std::sync::Arc;

/// A test that needs few values of a density. It tells nothing about a sampler, but uses all that is read.
pub const BRIEF: Protocol =
    Protocol { seed: 1, samples: SampleCount::Fixed(1), level: 0.01, tests: 1, cells: 2, cancelled: || false };

pub fn samples(path: &Path) -> Result<()> {
    files(path, &path.with_file_name("grid.csv"))
}

pub fn grid(path: &Path) -> Result<()> {
    files(&path.with_file_name("samples.csv"), path)
}

/// Tests samples against a grid over every domain; good if one of the tests can be done.
fn files(samples: &Path, grid: &Path) -> Result<()> {
    let spaces = [Space::Sphere, Space::Hemisphere, Space::Square, Space::Line, Space::Discrete(3)];
    let all = spaces.map(|space| space.with(Files { samples, grid }));
    all.into_iter().reduce(Result::or).unwrap_or(Ok(()))
}

struct Files<'a> {
    samples: &'a Path,
    grid: &'a Path,
}

impl Visitor for Files<'_> {
    type Output = Result<()>;

    fn visit<D: Row<Point: Coordinates> + Send + 'static>(self, domain: D) -> Result<()> {
        let density = Arc::new(GridDensity::read_csv(domain, self.grid)?);
        let sampler = SampleFile::open(self.samples, Arc::clone(&density))?;
        Ok(examine(&domain, &sampler, &*density, &BRIEF, 0).map(drop)?)
    }
}
