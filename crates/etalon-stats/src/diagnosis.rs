//! Where observed and expected counts differ most: regions of cells, as lines of a table and in words.

use crate::domain::Domain;
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::outcome::Counts;
use crate::text::count;
use std::collections::VecDeque;
use std::fmt::Write;

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
}

enum Place {
    Cells(Cell),
    Atom(usize),
    None,
}

impl Place {
    fn name(&self, domain: &dyn Domain) -> String {
        match self {
            Self::Cells(cell) => domain.region(cell),
            Self::Atom(atom) => format!("atom {atom}"),
            Self::None => "no sample".to_owned(),
        }
    }

    fn in_words(&self, domain: &dyn Domain) -> String {
        match self {
            Self::Cells(cell) => domain.in_words(cell),
            Self::Atom(atom) => format!("at atom {atom}"),
            Self::None => "among \"no sample\"".to_owned(),
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
        Self { place, counts: inside, observed, expected, sigma: sigma(observed, expected) }
    }

    /// "17 % too few", and where.
    fn in_words(&self, domain: &dyn Domain) -> String {
        let place = self.place.in_words(domain);
        if self.expected < 0.05 {
            return format!("{} where there should be none, {place}", count(self.observed, "sample", "samples"));
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
    let singles = cells.iter().map(|cell| Place::Cells(*cell)).chain((0..counts.atoms).map(Place::Atom));
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

#[cfg(test)]
mod tests {
    use crate::density::density;
    use crate::domain::{Directions, Pole};
    use crate::examine::{Protocol, validate};
    use crate::sampler::{Sample, sampler};
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
}
