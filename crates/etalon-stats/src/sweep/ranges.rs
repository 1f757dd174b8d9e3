//! One test of whatever has parameters, a sampler for instance, over their ranges.

use super::shrink::{ROUNDS, round_values};
use super::space::{Space, Strategy};
use crate::bsdf::Parameter;
use crate::error::Result;
use crate::examine::{Protocol, SampleCount};
use crate::extremes::Extremes;
use crate::multiple::any_of;
use crate::outcome::Outcome;

/// Combinations of special values of the parameters, and values inside their ranges, that are tested at most.
const VALUES: [(Strategy, u64); 2] = [(Strategy::Edges, 16), (Strategy::Random, 8)];
/// The error that is detected at each of them, times that of a test of one.
const COARSER: f64 = 2.5;
/// About as many tests as the search for simple values and for the ends of what fails makes.
const SEARCHED: f64 = 100.0;
/// Bisections by which the end of what fails is found.
const BISECTIONS: usize = 8;

/// One round of a test over the ranges of `parameters`: `examine` has their values, and a protocol whose level is the share of one test, for an
/// error 2.5 times as large. What fails is made as simple as it can be, and its ends are looked for along each parameter.
///
/// # Errors
/// Those of `examine`.
///
/// ```
/// use etalon_stats::bsdf::Parameter;
/// use etalon_stats::prelude::*;
/// use etalon_stats::{decide, examine, sweep::over_ranges};
///
/// // The pdf of a power of x, wrong above a power of 4
/// let exponent = [Parameter::new("n", 1.0, [0.0, 8.0])];
/// let test = |values: &[f64], protocol: &Protocol, round| {
///     let n = values[0];
///     let power = sampler(1, move |u| Some(Sample::new(u[0].powf(1.0 / (n + 1.0)))));
///     let pdf = density(move |x: f64| if n < 4.0 { (n + 1.0) * x.powf(n) } else { n * x.powf(n - 1.0) });
///     examine(&Line::UNIT, &power, &pdf, protocol, round)
/// };
/// let protocol = Protocol::default();
/// let mut found = [over_ranges(&exponent, &protocol, 0, test).unwrap()];
/// decide(&mut found, protocol.level, |_| over_ranges(&exponent, &protocol, 1, test)).unwrap();
/// assert!(found[0].reason().unwrap().starts_with("fails for n ≥ 4, such as n="), "{}", found[0]);
/// ```
pub fn over_ranges(
    parameters: &[Parameter],
    protocol: &Protocol,
    round: u64,
    examine: impl Fn(&[f64], &Protocol, u64) -> Result<Outcome>,
) -> Result<Outcome> {
    let spaces = VALUES.map(|(strategy, most)| Space::over("", parameters.to_vec(), 0, strategy, most, protocol.seed));
    let mut all: Vec<Vec<f64>> = vec![parameters.iter().map(|parameter| parameter.value).collect()];
    for values in spaces.iter().flat_map(|space| (0..space.len()).map(|number| space.get(number).values)) {
        if !all.contains(&values) {
            all.push(values);
        }
    }
    let samples = match protocol.samples {
        SampleCount::Detect(w) => SampleCount::Detect((COARSER * w).at_most(1.0)),
        fixed @ SampleCount::Fixed(_) => fixed,
    };
    let inner = Protocol { tests: protocol.tests * all.len(), samples, ..*protocol };
    let fails = |outcome: &Outcome| outcome.violation.is_some() || outcome.p.is_some_and(|p| p < inner.own_level());
    let examine = |values: &[f64]| examine(values, &inner, round);
    let named = |values: &[f64]| {
        let each = parameters.iter().zip(values).map(|(parameter, value)| format!("{}={value}", parameter.name));
        each.collect::<Vec<_>>().join(" ")
    };

    // Test all of them. The worst is the first violation, or else has the smallest p-value.
    let (mut samples, mut seconds, mut detectable, mut failed) = (0, 0.0, 0f64, 0);
    let (mut worst, mut undecided): (Option<(Vec<f64>, Outcome)>, Option<String>) = (None, None);
    for values in &all {
        let outcome = examine(values)?;
        (samples, seconds) = (samples + outcome.samples, seconds + outcome.seconds);
        detectable = detectable.at_least(outcome.detectable.unwrap_or(0.0));
        failed += usize::from(fails(&outcome));
        undecided = undecided.or(outcome.undecided().map(|reason| format!("{}: {reason}", named(values))));
        let rank = |outcome: &Outcome| (outcome.violation.is_none(), outcome.p.unwrap_or(1.0));
        if worst.as_ref().is_none_or(|(_, worst)| rank(&outcome) < rank(worst)) {
            worst = Some((values.clone(), outcome));
        }
    }
    let (mut values, mut found) = worst.unwrap_or_default();
    let p = found.p.map(|p| any_of(p, all.len()));
    found.remarks.iter_mut().for_each(|remark| *remark = format!("{}: {remark}", named(&values)));
    if fails(&found) {
        // The search makes tests of its own, whose number counts against the level
        let level = (inner.own_level() / SEARCHED).at_least(found.p.unwrap_or(0.0));
        let fails = |outcome: &Outcome| outcome.violation.is_some() || outcome.p.is_some_and(|p| p <= level);
        (values, found) = shrunk(parameters, values, found, &examine, fails)?;
        let region = region(parameters, &values, &|values| Ok(fails(&examine(values)?)))?;
        let place = format!("fails {region}, such as {}", named(&values));
        found.mistake = Some(match found.mistake.take() {
            Some(mistake) => mistake.with_prefix(&format!("{place}: ")),
            None => place.into(),
        });
        found.remarks.push(format!("{failed} of {} values of the parameters failed", all.len()));
    } else {
        found
            .remarks
            .push(format!("tested for {} values of the parameters, corners of their ranges among them", all.len()));
    }
    let detectable = Some(detectable);
    Ok(Outcome { p: p.or(found.p), samples, seconds, detectable, inconclusive_reason: undecided, ..found })
}

/// The simplest values that still fail, each parameter by itself.
fn shrunk(
    parameters: &[Parameter],
    mut values: Vec<f64>,
    mut found: Outcome,
    examine: &dyn Fn(&[f64]) -> Result<Outcome>,
    fails: impl Fn(&Outcome) -> bool,
) -> Result<(Vec<f64>, Outcome)> {
    for axis in (0..ROUNDS).flat_map(|_| 0..parameters.len()) {
        for value in round_values(&values[..=axis], &parameters[..=axis]) {
            if value == values[axis] {
                break;
            }
            let simpler = with(&values, axis, value);
            let outcome = examine(&simpler)?;
            if fails(&outcome) {
                (values, found) = (simpler, outcome);
                break;
            }
        }
    }
    Ok((values, found))
}

/// These values with another one along `axis`.
fn with(values: &[f64], axis: usize, value: f64) -> Vec<f64> {
    let mut values = values.to_vec();
    values[axis] = value;
    values
}

/// Where it fails around `values`, along each parameter: "for g ≥ 0.95".
fn region(parameters: &[Parameter], values: &[f64], fails: &dyn Fn(&[f64]) -> Result<bool>) -> Result<String> {
    let mut regions = Vec::new();
    for (axis, parameter) in parameters.iter().enumerate() {
        let middle = |a: f64, b: f64| if parameter.is_logarithmic() { (a * b).sqrt() } else { 0.5 * (a + b) };
        // The last value towards an end of the range that fails, unless all do.
        let limit = |end: f64| -> Result<Option<f64>> {
            if values[axis] == end || fails(&with(values, axis, end))? {
                return Ok(None);
            }
            let (mut inside, mut outside) = (values[axis], end);
            for _ in 0..BISECTIONS {
                let between = middle(inside, outside);
                if fails(&with(values, axis, between))? { inside = between } else { outside = between }
            }
            Ok(Some(inside))
        };
        let [from, to] = parameter.range;
        let name = &parameter.name;
        let short = |value: f64| format!("{value:.2e}").parse::<f64>().unwrap_or(value);
        regions.extend(match [limit(from)?, limit(to)?].map(|limit| limit.map(short)) {
            [None, None] => None,
            [Some(least), None] => Some(format!("{name} ≥ {least}")),
            [None, Some(most)] => Some(format!("{name} ≤ {most}")),
            [Some(least), Some(most)] if least == most => Some(format!("{name} = {least}")),
            [Some(least), Some(most)] => Some(format!("{least} ≤ {name} ≤ {most}")),
        });
    }
    Ok(if regions.is_empty() {
        "over the whole of its ranges".to_owned()
    } else {
        format!("for {}", regions.join(", "))
    })
}
