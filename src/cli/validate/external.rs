//! Samplers and BSDFs of other programs, samplers in files: the arguments of `validate` for them.

use super::super::families::{ProgramSource, REPLY_LIMIT};
use crate::cli::console::Console;
use crate::cli::values::setting;
use clap::{ArgAction, ArgGroup, Args};
use etalon_bench::likeness::Claim;
use etalon_bench::protocol::program::bsdf::Program;
use etalon_bench::protocol::program::sampler::Client;
use etalon_bench::protocol::program::{self, External};
use etalon_bench::protocol::sampler::Space;
use etalon_bench::protocol::sampler::files::{GridDensity, SampleFile};
use etalon_bench::validation::{Case, WholeBsdf, families};
use etalon_core::error::{Error, Result};
use etalon_stats::bsdf::Family as _;
use etalon_stats::sweep::over_ranges;
use etalon_stats::{Protocol, examine};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const DOMAIN: &str = "Domain of the samples [default: what the program says]";

/// An external sampler or BSDF.
#[derive(Args)]
#[command(next_help_heading = "Samplers and BSDFs of other programs")]
#[command(group = ArgGroup::new("program").args(["exec", "names"]).multiple(true))]
pub struct Arguments {
    /// Test the sampler or the BSDF of the program that COMMAND starts
    ///
    /// Requests and replies go over its standard input and output.
    #[arg(long, value_name = "COMMAND", conflicts_with_all = ["envmap", "pdf"])]
    exec: Option<String>,
    #[arg(long, value_name = "DOMAIN", help = DOMAIN, long_help = format!("{DOMAIN}\n\n{}", Space::known()))]
    domain: Option<String>,
    /// Time limit for each reply of the program
    #[arg(long, value_name = "SECONDS", default_value_t = REPLY_LIMIT, requires = "program")]
    timeout: f64,
    /// Compare the program's BSDF with this one of `etalon furnace --list`, too
    ///
    /// Its values and delta lobes must be those of the model, at all angles and over the range of the parameters that both have.
    /// Parameters of the model that the program does not declare are given by --set; alpha means both widths. Without eta and k,
    /// a metal has Schlick's Fresnel reflectance; f0, its value at normal incidence, is fitted if it is not set. If values differ, known variants are
    /// tried: other masking, Fresnel formulas and widths. Another pdf is only remarked on.
    #[arg(long, value_name = "MODEL", requires = "program")]
    like: Option<String>,
    /// Values of parameters [default: as declared; of samplers: whole ranges]
    ///
    /// Those of --like are given by it, too. A sampler with parameters is tested over their ranges, or by this for one value of each.
    #[arg(long, value_name = "NAME=VALUE,...", requires = "program", value_delimiter = ',', action = ArgAction::Set, value_parser = setting)]
    set: Vec<(String, f64)>,
    /// The pdf of the samples in a file: a grid in CSV, or a lat-long image
    #[arg(long, value_name = "FILE", conflicts_with_all = ["names", "envmap"], requires = "samples")]
    pdf: Option<PathBuf>,
}

#[derive(Debug, Clone)]
pub enum SampleSource {
    /// As many from a sampler.
    Count(u64),
    /// Those of a file.
    File(PathBuf),
}

impl From<&OsStr> for SampleSource {
    fn from(text: &OsStr) -> Self {
        text.to_str().and_then(|text| text.parse().ok()).map_or_else(|| Self::File(text.into()), Self::Count)
    }
}

/// What is to be tested.
pub enum Subject {
    /// Samplers.
    Cases(Vec<Case>),
    /// A program's BSDF.
    Bsdf(Box<WholeBsdf<Program>>),
}

impl Subject {
    /// The name of what is tested, if it is one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Cases(cases) => cases.first().filter(|_| cases.len() == 1).map(|case| case.name.as_str()),
            Self::Bsdf(bsdf) => Some(bsdf.name()),
        }
    }

    /// The names of all tests.
    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Cases(cases) => cases.iter().map(|case| case.name.clone()).collect(),
            Self::Bsdf(bsdf) => bsdf.names(),
        }
    }
}

impl Arguments {
    /// What is to be tested: the program, or the Python file that `names` is, or files of samples; `None`: what `names` names.
    pub fn subject(
        &self,
        names: &[String],
        samples: Option<&SampleSource>,
        console: &Console,
    ) -> Result<Option<Subject>> {
        let space = self.domain.as_deref().map(str::parse).transpose()?;
        // Names beside a program's choose among its tests
        let (python, patterns): (Vec<String>, Vec<String>) =
            names.iter().cloned().partition(|name| program::is_python_file(name));
        let source = ProgramSource::of(self.exec.as_deref(), &python)?;
        if source.is_none() && !self.set.is_empty() {
            return Err(Error::parameter("set", "there is no external BSDF to test")
                .with_hint("it goes with `exec`, or with a Python file"));
        }
        match (source, samples, &self.pdf) {
            (Some(_), Some(SampleSource::File(file)), _) => {
                Err(Error::parameter("samples", format!("\"{}\" is not a number", file.display()))
                    .with_hint("a program generates the samples itself"))
            }
            (Some(source), ..) => self.program(source, &patterns, space, console).map(Some),
            (None, Some(SampleSource::File(file)), Some(pdf)) => {
                files(file, pdf, space, console).map(|case| Some(Subject::Cases(vec![case])))
            }
            (None, Some(SampleSource::File(file)), None) => {
                Err(Error::parameter("samples", format!("\"{}\" is not a number", file.display()))
                    .with_hint("if it is a file of samples, give their pdf by `pdf` FILE"))
            }
            (None, _, Some(_)) => Err(Error::parameter("pdf", "a pdf without samples")
                .with_hint("give a file of samples by `samples` FILE.csv")),
            (None, _, None) if space.is_some() => {
                Err(Error::parameter("domain", "there is no external sampler to test")
                    .with_hint("it goes with `exec`, or with `samples` FILE and `pdf`"))
            }
            (None, _, None) => Ok(None),
        }
    }

    fn program(
        &self,
        source: ProgramSource,
        patterns: &[String],
        space: Option<Space>,
        console: &Console,
    ) -> Result<Subject> {
        match source.start(space.clone(), self.timeout)? {
            External::Bsdf(program) => {
                let claim = self.like.as_deref().map(|name| Claim::new(name, &self.set)).transpose()?;
                // What the program does not declare is a parameter of the model
                let declared = program.parameters();
                let is_own = |name: &String| declared.iter().any(|parameter| parameter.name == *name);
                let is_of_model = |name: &String| !is_own(name) && claim.as_ref().is_some_and(|claim| claim.has(name));
                let own: Vec<_> = self.set.iter().filter(|(name, _)| !is_of_model(name)).cloned().collect();
                let values = families::values(&program, &own)?;
                Ok(Subject::Bsdf(Box::new(WholeBsdf::new(program, values)?.like(claim).only(patterns)?)))
            }
            External::Sampler(_) if self.like.is_some() => {
                Err(Error::parameter("like", "the program has a sampler, and a model is a BSDF"))
            }
            External::Sampler(_) if !patterns.is_empty() => {
                Err(Error::parameter("names", format!("there is no test \"{}\": a sampler has one test", patterns[0]))
                    .with_hint("a program is tested alone; names choose among the tests of a BSDF"))
            }
            External::Sampler(client) => {
                let client = match self.set[..] {
                    [] => client,
                    _ => client.with(&families::values_of(client.name(), client.parameters(), &self.set)?)?,
                };
                let is_named = client.space().to_string().parse::<Space>().is_ok();
                if let (ProgramSource::File(file), None, true) = (source, space, is_named) {
                    let other = "another one by --domain, or by a variable `domain` of the file";
                    console.note(&format!("{file}: the domain is {}; {other}", client.space()));
                }
                let (name, space) = (client.name().to_owned(), client.space());
                // Values that are not given are those of the whole ranges
                let is_one = !self.set.is_empty() || client.parameters().is_empty();
                let test = move |protocol: &Protocol, round| {
                    let of = |client: &Client, protocol: &_| examine(space.domain(), client, client, protocol, round);
                    if is_one {
                        return Ok(of(&client, protocol)?);
                    }
                    let with = |values: &[f64]| client.with(values).map_err(etalon_stats::Error::from);
                    Ok(over_ranges(client.parameters(), protocol, round, |values, protocol, _| {
                        of(&with(values)?, protocol)
                    })?)
                };
                Ok(Subject::Cases(vec![Case::new(name, test)]))
            }
        }
    }
}

/// The test of samples in a file.
fn files(samples: &Path, pdf: &Path, space: Option<Space>, console: &Console) -> Result<Case> {
    let is_table = pdf.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    let of_image = || -> Result<GridDensity> {
        let (density, notes) = GridDensity::read_image(pdf)?;
        notes.iter().for_each(|note| console.warn(note));
        Ok(density)
    };
    let density = match space {
        None if is_table => {
            return Err(Error::parameter("domain", "the domain of a table is not known")
                .with_hint(format!("`domain` {}", Space::known())));
        }
        Some(space) if is_table => GridDensity::read_csv(space, pdf)?,
        None => of_image()?,
        Some(space) if space == "sphere".parse()? => of_image()?,
        Some(_) => {
            return Err(Error::parameter("pdf", "an image is a pdf over the sphere").with_hint("`domain` sphere"));
        }
    };
    let name = samples.file_stem().map_or_else(|| "samples".into(), |stem| stem.to_string_lossy().into_owned());
    let (space, density) = (density.space(), Arc::new(density));
    let sampler = SampleFile::open(samples, Arc::clone(&density))?;
    Ok(Case::new(name, move |protocol, round| Ok(examine(space.domain(), &sampler, &*density, protocol, round)?)))
}
