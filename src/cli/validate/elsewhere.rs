//! Samplers that are not part of this program: what `validate` takes to reach them.

use crate::error::{Error, Result};
use crate::import::sampler::{Client, Coordinates, Space};
use crate::stats::{Directions, Discrete, Domain, Line, Pole, Square, examine};
use crate::study::validation::Case;
use clap::Args;
use std::time::Duration;

/// A sampler elsewhere.
#[derive(Args)]
#[command(next_help_heading = "Samplers elsewhere")]
pub struct Elsewhere {
    /// Test the sampler of another program: it is started by this command and asked over its standard input and output
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// Where the samples lie: sphere, hemisphere, square, line or discrete:N (default: what the program says)
    #[arg(long, value_name = "DOMAIN")]
    domain: Option<String>,
    /// Time that the program has for every answer
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, requires = "exec")]
    timeout: f64,
}

impl Elsewhere {
    /// The test of the sampler that was asked for, if any was.
    pub fn case(&self) -> Result<Option<Case>> {
        let space = self.domain.as_deref().map(str::parse).transpose()?;
        let Some(command) = &self.exec else { return Ok(None) };
        let client = Client::start(command, space, self.limit()?)?;
        Ok(Some(match client.space() {
            Space::Sphere => program(Directions::sphere(Pole::Z), client)?,
            Space::Hemisphere => program(Directions::hemisphere(Pole::Z), client)?,
            Space::Square => program(Square, client)?,
            Space::Line => program(Line::UNIT, client)?,
            Space::Discrete(outcomes) => program(Discrete { outcomes }, client)?,
        }))
    }

    fn limit(&self) -> Result<Duration> {
        const LONGEST: f64 = 86_400.0;
        if !(self.timeout > 0.0 && self.timeout <= LONGEST) {
            return Err(Error::parameter("--timeout", format!("{} s is not from 0 to {LONGEST} s", self.timeout)));
        }
        Ok(Duration::from_secs_f64(self.timeout))
    }
}

/// The test of a program over `domain`.
fn program<D>(domain: D, client: Client) -> Result<Case>
where
    D: Domain<Point: Coordinates> + Send + Sync + 'static,
{
    let name = client.name().to_owned();
    let program = client.over::<D::Point>()?;
    Ok(Case::new(name, move |protocol, round| examine(&domain, &program, &program, protocol, round)))
}
