//! `etalon envmap`: environment maps, one file per subcommand.

mod cut;
mod info;
mod make;
mod options;
mod proposal;
mod sample;

use super::console::Console;
use super::global::{Global, Verdict};
use clap::Subcommand;
use etalon_core::error::Result;

#[derive(Subcommand)]
pub enum Envmap {
    Info(info::Info),
    Sample(sample::Sample),
    Cut(cut::Cut),
    Proposal(proposal::Proposal),
    Make(make::Make),
}

impl Envmap {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        match self {
            Envmap::Info(args) => args.run(console),
            Envmap::Sample(args) => args.run(global, console),
            Envmap::Cut(args) => args.run(global, console),
            Envmap::Proposal(args) => args.run(global, console),
            Envmap::Make(args) => args.run(global, console),
        }
    }
}
