//! What people read of a test: regions of cells where observed and expected counts differ most, as lines of a table and in words;
//! assertions for `cargo test` that say this; points and counts in messages.

use crate::domain::Domain;
use crate::examine::{Protocol, validate};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::outcome::{Counts, Outcome, Verdict};
use crate::power::POWER;
use crate::sampler::{Density, Mass, Sampler};
use std::collections::VecDeque;
use std::fmt::{Debug, Display, Write};

/// What no test of samples against their pdf sees.
pub const UNSEEN: &str = "this test cannot see an error that pdf and samples share (a wrong parameter in both), nor one \
                          that is smaller than the error that it detects: more samples find smaller errors";

/// Regions in the table.
const LISTED: usize = 6;
/// Regions in words.
const NAMED: usize = 3;
/// Standard deviations from which a region counts: in the table, and in words.
const NOTABLE: f64 = 2.0;
const CERTAIN: f64 = 4.0;

/// A part of the domain with the numbers of its counts.
struct Region {
    place: Place,
    counts: Vec<usize>,
    observed: u64,
    expected: f64,
    /// [`sigma`] of the sums.
    sigma: f64,
    /// All draws.
    draws: u64,
}

enum Place {
    Cells(Cell),
    Atom(String),
    None,
}

impl Place {
    fn name(&self, domain: &dyn Domain) -> String {
        match self {
            Self::Cells(cell) => domain.region(cell),
            Self::Atom(atom) => atom.clone(),
            Self::None => "no sample".to_owned(),
        }
    }

    fn in_words(&self, domain: &dyn Domain) -> String {
        match self {
            Self::Cells(cell) => domain.in_words(cell),
            Self::Atom(atom) => format!("at {atom}"),
            Self::None => "among draws that return no sample".to_owned(),
        }
    }
}

/// The error of a count in standard deviations of a Poisson count; at least one, where next to nothing is expected.
fn sigma(observed: u64, expected: f64) -> f64 {
    (observed as f64 - expected) / expected.at_least(1.0).sqrt()
}

impl Region {
    fn new(counts: &Counts, place: Place, inside: Vec<usize>) -> Self {
        let observed = inside.iter().map(|&i| counts.observed[i]).sum::<u64>();
        let expected = inside.iter().map(|&i| counts.expected[i]).sum::<f64>();
        let draws = counts.observed.iter().sum();
        Self { place, counts: inside, observed, expected, sigma: sigma(observed, expected), draws }
    }

    /// "17 % too few", and where.
    fn in_words(&self, domain: &dyn Domain) -> String {
        let place = self.place.in_words(domain);
        if let (Place::None, 0.05..) = (&self.place, self.expected) {
            let [observed, expected] = [self.observed as f64, self.expected].map(|n| n / self.draws as f64);
            return format!(
                "the pdf integrates to {:.4}, so that {:.2} % of the draws should return no sample: {:.2} % do",
                1.0 - expected,
                100.0 * expected,
                100.0 * observed
            );
        }
        if self.expected < 0.05 {
            return match self.place {
                Place::None => {
                    format!("{} no sample, and none should", count(self.observed, "draw returns", "draws return"))
                }
                _ => format!("{} where there should be none, {place}", count(self.observed, "sample", "samples")),
            };
        }
        let error = self.observed as f64 / self.expected - 1.0;
        let percent = 100.0 * error.abs();
        let size = match percent {
            _ if error > 9.5 => return format!("{:.0} times as many as expected {place}", error + 1.0),
            10.0.. => format!("{percent:.0} %"),
            _ => format!("{percent:.2} %"),
        };
        format!("{size} too {} {place}", if error > 0.0 { "many" } else { "few" })
    }
}

/// Cells that touch, all with too many or all with too few samples by `least` standard deviations: the smallest rectangle of
/// the chart around each group.
fn groups(counts: &Counts, least: f64) -> Vec<Cell> {
    let cells: Vec<Cell> = counts.grid.cells().collect();
    let sign = |i: usize| {
        let sigma = sigma(counts.observed[i], counts.expected[i]);
        if sigma.abs() > least { sigma.signum() } else { 0.0 }
    };
    let meet = |[a0, a1]: [f64; 2], [b0, b1]: [f64; 2]| a0 <= b1 && b0 <= a1;
    let mut waiting: Vec<bool> = (0..cells.len()).map(|i| sign(i) != 0.0).collect();
    let mut found = Vec::new();
    while let Some(first) = waiting.iter().position(|&waits| waits) {
        waiting[first] = false;
        let (mut around, mut queue) = (cells[first], VecDeque::from([first]));
        while let Some(at) = queue.pop_front() {
            let Cell { x, y } = cells[at];
            around.x = [around.x[0].at_most(x[0]), around.x[1].at_least(x[1])];
            around.y = [around.y[0].at_most(y[0]), around.y[1].at_least(y[1])];
            for (next, waits) in waiting.iter_mut().enumerate().filter(|(_, waits)| **waits) {
                if sign(next) == sign(first) && meet(cells[next].x, x) && meet(cells[next].y, y) {
                    *waits = false;
                    queue.push_back(next);
                }
            }
        }
        found.push(around);
    }
    found
}

/// All regions that are looked at: groups of cells, rows and columns of the grid, its cells, the atoms, and "no sample".
fn all(counts: &Counts) -> Vec<Region> {
    let cells: Vec<Cell> = counts.grid.cells().collect();
    let inside = |around: &Cell| {
        let within = |[from, to]: [f64; 2], [a, b]: [f64; 2]| from <= a && b <= to;
        (0..cells.len()).filter(|&i| within(around.x, cells[i].x) && within(around.y, cells[i].y)).collect::<Vec<_>>()
    };
    // Groups at several heights: of all cells that chance does not explain, and of the worst.
    let largest =
        (0..cells.len()).map(|i| sigma(counts.observed[i], counts.expected[i]).abs()).fold(0.0, f64::at_least);
    let groups = [1.0, 0.1 * largest, 0.4 * largest].into_iter().flat_map(|least| groups(counts, least.at_least(1.0)));
    let groups = groups.map(|group| (Place::Cells(group), inside(&group)));
    let strips = counts.grid.strips().into_iter().filter(|(_, inside)| inside.len() > 1);
    let strips = strips.map(|(strip, inside)| (Place::Cells(strip), inside));
    let singles = cells.iter().map(|cell| Place::Cells(*cell)).chain(counts.atoms.iter().cloned().map(Place::Atom));
    let singles = singles.chain([Place::None]).enumerate().map(|(i, place)| (place, vec![i]));
    let all = groups.chain(strips).chain(singles);
    all.map(|(place, inside)| Region::new(counts, place, inside)).collect()
}

/// Regions that do not overlap and whose counts are least likely, the worst first.
///
/// Where the pdf is wrong by θ alone, a row of the grid stands out more than any of its cells; where it is wrong in a spot,
/// a cell does.
fn worst(counts: &Counts, notable: f64) -> Vec<Region> {
    let mut regions = all(counts);
    regions.retain(|region| region.sigma.abs() > notable);
    regions.sort_by(|a, b| b.sigma.abs().total_cmp(&a.sigma.abs()));
    let mut taken = vec![false; counts.observed.len()];
    regions.retain(|region| {
        let is_new = region.counts.iter().all(|&i| !taken[i]);
        region.counts.iter().filter(|_| is_new).for_each(|&i| taken[i] = true);
        is_new
    });
    regions
}

/// In words, where observed and expected counts differ most: "17 % too few within 2.0° of the horizon; 95 % too many …"; `None`
/// where chance explains all differences.
pub fn diagnose(domain: &dyn Domain, counts: &Counts) -> Option<String> {
    let words: Vec<String> = worst(counts, CERTAIN).iter().take(NAMED).map(|region| region.in_words(domain)).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

/// A table of the regions in which the counts differ most; empty where chance explains all differences.
pub fn table(domain: &dyn Domain, counts: &Counts) -> String {
    let mut lines: Vec<(String, Region)> =
        worst(counts, NOTABLE).into_iter().map(|region| (region.place.name(domain), region)).collect();
    if lines.is_empty() {
        return String::new();
    }
    lines.truncate(LISTED);
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(6);
    let mut text = String::from("where counts differ most from what the pdf predicts:\n");
    // Writing to a string cannot fail.
    let _ =
        writeln!(text, "  {:<width$} {:>10} {:>12} {:>9} {:>8}", "region", "observed", "expected", "error", "sigma");
    for (name, Region { observed, expected, sigma, .. }) in lines {
        let error = 100.0 * (observed as f64 / expected - 1.0);
        let error = if expected >= 0.05 { format!("{error:+.1} %") } else { "-".to_owned() };
        let _ = writeln!(text, "  {name:<width$} {observed:>10} {expected:>12.1} {error:>9} {sigma:>+8.1}");
    }
    text
}

/// Panics unless the samples of `sampler` follow `density` over `domain`, by the default [`Protocol`].
///
/// The message says what an exact check found wrong, or in which regions of the domain the counts differ most from what the
/// pdf predicts; the size of error that the test detects; and the seed. See [`explain`].
///
/// # Panics
/// If the verdict is not [`Verdict::Accept`](crate::Verdict::Accept), or the test could not be done.
///
/// ```
/// use etalon_stats::prelude::*;
///
/// let triangular = sampler(1, |u| Some(Sample::new(u[0].sqrt())));
/// assert_samples_follow_pdf(&Line::UNIT, &triangular, &density(|x: f64| 2.0 * x));
/// ```
#[track_caller]
pub fn assert_samples_follow_pdf(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) {
    assert_samples_follow_pdf_by(&Protocol::default(), domain, sampler, density);
}

/// [`assert_samples_follow_pdf`] by a protocol of one's own: another seed, power, level, or number of tests that share the
/// level.
///
/// # Panics
/// As [`assert_samples_follow_pdf`].
#[track_caller]
pub fn assert_samples_follow_pdf_by(
    protocol: &Protocol,
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    density: &dyn Density,
) {
    match validate(domain, sampler, density, protocol) {
        Ok(outcome) if outcome.is_accepted() => {}
        Ok(outcome) => {
            let declared = match density.mass() {
                Mass::Exactly(mass) => format!("declared: {mass}"),
                Mass::AtMostOne => "declared: at most 1".to_owned(),
                Mass::Unknown => "not declared".to_owned(),
            };
            // A wrong mass is the violation already.
            let mass = outcome.mass.filter(|_| outcome.violation.is_none());
            let mass = mass.map_or_else(String::new, |mass| format!("integral of the pdf: {mass}; {declared}\n"));
            panic!("{}{mass}", explain(domain, &outcome, protocol));
        }
        Err(error) => panic!("the samples could not be tested: {error}"),
    }
}

/// What a test found, over several lines: the verdict and its reason; further places; the statistic; if counts reject, the
/// regions in which observed and expected counts differ most; the detectable error, and that of ripples finer than the cells;
/// what the test cannot see; remarks; the seed.
#[must_use]
pub fn explain(domain: &dyn Domain, outcome: &Outcome, protocol: &Protocol) -> String {
    // Writing to a string cannot fail.
    let mut text = outcome.headline() + "\n";
    outcome.other_places().for_each(|place| text += &format!("  {place}\n"));
    if let Some(p) = outcome.continuous_p() {
        let freedom = count(outcome.dof, "degree of freedom", "degrees of freedom");
        let _ = write!(text, "{}, chi-square = {:.1} with {freedom}, ", p_value(p), outcome.statistic);
    }
    let _ = writeln!(text, "{}", outcome.taken());
    if let Some(counts) = outcome.counts.as_ref().filter(|_| outcome.is_rejected_by_p()) {
        text += &table(domain, counts);
    }
    if let Some(error) = outcome.detectable.filter(|_| outcome.verdict != Verdict::Reject) {
        let (error, power) = (100.0 * error, 100.0 * POWER);
        let _ = writeln!(
            text,
            "power: relative errors of the pdf of {error:.2} % (RMS over the cells) are detected with {power:.0} % probability"
        );
    }
    if let Some(finer) = outcome.finer().filter(|_| outcome.verdict != Verdict::Reject) {
        let _ = writeln!(text, "ripples: {finer}");
    }
    if outcome.is_accepted() {
        let _ = writeln!(text, "{UNSEEN}");
    }
    for remark in &outcome.remarks {
        let _ = writeln!(text, "remark: {remark}");
    }
    let _ = writeln!(text, "seed: {} (the same seed gives the same samples)", protocol.seed);
    text
}

/// A point or a list of random numbers as `(x, y, z)`, with as many digits as find a place again; a single number without
/// brackets.
pub fn tuple(point: &impl Debug) -> String {
    let text = format!("{point:?}").replace('[', "(").replace(']', ")");
    let short = |part: &str| {
        let number = part.trim_matches(|c| c == '(' || c == ')');
        number.parse::<f64>().map_or(part.to_owned(), |value| part.replace(number, &coordinate(value, number)))
    };
    text.split(", ").map(short).collect::<Vec<_>>().join(", ")
}

/// Six digits after the point; `all` digits of a number near an integer, where errors of edges are.
fn coordinate(value: f64, all: &str) -> String {
    if (value - value.round()).abs() >= 1e-4 {
        format!("{value:.6}").trim_end_matches('0').to_owned()
    } else {
        all.to_owned()
    }
}

/// Two different numbers, with as many digits as tell them apart.
pub fn different(a: f64, b: f64) -> [String; 2] {
    let text = (6..=16).map(|digits| [a, b].map(|number| with_digits(number, digits))).find(|[a, b]| a != b);
    text.unwrap_or_else(|| [a, b].map(|number| format!("{number:e}")))
}

/// A number to that many digits after the point, with an exponent only where it is large or small.
fn with_digits(number: f64, digits: usize) -> String {
    if (1e-3..1e4).contains(&number.abs()) { format!("{number:.digits$}") } else { format!("{number:.digits$e}") }
}

/// A number with its noun, the singular for 1: `1 sample`, `2 samples`.
pub fn count<N: Display + PartialEq + From<u8>>(n: N, one: &str, many: &str) -> String {
    let noun = if n == N::from(1) { one } else { many };
    format!("{n} {noun}")
}

/// A p-value as `p = 5.46e-63`, or `p < 1e-300` where it is smaller.
pub fn p_value(p: f64) -> String {
    if p < 1e-300 { "p < 1e-300".to_owned() } else { format!("p = {p:.2e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Directions, Discrete, Pole};
    use crate::examine::{Protocol, validate};
    use crate::sampler::{Sample, density, sampler};
    use crate::testing::uniform_hemisphere;
    use std::f64::consts::{PI, TAU};

    fn words(domain: &Directions, kept: fn([f64; 3]) -> bool, pdf: fn([f64; 3]) -> f64) -> String {
        let samples = sampler(2, |u| Some(uniform_hemisphere(u)).filter(|w| kept(*w)).map(Sample::new));
        let outcome = validate(domain, &samples, &density(pdf), &Protocol::default()).unwrap();
        outcome.diagnosis.unwrap_or_default()
    }

    #[test]
    fn the_words_say_where_and_how_much() {
        let half = Directions::hemisphere(Pole::Z);
        // Uniform samples said to be cosine-weighted.
        let text = words(&half, |_| true, |w| w[2] / PI);
        assert!(text.contains("too many within") && text.contains("of the horizon"), "{text}");
        assert!(text.contains("too few within") && text.contains("of theta = 0"), "{text}");
        // No samples in a row of cells.
        let text = words(&half, |w| !(0.4..0.5).contains(&w[2]), |_| 1.0 / TAU);
        assert!(text.contains("100 % too few for theta 60.00°..66.42°"), "{text}");
        // No samples in a spot of several cells: for x > 0 and y > 0, from 53° to 78°.
        let text = words(&half, |w| w[0] < 0.0 || w[1] < 0.0 || !(0.2..0.6).contains(&w[2]), |_| 1.0 / TAU);
        assert!(text.contains("100 % too few for theta 53.13°..78.46°, phi 0.00°..90.00°"), "{text}");
        assert_eq!(words(&half, |_| true, |_| 1.0 / TAU), "");
    }

    fn message(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> String {
        let protocol = Protocol { seed: 7, ..Protocol::default() };
        explain(domain, &validate(domain, sampler, density, &protocol).unwrap(), &protocol)
    }

    #[test]
    fn the_message_says_where_samples_and_pdf_disagree() {
        // Uniform samples said to be cosine-weighted: too many at the horizon, too few at the pole.
        let half = Directions::hemisphere(Pole::Z);
        let uniform = sampler(2, |u| Some(Sample::new(uniform_hemisphere(u))));
        let text = message(&half, &uniform, &density(|w: [f64; 3]| w[2] / PI));
        let worst = text.lines().find(|line| line.trim_start().starts_with("theta")).unwrap();
        assert!(worst.contains("..90.00°") && worst.contains("+9"), "{text}");
        assert!(
            text.starts_with("reject: samples follow a uniform density, not the pdf: 929 % too many within")
                && text.contains("seed: 7"),
            "{text}"
        );
        let accepted = message(&half, &uniform, &density(|_: [f64; 3]| 1.0 / TAU));
        assert!(accepted.contains("errors of the pdf of 2.0"), "{accepted}");
        assert!(accepted.starts_with("accept\n") && !accepted.contains("region"), "{accepted}");
        // An error in one spot, at phi from 77° to 103°, is blamed on the cells around it and not on their whole row.
        let spot = |w: [f64; 3]| w[2] > 0.5 && w[2] < 0.6 && w[0].abs() < 0.2 && w[1] > 0.0;
        let holey = sampler(2, |u| Some(uniform_hemisphere(u)).filter(|w| !spot(*w)).map(Sample::new));
        let text = message(&half, &holey, &density(|_: [f64; 3]| 1.0 / TAU));
        let worst: Vec<&str> = text.lines().filter(|line| line.trim_start().starts_with("theta")).collect();
        assert!(worst[0].contains("phi 72.00°..108.00°"), "{text}");
    }

    #[test]
    fn outcomes_atoms_and_missing_samples_are_named() {
        let die = sampler(1, |u| Some(Sample::new((u[0] * 6.0) as usize)));
        let loaded = density(|face: usize| if face == 5 { 0.25 } else { 0.15 });
        assert!(message(&Discrete { outcomes: 6 }, &die, &loaded).contains("  outcome 5 "));
        let lazy = sampler(2, |u| (u[0] > 0.01).then(|| Sample::new(uniform_hemisphere(u))));
        let text = message(&Directions::hemisphere(Pole::Z), &lazy, &density(|_: [f64; 3]| 1.0 / TAU));
        assert!(text.contains("  no sample "), "{text}");
        // A pdf that lacks 3 % of its samples
        let uniform = sampler(2, |u| Some(Sample::new(uniform_hemisphere(u))));
        let lacking = density(|w: [f64; 3]| if w[0] > 0.0 { 0.94 / TAU } else { 1.0 / TAU }).with_mass(Mass::AtMostOne);
        let text = message(&Directions::hemisphere(Pole::Z), &uniform, &lacking);
        let told = "the pdf integrates to 0.9700, so that 3.00 % of the draws should return no sample: 0.00 % do";
        assert!(text.contains(told), "{text}");
    }

    #[test]
    #[should_panic(expected = "reject: the pdf integrates to 1.01")]
    fn a_wrong_mass_fails_the_assertion() {
        let uniform = sampler(2, |u| Some(Sample::new(uniform_hemisphere(u))));
        assert_samples_follow_pdf(&Directions::hemisphere(Pole::Z), &uniform, &density(|_: [f64; 3]| 1.01 / TAU));
    }

    #[test]
    fn the_smallest_p_values_have_a_bound() {
        assert_eq!((p_value(5.461e-63), p_value(0.0)), ("p = 5.46e-63".to_owned(), "p < 1e-300".to_owned()));
    }

    #[test]
    fn points_are_tuples_and_nouns_agree() {
        assert_eq!((tuple(&[0.5, 1e-30, 1.0]), tuple(&0.25)), ("(0.5, 1e-30, 1.0)".to_owned(), "0.25".to_owned()));
        assert_eq!((count(1, "test", "tests"), count(2_u64, "test", "tests")), ("1 test".into(), "2 tests".into()));
    }
}
