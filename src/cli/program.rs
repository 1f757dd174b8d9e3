//! BSDFs of another program: the arguments that start it.

use crate::error::{Error, Result};
use crate::import::program::bsdf::Program;
use crate::import::program::{self, External};
use clap::Args;
use std::time::Duration;

/// Another program.
#[derive(Args)]
pub struct ExternalBsdf {
    /// BSDFs of another program: COMMAND starts it; requests and replies go over its standard input and output
    #[arg(long, value_name = "COMMAND", conflicts_with_all = ["names", "list"])]
    exec: Option<String>,
    /// Time limit for each reply of the program
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, requires = "exec")]
    timeout: f64,
}

impl ExternalBsdf {
    /// Starts the program, if one is named.
    pub fn start(&self) -> Result<Option<Program>> {
        let Some(command) = &self.exec else { return Ok(None) };
        match program::start(command, None, limit(self.timeout)?)? {
            External::Bsdf(program) => Ok(Some(program)),
            External::Sampler(_) => Err(Error::parameter("command", "the program has a sampler, not BSDFs")
                .with_hint("its greeting needs kind=bsdf")),
        }
    }
}

/// The time limit of a reply.
pub fn limit(seconds: f64) -> Result<Duration> {
    const LONGEST: f64 = 86_400.0;
    if !(seconds > 0.0 && seconds <= LONGEST) {
        return Err(Error::parameter("timeout", format!("{seconds} s is not from 0 to {LONGEST} s")));
    }
    Ok(Duration::from_secs_f64(seconds))
}
