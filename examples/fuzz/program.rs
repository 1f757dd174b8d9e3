//! What a program answers: records of it, read as if the program were there, and actors that make such records.

use super::samplers::BRIEF;
use etalon::import::sampler::files::Row;
use etalon::import::sampler::program::{Answer, Client, Connection, Program};
use etalon::import::sampler::{Coordinates, Visitor};
use etalon::{Error, Result};
use etalon_stats::{Atom, Density, Mass, Sample, Sampler, examine};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::vec::IntoIter;

/// What stands between the blocks of a record, which are what a pipe hands out at a time.
const CUT: u8 = b'\x0c';
/// Samples that are asked for.
const SAMPLES: u64 = 4;

/// Reads the record at `path`.
pub fn read(path: &Path) -> Result<()> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let blocks: Vec<Vec<u8>> = bytes.split(|&byte| byte == CUT).map(<[u8]>::to_vec).collect();
    test(Record { blocks: blocks.into_iter() })
}

/// Tests the sampler of `connection`, over the domain that it names.
fn test(connection: impl Connection + 'static) -> Result<()> {
    let client = Client::connect(connection, None)?;
    client.space().with(Examined(client))
}

struct Examined(Client);

impl Visitor for Examined {
    type Output = Result<()>;

    fn visit<D: Row<Point: Coordinates> + Send + 'static>(self, domain: D) -> Result<()> {
        let few = Few(self.0.over::<D::Point>()?);
        Ok(examine(&domain, &few, &few, &BRIEF, 0).map(drop)?)
    }
}

/// A program that said this, whatever it was asked.
struct Record {
    blocks: IntoIter<Vec<u8>>,
}

impl Connection for Record {
    fn name(&self) -> &str {
        "record"
    }

    fn ask(&mut self, _: String, most: usize) -> Result<String> {
        let fault = |what| Error::input(Path::new("record"), what);
        let mut answer = Answer::new(most);
        for block in self.blocks.by_ref() {
            if let Some(text) = answer.add(&block).map_err(fault)? {
                return Ok(text);
            }
        }
        Err(fault(format!("it ended after {} lines of an answer", answer.lines())))
    }
}

/// A program that has a few lines for each kind of request, which it says in turn.
pub struct Actor {
    pub greeting: &'static str,
    pub sample: &'static [&'static str],
    pub pdf: &'static [&'static str],
    pub invert: &'static [&'static str],
}

/// An [`Actor`] whose answers are kept.
struct Recorded {
    actor: Actor,
    lines: usize,
    said: Arc<Mutex<Vec<String>>>,
}

impl Connection for Recorded {
    fn name(&self) -> &str {
        "actor"
    }

    fn ask(&mut self, request: String, _: usize) -> Result<String> {
        let mut words = request.split_ascii_whitespace();
        let script = match words.next() {
            Some("sample") => self.actor.sample,
            Some("pdf") => self.actor.pdf,
            Some("invert") => self.actor.invert,
            _ => &[self.actor.greeting],
        };
        // The number in a greeting is a version, 1.
        let count: usize = words.next().and_then(|count| count.parse().ok()).unwrap_or_default();
        // A density has to be the same when asked again.
        let first = if request.starts_with("pdf") { request.bytes().map(usize::from).sum() } else { self.lines };
        let answer: String = (first..first + count).map(|i| format!("{}\n", script[i % script.len()])).collect();
        self.lines += count;
        self.said.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{answer}end\n"));
        Ok(answer)
    }
}

impl Actor {
    /// What it says in a test; every other answer comes in two blocks.
    pub fn record(self) -> Result<Vec<u8>> {
        let said = Arc::default();
        test(Recorded { actor: self, lines: 0, said: Arc::clone(&said) })?;
        let said = said.lock().unwrap_or_else(PoisonError::into_inner);
        let blocks = said.iter().enumerate().flat_map(|(i, answer)| {
            let (first, second) = answer.as_bytes().split_at(answer.len() / 2);
            if i % 2 == 0 { vec![answer.as_bytes()] } else { vec![first, second] }
        });
        Ok(blocks.collect::<Vec<_>>().join(&CUT))
    }
}

/// A program of which only [`SAMPLES`] are drawn, and whose density is asked for once in every cell.
struct Few<P>(Program<P>);

impl<P: Coordinates> Sampler<P> for Few<P> {
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample<P>>>) -> etalon_stats::Result<()> {
        self.0.sample(u, out)
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample<P>>>) -> etalon_stats::Result<()> {
        self.0.sample_seeded(count, seed, out)
    }

    fn finite_len(&self) -> Option<u64> {
        Some(SAMPLES)
    }

    fn invert(&self, point: P) -> etalon_stats::Result<Option<Vec<f64>>> {
        self.0.invert(point)
    }
}

impl<P: Coordinates> Density<P> for Few<P> {
    fn pdf(&self, points: &[P], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        self.0.pdf(points, out)
    }

    fn mass(&self) -> Mass {
        self.0.mass()
    }

    fn atoms(&self) -> Vec<Atom<P>> {
        self.0.atoms()
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        Some([Vec::new(), Vec::new()])
    }
}
