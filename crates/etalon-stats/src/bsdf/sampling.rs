//! Samples against the pdf: the chi-square test on the sphere, with atoms for delta lobes; and the Jacobian by finite differences:
//! the pdf of a lobe times the Jacobian determinant of its map from random numbers to directions is the probability of choosing
//! the lobe.

use super::contract::{BsdfSample, Density as Probability, Direction, Kind, Pair, PdfKind};
use super::mistakes::{self, PDF};
use super::subject::{Comparison, Subject, cross, directions, length, sphere};
use crate::derivative::{Derivative, STEPS, derivative, moved, on_raster};
use crate::diagnosis::tuple;
use crate::domain::{Domain, Point, around};
use crate::error::Result;
use crate::examine::{Protocol, examine};
use crate::mistakes::{EQUAL, Mistake, Variable, common_factor, number};
use crate::outcome::Outcome;
use crate::sampler::{Atom, Density, Mass, Sample, Sampler};
use rand::RngExt;
use std::collections::BTreeMap;
use std::iter::repeat_n;

/// The samples and the pdf of a BSDF.
pub struct Scattering<'a>(pub &'a Subject<'a>);

impl Sampler for Scattering<'_> {
    fn dimension(&self) -> usize {
        self.0.properties.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        let of = |sample: BsdfSample| match sample.density {
            // `formula` compares that of a light, which has roundings.
            Probability::Pdf(pdf) if !self.0.is_light() => Sample::with_pdf(sample.wi, pdf),
            Probability::Pdf(_) | Probability::Unknown => Sample::new(sample.wi),
            Probability::Delta(_) => Sample::atom(sample.wi),
        };
        out.extend(self.0.sample(u)?.into_iter().map(|sample| sample.map(of)));
        Ok(())
    }
}

impl Density for Scattering<'_> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend(self.0.bsdf.pdf(&self.0.pairs(&directions(points)))?);
        Ok(())
    }

    /// 1 minus the probability of "no sample", which is not declared.
    fn mass(&self) -> Mass {
        Mass::AtMostOne
    }

    fn atoms(&self) -> Vec<Atom> {
        self.0.deltas.iter().map(|lobe| Atom::new(lobe.wi, lobe.probability)).collect()
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        mistakes::variables(self.0)
    }

    fn atom_names(&self) -> Vec<String> {
        self.0.delta_names()
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        mistakes::of_pdf(self.0)
    }
}

/// Cells of a phase function or a light, most of which are plainer than BSDFs: fewer cells need fewer samples and values.
const CELLS: usize = 100;

/// Counts samples in cells, at delta lobes, and "no sample"; see [`examine`]. The integral of the pdf is tested with them, and
/// the pdf that each sample carries.
pub fn sampling(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.properties.pdf != PdfKind::Exact {
        return Ok(None);
    }
    let scattering = Scattering(subject);
    let most = if subject.properties.kind == Kind::Surface { subject.protocol.cells } else { CELLS };
    let protocol = Protocol { cells: subject.protocol.cells.min(most), ..*subject.protocol };
    let test = |domain: &dyn Domain| examine(domain, &scattering, &scattering, &protocol, subject.round).map(Some);
    let spread = |(_, sample): (_, BsdfSample)| Some(sample.wi).filter(|_| !sample.is_delta());
    let towards: Vec<Direction> = subject.samples_inside()?.into_iter().filter_map(spread).collect();
    if !subject.is_light() || towards.is_empty() {
        return test(&sphere());
    }
    // The pdf of a light ends at its edges.
    test(&around(towards.into_iter().fold([0.0; 3], |sum, wi| [0, 1, 2].map(|i| sum[i] + wi[i]))))
}

/// Points at which the derivative is taken, and samples that are tried for them.
const POINTS: usize = 64;
const TRIALS: usize = 16 * POINTS;
/// A derivative with a larger error than this says nothing.
const COARSEST: f64 = 0.1;
/// Fewer points than this say nothing; where samples of other than delta lobes are so rare, the check does not apply.
const FEWEST: u64 = 8;

/// Compares pdf · |∂wi/∂u₁ × ∂wi/∂u₂| with the probability of choosing the lobe by other random numbers.
pub fn jacobian(subject: &Subject) -> Result<Option<Outcome>> {
    let Subject { bsdf, properties, wo, .. } = subject;
    let applies = properties.pdf == PdfKind::Exact && !properties.narrow;
    let Some(axes) = properties.map.filter(|_| applies) else { return Ok(None) };
    let points = points(subject, axes)?;
    let maps = derivatives(subject, &points, axes)?;
    let (mut used, mut numbers, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for (point, [first, second]) in points.iter().zip(maps) {
        let (Some(a), Some(b)) = (first, second) else { continue };
        let area = length(cross(a.value, b.value));
        let error = (a.error * length(b.value) + b.error * length(a.value)) / area;
        if !error.is_nan() && error <= COARSEST {
            used.push(point);
            numbers.push([point.pdf * area / point.sample.lobe_probability, 1.0]);
            errors.push(error);
        }
    }
    let rounding = |far: &[usize]| {
        let points: Vec<&MappedPoint> = far.iter().map(|&i| used[i]).collect();
        let pdfs: Vec<f64> = points.iter().map(|point| point.pdf).collect();
        let pairs: Vec<Pair> = points.iter().map(|point| [*wo, point.sample.wi]).collect();
        let of_pdf = subject.rounding(&pdfs, &pairs, |moved| {
            let each = moved.len() / points.len();
            let lobes: Vec<usize> = points.iter().flat_map(|point| repeat_n(point.sample.lobe, each)).collect();
            Ok(bsdf.lobe_pdf(moved, &lobes)?.into_iter().map(|pdf| pdf.unwrap_or(f64::NAN)).collect())
        })?;
        let relative = of_pdf.iter().zip(pdfs).map(|(rounding, pdf)| rounding / pdf);
        Ok(far.iter().zip(relative).map(|(&i, rounding)| errors[i] + rounding).collect())
    };
    let message = |i: usize| {
        let MappedPoint { u, sample, .. } = used[i];
        (Some(sample.wi), format!("{}, u = {}, lobe {}", subject.at(sample.wi), tuple(u), sample.lobe))
    };
    let mut found = Comparison::default();
    if !found.equal(&numbers, |i| errors[i], rounding, message)? {
        let precise: Vec<(&MappedPoint, f64)> =
            (0..used.len()).filter(|&i| errors[i] < 0.1 * EQUAL).map(|i| (used[i], numbers[i][0])).collect();
        let pair = |(point, product): &(&MappedPoint, f64)| (point.sample.wi.into(), [point.pdf / product, point.pdf]);
        let pairs: Vec<_> = precise.iter().map(pair).collect();
        // Without the probability of the lobe, pdf and map agree.
        let is_one = |product: f64| (product - 1.0).abs() <= EQUAL;
        let wrong = precise.iter().filter(|(_, product)| !is_one(*product)).count() as u64;
        let lacks = precise.iter().all(|(point, product)| is_one(product * point.sample.lobe_probability));
        let special = || {
            Ok(match lacks {
                _ if wrong < FEWEST => None,
                true => Some("pdfs of lobes lack the probability of the lobe".to_owned()),
                false => of_lobes(&precise),
            })
        };
        found.named(mistakes::explain(
            subject,
            &Scattering(subject),
            &pairs,
            ["the density of samples", PDF],
            special,
        )?);
    }
    let count = used.len() as u64;
    let outcome = found.outcome("pdf · |∂wi/∂u| / P(lobe) = 1").filter(|_| count >= FEWEST);
    let reason = "the map is too steep for finite differences in its precision".to_owned();
    let undecided = || Outcome { inconclusive_reason: Some(reason), ..Outcome::open(count) };
    Ok((points.len() as u64 >= FEWEST).then(|| outcome.unwrap_or_else(undecided)))
}

/// The factors of lobes whose pdfs are wrong by a factor each, or right.
fn of_lobes(precise: &[(&MappedPoint, f64)]) -> Option<String> {
    let mut lobes: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    precise.iter().for_each(|(point, product)| lobes.entry(point.sample.lobe).or_default().push(*product));
    let factor = |products: &[f64]| common_factor(products).filter(|_| products.len() as u64 >= FEWEST);
    let told = |(lobe, products): (&usize, &Vec<f64>)| {
        Some(format!("that of lobe {lobe} is {} times the density of its samples", number(factor(products)?)))
    };
    let told: Option<Vec<String>> = lobes.iter().map(told).collect();
    told.filter(|told| told.len() > 1).map(|told| format!("pdfs of lobes are wrong by factors: {}", told.join(", ")))
}

/// Random numbers, the sample that they give, and the pdf of its lobe times the probability of the lobe.
struct MappedPoint {
    u: Vec<f64>,
    sample: BsdfSample,
    pdf: f64,
}

/// Samples of other than delta lobes, of which a lobe's pdf is known. Where most samples are of delta lobes, many are tried.
fn points(subject: &Subject, axes: [usize; 2]) -> Result<Vec<MappedPoint>> {
    let mut rng = subject.random(2, 0);
    let mut trials = vec![vec![0.0; subject.properties.dimension]; TRIALS];
    for u in &mut trials {
        u.iter_mut().for_each(|u| *u = rng.random());
        axes.iter().for_each(|&axis| u[axis] = on_raster(u[axis]));
    }
    let samples = subject.sample(&trials.concat())?.into_iter();
    let spread = samples.zip(trials).filter_map(|(sample, u)| Some((u, sample.filter(|sample| !sample.is_delta())?)));
    let (u, samples): (Vec<Vec<f64>>, Vec<BsdfSample>) = spread.unzip();
    let pairs: Vec<Pair> = samples.iter().map(|sample| [subject.wo, sample.wi]).collect();
    let lobes: Vec<usize> = samples.iter().map(|sample| sample.lobe).collect();
    let pdfs = subject.bsdf.lobe_pdf(&pairs, &lobes)?;
    let points = u.into_iter().zip(samples).zip(pdfs);
    Ok(points.filter_map(|((u, sample), pdf)| Some(MappedPoint { u, sample, pdf: pdf? })).take(POINTS).collect())
}

/// The derivatives by two random numbers at each point; `None` at the edge of the lobe.
fn derivatives(subject: &Subject, points: &[MappedPoint], axes: [usize; 2]) -> Result<Vec<[Option<Derivative<3>>; 2]>> {
    let moved: Vec<f64> = points.iter().flat_map(|point| axes.map(|axis| moved(&point.u, axis))).flatten().collect();
    let samples = subject.sample(&moved)?;
    let mut samples = samples.chunks_exact(2 * STEPS);
    let mut of = |point: &MappedPoint, axis: usize| {
        let is_here = |sample: &&BsdfSample| sample.lobe == point.sample.lobe && !sample.is_delta();
        let place = |sample: &Option<BsdfSample>| sample.as_ref().filter(is_here).map(|sample| sample.wi);
        let places: Vec<Option<Direction>> = samples.next()?.iter().map(place).collect();
        derivative(point.u[axis], &places, subject.properties.precision)
    };
    Ok(points.iter().map(|point| axes.map(|axis| of(point, axis))).collect())
}
