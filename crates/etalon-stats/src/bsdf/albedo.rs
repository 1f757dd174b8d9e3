//! The albedo: its two estimates agree, and it is what the BSDF declares.

use super::contract::{Direction, Energy, Kind, PdfKind, Spectrum};
#[cfg(doc)]
use super::light::Uncertainty;
use super::light::{CellIntegrals, Pilot, integrate};
use super::subject::{Subject, sphere};
use super::weights::{BATCH, CellSum, Sums, sums};
use crate::error::Result;
use crate::exact::percent;
use crate::examine::{SUSPECT, SampleCount};
use crate::extremes::Extremes;
use crate::grid::Grid;
use crate::mistakes::constant;
use crate::multiple::sidak;
use crate::outcome::Outcome;
use crate::power::noncentrality;
use rand::RngExt;
use std::f64::consts::PI;

/// Cells that the cubature starts from.
const CELLS: usize = 50;
/// Fewest and most samples.
const SAMPLES: [u64; 2] = [1 << 14, 1 << 24];
/// What rounding of values may change of an integral, as of a pdf.
const ROUNDING: f64 = 1e-4;
/// A sample with a larger share of the squares makes their sum, and so the variance, uncertain.
const LARGEST: f64 = 0.1;
/// Directions in which large weights are looked for.
const DIRECTIONS: usize = 1 << 12;
/// Where the pdf predicts that many samples, some are met.
const EXPECTED: f64 = 10.0;
/// Standard errors that count as chance.
const CHANCE: f64 = 3.0;

/// The integrals of f |cos θᵢ| for every channel that differs from the others.
fn integrals(subject: &Subject, pilot: &Pilot, power: bool) -> Result<(Grid, Vec<(usize, CellIntegrals)>)> {
    let grid = pilot.grid(CELLS);
    let of = |channel: usize| Ok((channel, integrate(subject, pilot, &grid, [channel, 1 << 10], power)?));
    let integrals = pilot.channels(subject).into_iter().map(of).collect::<Result<Vec<_>>>()?;
    Ok((grid, integrals))
}

/// Errors of a ratio above this leave its constant unknown; and its cosine, as an angle has one that a ratio may have by chance.
const PRECISE: f64 = 2e-3;
const EXACT: f64 = 1e-4;

/// ", π times it", where a ratio with that `error` is a known constant; or the cosine of `wo` of a surface, or one over it.
fn times(subject: &Subject, ratio: f64, error: f64) -> String {
    let (cos, most) = (subject.wo[2].abs(), error.at_least(1e-5));
    let cosines = [(cos, "cos θo"), (1.0 / cos, "1/cos θo")].into_iter();
    let cosine = cosines
        .filter(|_| subject.properties.kind == Kind::Surface && most <= EXACT)
        .find(|(known, _)| (ratio / known - 1.0).abs() <= most);
    let names: Vec<&str> = constant(ratio, most).into_iter().chain(cosine.map(|(_, name)| name)).collect();
    if names.is_empty() || error >= PRECISE { String::new() } else { format!(", {} times it", names.join(" or ")) }
}

/// What the BSDF says of an albedo.
struct Claim {
    /// The albedo, or the largest one.
    albedo: f64,
    /// How far the claim itself may be from the truth.
    known: f64,
    is_upper_bound: bool,
}

impl Claim {
    /// What is declared of the albedo in a channel, or of the energy; `None` if that is nothing.
    fn of(energy: Energy, declared: Option<f64>) -> Option<Self> {
        match (declared, energy) {
            (Some(albedo), _) => Some(Self { albedo, known: 0.0, is_upper_bound: false }),
            (None, Energy::Conserved(known)) => Some(Self { albedo: 1.0, known, is_upper_bound: false }),
            (None, Energy::AtMostOne) => Some(Self { albedo: 1.0, known: 0.0, is_upper_bound: true }),
            (None, Energy::MayExceedOne(_)) => None,
        }
    }

    /// How far an albedo is from what is claimed.
    fn error_of(&self, value: f64) -> f64 {
        let error = value - self.albedo;
        (if self.is_upper_bound { error } else { error.abs() }) - self.known - ROUNDING
    }
}

/// Energy: the power that is scattered to `wo`, as a share of that of uniform light, against 1 or the declared value. For a
/// reciprocal BSDF it is the share of a beam from `wo` that is scattered.
///
/// The p-value is the largest probability with which the integral has the error found: see [`Uncertainty`]. Where nothing
/// is left to chance, as for delta lobes alone, there is none.
pub fn energy(subject: &Subject) -> Result<Option<Outcome>> {
    let pilot = Pilot::new(subject)?;
    if let Some(unresolved) = pilot.unresolved(subject)? {
        return Ok(Some(unresolved));
    }
    let (grid, integrals) = integrals(subject, &pilot, true)?;
    let declared = subject.bsdf.albedo(&[subject.wo])?.swap_remove(0);
    let level = sidak(subject.protocol.own_level(), integrals.len());
    let (mut violation, mut detectable, mut least): (Option<String>, f64, Option<(f64, String)>) = (None, 0.0, None);
    for (channel, integrals) in &integrals {
        let invalid = integrals.invalid.map(|at| {
            format!("{}: {} = {}", subject.at(at.point.into()), subject.properties.kind.integrand(), at.value)
        });
        violation = violation.or(invalid);
        let Some(claim) = Claim::of(subject.properties.energy, declared.map(|albedo| albedo[*channel])) else {
            continue;
        };
        if !claim.albedo.is_finite() {
            let message = || format!("{}: the declared albedo is {}", subject.from(), claim.albedo);
            violation = violation.or_else(|| Some(message()));
        }
        let deltas = subject.deltas.iter().map(|lobe| lobe.throughput[*channel] * subject.eta2(lobe.wi)).sum::<f64>();
        let (value, uncertainty) = (integrals.total() + deltas, integrals.uncertainty);
        let p = if value.is_finite() { uncertainty.p_value(claim.error_of(value)) } else { 0.0 };
        let message = || {
            let not = if claim.is_upper_bound { "more than" } else { "not" };
            let (from, error, albedo) = (subject.from(), uncertainty.systematic + ROUNDING, claim.albedo);
            let deviation = uncertainty.deviation;
            let noise = if deviation > 0.0 { format!(", standard error {deviation:.1e}") } else { String::new() };
            // What is on the side of `wo`, on the other, and in delta lobes
            let on_side = |is_above: bool| {
                let cells = grid.cells().zip(&integrals.values);
                cells.filter(|(cell, _)| (cell.x[0] < 0.5) == is_above).map(|(_, value)| value).sum::<f64>()
            };
            let is_above = subject.wo[2] > 0.0;
            let parts =
                [(on_side(is_above), "reflected"), (on_side(!is_above), "transmitted"), (deltas, "in delta lobes")];
            let parts = parts.into_iter().filter(|(part, _)| *part > ROUNDING);
            let parts: Vec<String> = parts.map(|(part, name)| format!("{part:.4} {name}")).collect();
            let is_surface = subject.properties.kind == Kind::Surface;
            let parts = if is_surface && parts.len() > 1 { format!(" ({})", parts.join(", ")) } else { String::new() };
            let what = if is_surface { "albedo" } else { "integral over the sphere" };
            // Without 1/π in f, it is π times what its author knows: a number of few digits.
            let known = (100.0 * value / PI).round() / 100.0;
            let uncertain = ((error + CHANCE * deviation) / PI).at_least(ROUNDING);
            let is_near = uncertain <= 5.0 * ROUNDING && (value / PI - known).abs() <= uncertain;
            let is_known = claim.is_upper_bound && known <= 1.0 && is_near;
            let of_pi = if is_known { format!(" = {known} π") } else { String::new() };
            format!(
                "{from}: the {what} is {value:.5}{of_pi} ± {error:.1e}{noise}{parts}, {not} {albedo:.5}{}",
                if claim.is_upper_bound {
                    String::new()
                } else {
                    times(subject, value / albedo, error / albedo + CHANCE * deviation)
                }
            )
        };
        detectable = detectable.at_least(uncertainty.detectable(level) + ROUNDING);
        if uncertainty.is_deterministic() {
            violation = violation.or_else(|| 1.0.may_exceed(p).then(message));
        } else if least.as_ref().is_none_or(|(least, _)| least.may_exceed(p)) {
            least = Some((p, message()));
        }
    }
    let reason = (detectable > subject.protocol.coarsest()).then(|| {
        format!(
            "the integral is too uncertain: an error of the albedo below {} would remain undetected",
            percent(detectable)
        )
    });
    let p = least.as_ref().map(|(p, _)| (p * integrals.len() as f64).at_most(1.0));
    Ok(Some(Outcome {
        p,
        detectable: Some(detectable),
        diagnosis: least.filter(|_| p.is_some_and(|p| p < SUSPECT)).map(|(_, message)| message),
        violation,
        inconclusive_reason: reason,
        ..Outcome::open(integrals.len() as u64)
    }))
}

/// Values and pdfs in uniformly distributed directions.
struct UniformDirections(Vec<(Spectrum, f64)>);

impl UniformDirections {
    /// Nothing, if the pdf is not known or values are stochastic.
    fn new(subject: &Subject) -> Result<Self> {
        if subject.properties.pdf != PdfKind::Exact || !subject.is_deterministic() {
            return Ok(Self(Vec::new()));
        }
        let mut rng = subject.random(9, 0);
        let directions: Vec<Direction> = (0..DIRECTIONS).map(|_| sphere().direction_at(rng.random())).collect();
        let pairs = subject.pairs(&directions);
        let values = subject.bsdf.eval(&pairs, &[])?.into_iter().zip(&directions);
        let light = values.map(|(f, wi)| f.map(|f| f * subject.properties.kind.cos(*wi)));
        Ok(Self(light.zip(subject.bsdf.pdf(&pairs)?).collect()))
    }

    /// A bound of the light that only weights above twice the `largest` of `n` samples carry, where the pdf lets fewer than
    /// a few of them be expected. Their variance is not in that of the samples.
    fn unseen(&self, channel: usize, largest: f64, n: f64) -> f64 {
        let size = 4.0 * PI / DIRECTIONS as f64;
        let is_unseen = |(light, pdf): &&(Spectrum, f64)| *pdf > 0.0 && light[channel] > 2.0 * largest * pdf;
        let (mut light, mut squares, mut probability) = (0.0, 0.0, 0.0);
        for (value, pdf) in self.0.iter().filter(is_unseen) {
            light += value[channel];
            squares += value[channel] * value[channel];
            probability += pdf;
        }
        if n * size * probability < EXPECTED { size * (light + CHANCE * f64::sqrt(squares)) } else { 0.0 }
    }
}

/// Two estimates of one albedo: the mean of the weights of samples, and the integral of the values.
pub fn agreement(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.has_known_weights()? {
        return Ok(None);
    }
    let pilot = Pilot::new(subject)?;
    if let Some(unresolved) = pilot.unresolved(subject)? {
        return Ok(Some(unresolved));
    }
    let (grid, integrals) = integrals(subject, &pilot, false)?;
    let channels: Vec<usize> = integrals.iter().map(|(channel, _)| *channel).collect();
    let level = sidak(subject.protocol.own_level(), channels.len());
    let whole = |cells: &Vec<CellSum>| cells.iter().fold(CellSum::default(), |sum, cell| sum.plus(*cell));
    // The relative variance of weights of a first run says how many samples to take.
    let first: Vec<CellSum> = sums(subject, &grid, &channels, 2 * BATCH, 7, false)?.cells.iter().map(whole).collect();
    let count = match subject.protocol.samples {
        SampleCount::Fixed(n) => n,
        SampleCount::Detect(w) => {
            let n = (2 * BATCH) as f64;
            let relative = first.iter().filter(|sum| sum.sum > 0.0);
            let variance = relative.map(|all| n * all.squares / (all.sum * all.sum) - 1.0).fold(0.0, f64::at_least);
            ((noncentrality(1, level) * variance / (w * w)) as u64).clamp(SAMPLES[0], SAMPLES[1])
        }
    };
    let Sums { cells, violation: above_bound } = sums(subject, &grid, &channels, count, 8, false)?;
    let found: Vec<CellSum> = cells.iter().map(whole).collect();
    let n = count as f64;
    let uniform = UniformDirections::new(subject)?;
    let (mut least, mut detectable, mut violation, mut reason) = (None, 0f64, above_bound, None);
    for ((channel, integrals), found) in integrals.iter().zip(&found) {
        let deltas = subject.deltas.iter().map(|lobe| lobe.throughput[*channel]).sum::<f64>();
        let (expected, mean) = (integrals.total() + deltas, found.sum / n);
        let sampled = (found.squares / n - mean * mean).at_least(0.0) / (n - 1.0);
        let deviation = (sampled + integrals.variances.iter().sum::<f64>()).sqrt();
        // Errors of cubature and of single precision explain a part of the difference.
        let error = if subject.is_deterministic() { integrals.uncertainty.bound(0.5 * CHANCE * CHANCE) } else { 0.0 };
        let explained = error + ROUNDING * expected;
        let explained = explained + uniform.unseen(*channel, found.largest.sqrt(), n);
        let excess = ((mean - expected).abs() - explained).at_least(0.0);
        let z = if excess == 0.0 { 0.0 } else { excess / deviation };
        let at = || {
            let error = 100.0 * (mean / expected - 1.0);
            format!(
                "{}: weights have the mean {mean:.5}, {error:+.1} % of ∫ {} = {expected:.5}{}",
                subject.from(),
                subject.properties.kind.integrand(),
                times(subject, mean / expected, (deviation * CHANCE + explained) / expected)
            )
        };
        if least.as_ref().is_none_or(|(largest, _)| z.may_exceed(*largest)) {
            least = Some((z, at()));
        }
        let scale = expected.at_least(f64::MIN_POSITIVE);
        detectable = detectable.at_least((explained + deviation * noncentrality(1, level).sqrt()) / scale);
        if found.squares > 0.0 && found.largest > LARGEST * found.squares {
            reason = Some("a single weight decides: their tail is not controlled".to_owned());
        }
        violation = violation.or(integrals.invalid.map(|at| {
            format!("{}: {} = {}", subject.at(at.point.into()), subject.properties.kind.integrand(), at.value)
        }));
    }
    // Where single weights decide, sums are not normally distributed, and p says nothing.
    let least = least.filter(|_| reason.is_none());
    let coarse = Some(detectable).filter(|&w| w > subject.protocol.coarsest());
    let reason = reason
        .or(coarse
            .map(|w| format!("too few samples: an error of the albedo below {} would remain undetected", percent(w))));
    let p = least.as_ref().map(|(z, _)| (libm::erfc(z / 2f64.sqrt()) * channels.len() as f64).at_most(1.0));
    Ok(Some(Outcome {
        statistic: least.as_ref().map_or(0.0, |(z, _)| z * z),
        // Where the tolerance explains all, p is 1: it has no continuous distribution.
        dof: usize::from(p.is_some_and(|p| p < 1.0)),
        p,
        detectable: Some(detectable),
        diagnosis: least.filter(|_| p.is_some_and(|p| p < SUSPECT)).map(|(_, at)| at),
        violation,
        inconclusive_reason: reason,
        ..Outcome::open(count)
    }))
}
