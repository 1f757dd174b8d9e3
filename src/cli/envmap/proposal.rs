//! `etalon envmap proposal`: inversion with uniform and with Gaussian random numbers.

use super::MapArgs;
use crate::cli::console::Console;
use crate::cli::global::{Global, SAMPLING, Verdict, out, seed, threads};
use crate::cli::style::StyleArgs;
use clap::Args;
use etalon_bench::proposal;
use etalon_core::error::{Error, Result};
use etalon_figures::figure::Wanted;
use etalon_figures::output;
use etalon_figures::view::proposal as view;
use etalon_figures::view::text::p_is;
use etalon_stats::power::ChiSquare;

/// Sample rows of a map with uniform and with Gaussian random numbers
///
/// Both go through the inverse of the rows' distribution function, as in the first report.
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap proposal nave -n 100000")]
#[command(next_help_heading = SAMPLING, args = [out(), seed(), threads()])]
pub struct Proposal {
    /// Samples with each kind of random number
    #[arg(short, value_name = "N", default_value_t = 100_000)]
    n: usize,
    #[command(flatten)]
    map: MapArgs,
    #[command(flatten)]
    style: StyleArgs,
}

impl Proposal {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let source = self.map.load(console)?;
        let bar = console.busy("proposal");
        let Some(result) = proposal::compare(&source.map, self.n, global.seed)? else {
            return Err(Error::parameter("map", format!("{} has light in too few rows for this test", source.name)));
        };
        let (target, style) = (global.target(), self.style.style()?);
        let stem = target.stem(&format!("{}-proposal", self.map.short_name()), "", &output::STUDY)?;
        let (mut wanted, drawing) = (Wanted::of(&style), view::drawing(&result));
        let files = output::write(&stem, &drawing, &wanted.style(&drawing), &output::csv(&result.bins)?)?;
        bar.finish_and_clear();
        console.saved(&result, &target.written(files), || {
            let line = |name: &str, t: &ChiSquare| {
                format!("{name:<24} chi-square {:.1}, {} degrees of freedom, {}\n", t.statistic, t.dof, p_is(t.p))
            };
            line("uniform random numbers:", &result.uniform) + &line("Gaussian random numbers:", &result.gaussian)
        });
        wanted.check()?;
        Ok(Verdict::Good)
    }
}
