//! BSDFs, phase functions and lights that are functions of Python.

use crate::arrays::{Given, flags, no_nan, numbers, rows};
use crate::caller::{Caller, run};
use crate::calls::Calls;
use crate::found::Found;
use crate::sampler::Plan;
use etalon::protocol::program::properties::{declare, has_sound_map, of_kind};
use etalon::study::albedo::{Request, albedo_table};
use etalon::study::likeness::Claim;
use etalon::study::validation::{WholeBsdf, families};
use etalon_stats::bsdf::{
    BatchBsdf, BsdfSample, DeltaLobe, Density, Direction, Family, Hit, Pair, Parameter, PdfKind, Properties, Spectrum,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::ops::Range;
use std::sync::Arc;

/// A BSDF's functions, and what is declared of it by the keys of the protocol for external programs.
#[derive(FromPyObject)]
pub struct Declared {
    sample: Py<PyAny>,
    eval: Py<PyAny>,
    pdf: Option<Py<PyAny>>,
    lobes: Option<Py<PyAny>>,
    hit: Option<Py<PyAny>>,
    properties: Vec<(String, String)>,
}

/// Functions with their properties.
struct Functions {
    sample: Py<PyAny>,
    eval: Py<PyAny>,
    pdf: Option<Py<PyAny>>,
    lobes: Option<Py<PyAny>>,
    hit: Option<Py<PyAny>>,
    properties: Properties,
}

/// Calls of `eval`, `pdf` and `sample`.
type AllCalls = Arc<[Calls; 3]>;

impl Declared {
    fn checked(self) -> PyResult<Functions> {
        let meaningless =
            |(key, value): &(String, String)| PyValueError::new_err(format!("{key}: {value} has no meaning"));
        let (kind, declared) = self.properties.split_first().ok_or_else(|| PyValueError::new_err("no kind"))?;
        let mut properties = of_kind(&kind.1).ok_or_else(|| meaningless(kind))?;
        for both in declared {
            declare(&mut properties, &both.0, &both.1).ok_or_else(|| meaningless(both))?;
        }
        if !has_sound_map(&properties) {
            return Err(PyValueError::new_err("map: wanted two different random numbers of a sample, counted from 0"));
        }
        let Self { sample, eval, pdf, lobes, hit, .. } = self;
        Ok(Functions { sample, eval, pdf, lobes, hit, properties })
    }
}

/// BSDFs over their parameters.
#[derive(FromPyObject)]
pub struct Bsdfs {
    name: String,
    /// Name, usual value and range.
    parameters: Vec<(String, f64, f64, f64)>,
    /// The function that returns a [`Declared`] for values of the parameters, by name.
    make: Py<PyAny>,
}

/// All checks of one BSDF.
#[pyfunction]
pub fn check_bsdf(
    py: Python<'_>,
    bsdfs: Bsdfs,
    plan: Plan,
    like: Option<(String, Vec<(String, f64)>)>,
) -> PyResult<Found> {
    let (name, protocol) = (bsdfs.name.clone(), plan.protocol());
    let (validation, raised) = run(py, &name, move |caller| {
        let family = PythonFamily::new(bsdfs, caller.clone());
        let calls = Arc::clone(&family.calls);
        let claim = like.map(|(model, chosen)| Claim::new(&model, &chosen)).transpose()?;
        let whole = WholeBsdf::new(family, Vec::new())?.like(claim);
        let tests = whole.names().len() as u64;
        let validation = whole.run(&protocol, &|| caller.step(tests))?;
        Ok((validation, calls.iter().find_map(Calls::raised)))
    })?;
    Found::of_run(py, &name, validation).map(|found| found.because(raised))
}

/// What is tabulated.
#[derive(FromPyObject)]
pub struct Tabulated {
    over: Vec<String>,
    set: Vec<(String, f64)>,
    size: (usize, usize),
    error: f64,
    seed: u64,
}

/// The albedo of a BSDF over angle and parameters: of Python, or of the program, by its name.
#[pyfunction]
pub fn furnace(py: Python<'_>, subject: Subject, tabulated: Tabulated) -> PyResult<Found> {
    let Tabulated { over, set, size, error, seed } = tabulated;
    let request = Request { over, set, cells: size.into(), error, samples: None, seed };
    let table = match subject {
        Subject::Python(bsdfs) => run(py, &bsdfs.name.clone(), move |caller| {
            let family = PythonFamily::new(bsdfs, caller.clone());
            albedo_table(&family, &|_| None, &request, &|of| caller.step(of))
        }),
        Subject::Program(name) => {
            let all = families::all();
            let Some(family) = all.iter().find(|family| family.name() == name) else {
                let names: Vec<&str> = all.iter().map(|family| family.name()).collect();
                return Err(PyValueError::new_err(format!("bsdf: there is no \"{name}\", but {}", names.join(", "))));
            };
            run(py, &name, |caller| {
                albedo_table(family, &|values| family.facets(values), &request, &|of| caller.step(of))
            })
        }
    }?;
    Ok(Found::of_albedos(table, error))
}

/// What is tested for its albedo.
#[derive(FromPyObject)]
pub enum Subject {
    /// A BSDF of the program.
    Program(String),
    /// Functions of Python.
    Python(Bsdfs),
}

struct PythonFamily {
    caller: Caller,
    name: String,
    parameters: Vec<Parameter>,
    make: Arc<Py<PyAny>>,
    calls: AllCalls,
}

impl PythonFamily {
    fn new(bsdfs: Bsdfs, caller: Caller) -> Self {
        let parameter = |(name, value, from, to): (String, f64, f64, f64)| Parameter::new(name, value, [from, to]);
        let parameters = bsdfs.parameters.into_iter().map(parameter).collect();
        Self { caller, name: bsdfs.name, parameters, make: Arc::new(bsdfs.make), calls: AllCalls::default() }
    }
}

impl Family for PythonFamily {
    fn name(&self) -> &str {
        &self.name
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.parameters.clone()
    }

    fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn BatchBsdf + '_>> {
        let names = self.parameters.iter().map(|parameter| parameter.name.clone());
        let (named, make): (Vec<_>, _) = (names.zip(values.iter().copied()).collect(), Arc::clone(&self.make));
        let mut functions = self.caller.call(move |py| {
            let values = PyDict::new(py);
            named.iter().try_for_each(|(name, value)| values.set_item(name, value))?;
            make.bind(py).call((), Some(&values))?.extract::<Declared>()?.checked()
        })?;
        let valued = |(parameter, &value): (&Parameter, &f64)| Parameter { value, ..parameter.clone() };
        functions.properties.parameters = self.parameters.iter().zip(values).map(valued).collect();
        let calls = Arc::clone(&self.calls);
        Ok(Box::new(PythonBsdf { caller: self.caller.clone(), functions: Arc::new(functions), calls }))
    }
}

struct PythonBsdf {
    caller: Caller,
    functions: Arc<Functions>,
    calls: AllCalls,
}

impl PythonBsdf {
    /// Has the calling thread run `job` on the functions.
    fn call<T: Send + 'static>(
        &self,
        job: impl FnOnce(Python<'_>, &Functions, &[Calls; 3]) -> PyResult<T> + Send + 'static,
    ) -> etalon_stats::Result<T> {
        let (functions, calls) = (Arc::clone(&self.functions), Arc::clone(&self.calls));
        self.caller.call(move |py| job(py, &functions, &calls))
    }

    fn channels(&self) -> usize {
        self.functions.properties.channels
    }
}

impl BatchBsdf for PythonBsdf {
    fn properties(&self) -> Properties {
        self.functions.properties.clone()
    }

    fn eval(&self, pairs: &[Pair], u: &[f64]) -> etalon_stats::Result<Vec<Spectrum>> {
        let (pairs, u, channels) = (pairs.to_vec(), u.to_vec(), self.channels());
        if pairs.is_empty() {
            return Ok(Vec::new());
        }
        self.call(move |py, functions, calls| {
            let dimension = functions.properties.eval_dimension;
            let some = |range: Range<usize>| {
                let (wo, wi) = directions_of(py, &pairs[range.clone()])?;
                let u = u[range.start * dimension..range.end * dimension].to_vec();
                let f = match dimension {
                    0 => functions.eval.bind(py).call1((&wo, &wi)),
                    _ => functions.eval.bind(py).call1((&wo, &wi, rows(py, u, dimension)?)),
                }?;
                spectra(&f, "eval", &[range.len()], channels)
            };
            calls[0].of_rows(py, ("eval", pairs.len()), [f64::NAN; 3], some, |i| pair(&pairs[i]))
        })
    }

    /// 0 everywhere if there is none.
    fn pdf(&self, pairs: &[Pair]) -> etalon_stats::Result<Vec<f64>> {
        if pairs.is_empty() || self.functions.properties.pdf == PdfKind::None {
            return Ok(vec![0.0; pairs.len()]);
        }
        let pairs = pairs.to_vec();
        self.call(move |py, functions, calls| {
            let Some(pdf) = &functions.pdf else { return Ok(vec![0.0; pairs.len()]) };
            let some = |range: Range<usize>| {
                let (wo, wi) = directions_of(py, &pairs[range.clone()])?;
                numbers(&pdf.bind(py).call1((&wo, &wi))?, "pdf")?.of_shape(&[&[range.len()]])
            };
            calls[1].of_rows(py, ("pdf", pairs.len()), f64::NAN, some, |i| pair(&pairs[i]))
        })
    }

    fn sample(&self, wos: &[Direction], u: &[f64]) -> etalon_stats::Result<Vec<Option<BsdfSample>>> {
        let (wos, u, channels) = (wos.to_vec(), u.to_vec(), self.channels());
        if wos.is_empty() {
            return Ok(Vec::new());
        }
        self.call(move |py, functions, calls| {
            let dimension = functions.properties.dimension;
            let numbers = |range: &Range<usize>| u[range.start * dimension..range.end * dimension].to_vec();
            let some = |range: Range<usize>| {
                let (wo, u) =
                    (directions(py, wos[range.clone()].iter().copied())?, rows(py, numbers(&range), dimension)?);
                samples(&functions.sample.bind(py).call1((&wo, &u))?, range.len(), channels)
            };
            let nan = BsdfSample::new([f64::NAN; 3], [f64::NAN; 3], Density::Pdf(f64::NAN));
            let given = |i: usize| format!("wo = {:?}, u = {:?}", wos[i], numbers(&(i..i + 1)));
            calls[2].of_rows(py, ("sample", wos.len()), Some(nan), some, given)
        })
    }

    fn delta_lobes(&self, wos: &[Direction]) -> etalon_stats::Result<Vec<Vec<DeltaLobe>>> {
        let (wos, channels) = (wos.to_vec(), self.channels());
        self.call(move |py, functions, _| {
            let Some(lobes) = &functions.lobes else { return Ok(vec![Vec::new(); wos.len()]) };
            let (n, wo) = (wos.len(), directions(py, wos.into_iter())?);
            delta_lobes(&lobes.bind(py).call1((&wo,))?, n, channels, &[("wo", &wo)])
        })
    }

    fn hits(&self, pairs: &[Pair]) -> etalon_stats::Result<Vec<Option<Hit>>> {
        let pairs = pairs.to_vec();
        self.call(move |py, functions, _| {
            let Some(hit) = functions.hit.as_ref().filter(|_| !pairs.is_empty()) else {
                return Ok(vec![None; pairs.len()]);
            };
            let (wo, wi) = directions_of(py, &pairs)?;
            hits(&hit.bind(py).call1((&wo, &wi))?, pairs.len())
        })
    }
}

/// Directions as an array (n, 3).
fn directions(py: Python<'_>, directions: impl Iterator<Item = Direction>) -> PyResult<Bound<'_, PyAny>> {
    rows(py, directions.flatten().collect(), 3)
}

/// The directions of pairs as two arrays.
fn directions_of<'py>(py: Python<'py>, pairs: &[Pair]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let side = |side: usize| directions(py, pairs.iter().map(move |pair| pair[side]));
    Ok((side(0)?, side(1)?))
}

/// A pair as text.
fn pair([wo, wi]: &Pair) -> String {
    format!("wo = {wo:?}, wi = {wi:?}")
}

/// A value in every channel for each entry of an array of the shape `entries`.
fn spectra(value: &Bound<'_, PyAny>, name: &str, entries: &[usize], channels: usize) -> PyResult<Vec<Spectrum>> {
    let of_all = [entries, &[channels]].concat();
    let wanted: &[&[usize]] = if channels == 1 { &[entries, &of_all] } else { &[&of_all] };
    let values: Vec<f64> = numbers(value, name)?.of_shape(wanted)?;
    let spectrum = |row: &[f64]| std::array::from_fn(|c| row[if channels == 1 { 0 } else { c }]);
    Ok(values.chunks_exact(channels).map(spectrum).collect())
}

/// The parts of a tuple; those that are None are left out.
fn parts<'py, const N: usize>(
    value: &Bound<'py, PyAny>,
    least: usize,
    wanted: &str,
) -> PyResult<[Option<Bound<'py, PyAny>>; N]> {
    let parts = value.cast::<PyTuple>().ok().filter(|parts| (least..=N).contains(&parts.len()));
    let parts = parts.ok_or_else(|| {
        let found = value.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        PyTypeError::new_err(format!("{wanted}; found {found}"))
    })?;
    let mut parts = parts.iter();
    Ok(std::array::from_fn(|_| parts.next().filter(|part| !part.is_none())))
}

/// The samples that a function has returned as `BsdfSamples`.
fn samples(value: &Bound<'_, PyAny>, n: usize, channels: usize) -> PyResult<Vec<Option<BsdfSample>>> {
    let [wi, weight, pdf, delta, valid, point] = parts::<6>(value, 5, "sample: wanted BsdfSamples(wi, weight, …)")?;
    let missing = |what: &str| PyTypeError::new_err(format!("sample: no {what}"));
    let (wi, weight) = (wi.ok_or_else(|| missing("wi"))?, weight.ok_or_else(|| missing("weight"))?);
    let valid = flags(valid.as_ref(), "sample.valid", n, true)?;
    let delta = flags(delta.as_ref(), "sample.delta", n, false)?;
    let wi: Vec<f64> = numbers(&wi, "sample.wi")?.of_shape(&[&[n, 3]])?;
    let weight = spectra(&weight, "sample.weight", &[n], channels)?;
    let pdf = match pdf {
        None => None,
        Some(pdf) => Some(numbers::<f64>(&pdf, "sample.pdf")?.of_shape(&[&[n]])?),
    };
    let points = match point {
        None => None,
        Some(point) => Some(numbers::<f64>(&point, "sample.point")?.of_shape(&[&[n, 3]])?),
    };
    let density = |i: usize| match &pdf {
        Some(pdf) if delta[i] => Ok(Density::Delta(pdf[i])),
        Some(pdf) => Ok(Density::Pdf(pdf[i])),
        None if delta[i] => Err(PyValueError::new_err("sample.pdf: a delta lobe needs its probability")),
        None => Ok(Density::Unknown),
    };
    let sample = |(i, wi): (usize, &[f64])| {
        let point = points.as_ref().map(|points| std::array::from_fn(|c| points[3 * i + c]));
        let sample =
            || Ok(BsdfSample { point, ..BsdfSample::new(std::array::from_fn(|c| wi[c]), weight[i], density(i)?) });
        valid[i].then(sample).transpose()
    };
    wi.chunks_exact(3).enumerate().map(sample).collect()
}

/// Where rays meet a light, by what a function has returned: distances (n,), normals (n, 3), pdfs per area (n,) or None.
fn hits(value: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<Option<Hit>>> {
    const WANTED: &str = "hit: wanted (distance, normal) or (distance, normal, pdf per area)";
    let [Some(distance), Some(normal), pdf] = parts::<3>(value, 2, WANTED)? else {
        return Err(PyTypeError::new_err(WANTED));
    };
    let distance: Vec<f64> = numbers(&distance, "hit.distance")?.of_shape(&[&[n]])?;
    let normal: Vec<f64> = numbers(&normal, "hit.normal")?.of_shape(&[&[n, 3]])?;
    let pdf = pdf.map(|pdf| numbers::<f64>(&pdf, "hit.pdf")?.of_shape(&[&[n]])).transpose()?;
    let hit = |i: usize| Hit {
        distance: distance[i],
        normal: std::array::from_fn(|c| normal[3 * i + c]),
        pdf_area: pdf.as_ref().map(|pdf| pdf[i]),
    };
    Ok((0..n).map(|i| distance[i].is_finite().then(|| hit(i))).collect())
}

/// The delta lobes that a function has returned: directions (n, k, 3), probabilities (n, k), throughputs (n, k) or (n, k, 3); a
/// lobe of probability 0 is none.
fn delta_lobes(
    value: &Bound<'_, PyAny>,
    n: usize,
    channels: usize,
    given: Given<'_, '_>,
) -> PyResult<Vec<Vec<DeltaLobe>>> {
    let [wi, probability, throughput] = parts::<3>(value, 3, "lobes: wanted (wi, probability, throughput)")?;
    let missing = || PyTypeError::new_err("lobes: wanted (wi, probability, throughput), none of them None");
    let wi = numbers::<f64>(&wi.ok_or_else(missing)?, "lobes.wi")?;
    let k = match wi.shape[..] {
        [rows, k, 3] if rows == n => k,
        _ => return Err(wi.wrong_shape(&format!("({n}, k, 3)"))),
    };
    let wi = wi.values;
    no_nan(&wi, 3 * k, "lobes.wi", |_| true, given)?;
    let probability: Vec<f64> =
        numbers(&probability.ok_or_else(missing)?, "lobes.probability")?.of_shape(&[&[n, k]])?;
    no_nan(&probability, k, "lobes.probability", |_| true, given)?;
    let throughput = spectra(&throughput.ok_or_else(missing)?, "lobes.throughput", &[n, k], channels)?;
    let of_lobes: Vec<f64> = throughput.iter().flatten().copied().collect();
    no_nan(&of_lobes, 3 * k, "lobes.throughput", |_| true, given)?;
    let lobe = |i: usize| DeltaLobe {
        wi: std::array::from_fn(|c| wi[3 * i + c]),
        probability: probability[i],
        throughput: throughput[i],
    };
    let of_row = |row: usize| (row * k..(row + 1) * k).filter(|i| probability[*i] != 0.0).map(lobe).collect();
    Ok((0..n).map(of_row).collect())
}
