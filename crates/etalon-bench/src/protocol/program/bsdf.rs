//! BSDFs, phase functions and lights over their parameters in another program.
//!
//! | request | response |
//! |---|---|
//! | `etalon 1` | `etalon 1 kind=KIND KEY=VALUE …`, then a line `name default from to` for each parameter |
//! | `set VALUE …`, one for each parameter | nothing, or a line `KEY=VALUE …` of what these values change |
//! | `eval N`, then N lines `wo wi [random numbers]` | N lines with f in every channel |
//! | `pdf N`, then N lines `wo wi` | N lines with the pdf |
//! | `sample N`, then N lines `wo random numbers` | N lines `wi weight [pdf [point]]`, `delta wi weight probability [point]` or `none` |
//! | `hits N`, then N lines `wo wi`, of a light that has them | N lines `distance normal [pdf per area]` or `none` |
//! | `lobes N`, then N lines `wo`, if it has delta lobes | N lines `wi probability throughput …` of all lobes, or `none` |

use super::connection::{self, Connection, protocol_error};
use super::properties::{Greeting, declared};
use crate::protocol::sampler::write_numbers;
use etalon_core::error::Result;
use etalon_core::import::place::{number, quote, real};
use etalon_stats::bsdf::{
    BatchBsdf, BsdfSample, DeltaLobe, Density, Direction, Family, Hit, Kind, Pair, Parameter, PdfKind, Properties,
    Spectrum,
};
use std::sync::{Mutex, PoisonError};

/// Most lines of a request.
const BATCH: usize = 1 << 13;

/// A running program. One request is in flight at a time; requests for different parameters may alternate.
pub struct Program {
    name: String,
    parameters: Vec<Parameter>,
    properties: Properties,
    state: Mutex<State>,
}

pub(super) struct State {
    pub connection: Box<dyn Connection>,
    /// The values of the parameters that were set last, and what the program answered.
    set: Option<(Vec<f64>, String)>,
}

impl State {
    pub fn new(connection: impl Connection + 'static) -> Self {
        Self { connection: Box::new(connection), set: None }
    }

    /// Sets the parameters unless they are set; returns the answer.
    pub fn set(&mut self, values: &[f64]) -> Result<&str> {
        if values.is_empty() {
            return Ok("");
        }
        if self.set.as_ref().is_none_or(|(known, _)| known != values) {
            let mut request = "set ".to_owned();
            write_numbers(values, &mut request);
            request.push('\n');
            self.set = None;
            let answer = self.connection.ask(request, 1)?;
            self.set = Some((values.to_vec(), answer));
        }
        Ok(self.set.as_ref().map_or("", |(_, answer)| answer))
    }
}

impl Program {
    pub(super) fn new(
        connection: impl Connection + 'static,
        mut greeting: Greeting,
        known: Properties,
    ) -> Result<Self> {
        let name = greeting.take("name").unwrap_or_else(|| "exec".to_owned());
        let properties = declared(known, &greeting)?;
        let parameters = greeting.lines.iter().map(|line| parameter(&greeting.program, line)).collect::<Result<_>>()?;
        let state = Mutex::new(State::new(connection));
        Ok(Self { name, parameters, properties, state })
    }
}

pub(super) fn parameter(program: &str, line: &str) -> Result<Parameter> {
    let read = || {
        let [name, value, from, to] = line.split_ascii_whitespace().collect::<Vec<_>>().try_into().ok()?;
        let [value, from, to] = [real(value)?, real(from)?, real(to)?];
        let is_sound = from.is_finite() && to.is_finite() && (from..=to).contains(&value);
        is_sound.then(|| Parameter::new(name, value, [from, to]))
    };
    let wrong = || format!("its parameter {} is not \"NAME VALUE FROM TO\" with FROM ≤ VALUE ≤ TO", quote(line));
    read().ok_or_else(|| protocol_error(program, wrong()))
}

impl Family for Program {
    fn name(&self) -> &str {
        &self.name
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.parameters.clone()
    }

    /// Each change of parameters is a request.
    fn is_sequential(&self) -> bool {
        true
    }

    fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn BatchBsdf + '_>> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = state.set(values)?.to_owned();
        let greeting = Greeting::of_line(state.connection.name(), &answer)?;
        let valued = |(parameter, &value): (&Parameter, &f64)| Parameter { value, ..parameter.clone() };
        let parameters = self.parameters.iter().zip(values).map(valued).collect();
        let properties = Properties { parameters, ..declared(self.properties.clone(), &greeting)? };
        Ok(Box::new(Configured { program: self, values: values.to_vec(), properties }))
    }
}

/// The BSDF of a program for some values of its parameters.
struct Configured<'a> {
    program: &'a Program,
    values: Vec<f64>,
    properties: Properties,
}

impl Configured<'_> {
    /// Asks `verb` for as many lines as `lines` yields, each a list of numbers, and reads the words of each answer by `read`.
    fn ask<T>(
        &self,
        verb: [&str; 2],
        lines: impl Iterator<Item = Vec<f64>>,
        read: impl Fn(&[&str]) -> Option<T>,
    ) -> Result<Vec<T>> {
        let (mut lines, mut answers) = (lines.peekable(), Vec::new());
        while lines.peek().is_some() {
            let (mut text, mut count) = (String::new(), 0);
            for numbers in lines.by_ref().take(BATCH) {
                write_numbers(&numbers, &mut text);
                text.push('\n');
                count += 1;
            }
            let request = format!("{} {count}\n{text}", verb[0]);
            // A panic elsewhere leaves nothing half done that matters here.
            let mut state = self.program.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.set(&self.values)?;
            answers.extend(connection::ask(&mut *state.connection, verb, count, request, &read)?);
        }
        Ok(answers)
    }

    /// A value for each channel, of one channel for all.
    fn spectrum(&self, values: &[f64]) -> Option<Spectrum> {
        match values {
            [all] if self.properties.channels == 1 => Some([*all; 3]),
            _ => values.try_into().ok(),
        }
    }

    fn read_sample(&self, words: &[&str]) -> Option<Option<BsdfSample>> {
        let (is_delta, words) = match words {
            ["none"] => return Some(None),
            ["delta", rest @ ..] => (true, rest),
            all => (false, all),
        };
        let numbers = numbers(words)?;
        let (wi, rest) = numbers.split_first_chunk::<3>()?;
        let (weight, density) = rest.split_at_checked(self.properties.channels)?;
        let is_light = matches!(self.properties.kind, Kind::Light { .. });
        let (density, point) = match density {
            [density, point @ ..] if is_light && point.len() == 3 => (&[*density][..], point.try_into().ok()),
            all => (all, None),
        };
        let density = match density {
            [probability] if is_delta => Density::Delta(*probability),
            [pdf] => Density::Pdf(*pdf),
            [] if !is_delta => Density::Unknown,
            _ => return None,
        };
        Some(Some(BsdfSample { point, ..BsdfSample::new(*wi, self.spectrum(weight)?, density) }))
    }

    fn read_lobes(&self, words: &[&str]) -> Option<Vec<DeltaLobe>> {
        if words == ["none"] {
            return Some(Vec::new());
        }
        let lobe = |numbers: &[f64]| {
            let (wi, rest) = numbers.split_first_chunk::<3>()?;
            let (probability, throughput) = rest.split_first()?;
            Some(DeltaLobe { wi: *wi, probability: *probability, throughput: self.spectrum(throughput)? })
        };
        let numbers = numbers(words).filter(|numbers| !numbers.iter().any(|x| x.is_nan()))?;
        numbers.chunks(4 + self.properties.channels).map(lobe).collect()
    }
}

fn numbers(words: &[&str]) -> Option<Vec<f64>> {
    words.iter().map(|word| number(word)).collect()
}

fn line(pair: &Pair) -> Vec<f64> {
    pair.concat()
}

impl BatchBsdf for Configured<'_> {
    fn properties(&self) -> Properties {
        self.properties.clone()
    }

    fn eval(&self, pairs: &[Pair], u: &[f64]) -> etalon_stats::Result<Vec<Spectrum>> {
        let each = self.properties.eval_dimension;
        let u = |i: usize| u.get(i * each..(i + 1) * each).unwrap_or_default();
        let lines = pairs.iter().enumerate().map(|(i, pair)| [&line(pair), u(i)].concat());
        Ok(self.ask(["eval", "f in every channel"], lines, |words| self.spectrum(&numbers(words)?))?)
    }

    /// 0 everywhere if there is none.
    fn pdf(&self, pairs: &[Pair]) -> etalon_stats::Result<Vec<f64>> {
        if self.properties.pdf == PdfKind::None {
            return Ok(vec![0.0; pairs.len()]);
        }
        let read = |words: &[&str]| match words {
            [pdf] => number(pdf),
            _ => None,
        };
        Ok(self.ask(["pdf", "a pdf"], pairs.iter().map(line), read)?)
    }

    fn sample(&self, wos: &[Direction], u: &[f64]) -> etalon_stats::Result<Vec<Option<BsdfSample>>> {
        let expected = "\"WI WEIGHT PDF\", \"WI WEIGHT\", \"delta WI WEIGHT PROBABILITY\" or \"none\"";
        let samples = wos.iter().zip(u.chunks_exact(self.properties.dimension));
        let lines = samples.map(|(wo, u)| [&wo[..], u].concat());
        Ok(self.ask(["sample", expected], lines, |words| self.read_sample(words))?)
    }

    fn delta_lobes(&self, wos: &[Direction]) -> etalon_stats::Result<Vec<Vec<DeltaLobe>>> {
        if !self.properties.delta {
            return Ok(vec![Vec::new(); wos.len()]);
        }
        let expected = "\"WI PROBABILITY THROUGHPUT\" for each lobe, or \"none\"";
        let lines = wos.iter().map(|wo| wo.to_vec());
        Ok(self.ask(["lobes", expected], lines, |words| self.read_lobes(words))?)
    }

    fn hits(&self, pairs: &[Pair]) -> etalon_stats::Result<Vec<Option<Hit>>> {
        if !matches!(self.properties.kind, Kind::Light { hits: true, .. }) {
            return Ok(vec![None; pairs.len()]);
        }
        let read = |words: &[&str]| match numbers(words) {
            _ if words == ["none"] => Some(None),
            Some(numbers) => match numbers[..] {
                [distance, x, y, z] => Some(Some(Hit { distance, normal: [x, y, z], pdf_area: None })),
                [distance, x, y, z, pdf] => Some(Some(Hit { distance, normal: [x, y, z], pdf_area: Some(pdf) })),
                _ => None,
            },
            None => None,
        };
        Ok(self.ask(
            ["hits", "\"DISTANCE NORMAL\", \"DISTANCE NORMAL PDF\" or \"none\""],
            pairs.iter().map(line),
            read,
        )?)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{External, connect};
    use super::*;
    use etalon_stats::bsdf::Energy;
    use std::sync::Arc;

    /// A program that remembers what it was asked and answers by `answers`.
    struct Recorded {
        asked: Arc<Mutex<Vec<String>>>,
        answers: fn(&str) -> String,
    }

    impl Connection for Recorded {
        fn name(&self) -> &str {
            "recorded"
        }

        fn ask(&mut self, request: String, _: usize) -> Result<String> {
            let answer = (self.answers)(&request);
            self.asked.lock().unwrap().push(request);
            Ok(answer)
        }
    }

    fn program(answers: fn(&str) -> String) -> (Result<Program>, Arc<Mutex<Vec<String>>>) {
        let asked = Arc::new(Mutex::new(Vec::new()));
        let recorded = Recorded { asked: Arc::clone(&asked), answers };
        let program = connect(recorded, None).map(|external| match external {
            External::Bsdf(program) => program,
            External::Sampler(_) => panic!("it has a BSDF"),
        });
        (program, asked)
    }

    fn glass(request: &str) -> String {
        match request.split_whitespace().next() {
            Some("etalon") => "etalon 1 kind=bsdf name=glass delta=yes scatters=both\neta 1.5 1 3\n".to_owned(),
            Some("set") => format!("eta={} energy=conserved:1e-3\n", &request[4..request.len() - 1]),
            Some("sample") => "delta 0 0 1 0x1p-1 0.25\n0 0 1 0.5 2\n0 0 1 0.5\nnone\n".to_owned(),
            Some("lobes") => "0 0 1 0.25 0.5 0 0 -1 0.75 1\nnone\n".to_owned(),
            _ => "0.5\n".to_owned(),
        }
    }

    #[test]
    fn parameters_are_set_when_they_change() {
        let (program, asked) = program(glass);
        let program = program.unwrap();
        let (one, other) = (program.with(&[1.5]).unwrap(), program.with(&[2.0]).unwrap());
        assert_eq!([one.properties().eta, other.properties().eta], [1.5, 2.0]);
        assert_eq!(one.properties().energy, Energy::Conserved(1e-3));
        assert_eq!(other.properties().parameters, [Parameter::new("eta", 2.0, [1.0, 3.0])]);
        let up = [0.0, 0.0, 1.0];
        assert_eq!(other.eval(&[[up, up]], &[]).unwrap(), [[0.5; 3]]);
        assert_eq!((one.pdf(&[[up, up]]).unwrap(), one.pdf(&[]).unwrap()), (vec![0.5], Vec::new()));
        let verbs: Vec<String> =
            asked.lock().unwrap().iter().map(|request| request.lines().next().unwrap_or_default().to_owned()).collect();
        assert_eq!(verbs, ["etalon 1", "set 1.5e0", "set 2e0", "eval 1", "set 1.5e0", "pdf 1"]);
    }

    #[test]
    fn samples_and_lobes_are_read() {
        let program = program(glass).0.unwrap();
        let bsdf = program.with(&[1.5]).unwrap();
        let up = [0.0, 0.0, 1.0];
        let sample = |density| Some(BsdfSample::new(up, [0.5; 3], density));
        let expected = [sample(Density::Delta(0.25)), sample(Density::Pdf(2.0)), sample(Density::Unknown), None];
        assert_eq!(bsdf.sample(&[up; 4], &[0.5; 12]).unwrap(), expected);
        let lobes = bsdf.delta_lobes(&[up; 2]).unwrap();
        assert_eq!((lobes[0].len(), lobes[1].len()), (2, 0));
        assert_eq!(lobes[0][1], DeltaLobe { wi: [0.0, 0.0, -1.0], probability: 0.75, throughput: [1.0; 3] });
    }

    #[test]
    fn greetings_that_make_no_sense_are_refused() {
        let refused = |answers: fn(&str) -> String, why: &str| {
            let error = program(answers).0.err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.contains(why) && error.contains("recorded"), "{error}");
        };
        refused(|_| "etalon 1 kind=lamp\n".to_owned(), "\"kind=lamp\", which has no meaning");
        refused(|_| "etalon 1 kind=light eta=2\n".to_owned(), "\"eta=2\", which has no meaning");
        refused(|_| "etalon 1 kind=phase mean_cosine=2\n".to_owned(), "\"mean_cosine=2\", which has no meaning");
        refused(|_| "etalon 1 kind=bsdf channels=2\n".to_owned(), "\"channels=2\", which has no meaning");
        refused(|_| "etalon 1 kind=bsdf energy=much\n".to_owned(), "energy=much");
        refused(|_| "etalon 1 kind=bsdf map=1,7\n".to_owned(), "has a map");
        refused(|_| "etalon 1 kind=bsdf dimension=65\n".to_owned(), "dimension=65");
        refused(|_| "etalon 1 kind=bsdf\nalpha 2 0 1\n".to_owned(), "\"alpha 2 0 1\" is not");
        refused(|_| "etalon 1 kind=bsdf\nalpha 0.5\n".to_owned(), "is not \"NAME VALUE FROM TO\"");
    }
}
