//! Samplers and pdfs that are functions of Python.

use crate::arrays::{Numbers, flags, numbers, rows};
use crate::caller::{Caller, run};
use crate::calls::Calls;
use crate::found::Found;
use etalon::protocol::sampler::Space;
use etalon::study::validation::{Case, run as validate};
use etalon_stats::{
    Atom, Density, Mass, Point, Protocol, SINGLE_PRECISION, Sample, SampleCount, Sampler, Verdict, examine, explain,
};
use numpy::IntoPyArray;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::ops::Range;
use std::sync::Arc;

/// How a test is done.
#[derive(FromPyObject)]
pub struct Plan {
    level: f64,
    detect: f64,
    samples: Option<u64>,
    seed: u64,
}

impl Plan {
    pub fn protocol(&self) -> Protocol {
        let samples = self.samples.map_or(SampleCount::Detect(self.detect), SampleCount::Fixed);
        Protocol { seed: self.seed, samples, level: self.level, ..Protocol::default() }
    }
}

/// A sampler's functions, and what is declared of them.
#[derive(FromPyObject)]
pub struct Declared {
    name: String,
    sample: Py<PyAny>,
    pdf: Py<PyAny>,
    invert: Option<Py<PyAny>>,
    /// Random numbers of a sample; the coordinates of the domain by default.
    dimension: Option<usize>,
    /// The integral of the pdf, "at-most-1" or "unknown".
    mass: DeclaredMass,
    /// Rows and columns of the table in whose cells the pdf is constant.
    table: Option<(usize, usize)>,
    /// Precision of the pdfs that samples carry; negative for single precision.
    precision: f64,
    /// Points with their probabilities.
    atoms: Vec<(Vec<f64>, f64)>,
}

/// What a pdf integrates to.
#[derive(FromPyObject)]
pub enum DeclaredMass {
    /// This.
    Exactly(f64),
    /// In words.
    Words(String),
}

/// Tests samples against their pdf.
#[pyfunction]
pub fn check_sampler(py: Python<'_>, declared: Declared, domain: &str, plan: Plan) -> PyResult<Found> {
    let space: Space = domain.parse().map_err(crate::errors::of)?;
    let atom = |(point, probability): &(Vec<f64>, f64)| {
        let is_right = point.len() == space.width() && (0.0..=1.0).contains(probability);
        let found = space.point(point).filter(|&point| is_right && space.domain().to_chart(point).is_some());
        let wrong = "is no point of the domain with its probability";
        let wrong = || PyValueError::new_err(format!("atoms: ({point:?}, {probability}) {wrong}"));
        Ok(Atom { point: found.ok_or_else(wrong)?, probability: *probability })
    };
    let atoms = declared.atoms.iter().map(atom).collect::<PyResult<Vec<_>>>()?;
    let dimension = declared.dimension.unwrap_or(if space.width() > 1 { 2 } else { 1 });
    let mass = match declared.mass {
        DeclaredMass::Exactly(mass) => Mass::Exactly(mass),
        DeclaredMass::Words(words) if words == "unknown" => Mass::Unknown,
        DeclaredMass::Words(_) => Mass::AtMostOne,
    };
    let table = declared.table.map(|(rows, columns)| [rows, columns]);
    let precision = if declared.precision < 0.0 { SINGLE_PRECISION } else { declared.precision };
    let (name, protocol) = (declared.name, plan.protocol());
    let [sample, pdf] = [declared.sample, declared.pdf].map(Arc::new);
    let invert = declared.invert.map(Arc::new);
    let what = name.clone();
    let tested = run(py, &what, move |caller| {
        let functions = Functions {
            caller,
            space,
            sample,
            pdf,
            invert,
            dimension,
            mass,
            table,
            precision,
            atoms,
            calls: Default::default(),
        };
        let calls = functions.calls.clone();
        // As the command line runs it: the random numbers depend on the name, too
        let case = Case::new(name, move |protocol, round| {
            Ok(examine(space.domain(), &functions, &functions, protocol, round)?)
        });
        let mut tested = validate(&[case], &protocol, &|_| ())?.tests.pop();
        if let (Some(test), Some(raised)) = (&mut tested, calls.iter().find_map(|calls| calls.raised())) {
            let outcome = &mut test.outcome;
            (outcome.mistake, outcome.violation, outcome.p) = (None, Some(raised), None);
            outcome.verdict = Verdict::Reject;
        }
        Ok(tested.map(|test| (explain(space.domain(), &test.outcome, &protocol), test)))
    })?;
    let (text, test) = tested.ok_or_else(|| PyRuntimeError::new_err("no test was done"))?;
    Ok(Found::of_test(test, Some(text)))
}

/// A sampler and its pdf over a domain.
struct Functions {
    caller: Caller,
    space: Space,
    sample: Arc<Py<PyAny>>,
    pdf: Arc<Py<PyAny>>,
    invert: Option<Arc<Py<PyAny>>>,
    dimension: usize,
    mass: Mass,
    table: Option<[usize; 2]>,
    precision: f64,
    atoms: Vec<Atom>,
    /// Calls of `sample` and of `pdf`.
    calls: Arc<[Calls; 2]>,
}

impl Functions {
    /// Appends the samples that `call` has the function return.
    fn append(
        &self,
        call: impl FnOnce(Space, &Bound<'_, PyAny>) -> PyResult<Vec<Option<Sample>>> + Send + 'static,
        out: &mut Vec<Option<Sample>>,
    ) -> etalon_stats::Result<()> {
        let (space, sample) = (self.space, Arc::clone(&self.sample));
        out.append(&mut self.caller.call(move |py| call(space, sample.bind(py)))?);
        Ok(())
    }
}

impl Sampler for Functions {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let (u, dimension, calls) = (u.to_vec(), self.dimension, Arc::clone(&self.calls));
        let call = move |space: Space, sample: &Bound<'_, PyAny>| {
            let py = sample.py();
            let some = |range: Range<usize>| {
                let u = rows(py, u[range.start * dimension..range.end * dimension].to_vec(), dimension)?;
                samples(space, &sample.call1((&u,))?, range.len())
            };
            let given = |i: usize| format!("u = {:?}", &u[i * dimension..(i + 1) * dimension]);
            calls[0].of_rows(py, ("sample", u.len() / dimension), nowhere(space), some, given)
        };
        self.append(call, out)
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let calls = Arc::clone(&self.calls);
        let call = move |space: Space, sample: &Bound<'_, PyAny>| {
            let some = |range: Range<usize>| samples(space, &sample.call1((range.len(), seed))?, range.len());
            let given = |_: usize| format!("n = 1, seed = {seed}");
            calls[0].of_rows(sample.py(), ("sample", count), nowhere(space), some, given)
        };
        self.append(call, out)
    }

    fn invert(&self, point: Point) -> etalon_stats::Result<Option<Vec<f64>>> {
        let Some(invert) = self.invert.clone() else { return Ok(None) };
        let (dimension, space, coordinates) = (self.dimension, self.space, coordinates(&[point]));
        self.caller.call(move |py| {
            let u = invert.bind(py).call1((points(py, space, coordinates)?,))?;
            numbers(&u, "invert")?.of_shape(&[&[1, dimension]]).map(Some)
        })
    }
}

impl Density for Functions {
    fn pdf(&self, at: &[Point], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        if at.is_empty() {
            return Ok(());
        }
        let (count, space, coordinates, pdf) = (at.len(), self.space, coordinates(at), Arc::clone(&self.pdf));
        let calls = Arc::clone(&self.calls);
        let job = move |py: Python<'_>| {
            let of = |range: Range<usize>| coordinates[range.start * space.width()..range.end * space.width()].to_vec();
            let some = |range: Range<usize>| {
                let x = points(py, space, of(range.clone()))?;
                numbers(&pdf.bind(py).call1((&x,))?, "pdf")?.of_shape(&[&[range.len()]])
            };
            calls[1].of_rows(py, ("pdf", count), f64::NAN, some, |i| format!("x = {:?}", of(i..i + 1)))
        };
        out.append(&mut self.caller.call(job)?);
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.mass
    }

    fn atoms(&self) -> Vec<Atom> {
        self.atoms.clone()
    }

    fn precision(&self) -> f64 {
        self.precision
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        self.table.map(|sides| self.space.steps(sides))
    }
}

/// The coordinates of points, one point after another.
fn coordinates(points: &[Point]) -> Vec<f64> {
    points.iter().flat_map(|point| point.coordinates()).copied().collect()
}

/// Points as an array: (n, d); (n,) for points with one coordinate, of integers for a finite set.
fn points(py: Python<'_>, space: Space, coordinates: Vec<f64>) -> PyResult<Bound<'_, PyAny>> {
    match space.names()[0] {
        ["i"] => Ok(coordinates.into_iter().map(|i| i as i64).collect::<Vec<_>>().into_pyarray(py).into_any()),
        [_] => Ok(coordinates.into_pyarray(py).into_any()),
        names => rows(py, coordinates, names.len()),
    }
}

/// A sample that is outside of any domain.
fn nowhere(space: Space) -> Option<Sample> {
    let points = [vec![f64::NAN; space.width()], vec![f64::from(u32::MAX); space.width()]];
    points.iter().find_map(|point| space.point(point)).map(Sample::new)
}

/// The samples that a function has returned: an array of points, or `Samples`.
fn samples(space: Space, returned: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<Option<Sample>>> {
    let [x, pdf, valid, atom] = match returned.cast::<PyTuple>() {
        Err(_) => [Some(returned.clone()), None, None, None],
        Ok(parts) if parts.len() == 4 => {
            let part = |i: usize| parts.get_item(i).map(|part| Some(part).filter(|part| !part.is_none()));
            [part(0)?, part(1)?, part(2)?, part(3)?]
        }
        Ok(parts) => {
            let found = format!("sample: a tuple of {}; wanted an array of points, or Samples(x, …)", parts.len());
            return Err(PyTypeError::new_err(found));
        }
    };
    let x = x.ok_or_else(|| PyTypeError::new_err("sample: no points"))?;
    let (valid, atom) =
        (flags(valid.as_ref(), "sample.valid", n, true)?, flags(atom.as_ref(), "sample.atom", n, false)?);
    let x: Numbers<f64> = numbers(&x, "sample")?;
    let d = space.width();
    let coordinates = if d == 1 { x.of_shape(&[&[n], &[n, 1]])? } else { x.of_shape(&[&[n, d]])? };
    let pdf = match pdf {
        None => None,
        Some(pdf) => Some(numbers::<f64>(&pdf, "sample.pdf")?.of_shape(&[&[n]])?),
    };
    let of_row = |(i, row): (usize, &[f64])| -> PyResult<_> {
        if !valid[i] {
            return Ok(None);
        }
        let no_point = || PyValueError::new_err(format!("sample: {row:?} in row {i} is no point of the domain"));
        let point = space.point(row).ok_or_else(no_point)?;
        let pdf = pdf.as_ref().map(|pdf| pdf[i]).filter(|_| !atom[i]);
        Ok(Some(Sample { point, pdf, atom: atom[i] }))
    };
    let mut samples = Vec::with_capacity(n);
    for row in coordinates.chunks_exact(d).enumerate() {
        samples.push(of_row(row)?);
    }
    Ok(samples)
}
