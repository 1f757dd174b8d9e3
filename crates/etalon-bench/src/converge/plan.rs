//! How much a comparison measures, and whether that is possible.

use etalon_core::error::{Error, Result};
use etalon_core::memory;
use etalon_core::scene::Request;
use std::path::PathBuf;

/// How much to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Seconds of wall-clock time for everything.
    pub budget: f64,
    /// Samples per pixel at which every curve ends; `None` for as many as fit into the time.
    pub max_spp: Option<u32>,
    /// So many renders of each contender with seeds of their own; `None` for [`REPLICATES`], or fewer if they do not fit.
    pub replicates: Option<u32>,
    /// Seed of the first replicate; the others follow it.
    pub seed: u64,
    /// A folder for all images and their times; see [`recorded`](super::recorded).
    pub keep: Option<PathBuf>,
}

/// Replicates of a plan that does not say how many.
pub const REPLICATES: u32 = 8;
/// Largest number of samples per pixel of a plan that does not say how many.
const MOST_SPP: u32 = 1 << 16;

/// Largest budget, in seconds: a day.
const LONGEST: f64 = 86_400.0;
/// A film's bytes per pixel, and an image's.
const FILM: usize = 104;
const IMAGE: usize = 12;

impl Plan {
    /// Samples per pixel at which every curve ends.
    pub fn last_spp(&self) -> u32 {
        self.max_spp.unwrap_or(MOST_SPP)
    }

    /// Checks the plan for n contenders.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what is out of range, [`Error::Memory`].
    pub fn check(&self, request: &Request, strategies: usize) -> Result<()> {
        etalon_render::check_request(&Request { spp: 1, ..*request })?;
        if !(self.budget > 0.0 && self.budget <= LONGEST) {
            return Err(Error::parameter("budget", format!("{} is not a number of seconds", self.budget))
                .with_hint("more than 0 and at most 86400"));
        }
        let (max_spp, replicates) = (self.last_spp(), self.replicates.unwrap_or(REPLICATES));
        if max_spp == 0 || max_spp > 1 << 24 {
            return Err(
                Error::parameter("max_spp", format!("{max_spp} samples per pixel")).with_hint("from 1 to 16777216")
            );
        }
        if !(1..=1000).contains(&replicates) {
            return Err(Error::parameter("replicates", format!("{replicates}")).with_hint("from 1 to 1000"));
        }
        if strategies == 0 {
            return Err(Error::parameter("strategies", "none is given"));
        }
        let levels = max_spp.ilog2() as usize + 1;
        let each = FILM + IMAGE * (levels + replicates as usize);
        let bytes = request.width.saturating_mul(request.height).saturating_mul(strategies * each);
        memory::request(bytes, || {
            format!("the films of {strategies} strategies at {}x{}", request.width, request.height)
        })
    }
}
