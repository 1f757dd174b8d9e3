//! The mistake that makes numbers other than they should be: the pdfs that samples carry, and values of BSDFs.

use super::{Follows, MOST_CELLS, Variable, all, asked, number, unless_cancelled, variables};
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::named_mistake::NamedMistake;
use crate::sampler::Density;

/// The share of pairs that must have a ratio.
const MOST_PAIRS: f64 = 0.9;

/// A point, with what was found there and what should be: the pdf that a sample carries, and the density's.
pub type Pair = (Point, [f64; 2]);

/// Relative differences of numbers that differ by rounding.
const ROUNDED: f64 = 1e-6;
/// Relative differences of ratios that count as equal.
pub const EQUAL: f64 = 1e-4;
/// Fewer pairs say nothing.
pub const FEWEST_PAIRS: usize = 32;

/// The mistake that makes `found` another number than `of` at all of `pairs`, of which `density` has the second: "[what samples
/// carry] is π times [the pdf]".
///
/// # Errors
/// As [`of_counts`].
pub fn of_pairs(
    domain: &dyn Domain,
    density: &dyn Density,
    pairs: &[Pair],
    [found, of]: [&str; 2],
) -> Result<Option<NamedMistake>> {
    let pairs = both_not_zero(pairs);
    if let Some(factor) = factor_of(&pairs, &known(&pairs)) {
        let told = || NamedMistake::from(format!("{found} is {} times {of}", number(factor)));
        return Ok((!is_one(factor)).then(told));
    }
    let explained = explained_pairs(domain, density, &pairs, of, |factor, name| match name.strip_prefix(of) {
        Some(_) => format!("{} times {name}", number(factor)),
        None => format!("in proportion to {name}"),
    });
    let named = unless_cancelled(explained.map(|names| NamedMistake::one_of(&format!("{found} is "), names, "")))?;
    Ok(named.or_else(|| of_power(&pairs, [found, of])))
}

/// The mistake that makes the density of samples, the first of each pair, another than the pdf: in the words of [`of_counts`].
///
/// # Errors
/// As [`of_counts`].
pub fn of_samples(
    domain: &dyn Domain,
    density: &dyn Density,
    pairs: &[Pair],
    [samples, of]: [&str; 2],
) -> Result<Option<NamedMistake>> {
    let pairs = both_not_zero(pairs);
    if let Some(factor) = factor_of(&pairs, &known(&pairs)) {
        let told = |pdf: f64| {
            let told = format!(
                "{samples} follow {of} up to a factor: {of} is {} times as large as {samples} say",
                number(pdf)
            );
            NamedMistake::from(told).with_factor([samples, of], pdf)
        };
        return Ok((!is_one(factor)).then(|| told(1.0 / factor)));
    }
    let explained = explained_pairs(domain, density, &pairs, of, |_, name| match name.strip_prefix(of) {
        Some(_) => format!("a density in proportion to {name}"),
        None => name,
    });
    unless_cancelled(
        explained.map(|names| NamedMistake::one_of(&format!("{samples} follow "), names, &format!(", not {of}"))),
    )
}

/// The power of the numbers that should be, times a factor, that what was found is.
pub fn of_power(pairs: &[Pair], [found, of]: [&str; 2]) -> Option<NamedMistake> {
    let pairs = both_not_zero(pairs);
    logarithms(&pairs)?;
    let ln: Vec<[f64; 2]> = pairs
        .iter()
        .map(|(_, both)| both.map(f64::ln))
        .filter(|both| both[0].is_finite() && both[1].is_finite())
        .collect();
    // By the largest and the least value, if it holds for all
    let end = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    let (least, most) = (ln.iter().min_by(end)?, ln.iter().max_by(end)?);
    let power = (most[0] - least[0]) / (most[1] - least[1]);
    let left: Vec<f64> = ln.iter().map(|[found, known]| (found - power * known).exp()).collect();
    let factor = common_factor(&left).filter(|_| power.is_finite() && power.abs() > EQUAL)?;
    let factor = times(factor);
    Some(NamedMistake::from(format!("{found} is {factor}{of} to the power of {}", number(power))))
}

fn is_one(factor: f64) -> bool {
    (factor - 1.0).abs() <= EQUAL
}

/// "2 times ", nothing for 1.
fn times(factor: f64) -> String {
    if is_one(factor) { String::new() } else { format!("{} times ", number(factor)) }
}

/// The numbers that should be.
fn known(pairs: &[Pair]) -> Vec<f64> {
    pairs.iter().map(|(_, [_, known])| *known).collect()
}

/// The factor between what was found and `values`, if nearly all have the same.
fn factor_of(pairs: &[Pair], values: &[f64]) -> Option<f64> {
    let ratios = pairs.iter().zip(values).map(|((_, [found, _]), value)| found / value);
    let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect();
    let enough = ratios.len() >= FEWEST_PAIRS && ratios.len() as f64 >= MOST_PAIRS * pairs.len() as f64;
    common_factor(&ratios).filter(|_| enough)
}

/// What the numbers are: the mistakes that make them, each of which does. Of shapes with another factor the first is told, in the words that
/// `shape` has for factor and name.
fn explained_pairs(
    domain: &dyn Domain,
    density: &dyn Density,
    pairs: &[Pair],
    of: &str,
    shape: impl Fn(f64, String) -> String,
) -> Result<Vec<Vec<String>>> {
    let known = known(pairs);
    let points: Vec<Point> = pairs.iter().map(|(point, _)| *point).collect();
    // Those that explain the numbers themselves, all of them where a symmetry or an angle makes several equal; else their shape.
    let (mut exact, mut shapes) = (Vec::new(), Vec::new());
    let is_positive = known.iter().filter(|known| **known > 0.0).count() as f64 >= MOST_PAIRS * known.len() as f64;
    for mistake in all(domain, density).into_iter().filter(|mistake| !mistake.is_family()) {
        let values = unless_cancelled(mistake.values(density, &points, &known).map(Some))?;
        let Some(factor) = values.and_then(|values| factor_of(pairs, &values)) else { continue };
        let name = mistake.told(of);
        match mistake.follows {
            Follows::Density(_) if !is_positive => {}
            Follows::Density(_) => shapes.push(shape(factor, name)),
            _ if is_one(factor) => exact.push(vec![name]),
            _ => shapes.push(shape(factor, name)),
        }
    }
    if !exact.is_empty() {
        return Ok(exact);
    }
    // The pdf of another outcome
    if let Some(n) = domain.outcomes().filter(|n| *n <= MOST_CELLS) {
        let mut all = asked(density, &(0..n).map(Point::from).collect::<Vec<_>>())?;
        all.sort_unstable_by(f64::total_cmp);
        let near = |found: f64| {
            let i = all.partition_point(|pdf| *pdf < found * (1.0 - ROUNDED));
            all.get(i).is_some_and(|pdf| *pdf <= found * (1.0 + ROUNDED))
        };
        let mut different: Vec<u64> = pairs.iter().map(|(_, [found, _])| found.to_bits()).collect();
        different.sort_unstable();
        different.dedup();
        let is_many = pairs.len() >= FEWEST_PAIRS && different.len() > 2;
        if shapes.is_empty() && is_many && pairs.iter().all(|(_, [found, _])| near(*found)) {
            return Ok(vec![vec![format!("{of} of other outcomes")]]);
        }
    }
    if shapes.is_empty() {
        let powers = logarithms(pairs).and_then(|ratios| powers(&ratios, &variables(domain, density)));
        shapes.extend(powers.map(|powers| powers.replace("{}", of)));
    }
    Ok(if shapes.is_empty() { Vec::new() } else { vec![shapes] })
}

/// The variable of which alone the ratio of the numbers is a function, if there is one: less than a mistake, and not looked for
/// where there is one.
pub fn of_one_variable(
    domain: &dyn Domain,
    density: &dyn Density,
    pairs: &[Pair],
    [found, of]: [&str; 2],
) -> Option<NamedMistake> {
    let open = function(&logarithms(&both_not_zero(pairs))?, &variables(domain, density));
    NamedMistake::one_of(&format!("{found} is {of} times a function of "), open, "")
}

/// On which side of a place along an axis of the chart the numbers are equal, or one a constant times the other, and what they are on the
/// other side: a function of two branches of which one is wrong.
pub fn of_side(domain: &dyn Domain, pairs: &[Pair], [found, of]: [&str; 2]) -> Option<NamedMistake> {
    let ratios = logarithms(&both_not_zero(pairs))?;
    let charts = domain.charts(&ratios.iter().map(|(point, _)| *point).collect::<Vec<_>>()).ok()?;
    let side = |axis: usize| {
        let mut sorted: Vec<[f64; 2]> =
            charts.iter().zip(&ratios).map(|(at, (_, ratio))| [at[axis], ratio.exp()]).collect();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let n = sorted.len();
        let equal = |first: f64, all: &mut dyn Iterator<Item = &[f64; 2]>| {
            all.take_while(|[_, ratio]| (ratio / first - 1.0).abs() <= EQUAL).count()
        };
        let below = equal(sorted[0][1], &mut sorted.iter());
        let above = equal(sorted[n - 1][1], &mut sorted.iter().rev());
        let told = |ratio: f64| times(ratio) + of;
        let (is_below, is_above) = (below >= FEWEST_PAIRS, above >= FEWEST_PAIRS);
        if below >= n || !is_below && !is_above {
            return None;
        }
        // Where the known sides end
        let [low, high] = [below.max(1) - 1, n - above.max(1)].map(|i| about(&domain.told(axis, sorted[i][0])));
        let [first, last] = [sorted[0][1], sorted[n - 1][1]].map(told);
        Some(match (is_below, is_above) {
            (true, true) if below + above >= n => format!("{found} is {first} up to about {low}, and {last} beyond"),
            (true, true) => {
                format!(
                    "{found} is {first} up to about {low}, {last} from about {high} on, and another function between"
                )
            }
            (true, false) => format!("{found} is {first} up to about {low}, and another function beyond"),
            (false, _) => format!("{found} is {last} from about {high} on, and another function before"),
        })
    };
    (0..1 + usize::from(domain.is_plane())).find_map(side).map(NamedMistake::from)
}

/// A place such as `x = 0.4987`, its number with two digits.
fn about(place: &str) -> String {
    let Some((name, number)) = place.split_once(" = ") else { return place.to_owned() };
    let end = number.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(number.len());
    let (number, unit) = number.split_at(end);
    let two = |x: f64| format!("{x:.1e}").parse().unwrap_or(x);
    number.parse().map_or_else(|_| place.to_owned(), |x| format!("{name} = {}{unit}", two(x)))
}

/// Pairs that have a ratio, or where one number alone is 0.
fn both_not_zero(pairs: &[Pair]) -> Vec<Pair> {
    pairs.iter().copied().filter(|(_, both)| *both != [0.0; 2]).collect()
}

/// The logarithms of the ratios, if nearly all have one.
fn logarithms(pairs: &[Pair]) -> Option<Vec<(Point, f64)>> {
    let ratios = pairs.iter().map(|(point, [found, known])| (*point, (found / known).ln()));
    let ratios: Vec<(Point, f64)> = ratios.filter(|(_, ratio)| ratio.is_finite()).collect();
    let enough = ratios.len() >= FEWEST_PAIRS && ratios.len() as f64 >= MOST_PAIRS * pairs.len() as f64;
    enough.then_some(ratios)
}

/// The largest power of a variable, and the variance of its logarithm that must be its own.
const MOST_POWER: f64 = 4.0;
const OWN: f64 = 1e-6;
/// How much the logarithm of a ratio goes up and down in all, in units of its range, if it is a function of the variable; and the
/// least range.
const UP_AND_DOWN: f64 = 3.0;
const LEAST_RANGE: f64 = 10.0 * EQUAL;
/// One in this many ratios may be farther away than the range.
const FEW: usize = 20;

/// The product of a factor and powers of variables, multiples of ½, that ratios with these logarithms are.
fn powers(ratios: &[(Point, f64)], variables: &[Variable]) -> Option<String> {
    let centred = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.into_iter().map(|value| value - mean).collect::<Vec<f64>>()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let logarithms =
        |variable: &Variable| ratios.iter().map(|(point, _)| (variable.at)(*point).abs().ln()).collect::<Vec<f64>>();
    let columns = variables.iter().map(|variable| (variable.name, logarithms(variable)));
    let columns = columns.filter(|(_, column)| column.iter().all(|value| value.is_finite()));
    let (names, columns): (Vec<&str>, Vec<Vec<f64>>) = columns.unzip();
    // Least squares by Gram and Schmidt's orthogonal vectors; a variable that others make up is left out.
    let mut vectors: Vec<(usize, Vec<f64>, Vec<f64>)> = Vec::new();
    for (i, column) in columns.iter().enumerate() {
        let mut rest = centred(column.clone());
        let size = product(&rest, &rest);
        let mut shares = Vec::new();
        for (_, vector, _) in &vectors {
            let share = product(vector, &rest) / product(vector, vector);
            rest.iter_mut().zip(vector).for_each(|(rest, value)| *rest -= share * value);
            shares.push(share);
        }
        if product(&rest, &rest) > OWN * size.at_least(OWN) {
            vectors.push((i, rest, shares));
        }
    }
    let found = centred(ratios.iter().map(|(_, ratio)| *ratio).collect());
    let mut exponents: Vec<f64> =
        vectors.iter().map(|(_, vector, _)| product(vector, &found) / product(vector, vector)).collect();
    for k in (0..vectors.len()).rev() {
        let exponent = exponents[k];
        vectors[k].2.iter().enumerate().for_each(|(j, share)| exponents[j] -= share * exponent);
    }
    let exponents: Vec<f64> = exponents.into_iter().map(|exponent| 0.5 * (2.0 * exponent).round()).collect();
    let used: Vec<(usize, f64)> = vectors.iter().map(|(i, ..)| *i).zip(exponents).filter(|(_, e)| *e != 0.0).collect();
    if used.is_empty() || used.iter().any(|(_, exponent)| exponent.is_nan() || exponent.abs() > MOST_POWER) {
        return None;
    }
    let left = |(row, (_, ratio)): (usize, &(Point, f64))| {
        (ratio - used.iter().map(|(i, exponent)| exponent * columns[*i][row]).sum::<f64>()).exp()
    };
    let factor = common_factor(&ratios.iter().enumerate().map(left).collect::<Vec<f64>>())?;
    let told = |(i, exponent): &(usize, f64)| {
        let verb = if *exponent > 0.0 { "times" } else { "divided by" };
        if exponent.abs() == 1.0 {
            return format!("{verb} {}", names[*i]);
        }
        // "cos α, α the angle …" is (cos α)^2, α the angle …
        let (name, what) = names[*i].split_at(names[*i].find(',').unwrap_or(names[*i].len()));
        let name = if name.starts_with('(') { name.to_owned() } else { format!("({name})") };
        format!("{verb} {name}^{}{what}", exponent.abs())
    };
    let factor = times(factor);
    Some(format!("{factor}{{}} {}", used.iter().map(told).collect::<Vec<_>>().join(", ")))
}

/// The variables of each of which alone ratios with these logarithms are a function: several, where they are functions of each other.
fn function(ratios: &[(Point, f64)], variables: &[Variable]) -> Vec<Vec<String>> {
    let of = |variable: &Variable| {
        let mut sorted: Vec<[f64; 2]> = ratios.iter().map(|(at, ratio)| [(variable.at)(*at), *ratio]).collect();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        // Single values that differ make no function, and one steep end must not hide the rest: the outer ones are clamped.
        let mut ratios: Vec<f64> = sorted.iter().map(|at| at[1]).collect();
        ratios.sort_by(f64::total_cmp);
        let [low, high] = [ratios[ratios.len() / FEW], ratios[ratios.len() - 1 - ratios.len() / FEW]];
        let range = high - low;
        let step = |both: &[[f64; 2]]| (both[1][1].within(low, high) - both[0][1].within(low, high)).abs();
        let travelled: f64 = sorted.windows(2).map(step).sum();
        let is_known = sorted.iter().all(|at| at[0].is_finite());
        let is_function = is_known && range > LEAST_RANGE && travelled <= UP_AND_DOWN * range;
        let what = variable.of?;
        is_function.then(|| vec![format!("{} alone{}", variable.name, what(&sorted))])
    };
    variables.iter().filter_map(of).collect()
}

/// The least of `ratios`, if all are equal to it.
pub fn common_factor(ratios: &[f64]) -> Option<f64> {
    let [least, most] = [f64::at_most, f64::at_least].map(|of| ratios.iter().copied().reduce(of).unwrap_or(f64::NAN));
    (most <= least * (1.0 + EQUAL)).then_some(least)
}
