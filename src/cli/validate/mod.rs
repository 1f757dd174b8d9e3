//! `etalon validate`: samplers against their densities.

mod elsewhere;

use super::console::Console;
use super::{Global, Verdict};
use crate::error::Result;
use crate::stats::{Protocol, Samples};
use crate::study::validation::{Validation, run, suite};
use clap::Args;
use elsewhere::Elsewhere;

/// Test samplers.
#[derive(Args)]
pub struct Validate {
    /// Samples of every test
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    #[command(flatten)]
    elsewhere: Elsewhere,
}

impl Validate {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let samples = self.samples.map_or(Protocol::default().samples, Samples::Count);
        let protocol = Protocol { seed: global.seed, samples, ..Protocol::default() };
        let cases = match self.elsewhere.case()? {
            Some(case) => vec![case],
            None => suite::cases(),
        };
        let validation = run(&cases, &protocol, &|_| ())?;
        console.result(&validation, || human(&validation));
        Ok(match &validation {
            v if v.rejected > 0 => Verdict::Rejected,
            v if v.inconclusive > 0 => Verdict::Inconclusive,
            _ => Verdict::Good,
        })
    }
}

fn human(validation: &Validation) -> String {
    validation.tests.iter().map(|test| format!("{}: {}\n", test.name, test.outcome)).collect()
}
