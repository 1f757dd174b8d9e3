//! `etalon envmap proposal`: inversion with uniform and with Gaussian random numbers, and what proposal distributions cost.

use super::MapArgs;
use crate::cli::console::Console;
use crate::cli::global::{Global, SAMPLING, Verdict, out, seed, threads};
use crate::cli::style::StyleArgs;
use clap::Args;
use etalon_bench::proposal::{self, Along, Cost};
use etalon_bench::table::Table;
use etalon_core::error::{Error, Result};
use etalon_figures::figure::Wanted;
use etalon_figures::output;
use etalon_figures::view::proposal as view;
use etalon_figures::view::text::{LINE, p_is, rounded, wrapped};
use etalon_stats::power::ChiSquare;
use serde::Serialize;

/// Compare distributions that choose rows and columns of a map
///
/// Inversion with uniform and with Gaussian random numbers, as the first report tried them; and, where each sample is weighted by one over
/// its probability, what seven distributions cost in variance.
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

/// What `--json` prints.
#[derive(Serialize)]
struct Results<'a> {
    #[serde(flatten)]
    inversion: &'a proposal::Proposal,
    costs: &'a [Cost],
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
        let mut files = output::write(&stem, &drawing, &wanted.style(&drawing), &output::csv(&result.bins)?)?;
        // A map that is dark above the horizon has no irradiance to estimate
        let costs = proposal::costs(&source.map, CHECKED, global.seed);
        if let Some(costs) = &costs {
            let stem = target.stem(&format!("{}-proposal", self.map.short_name()), "-cost", &output::STUDY)?;
            let drawing = view::costs(costs);
            files.extend(output::write(&stem, &drawing, &wanted.style(&drawing), &output::csv(&costs.costs)?)?);
        }
        let costs = costs.map_or(Vec::new(), |costs| costs.costs);
        bar.finish_and_clear();
        console.saved(&Results { inversion: &result, costs: &costs }, &target.written(files), || {
            let line = |name: &str, t: &ChiSquare| {
                format!("{name:<24} chi-square {:.1}, {} degrees of freedom, {}\n", t.statistic, t.dof, p_is(t.p))
            };
            line("uniform random numbers:", &result.uniform)
                + &line("Gaussian random numbers:", &result.gaussian)
                + &samples(&costs)
        });
        wanted.check()?;
        Ok(Verdict::Good)
    }
}

/// Samples of each proposal that check the sums.
const CHECKED: u32 = 1 << 12;

/// The table of the samples that each proposal needs.
fn samples(costs: &[Cost]) -> String {
    if costs.is_empty() {
        return String::new();
    }
    let rows: Vec<&[Cost]> = costs.chunks(Along::ALL.len()).collect();
    let needed = |along: usize| move |costs: &&[Cost]| rounded(view::samples(costs[along].irradiance_variance), 3);
    let table = Table::of(&rows).words("proposal", |costs| &costs[0].proposal);
    let table = table.numbers("rows alone", needed(0)).numbers("columns alone", needed(1)).numbers("both", needed(2));
    let title = wrapped(
        "samples until the irradiance of a floor has a relative standard error of 1 %, with weights:",
        "",
        LINE,
    );
    format!("\n{title}{}", table.text())
}
