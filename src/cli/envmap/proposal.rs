//! `etalon envmap proposal`: inversion with uniform and with Gaussian random numbers.

use super::options::MapArgs;
use crate::cli::console::Console;
use crate::cli::global::{Global, SAMPLING, Verdict, out, seed, threads};
use crate::error::{Error, Result};
use crate::output;
use crate::study::proposal;
use crate::view::proposal as view;
use crate::view::text::p_is;
use clap::Args;
use etalon_stats::chi_square::ChiSquare;

/// Compare uniform with Gaussian random numbers for inversion
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap proposal nave -n 100000")]
#[command(next_help_heading = SAMPLING, args = [out(), seed(), threads()])]
pub struct Proposal {
    /// Samples with each kind of random number
    #[arg(short, value_name = "N", default_value_t = 100_000)]
    n: usize,
    #[command(flatten)]
    map: MapArgs,
}

impl Proposal {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = self.map.load(console)?;
        let Some(result) = proposal::compare(&source.map, self.n, global.seed)? else {
            return Err(Error::parameter("map", format!("{} has light in too few rows for this test", source.name)));
        };
        let target = global.target(&["map"]);
        let stem = target.stem(&format!("{}-proposal", self.map.short_name()), "", &output::STUDY)?;
        let files = output::write(&stem, &view::drawing(&result), &output::table(&result.bins)?)?;
        console.saved(&result, &target.written(files), || {
            let line = |name: &str, t: &ChiSquare| {
                format!("{name:<24} chi-square {:.1} with {} degrees of freedom, {}\n", t.statistic, t.dof, p_is(t.p))
            };
            line("uniform random numbers:", &result.uniform) + &line("Gaussian random numbers:", &result.gaussian)
        });
        Ok(Verdict::Good)
    }
}
