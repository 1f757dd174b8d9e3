//! The file of a sweep: a line of JSON that identifies the sweep, then CSV with a row for each computed configuration.

use super::plan::{Description, Plan};
use csv::StringRecord;
use etalon_core::error::{Error, Result};
use etalon_core::{files, interrupt, memory};
use etalon_stats::bsdf::ALL;
use etalon_stats::sweep::{Finding, State};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// The first line of a file, after `# `.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Header {
    sweep: u32,
    #[serde(flatten)]
    description: Description,
}

const FORMAT: u32 = 2;
/// Most bytes of a file: twice those of as many configurations as a sweep may have.
const LARGEST: u64 = 600 << 20;
/// Memory of a row besides its text and the ends of its fields.
const ROW_BYTES: usize = 128;
/// Columns before those of the checks.
const FIRST: [&str; 6] = ["number", "family", "parameters", "theta_deg", "phi_deg", "seed"];

/// Some of the configurations of a sweep, with what the checks say.
#[derive(Debug, Clone, PartialEq)]
pub struct Computed {
    description: Description,
    rows: BTreeMap<u64, StringRecord>,
}

/// What a row says of one check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    pub check: usize,
    pub state: State,
    pub p: Option<f64>,
    /// The error that it would have found.
    pub detectable: Option<f64>,
}

const STATES: [(&str, State); 4] = [
    ("ok", State::Holds),
    ("inconclusive", State::Inconclusive),
    ("suspicious", State::Suspicious),
    ("violated", State::Violated),
];

impl Computed {
    /// The same without configurations yet.
    pub fn new(plan: &Plan) -> Self {
        Self { description: plan.description.clone(), rows: BTreeMap::new() }
    }

    pub fn description(&self) -> &Description {
        &self.description
    }

    pub fn has(&self, number: u64) -> bool {
        self.rows.contains_key(&number)
    }

    /// The largest number of a configuration.
    pub fn last(&self) -> Option<u64> {
        self.rows.keys().next_back().copied()
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Adds what the checks found of a configuration.
    pub fn add(&mut self, plan: &Plan, number: u64, findings: &[Finding]) {
        let (index, configuration) = plan.get(number);
        let family = plan.family(index);
        let values = family.parameters().into_iter().zip(&configuration.values);
        let values: Vec<String> = values.map(|(parameter, value)| format!("{}={value}", parameter.name)).collect();
        let [theta, phi] = configuration.wo.map(|angle| angle.to_string());
        let mut fields = vec![
            number.to_string(),
            family.name().into(),
            values.join(" "),
            theta,
            phi,
            configuration.seed.to_string(),
        ];
        for (index, check) in ALL.iter().enumerate() {
            let found = findings.iter().find(|finding| finding.check == index);
            let state = found.and_then(|found| STATES.iter().find(|(_, state)| *state == found.state));
            fields.push(state.map_or(String::new(), |(word, _)| (*word).to_owned()));
            if check.is_statistical {
                let [p, detectable] = [found.and_then(|f| f.p), found.and_then(|f| f.detectable)];
                fields.push(p.map_or(String::new(), |p| format!("{p:.3e}")));
                fields.push(detectable.map_or(String::new(), |detectable| format!("{detectable:.3e}")));
            }
        }
        // The message of the gravest finding.
        let gravest = findings.iter().filter(|finding| finding.state != State::Holds).max_by_key(|finding| {
            let rank = STATES.iter().position(|(_, state)| *state == finding.state);
            (rank, std::cmp::Reverse(finding.check))
        });
        let message = |finding: &Finding| {
            Some(format!("{}: {}", ALL[finding.check].name, finding.message.as_deref().unwrap_or("small p-value")))
        };
        fields.push(gravest.and_then(message).unwrap_or_default());
        self.rows.insert(number, StringRecord::from(fields));
    }

    /// The rows: numbers, what each check says, and the message.
    pub fn rows(&self) -> impl Iterator<Item = (u64, Vec<Cell>, &str)> {
        self.rows.iter().map(|(&number, record)| {
            let mut fields = record.iter().skip(FIRST.len());
            let mut cells = Vec::new();
            for (check, known) in ALL.iter().enumerate() {
                let state = fields.next().unwrap_or_default();
                let mut number = || fields.next().filter(|_| known.is_statistical).and_then(|text| text.parse().ok());
                let [p, detectable] = if known.is_statistical { [number(), number()] } else { [None; 2] };
                let state = STATES.iter().find(|(word, _)| *word == state);
                cells.extend(state.map(|(_, state)| Cell { check, state: *state, p, detectable }));
            }
            (number, cells, fields.next().unwrap_or_default())
        })
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, path: &Path) -> Result<()> {
        let header = Header { sweep: FORMAT, description: self.description.clone() };
        files::write_atomic(path, |out| {
            let io = |e: std::io::Error| Error::io(path, e);
            let line = serde_json::to_string(&header).map_err(|e| io(e.into()))?;
            writeln!(out, "# {line}").map_err(io)?;
            let mut table = csv::Writer::from_writer(out);
            let rows = std::iter::once(&StringRecord::from(columns()))
                .chain(self.rows.values())
                .try_for_each(|row| table.write_record(row));
            rows.map_err(|e| io(e.into()))?;
            table.flush().map_err(io)
        })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is not of a sweep, of another version, or damaged; [`Error::Io`].
    pub fn read(path: &Path) -> Result<Self> {
        let text = files::read_bounded(path, LARGEST)?;
        let refuse = |message: &str| Error::input(path, message).with_hint("`etalon sweep` writes such files");
        let (first, rest) = text.split_at(text.iter().position(|b| *b == b'\n').unwrap_or(text.len()));
        let Some(json) = first.strip_prefix(b"# ") else { return Err(refuse("this is no file of a sweep")) };
        let header: Header = serde_json::from_slice(json).map_err(|_| refuse("this is no file of a sweep"))?;
        if header.sweep != FORMAT {
            return Err(refuse("this file of a sweep is of another version"));
        }
        let mut reader = csv::Reader::from_reader(rest);
        let damaged = |what: String| refuse(&format!("the table is damaged: {what}"));
        let titles = reader.headers().map_err(|e| damaged(e.to_string()))?;
        if titles.iter().ne(columns()) {
            return Err(damaged("its columns are not those of a sweep".into()));
        }
        let mut rows = BTreeMap::new();
        for record in reader.into_records() {
            let record = record.map_err(|e| damaged(e.to_string()))?;
            let Some(number) = record.get(0).and_then(|number| number.parse::<u64>().ok()) else {
                return Err(damaged(format!("{:?} is no number of a configuration", record.get(0))));
            };
            let bytes = ROW_BYTES + record.as_slice().len() + record.len() * size_of::<usize>();
            memory::grow(bytes, || path.display().to_string())?;
            if rows.insert(number, record).is_some() {
                return Err(damaged(format!("configuration {number} is there twice")));
            }
        }
        Ok(Self { description: header.description, rows })
    }
}

/// The titles of the table.
fn columns() -> Vec<String> {
    let of_check = |check: &etalon_stats::bsdf::Check| {
        let more = ["p", "detects"].map(|what| format!("{}_{what}", check.name));
        std::iter::once(check.name.to_owned())
            .chain(more.into_iter().filter(|_| check.is_statistical))
            .collect::<Vec<_>>()
    };
    let first = FIRST.map(str::to_owned).into_iter();
    first.chain(ALL.iter().flat_map(of_check)).chain(["message".to_owned()]).collect()
}

/// Configurations computed at a time.
const BATCH: usize = 64;
/// How often what is finished is saved.
const SAVE: Duration = Duration::from_secs(60);

/// Computes what `computed` lacks. `save` is called about once a minute and at the end; `done` with the number of configurations so far. Once the
/// process is asked to stop, what is finished is saved; the rest is then missing.
///
/// # Errors
/// Those of the checks, except interruption, and of `save`.
pub fn run(
    plan: &Plan,
    computed: &mut Computed,
    done: &dyn Fn(u64),
    save: &dyn Fn(&Computed) -> Result<()>,
) -> Result<()> {
    let missing: Vec<u64> = (0..plan.len()).filter(|&number| !computed.has(number)).collect();
    let mut saved = Instant::now();
    for batch in missing.chunks(BATCH) {
        if interrupt::requested() {
            break;
        }
        let one = |&number: &u64| match plan.screen(number) {
            Ok(findings) => Ok(Some((number, findings))),
            Err(Error::Interrupted) => Ok(None),
            Err(error) => Err(error),
        };
        let found: Vec<_> = match plan.is_sequential() {
            true => batch.iter().map(one).collect::<Result<_>>()?,
            false => batch.par_iter().map(one).collect::<Result<_>>()?,
        };
        for (number, findings) in found.into_iter().flatten() {
            computed.add(plan, number, &findings);
        }
        done(batch.len() as u64);
        if saved.elapsed() > SAVE {
            save(computed)?;
            saved = Instant::now();
        }
    }
    save(computed)
}
