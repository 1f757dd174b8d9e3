//! BSDFs of another program: the arguments that start it.

use clap::Args;
use etalon_bench::protocol::program::bsdf::Program;
use etalon_bench::protocol::program::{self, External};
use etalon_core::error::{Error, Result};
use std::time::Duration;

/// Another program.
#[derive(Args)]
#[command(next_help_heading = "BSDFs of other programs")]
pub struct ExternalBsdf {
    /// Test the BSDFs of the program that COMMAND starts
    ///
    /// Requests and replies go over its standard input and output.
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// Time limit for each reply of the program
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, requires = "exec")]
    timeout: f64,
}

impl ExternalBsdf {
    /// The command, if one is given.
    pub fn command(&self) -> Option<&str> {
        self.exec.as_deref()
    }

    /// Refuses names of BSDFs beside a command.
    pub fn check_no_names(&self, names: &[String]) -> Result<()> {
        if self.exec.is_some() && !names.is_empty() {
            return Err(Error::parameter("names", "`exec` is given, too").with_hint("a program is one family"));
        }
        Ok(())
    }

    /// Starts the program, if a command is given.
    pub fn start(&self) -> Result<Option<Program>> {
        let Some(command) = &self.exec else { return Ok(None) };
        match program::start(command, None, reply_limit(self.timeout)?)? {
            External::Bsdf(program) => Ok(Some(program)),
            External::Sampler(_) => Err(Error::parameter("exec", "the program has a sampler, and no BSDFs")
                .with_hint("`etalon validate` tests samplers")),
        }
    }
}

/// The time that a program has for each reply.
pub fn reply_limit(seconds: f64) -> Result<Duration> {
    const LONGEST: f64 = 86_400.0;
    if !(seconds > 0.0 && seconds <= LONGEST) {
        return Err(Error::parameter("timeout", format!("{seconds} s is not from 0 to {LONGEST} s")));
    }
    Ok(Duration::from_secs_f64(seconds))
}
