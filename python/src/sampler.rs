//! Samplers and pdfs that are functions of Python.

use crate::arrays::{Numbers, flags, numbers, rows};
use crate::caller::{Caller, run};
use crate::calls::Calls;
use crate::found::Found;
use etalon::protocol::sampler::Space;
use etalon::study::validation::{Case, run as validate};
use etalon_stats::bsdf::Parameter;
use etalon_stats::sweep::over_ranges;
use etalon_stats::{
    Atom, Chart, ChartFunctions, Density, Domain, Extremes as _, Mass, Outcome, Place, Point, Protocol,
    SINGLE_PRECISION, Sample, SampleCount, Sampler, Verdict, examine, explain, place,
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
    /// The pdf, or the target of weights.
    pdf: Option<Py<PyAny>>,
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
    /// Whether samples carry weights.
    weighted: bool,
    stochastic: bool,
    /// Points and boxes of the chart.
    narrow: Vec<Vec<f64>>,
    /// Names, values, and the ends of the ranges.
    parameters: Vec<(String, f64, f64, f64)>,
    /// The functions for values of the parameters.
    at: Py<PyAny>,
}

/// What a pdf integrates to.
#[derive(FromPyObject)]
pub enum DeclaredMass {
    /// This.
    Exactly(f64),
    /// In words.
    Words(String),
}

/// A domain: its name, or a chart of the user's own.
#[derive(FromPyObject)]
pub enum DeclaredDomain {
    Name(String),
    Chart(DeclaredChart),
}

/// The functions of a chart, and what is declared of them.
#[derive(FromPyObject)]
pub struct DeclaredChart {
    to_cube: Py<PyAny>,
    from_cube: Py<PyAny>,
    jacobian: Py<PyAny>,
    /// The dimension of the unit cube: 1 to 6.
    dimension: usize,
    /// Names of the coordinates of the cube.
    names: Vec<String>,
}

impl DeclaredDomain {
    fn space(self, caller: &Caller) -> etalon::Result<Space> {
        let DeclaredChart { to_cube, from_cube, jacobian, dimension, names } = match self {
            Self::Name(name) => return name.parse(),
            Self::Chart(chart) => chart,
        };
        let [to_cube, from_cube, jacobian] = [to_cube, from_cube, jacobian].map(Arc::new);
        let functions = OwnChart { caller: caller.clone(), to_cube, from_cube, jacobian, dimension };
        let chart = Chart::new(functions, dimension).with_axes(names);
        chart.check()?;
        Ok(Space::new("of its own chart", chart))
    }
}

/// The functions of a chart.
struct OwnChart {
    caller: Caller,
    to_cube: Arc<Py<PyAny>>,
    from_cube: Arc<Py<PyAny>>,
    jacobian: Arc<Py<PyAny>>,
    dimension: usize,
}

/// An array (n, width), or (n,) of one coordinate each.
fn array(py: Python<'_>, values: Vec<f64>, width: usize) -> PyResult<Bound<'_, PyAny>> {
    if width == 1 { Ok(values.into_pyarray(py).into_any()) } else { rows(py, values, width) }
}

impl OwnChart {
    /// Calls a function with places of the cube; `read` takes what it returns for n of them.
    fn at_places<T: Send + 'static>(
        &self,
        function: &Arc<Py<PyAny>>,
        cube: &[Place],
        read: impl FnOnce(&Bound<'_, PyAny>, usize) -> PyResult<T> + Send + 'static,
    ) -> etalon_stats::Result<T> {
        let (function, d, n) = (Arc::clone(function), self.dimension, cube.len());
        let cube: Vec<f64> = cube.iter().flat_map(|place| &place[..d]).copied().collect();
        self.caller.call(move |py| read(&function.bind(py).call1((array(py, cube, d)?,))?, n))
    }
}

impl ChartFunctions for OwnChart {
    fn to_cube(&self, points: &[Point]) -> etalon_stats::Result<Vec<Place>> {
        let Some(first) = points.first() else { return Ok(Vec::new()) };
        let (width, n, d) = (first.coordinates().len(), points.len(), self.dimension);
        let (function, coordinates) = (Arc::clone(&self.to_cube), coordinates(points));
        self.caller.call(move |py| {
            let returned = numbers(&function.bind(py).call1((array(py, coordinates, width)?,))?, "to_cube")?;
            let shapes: [&[usize]; 2] = [&[n, d], &[n]];
            let cube: Vec<f64> = returned.of_shape(if d == 1 { &shapes } else { &shapes[..1] })?;
            Ok(cube.chunks_exact(d).map(place).collect())
        })
    }

    fn from_cube(&self, cube: &[Place]) -> etalon_stats::Result<Vec<Point>> {
        self.at_places(&self.from_cube, cube, |returned, n| {
            let points: Numbers<f64> = numbers(returned, "from_cube")?;
            let width = match points.shape[..] {
                [rows] if rows == n => 1,
                [rows, width @ 1..=8] if rows == n => width,
                _ => return Err(points.wrong_shape(&format!("({n},) or ({n}, 2 to 8)"))),
            };
            Ok(points.values.chunks_exact(width).filter_map(Point::of).collect())
        })
    }

    fn jacobian(&self, cube: &[Place]) -> etalon_stats::Result<Vec<f64>> {
        self.at_places(&self.jacobian, cube, |returned, n| numbers(returned, "jacobian")?.of_shape(&[&[n]]))
    }
}

/// Tests samples against their pdf.
#[pyfunction]
pub fn check_sampler(py: Python<'_>, declared: Declared, domain: DeclaredDomain, plan: Plan) -> PyResult<Found> {
    let mass = match declared.mass {
        DeclaredMass::Exactly(mass) => Mass::Exactly(mass),
        DeclaredMass::Words(words) if words == "unknown" => Mass::Unknown,
        DeclaredMass::Words(_) => Mass::AtMostOne,
    };
    let table = declared.table.map(|(rows, columns)| [rows, columns]);
    let precision = if declared.precision < 0.0 { SINGLE_PRECISION } else { declared.precision };
    let (name, protocol) = (declared.name, plan.protocol());
    let (sample, at) = (Arc::new(declared.sample), declared.at);
    let [pdf, invert] = [declared.pdf, declared.invert].map(|function| function.map(Arc::new));
    let (weighted, stochastic) = (declared.weighted, declared.stochastic);
    let parameter = |(name, value, from, to): (String, f64, f64, f64)| Parameter::new(name, value, [from, to]);
    let parameters: Vec<Parameter> = declared.parameters.into_iter().map(parameter).collect();
    let narrow = declared.narrow.iter().map(|place| match place[..] {
        [x0, y0, x1, y1] => [[x0.at_most(x1), x1.at_least(x0)], [y0.at_most(y1), y1.at_least(y0)]],
        [x, y] => [[x; 2], [y; 2]],
        _ => [[place[0]; 2], [0.0, 1.0]],
    });
    let narrow: Vec<[[f64; 2]; 2]> = narrow.collect();
    let (of_points, dimension) = (declared.atoms, declared.dimension);
    let what = name.clone();
    let tested = run(py, &what, move |caller| {
        let space = domain.space(&caller)?;
        let atom = |(point, probability): &(Vec<f64>, f64)| {
            let is_right = point.len() == space.width() && (0.0..=1.0).contains(probability);
            let found = space.point(point).filter(|&point| is_right && space.domain().to_chart(point).is_some());
            let wrong = format!("({point:?}, {probability}) is no point of the domain with its probability");
            let point = found.ok_or_else(|| etalon::Error::parameter("atoms", wrong))?;
            Ok(Atom { point, probability: *probability })
        };
        let atoms = of_points.iter().map(atom).collect::<etalon::Result<Vec<_>>>()?;
        let dimension = dimension.unwrap_or(if space.width() > 1 { 2 } else { 1 });
        if let Some(sides) = table {
            space.steps(sides)?;
        }
        let functions = Functions {
            caller,
            space: space.clone(),
            sample,
            pdf,
            invert,
            dimension,
            mass,
            table,
            precision,
            atoms,
            weighted,
            stochastic,
            narrow,
            calls: Default::default(),
        };
        let calls = functions.calls.clone();
        // As the command line runs it: the random numbers depend on the name, too
        let own = space.clone();
        let test = move |protocol: &Protocol, round| -> etalon::Result<Outcome> {
            let of = |functions: &Functions, protocol: &Protocol| {
                examine(own.domain(), functions, functions, protocol, round)
            };
            if parameters.is_empty() {
                return Ok(of(&functions, protocol)?);
            }
            Ok(over_ranges(&parameters, protocol, round, |values, protocol, _| {
                of(&functions.with(&at, values)?, protocol)
            })?)
        };
        let case = Case::new(name, test);
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
#[derive(Clone)]
struct Functions {
    caller: Caller,
    space: Space,
    sample: Arc<Py<PyAny>>,
    pdf: Option<Arc<Py<PyAny>>>,
    invert: Option<Arc<Py<PyAny>>>,
    dimension: usize,
    mass: Mass,
    table: Option<[usize; 2]>,
    precision: f64,
    atoms: Vec<Atom>,
    weighted: bool,
    stochastic: bool,
    narrow: Vec<[[f64; 2]; 2]>,
    /// Calls of `sample` and of `pdf`.
    calls: Arc<[Calls; 2]>,
}

impl Functions {
    /// The same for these values of the parameters, for which `at` has the functions.
    fn with(&self, at: &Py<PyAny>, values: &[f64]) -> etalon_stats::Result<Self> {
        let (at, values) = (Python::attach(|py| at.clone_ref(py)), values.to_vec());
        let (sample, pdf, invert) = self.caller.call(move |py| {
            let functions: (Py<PyAny>, Option<Py<PyAny>>, Option<Py<PyAny>>) =
                at.bind(py).call1(PyTuple::new(py, values)?)?.extract()?;
            Ok(functions)
        })?;
        let [pdf, invert] = [pdf, invert].map(|function| function.map(Arc::new));
        Ok(Self { sample: Arc::new(sample), pdf, invert, ..self.clone() })
    }

    /// Appends the samples that `call` has the function return.
    fn append(
        &self,
        call: impl FnOnce(&Space, &Bound<'_, PyAny>) -> PyResult<Vec<Option<Sample>>> + Send + 'static,
        out: &mut Vec<Option<Sample>>,
    ) -> etalon_stats::Result<()> {
        let (space, sample) = (self.space.clone(), Arc::clone(&self.sample));
        out.append(&mut self.caller.call(move |py| call(&space, sample.bind(py)))?);
        Ok(())
    }
}

impl Sampler for Functions {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let (u, dimension, calls) = (u.to_vec(), self.dimension, Arc::clone(&self.calls));
        let weighted = self.weighted;
        let call = move |space: &Space, sample: &Bound<'_, PyAny>| {
            let py = sample.py();
            let some = |range: Range<usize>| {
                let u = rows(py, u[range.start * dimension..range.end * dimension].to_vec(), dimension)?;
                samples(space, &sample.call1((&u,))?, range.len(), weighted)
            };
            let given = |i: usize| format!("u = {:?}", &u[i * dimension..(i + 1) * dimension]);
            calls[0].of_rows(py, ("sample", u.len() / dimension), nowhere(space), some, given)
        };
        self.append(call, out)
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let (calls, weighted) = (Arc::clone(&self.calls), self.weighted);
        let call = move |space: &Space, sample: &Bound<'_, PyAny>| {
            let some = |range: Range<usize>| samples(space, &sample.call1((range.len(), seed))?, range.len(), weighted);
            let given = |_: usize| format!("n = 1, seed = {seed}");
            calls[0].of_rows(sample.py(), ("sample", count), nowhere(space), some, given)
        };
        self.append(call, out)
    }

    fn invert(&self, point: Point) -> etalon_stats::Result<Option<Vec<f64>>> {
        let Some(invert) = self.invert.clone() else { return Ok(None) };
        let (dimension, space, coordinates) = (self.dimension, self.space.clone(), coordinates(&[point]));
        self.caller.call(move |py| {
            let u = invert.bind(py).call1((points(py, &space, coordinates)?,))?;
            numbers(&u, "invert")?.of_shape(&[&[1, dimension]]).map(Some)
        })
    }
}

impl Density for Functions {
    fn pdf(&self, at: &[Point], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        if at.is_empty() {
            return Ok(());
        }
        let Some(pdf) = self.pdf.clone() else {
            out.resize(out.len() + at.len(), 1.0);
            return Ok(());
        };
        let (count, space, coordinates) = (at.len(), self.space.clone(), coordinates(at));
        let calls = Arc::clone(&self.calls);
        let job = move |py: Python<'_>| {
            let width = space.width();
            let of = |range: Range<usize>| coordinates[range.start * width..range.end * width].to_vec();
            let some = |range: Range<usize>| {
                let x = points(py, &space, of(range.clone()))?;
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

    fn is_target(&self) -> bool {
        self.weighted
    }

    fn is_stochastic(&self) -> bool {
        self.stochastic
    }

    fn narrow(&self) -> Vec<[[f64; 2]; 2]> {
        self.narrow.clone()
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        self.space.steps(self.table?).ok()
    }
}

/// The coordinates of points, one point after another.
fn coordinates(points: &[Point]) -> Vec<f64> {
    points.iter().flat_map(|point| point.coordinates()).copied().collect()
}

/// Points as an array: (n, d); (n,) for points with one coordinate, of integers for a finite set.
fn points<'py>(py: Python<'py>, space: &Space, coordinates: Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
    match space.domain().names()[..] {
        ["i"] => Ok(coordinates.into_iter().map(|i| i as i64).collect::<Vec<_>>().into_pyarray(py).into_any()),
        _ => array(py, coordinates, space.width()),
    }
}

/// A sample that is outside of any domain.
fn nowhere(space: &Space) -> Option<Sample> {
    let points = [vec![f64::NAN; space.width()], vec![f64::from(u32::MAX); space.width()]];
    points.iter().find_map(|point| space.point(point)).map(Sample::new)
}

/// The samples that a function has returned: an array of points, or `Samples`.
fn samples(space: &Space, returned: &Bound<'_, PyAny>, n: usize, weighted: bool) -> PyResult<Vec<Option<Sample>>> {
    let [x, pdf, valid, atom, weight] = match returned.cast::<PyTuple>() {
        Err(_) => [Some(returned.clone()), None, None, None, None],
        Ok(parts) if parts.len() == 5 => {
            let part = |i: usize| parts.get_item(i).map(|part| Some(part).filter(|part| !part.is_none()));
            [part(0)?, part(1)?, part(2)?, part(3)?, part(4)?]
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
    let row = |values: Option<Bound<'_, PyAny>>, name: &str| -> PyResult<Option<Vec<f64>>> {
        values.map(|values| numbers::<f64>(&values, name)?.of_shape(&[&[n]])).transpose()
    };
    let (pdf, weight) = (row(pdf, "sample.pdf")?, row(weight, "sample.weight")?);
    if weighted && weight.is_none() {
        return Err(PyTypeError::new_err("sample: no weights, and no pdf is given; wanted Samples(x, weight=…)"));
    }
    let of_row = |(i, row): (usize, &[f64])| -> PyResult<_> {
        if !valid[i] {
            return Ok(None);
        }
        let no_point = || PyValueError::new_err(format!("sample: {row:?} in row {i} is no point of the domain"));
        let point = space.point(row).ok_or_else(no_point)?;
        let pdf = pdf.as_ref().map(|pdf| pdf[i]).filter(|_| !atom[i]);
        let weight = weight.as_ref().filter(|_| weighted).map_or(1.0, |weight| weight[i]);
        Ok(Some(Sample { point, pdf, atom: atom[i], weight }))
    };
    let mut samples = Vec::with_capacity(n);
    for row in coordinates.chunks_exact(d).enumerate() {
        samples.push(of_row(row)?);
    }
    Ok(samples)
}

/// The names of all domains, in a sentence.
#[pyfunction]
pub fn domains() -> String {
    Space::known()
}
