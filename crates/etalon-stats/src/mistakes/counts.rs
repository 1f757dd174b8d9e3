//! The mistake that explains counts of cells: samples follow its density as well as chance lets them.

use super::axis::{self, Axis, Direction};
use super::centre;
use super::{BATCH, Follows, MOST_CELLS, Mistake, all, asked, marginals, unless_cancelled};
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid};
use crate::named_mistake::NamedMistake;
use crate::outcome::Counts;
use crate::power::chi_square;
use crate::sampler::Density;

/// Points of each cell at which densities are compared, and the step of their lattice (Fibonacci's numbers); those of a first look, which
/// leaves out what explains so little that more points would not change it.
const POINTS: [usize; 2] = [34, 21];
const FEW_POINTS: [usize; 2] = [8, 5];
const FIRST_LOOK: f64 = 0.3;
/// Outcomes of a finite set up to which each is asked for.
const MOST_POINTS: usize = 1 << 16;
/// The share of the pdf's deviance that the best step of an amount may leave.
const FIRST_STEP: f64 = 0.9;
/// The share of the noncentrality of the counts that a mistake may leave unexplained, of at most 1 per sample (an error of
/// 100 %): midpoints are not exact, and samples may have small errors besides.
const LEFT: f64 = 0.002;
/// The share of the pdf's excess that a mistake may leave, also where chance leaves more; with an amount, which can be had for many
/// errors; and what chance may hide beside a factor.
const MOST: f64 = 0.1;
const MOST_FITTED: f64 = 0.02;
/// Samples after which an excess within chance says that the shape is right, and by which mistakes are named.
pub const SAMPLES_TO_NAME: u64 = 1 << 16;
/// Standard deviations of the statistic that count as chance; those that a density which explains the counts may leave; those from
/// which there is something to explain; and those from which there is no doubt.
const CHANCE: f64 = 2.5;
const LEFT_BY_CHANCE: f64 = 3.5;
const CLEAR: f64 = 10.0;
const CERTAIN: f64 = 100.0;
/// Factors of a part of the domain: squares of indices up to 2.8, and one over them.
const FACTORS: [f64; 2] = [0.125, 8.0];
/// Powers that exponents which are wrong by a simple factor make, and their names.
const POWERS: [(f64, &str); 6] =
    [(1.0 / 3.0, "1/3"), (0.5, "1/2"), (2.0 / 3.0, "2/3"), (1.5, "3/2"), (2.0, "2"), (3.0, "3")];
/// Steps and golden sections of the search for an amount, with the smaller part of a section.
const STEPS: usize = 24;
const SECTIONS: usize = 11;
const GOLDEN: f64 = 0.381_966_011_250_105;
/// The least share of a part of the pdf, and of the rest.
const PART: f64 = 0.02;
/// The relative step by which the error of an amount is found, and the least relative error: cells have sums in place of integrals.
const NEAR: f64 = 0.02;
const PRECISION: f64 = 0.005;
/// The share of samples that must lie in cells of which a mistake says the pdf; and a moved pdf, which may fit a part by chance.
const HELD: f64 = 0.5;
const MOST_HELD: f64 = 0.97;
/// The sum of differences of the cells' shares up to which densities are one.
const SAME: f64 = 0.01;
/// The logarithm of a factor that counts as 1.
const SCALE: f64 = 0.02;
/// Steps by which the axis of samples is found.
const TURNS: usize = 4;
/// Standard deviations of a Poisson count from which a share of the draws is wrong, and most shares that are told.
const WRONG: f64 = 5.0;
const TOLD_SHARES: usize = 3;
/// Fewer degrees of freedom are explained by too many densities. A finite set needs fewer: its outcomes are not sums over cells.
const FEWEST: usize = 5;
const FEWEST_OF_SET: usize = 3;
/// Columns of the rows in which a name is tried again.
const COLUMNS: usize = 8;

/// Samples that were not counted, by their chart coordinates: half of them make cells in which as many lie, the other half is counted
/// there; `None` where they are too few. Cells of equal area may be wider than a lobe, and tell little of its shape.
///
/// 2 n^(2/5) rows tell the shape along the first axis of n samples. Source: Mann & Wald, "On the Choice of the Number of Class Intervals in
/// the Application of the Chi Square Test", Annals of Mathematical Statistics 13(3), 1942.
pub fn of_others(domain: &dyn Domain, charts: &[[f64; 2]]) -> Option<Counts> {
    let half = |first: usize| charts.iter().skip(first).step_by(2).copied().collect::<Vec<_>>();
    let (places, counted) = (half(0), half(1));
    let shape = [(2.0 * (counted.len() as f64).powf(0.4)) as usize, if domain.is_plane() { COLUMNS } else { 1 }];
    if shape[0] <= FEWEST {
        return None;
    }
    let grid = Grid::adapted(&places, shape, Cell::WHOLE, domain.outcomes());
    let mut observed = vec![0; grid.len()];
    counted.iter().for_each(|&at| observed[grid.find(at)] += 1);
    let unknown = vec![f64::NAN; observed.len()];
    Some(Counts::new(domain, grid, Vec::new(), observed, unknown))
}

/// The mistake that explains the counts of the cells, if the density does not and one does: "[samples] follow cos θ/π, not
/// [the pdf]". It must explain the counts of `others`, too: see [`of_others`].
///
/// # Errors
/// [`Error::Cancelled`]. Where the density fails otherwise, at points that it was not made for, nothing is named.
pub fn of_counts(
    domain: &dyn Domain,
    density: &dyn Density,
    counts: &Counts,
    others: Option<&Counts>,
    [samples, of]: [&str; 2],
    kinds: Kinds,
) -> Result<Option<NamedMistake>> {
    let table = Table::new(domain, density, counts, POINTS);
    unless_cancelled(table.and_then(|table| Table { confirming: others, ..table }.explained([samples, of], kinds)))
}

/// In words, where no mistake explains that samples and pdf differ: which of two coordinates is wrong; and how wide both are.
///
/// # Errors
/// As [`of_counts`].
pub fn facts(
    domain: &dyn Domain,
    density: &dyn Density,
    counts: &Counts,
    names: [&str; 2],
) -> Result<[Option<String>; 2]> {
    let table = Table::new(domain, density, counts, POINTS);
    let told = table.and_then(|table| Ok(Some([table.coordinates(names[1]), table.widths(names)?])));
    Ok(unless_cancelled(told)?.unwrap_or_default())
}

/// Which mistakes are tried.
#[derive(Clone, Copy, PartialEq)]
pub enum Kinds {
    /// All.
    All,
    /// Those without an amount, where counts are beyond doubt; else more samples decide.
    Certain,
    /// Those that change values where they are: of counts that are no numbers of independent samples.
    Local,
}

/// Whether counts say if they differ from the shape of what is expected: so clearly that a mistake can be named, or not at all.
pub fn is_clear(counts: &Counts) -> bool {
    let cells = counts.grid.len();
    let (observed, expected) = (&counts.observed[..cells], &counts.expected[..cells]);
    let shares = shares_of(expected);
    let is_told = observed.iter().sum::<u64>() >= SAMPLES_TO_NAME;
    excess(observed, &shares, fewest(counts))
        .is_none_or(|[excess, spread]| excess * MOST > CHANCE * spread || is_told && excess <= CHANCE * spread)
}

/// Whether up to `most` samples in all may make clear what differs from the pdf, as the excess grows with the samples.
pub fn is_open(counts: &Counts, most: u64) -> bool {
    let cells = counts.grid.len();
    let (observed, shares) = (&counts.observed[..cells], shares_of(&counts.expected[..cells]));
    let all = observed.iter().sum::<u64>();
    // What chance hides of the shape must be little beside a factor, too.
    let is_factor = (counts.expected[..cells].iter().sum::<f64>() / all as f64 - 1.0).abs() > MOST_FITTED;
    let growth = most as f64 / all as f64;
    excess(observed, &shares, 1).is_some_and(|[excess, spread]| {
        all < SAMPLES_TO_NAME && excess <= CHANCE * spread && is_factor
            || excess < CLEAR * spread && excess * growth >= CLEAR * spread
    })
}

fn fewest(counts: &Counts) -> usize {
    if counts.outcomes.is_some() { FEWEST_OF_SET } else { FEWEST }
}

/// Whether nothing is expected: counts are compared with the smallest number in place of 0.
fn is_zero(expected: f64) -> bool {
    expected < 1e-300
}

/// The shares that the density expects.
fn shares_of(expected: &[f64]) -> Vec<Option<f64>> {
    expected.iter().map(|&expected| Some(if is_zero(expected) { 0.0 } else { expected })).collect()
}

/// Statistic minus degrees of freedom of counts against shares, and the standard deviation of that. Cells without a share are
/// left out, and there must be at least `fewest` degrees of freedom.
fn excess(observed: &[u64], shares: &[Option<f64>], fewest: usize) -> Option<[f64; 2]> {
    let known: Vec<(u64, f64)> = observed.iter().zip(shares).filter_map(|(n, share)| Some((*n, (*share)?))).collect();
    let (observed, shares): (Vec<u64>, Vec<f64>) = known.into_iter().unzip();
    let (total, sum) = (observed.iter().sum::<u64>() as f64, shares.iter().sum::<f64>());
    let is_valid = shares.iter().all(|share| share.is_finite() && *share >= 0.0) && sum > 0.0;
    let expected: Vec<f64> = shares.iter().map(|share| (share / sum * total).at_least(f64::MIN_POSITIVE)).collect();
    let test = chi_square(&observed, &expected).filter(|test| is_valid && test.dof >= fewest)?;
    Some([test.statistic - test.dof as f64, (2.0 * test.dof as f64).sqrt()])
}

/// Twice the logarithm of the likelihood ratio of counts against shares: what is least for the likeliest amount.
fn deviance(observed: &[u64], shares: &[Option<f64>]) -> f64 {
    let known = || observed.iter().zip(shares).filter_map(|(n, share)| Some((*n as f64, (*share)?)));
    let (total, sum) = known().fold((0.0, 0.0), |(total, sum), (n, share)| (total + n, sum + share));
    // Points miss a little of an edge: what they do not meet counts as half a sample.
    let expected = |share: f64| (share / sum * total).at_least(0.5);
    let term = |(n, share): (f64, f64)| if n > 0.0 { 2.0 * n * (n / expected(share)).ln() } else { 0.0 };
    let deviance = known().map(term).sum::<f64>();
    if total > 0.0 && deviance.is_finite() { deviance } else { f64::INFINITY }
}

/// What a mistake leaves unexplained of the statistic, the standard deviation of that by chance, and its rank among others of the
/// same shape.
struct Explained {
    left: f64,
    spread: f64,
    rank: usize,
    name: String,
    shares: Vec<Option<f64>>,
}

impl Explained {
    /// Whether both are one density.
    fn is_same(&self, other: &Self) -> bool {
        let pairs = || self.shares.iter().zip(&other.shares).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let [of_a, of_b] = pairs().fold([0.0; 2], |[a, b], (x, y)| [a + x, b + y]);
        pairs().map(|(a, b)| (a / of_a - b / of_b).abs()).sum::<f64>() <= SAME
    }
}

/// The rank of factors that make the integral another one.
const OTHER_FACTOR: usize = 2;

/// Values at points, by an amount.
type ByAmount<'a> = Box<dyn Fn(f64) -> Result<Vec<f64>> + 'a>;

/// A mistake with an amount, at the points of a table.
struct Family<'a> {
    /// The least and the largest amount.
    limits: [f64; 2],
    /// The amount that changes nothing: 1 of factors, 0 of others.
    rest: f64,
    /// Whether values are the pdf's, changed where they are.
    is_local: bool,
    /// The values by the amount.
    values: ByAmount<'a>,
    /// What follows the amount in words.
    own: String,
}

/// The counts of the cells, with points of them.
struct Table<'a> {
    domain: &'a dyn Domain,
    density: &'a dyn Density,
    counts: &'a Counts,
    observed: &'a [u64],
    expected: &'a [f64],
    /// Observed and expected counts of atoms, then of "no sample".
    others: Vec<(u64, f64)>,
    total: f64,
    /// Points of parts of the cells, graded so that wide cells have more of them near narrow ones.
    points: Vec<Point>,
    /// For each, the number of its cell and the measure that it stands for.
    places: Vec<(usize, f64)>,
    /// The pdf there.
    pdfs: Vec<f64>,
    /// Counts of other samples, which a mistake must explain, too.
    confirming: Option<&'a Counts>,
}

impl<'a> Table<'a> {
    fn new(domain: &'a dyn Domain, density: &'a dyn Density, counts: &'a Counts, lattice: [usize; 2]) -> Result<Self> {
        let cells = counts.grid.len();
        let (observed, expected) = (&counts.observed[..cells], &counts.expected[..cells]);
        let others = counts.observed[cells..].iter().copied().zip(counts.expected[cells..].iter().copied()).collect();
        let (mut points, mut places) = (Vec::new(), Vec::<(usize, f64)>::new());
        match domain.outcomes() {
            // Each outcome is a point of its own.
            Some(n) if n <= MOST_POINTS => {
                points.extend((0..n).map(Point::from));
                let place = |&point: &Point| domain.to_chart(point).map_or(0, |at| counts.grid.find(at));
                places.extend(points.iter().map(|point| (place(point), 1.0 / n as f64)));
            }
            Some(_) => {}
            None => {
                let graded = counts.grid.graded();
                let few = graded.len() <= MOST_CELLS;
                let (mut charts, mut cells, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
                for part in graded.cells().filter(|_| few) {
                    charts.extend(points_of(&part, lattice));
                    cells.resize(charts.len(), counts.grid.find(part.place([0.0, 0.0])));
                    sizes.resize(charts.len(), part.area() / lattice[0] as f64);
                }
                domain.per_chart_area(&charts, &mut sizes)?;
                points = domain.points_at(&charts)?;
                places.extend(cells.into_iter().zip(sizes));
            }
        }
        let pdfs = asked(density, &points)?;
        let total = observed.iter().sum::<u64>() as f64;
        Ok(Self { domain, density, counts, observed, expected, others, total, points, places, pdfs, confirming: None })
    }

    /// Whether a density with the values that are `of` a table's points explains the other samples, by their cells and by their rows, as
    /// well as chance and the errors of sums over points let them.
    fn is_confirmed(&self, of: impl Fn(&Table) -> Result<Vec<f64>>) -> Result<bool> {
        let Some(counts) = self.confirming else { return Ok(true) };
        let finer = Table::new(self.domain, self.density, counts, POINTS)?;
        let shares = finer.shares(&of(&finer)?, false);
        let (rows, columns) = counts.grid.ends();
        let row = |row: usize| {
            let first = counts.grid.number(row, 0);
            let cells = first..first + columns[row].len() - 1;
            let known: Option<Vec<f64>> = shares[cells.clone()].iter().copied().collect();
            (finer.observed[cells].iter().sum::<u64>(), known.map(|shares| shares.iter().sum::<f64>()))
        };
        let (of_rows, shares_of_rows): (Vec<u64>, Vec<Option<f64>>) = (0..rows.len() - 1).map(row).unzip();
        let is_left = |[left, spread]: [f64; 2]| left > LEFT_BY_CHANCE * spread + LEFT * finer.total;
        let left = [excess(finer.observed, &shares, fewest(counts)), excess(&of_rows, &shares_of_rows, fewest(counts))];
        Ok(!left.into_iter().flatten().any(is_left))
    }

    fn excess(&self, shares: &[Option<f64>]) -> Option<[f64; 2]> {
        excess(self.observed, shares, fewest(self.counts))
    }

    /// Sums over the points of each cell of `values` times the areas.
    fn sums(&self, values: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.observed.len()];
        values.into_iter().zip(&self.places).for_each(|(value, (cell, area))| sums[*cell] += value * area);
        sums
    }

    /// The shares of cells by the density's `values` at the points, NaN where it is not known. Integrals are sums over the
    /// points; where values are the pdf's own, changed, they are in proportion to the pdf's known integrals.
    fn shares(&self, values: &[f64], is_local: bool) -> Vec<Option<f64>> {
        let [of_values, of_pdf] = [values, &self.pdfs].map(|values| self.sums(values.iter().copied()));
        let share = |i: usize| match is_local {
            true if is_zero(self.expected[i]) => 0.0,
            true => self.expected[i] * of_values[i] / of_pdf[i],
            false => of_values[i],
        };
        // Where no point meets the pdf, or one of them has none, the share is not known.
        let known = |i: usize| Some(share(i)).filter(|share| !share.is_nan() && !of_values[i].is_nan());
        (0..of_values.len()).map(known).collect()
    }

    /// Whether what is left unexplained is as little as chance leaves, and at most the share `most` of `of_pdf`, the excess of the pdf; or
    /// [`LEFT`] of it, as integrals are not exact.
    fn is_explained(&self, of_pdf: f64, [left, spread]: [f64; 2], most: f64) -> bool {
        left <= (LEFT_BY_CHANCE * spread).at_most(most * of_pdf).at_least(LEFT * of_pdf.at_most(self.total))
    }

    /// What a mistake leaves unexplained by the points of a first look, if more points may show that it explains the counts.
    fn may_explain(&self, mistake: &Mistake, of_pdf: f64) -> Result<Option<[f64; 2]>> {
        let shares = self.shares(&mistake.values(self.density, &self.points, &self.pdfs)?, mistake.is_local());
        let is_little = |[left, spread]: &[f64; 2]| *left <= (FIRST_LOOK * of_pdf).at_least(LEFT_BY_CHANCE * spread);
        Ok(self.excess(&shares).filter(is_little))
    }

    /// What a mistake leaves unexplained, if that is little.
    fn explanation(&self, mistake: &Mistake, of_pdf: f64, of: &str) -> Result<Option<Explained>> {
        let values = mistake.values(self.density, &self.points, &self.pdfs)?;
        let is_local = mistake.is_local();
        let shares = self.shares(&values, is_local);
        let sum = shares.iter().flatten().sum::<f64>();
        let keeps_integral = is_local && (self.total / sum).ln().abs() < SCALE;
        // Factors that make the integral right, then densities, then factors of another integral
        let rank = match mistake.follows {
            Follows::Times(_) if keeps_integral => 0,
            Follows::Times(_) => OTHER_FACTOR,
            _ => 1,
        };
        Ok(self.explained_by(shares, of_pdf, rank, mistake.told(of)))
    }

    /// The same of shares of cells.
    fn explained_by(&self, shares: Vec<Option<f64>>, of_pdf: f64, rank: usize, name: String) -> Option<Explained> {
        let found =
            self.excess(&shares).filter(|left| self.held(&shares) >= HELD && self.is_explained(of_pdf, *left, MOST));
        found.map(|[left, spread]| Explained { left, spread, rank, name, shares })
    }

    /// The mistakes in one of two coordinates that explain the counts.
    fn marginals(&self, of_pdf: f64, of: &str) -> Result<Vec<Explained>> {
        if !self.domain.is_plane() || !self.domain.is_even() {
            return Ok(Vec::new());
        }
        let all = marginals::of(self.domain, self.density, &self.points)?.into_iter();
        let explained = |(name, values): (String, Vec<f64>)| {
            self.explained_by(self.shares(&values, false), of_pdf, 1, format!("{of} {name}"))
        };
        Ok(all.filter_map(explained).collect())
    }

    /// A mistake with an amount, if it is one.
    fn family<'b>(&'b self, mistake: &'b Mistake) -> Result<Option<Family<'b>>> {
        let is_local = mistake.is_local();
        let (limits, rest, values, own): ([f64; 2], f64, ByAmount, String);
        match &mistake.follows {
            Follows::Moved { limits: all, rest: own_rest, place } => {
                (limits, rest, own) = (*all, *own_rest, String::new());
                values = Box::new(|amount: f64| {
                    let (places, factors): (Vec<Point>, Vec<f64>) =
                        self.points.iter().map(|&at| place(amount, at)).unzip();
                    Ok(self.pdf_at(&places)?.into_iter().zip(factors).map(|(pdf, factor)| pdf * factor).collect())
                });
            }
            Follows::Mixed(parts) => {
                let batches = self.points.chunks(BATCH).map(parts).collect::<Result<Vec<_>>>()?;
                let both: [Vec<f64>; 2] =
                    [0, 1].map(|part| batches.iter().flat_map(|batch| &batch[part]).copied().collect());
                let of_parts = self.integrals(&both);
                (limits, rest) = ([0.0, 1.0], 0.5);
                own = format!(", not {:.3},", of_parts[0] / (of_parts[0] + of_parts[1]));
                values = mixture(both, of_parts);
            }
            Follows::Added(density) => {
                let both = [self.points.iter().map(|&point| density(point)).collect(), self.pdfs.clone()];
                (limits, rest, own) = ([0.0, 1.0], 0.0, String::new());
                let of_parts = self.integrals(&both);
                values = mixture(both, of_parts);
            }
            Follows::TimesIn(is_inside) => {
                let inside: Vec<bool> = self.points.iter().map(|&point| is_inside(point)).collect();
                (limits, rest, own) = (FACTORS, 1.0, String::new());
                values = Box::new(move |factor: f64| {
                    let pdfs = self.pdfs.iter().zip(&inside);
                    Ok(pdfs.map(|(pdf, inside)| if *inside { factor * pdf } else { *pdf }).collect())
                });
            }
            Follows::Power => {
                let ends = [0, POWERS.len() - 1].map(|i| POWERS[i].0);
                (limits, rest, own) = ([0.5 * ends[0], 1.5 * ends[1]], 1.0, String::new());
                values = Box::new(|power: f64| Ok(self.pdfs.iter().map(|pdf| pdf.powf(power)).collect()));
            }
            _ => return Ok(None),
        }
        Ok(Some(Family { limits, rest, is_local, values, own }))
    }

    /// The integrals of two densities, by their values at the points.
    fn integrals(&self, both: &[Vec<f64>; 2]) -> [f64; 2] {
        both.each_ref().map(|values| self.sums(values.iter().copied()).iter().sum())
    }

    /// The shares of cells with some amount; none where too few are known.
    fn shares_with(&self, family: &Family, amount: f64) -> Result<Vec<Option<f64>>> {
        let shares = self.shares(&(family.values)(amount)?, family.is_local);
        Ok(if self.held(&shares) >= MOST_HELD { shares } else { vec![None; shares.len()] })
    }

    /// The deviance with some amount.
    fn left_by(&self, family: &Family, amount: f64) -> Result<f64> {
        Ok(deviance(self.observed, &self.shares_with(family, amount)?))
    }

    /// The best of some amounts, equally distant or, of factors, in equal ratios; of those that a symmetry makes equal the one that changes
    /// least; and its distance to the next; `None` where it explains little of the deviance of the pdf.
    fn best_step(&self, family: &Family) -> Result<Option<[f64; 2]>> {
        let Family { limits: [least, most], rest, .. } = family;
        let at = |i: usize| {
            let share = i as f64 / STEPS as f64;
            if *rest == 1.0 { least * (most / least).powf(share) } else { least + (most - least) * share }
        };
        let all: Vec<(f64, f64)> =
            (0..=STEPS).map(|i| Ok((at(i), self.left_by(family, at(i))?))).collect::<Result<_>>()?;
        let least_left = all.iter().map(|(_, left)| *left).fold(f64::INFINITY, f64::at_most);
        let most_left = FIRST_STEP * deviance(self.observed, &shares_of(self.expected));
        let chance = CHANCE * (2.0 * self.observed.len() as f64).sqrt();
        // Only local minima are candidates.
        let is_lowest = |i: &usize| {
            let left = all[*i].1;
            let mut around = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|i| all.get(i));
            left <= (least_left + chance).at_most(most_left)
                && left.is_finite()
                && around.all(|(_, other)| left <= *other)
        };
        let from_rest = |i: &usize| if *rest == 1.0 { at(*i).ln().abs() } else { (at(*i) - rest).abs() };
        let best = (0..all.len()).filter(is_lowest).min_by(|a, b| from_rest(a).total_cmp(&from_rest(b)));
        Ok(best.map(|i| [at(i), at(i + 1) - at(i)]))
    }

    /// What a family leaves unexplained with the amount that explains most, if that is little, and its name. `few` has few points, for
    /// a first look.
    fn fitted(&self, few: &Table, mistake: &Mistake, of_pdf: f64, of: &str) -> Result<Option<(f64, String)>> {
        let best = match few.family(mistake)? {
            Some(family) => few.best_step(&family)?,
            None => None,
        };
        let (Some([best, step]), Some(family)) = (best, self.family(mistake)?) else { return Ok(None) };
        let left_by = |amount: f64| self.left_by(&family, amount);
        // Between the neighbours of the best step by golden sections
        let (mut low, mut high) = (best - step, best + step);
        let [mut first, mut second] = [low + GOLDEN * (high - low), high - GOLDEN * (high - low)];
        let [mut by_first, mut by_second] = [left_by(first)?, left_by(second)?];
        for _ in 0..SECTIONS {
            if by_first < by_second {
                (high, second, by_second) = (second, first, by_first);
                first = low + GOLDEN * (high - low);
                by_first = left_by(first)?;
            } else {
                (low, first, by_first) = (first, second, by_second);
                second = high - GOLDEN * (high - low);
                by_second = left_by(second)?;
            }
        }
        let amount = 0.5 * (low + high);
        // A pdf of one part is no mixture.
        if matches!(mistake.follows, Follows::Mixed(_) | Follows::Added(_)) && !(PART..1.0 - PART).contains(&amount) {
            return Ok(None);
        }
        // Where the deviance is larger by 1, one standard deviation away
        let near = NEAR * amount.abs().at_least(step);
        let around = left_by(amount - near)? + left_by(amount + near)? - 2.0 * left_by(amount)?;
        let error = near * (2.0 / around).sqrt();
        let known = Some(error.at_least(PRECISION * amount.abs())).filter(|error| error.is_finite());
        let error = known.unwrap_or(near);
        let power = |(power, _): &&(f64, &str)| (amount - power).abs() <= LEFT_BY_CHANCE * error;
        let text = match &mistake.follows {
            Follows::Power => POWERS.iter().find(power).map(|(_, name)| (*name).to_owned()),
            _ if known.is_none() => Some(format!("about {}", significant(amount, 2))),
            // Wrong shares of two lobes make both parts wrong; where one is right, the factor of the other may be the square of an index.
            Follows::TimesIn(is_inside) if self.is_right_outside(is_inside, amount) => {
                let (one_over, index) = if amount < 1.0 { ("1/", amount.sqrt().recip()) } else { ("", amount.sqrt()) };
                let of_index = with_error(index, 0.5 * error / amount * index);
                Some(format!("{} = {one_over}({of_index})²", with_error(amount, error)))
            }
            _ => Some(with_error(amount, error)),
        };
        let Some(text) = text else { return Ok(None) };
        let left = self
            .excess(&self.shares_with(&family, amount)?)
            .filter(|left| self.is_explained(of_pdf, *left, MOST_FITTED));
        let of_amount = |table: &Table| match table.family(mistake)? {
            Some(family) => (family.values)(amount),
            None => Ok(vec![f64::NAN; table.points.len()]),
        };
        if left.is_some() && !self.is_confirmed(of_amount)? {
            return Ok(None);
        }
        Ok(left.map(|[left, _]| (left, mistake.told(of).replace("{}", &(text + &family.own)))))
    }

    /// The values of the pdf, turned with its axis to another.
    fn turned_values(&self, from: Axis, to: Direction) -> Result<Vec<f64>> {
        let place = |&at: &Point| axis::turn_to(to, from.direction, at.into()).into();
        self.pdf_at(&self.points.iter().map(place).collect::<Vec<_>>())
    }

    /// The axis of the samples, if the pdf's counts are explained by a turn of its axis to there.
    fn turned(&self, from: Axis, of_pdf: f64, of: &str) -> Result<Option<String>> {
        // The samples of a cell lie in it evenly, to begin with, and then as the turned pdf does.
        let (mut to, mut values) = (None, vec![1.0; self.points.len()]);
        for _ in 0..TURNS {
            let coordinate = |axis: usize| {
                let coordinates = self.points.iter().map(|&at| Direction::from(at)[axis]);
                self.sums(coordinates.zip(&values).map(|(at, value)| at * value))
            };
            let (sums, all) = ([0, 1, 2].map(coordinate), self.sums(values.iter().copied()));
            let mean = |(i, n): (usize, &u64)| ([0, 1, 2].map(|axis| sums[axis][i] / all[i]), *n as f64);
            let means =
                self.observed.iter().enumerate().map(mean).filter(|(mean, _)| mean.iter().all(|x| x.is_finite()));
            to = axis::mean(means).map(|(to, _)| to).or(to);
            let Some(to) = to else { return Ok(None) };
            values = self.turned_values(from, to)?;
        }
        let Some(to) = to else { return Ok(None) };
        let shares = self.shares(&values, false);
        let is_explained = |left: &[f64; 2]| self.is_explained(of_pdf, *left, MOST_FITTED);
        let found = self.excess(&shares).filter(|left| self.held(&shares) >= MOST_HELD && is_explained(left));
        if found.is_some() && !self.is_confirmed(|table| table.turned_values(from, to))? {
            return Ok(None);
        }
        let angle = axis::dot(to, from.direction).within(-1.0, 1.0).acos().to_degrees();
        let name = || format!("{of} around {} in place of its axis {}, {angle:.2}° away", axis::name(to), from.name());
        Ok(found.map(|_| name()))
    }

    /// Whether as many samples as expected lie outside of a part of the domain, by the cells that have no point in it, and clearly others
    /// would if the factor inside were that of a wrong share of the part.
    fn is_right_outside(&self, is_inside: impl Fn(Point) -> bool, factor: f64) -> bool {
        let inside = self.sums(self.points.iter().map(|&point| if is_inside(point) { 1.0 } else { 0.0 }));
        let outside = (0..inside.len()).filter(|&i| inside[i] == 0.0);
        let [n, expected] =
            outside.fold([0.0; 2], |[n, expected], i| [n + self.observed[i] as f64, expected + self.expected[i]]);
        let chance = CHANCE * expected.sqrt() + PRECISION * expected;
        let all = self.expected.iter().sum::<f64>();
        let of_wrong_share = expected * all / (factor * (all - expected) + expected);
        (n - expected).abs() <= chance && (of_wrong_share - expected).abs() > 2.0 * chance
    }

    /// Observed and expected counts of all that may be drawn: of atoms, of "no sample", then of all other samples.
    fn drawn(&self) -> impl Iterator<Item = (u64, f64)> {
        let rest = (self.total as u64, self.expected.iter().sum::<f64>());
        self.others.iter().copied().chain([rest])
    }

    /// Whether probabilities of all that may be drawn do not add to 1.
    fn is_mass_wrong(&self) -> bool {
        let [draws, expected] = self.drawn().fold([0.0; 2], |[draws, all], (n, e)| [draws + n as f64, all + e]);
        (expected / draws - 1.0).abs() > PRECISION
    }

    /// Pearson's statistic of what is drawn at atoms, as "no sample" and else.
    fn excess_of_draws(&self) -> f64 {
        self.drawn().map(|(n, expected)| (n as f64 - expected).powi(2) / expected.at_least(1.0)).sum()
    }

    /// What shares of the draws are wrong, of atoms, "no sample" and the rest, where nothing else is.
    fn of_draws(&self, [samples, of]: [&str; 2]) -> Option<String> {
        let names = self.density.atom_names().into_iter().chain(["no sample", "all other samples"].map(str::to_owned));
        let all: Vec<(String, (u64, f64))> =
            names.zip(self.drawn()).filter(|(_, (n, expected))| *n > 0 || *expected > 0.5).collect();
        let draws = all.iter().map(|(_, (n, _))| *n as f64).sum::<f64>();
        let deviations = |(n, expected): (u64, f64)| (n as f64 - expected).abs() / expected.at_least(1.0).sqrt();
        let is_wrong = |counts: (u64, f64)| deviations(counts) > WRONG;
        let is_near = |counts: (u64, f64)| deviations(counts) <= CHANCE;
        // Where expected probabilities do not add to 1, they are no probabilities.
        if self.is_mass_wrong() {
            return None;
        }
        let wrong: Vec<&(String, (u64, f64))> = all.iter().filter(|(_, counts)| is_wrong(*counts)).collect();
        let told = |(name, (n, expected)): &&(String, (u64, f64))| {
            let share = *n as f64 / draws;
            let error = (share * (1.0 - share)).at_least(1.0 / draws).sqrt() / draws.sqrt();
            format!("that of {name} is {}, not {:.4}", with_error(share, error), expected / draws)
        };
        let what = match wrong[..] {
            [] => return None,
            [(a, (n, m)), (b, (k, l))] if is_near((*n, *l)) && is_near((*k, *m)) => {
                format!("the probabilities of {a} and of {b} are exchanged")
            }
            // Without atoms, "no sample" has what the pdf lacks.
            _ if all.len() == 2 && all[0].1.0 == 0 => {
                format!("every draw returns a sample, though the pdf integrates to {:.4}", all[1].1.1 / draws)
            }
            _ => format!(
                "probabilities are wrong: {}",
                wrong.iter().take(TOLD_SHARES).map(told).collect::<Vec<_>>().join(", ")
            ),
        };
        Some(format!("{samples} follow {of}, and {what}"))
    }

    /// The pdf at places; NaN where they are outside of the domain.
    fn pdf_at(&self, places: &[Point]) -> Result<Vec<f64>> {
        let inside: Vec<bool> = places.iter().map(|&place| self.domain.to_chart(place).is_some()).collect();
        let known: Vec<Point> = places.iter().zip(&inside).filter(|(_, inside)| **inside).map(|(at, _)| *at).collect();
        let mut values = asked(self.density, &known)?.into_iter();
        Ok(inside.iter().map(|inside| if *inside { values.next().unwrap_or(f64::NAN) } else { f64::NAN }).collect())
    }

    /// The share of samples that lie in cells with a share.
    fn held(&self, shares: &[Option<f64>]) -> f64 {
        let held = shares.iter().zip(self.observed).filter(|(share, _)| share.is_some());
        held.map(|(_, n)| *n as f64).sum::<f64>() / self.total
    }

    fn explained(&self, [samples, of]: [&str; 2], kinds: Kinds) -> Result<Option<NamedMistake>> {
        let all_of = shares_of(self.expected);
        let of_draws = || self.of_draws([samples, of]).filter(|_| kinds != Kinds::Local).map(NamedMistake::from);
        let Some([of_pdf, spread]) = excess(self.observed, &all_of, 1).filter(|_| !self.points.is_empty()) else {
            // Where atoms and "no sample" are all there is, their probabilities are all that can be wrong.
            return Ok(if self.total == 0.0 { of_draws() } else { None });
        };
        if of_pdf <= CHANCE * spread {
            if !self.is_confirmed(|table| Ok(table.pdfs.clone()))? {
                return Ok(None);
            }
            // What chance hides of the shape must be little beside what is wrong of the probabilities, too.
            let of_draws = || of_draws().filter(|_| MOST * self.excess_of_draws() > CHANCE * spread);
            // What chance hides of the shape must be little beside the factor, unless probabilities tell that there is one.
            let ratio = self.expected.iter().sum::<f64>() / self.total;
            let is_much = MOST_FITTED * self.total * ratio.ln().powi(2) > CHANCE * spread;
            let is_factor = ratio.is_finite() && (is_much || kinds != Kinds::Local && self.is_mass_wrong());
            let text = if ratio < 0.1 { format!("{ratio:.1e}") } else { format!("{ratio:.3}") };
            let told =
                || format!("{samples} follow {of} up to a factor: {of} is {text} times as large as {samples} say");
            let told = of_draws().or_else(|| is_factor.then(told).map(NamedMistake::from));
            // Without atoms, the rest of the draws has what the factor lacks.
            let has_atoms = self.others.len() > 1;
            let with_factor = |named: NamedMistake| named.with_factor([samples, of], ratio);
            return Ok(if has_atoms { told } else { told.map(with_factor) });
        }
        let clear = if kinds == Kinds::Certain { CERTAIN } else { CLEAR };
        if of_pdf.is_nan() || of_pdf < clear * spread {
            return Ok(None);
        }
        let mut all = all(self.domain, self.density);
        let own_axis = self.axis()?;
        all.extend(own_axis.into_iter().flat_map(Axis::mistakes));
        all.extend(self.mean().map(spread_about));
        all.extend(self.backgrounds());
        all.extend(self.centre()?.into_iter().flat_map(centre::mistakes));
        // Mistakes that need no other values of the pdf come first, and those with an amount last.
        let is_tried =
            |mistake: &Mistake| !mistake.needs_exact_numbers && (kinds != Kinds::Local || mistake.is_local());
        let (families, others): (Vec<Mistake>, Vec<Mistake>) =
            all.into_iter().filter(is_tried).partition(Mistake::is_family);
        let (known, others): (Vec<Mistake>, Vec<Mistake>) = others.into_iter().partition(Mistake::is_known);
        let (places, asked): (Vec<Mistake>, Vec<Mistake>) =
            others.into_iter().partition(|mistake| matches!(mistake.follows, Follows::At(_)));
        let named = |names: Vec<Vec<String>>| {
            Ok(NamedMistake::one_of(&format!("{samples} follow "), names, &format!(", not {of}")))
        };
        let few = Table::new(self.domain, self.density, self.counts, FEW_POINTS)?;
        for (group, is_place, is_last) in [(known, false, false), (places, true, false), (asked, false, true)] {
            let mut found = Vec::new();
            for mistake in &group {
                // What is not known at the points is asked at few of them first.
                // Where the density fails at what a mistake asks for, that mistake is left out.
                let is_tried = mistake.is_known() || unless_cancelled(few.may_explain(mistake, of_pdf))?.is_some();
                if is_tried {
                    let explanation = self.explanation(mistake, of_pdf, of).and_then(|explained| {
                        let of = |table: &Table| mistake.values(table.density, &table.points, &table.pdfs);
                        Ok(if explained.is_some() && !self.is_confirmed(of)? { None } else { explained })
                    });
                    found.extend(unless_cancelled(explanation)?);
                }
            }
            if is_last && kinds != Kinds::Local {
                found.extend(unless_cancelled(self.marginals(of_pdf, of).map(Some))?.unwrap_or_default());
            }
            let best = found.iter().map(|explained| explained.left).fold(f64::INFINITY, f64::at_most);
            found.retain(|Explained { left, spread, .. }| *left <= best + CHANCE * spread);
            // Places that a symmetry makes equal are named together.
            if is_place && !found.is_empty() {
                return named(found.into_iter().map(|explained| vec![explained.name]).collect());
            }
            // Densities of the first rank that differ, each with its names of lower ranks: tests of other directions may share one of those
            found.sort_by_key(|explained| explained.rank);
            let first = found.first().map(|explained| explained.rank);
            let mut different: Vec<(Explained, Vec<String>)> = Vec::new();
            for explained in found {
                let proportional = if explained.rank == OTHER_FACTOR { "a density in proportion to " } else { "" };
                let name = format!("{proportional}{}", explained.name);
                match different.iter_mut().find(|(other, _)| explained.is_same(other)) {
                    Some((_, names)) => names.push(name),
                    None if Some(explained.rank) == first => different.push((explained, vec![name])),
                    None => {}
                }
            }
            if !different.is_empty() {
                return named(different.into_iter().map(|(_, names)| names).collect());
            }
        }
        if kinds == Kinds::Certain {
            return Ok(None);
        }
        let fitted = families.iter().map(|family| unless_cancelled(self.fitted(&few, family, of_pdf, of)));
        let mut fitted: Vec<(f64, String)> = fitted.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
        if !fitted.is_empty() {
            // Those that explain as much as the best, the usual one first
            let best = fitted.iter().map(|(left, _)| *left).fold(f64::INFINITY, f64::at_most);
            fitted.retain(|(left, _)| *left <= best + CHANCE * spread);
            return named(fitted.into_iter().map(|(_, name)| vec![name]).collect());
        }
        let turned = match own_axis.filter(|_| kinds != Kinds::Local) {
            Some(from) => self.turned(from, of_pdf, of)?,
            None => None,
        };
        named(turned.into_iter().map(|name| vec![name]).collect())
    }

    /// The axis about which the pdf is symmetric, if there is one.
    fn axis(&self) -> Result<Option<Axis>> {
        axis::of(self.domain, &self.points, &self.masses(), |places| self.pdf_at(places))
    }

    /// Mixtures of a uniform or a cosine-weighted part with the rest of the pdf, with other shares.
    fn backgrounds(&self) -> impl Iterator<Item = Mistake<'_>> {
        let pole: Direction = self.domain.point_at([0.0; 2]).into();
        let cos = move |point: Point| axis::dot(point.into(), pole).at_least(0.0);
        [self.background("uniform", |_| 1.0), self.background("cosine-weighted", cos)].into_iter().flatten()
    }

    /// The largest part of the pdf that is in proportion to a density, as the first of two with another share.
    fn background<'b>(&'b self, name: &str, density: impl Fn(Point) -> f64 + 'b) -> Option<Mistake<'b>> {
        let ratios = self.points.iter().zip(&self.pdfs).map(|(&point, pdf)| pdf / density(point));
        let least = ratios.filter(|ratio| ratio.is_finite()).fold(f64::INFINITY, f64::at_most);
        let of_part = self.sums(self.points.iter().map(|&point| least * density(point))).iter().sum::<f64>();
        let share = of_part / self.masses().iter().sum::<f64>();
        let parts = move |points: &[Point]| {
            let first: Vec<f64> = points.iter().map(|&point| least * density(point)).collect();
            let rest = asked(self.density, points)?.iter().zip(&first).map(|(pdf, first)| pdf - first).collect();
            Ok([first, rest])
        };
        let name = format!("with a share of {{}} for its {name} part");
        (PART..1.0 - PART).contains(&share).then(|| Mistake::mixed(&name, parts))
    }

    /// The centre about which a pdf of the square is symmetric, if there is one.
    fn centre(&self) -> Result<Option<[f64; 2]>> {
        centre::of(&self.points, &self.pdfs, &self.masses(), |places| self.pdf_at(places))
    }

    /// The pdf's share at each point.
    fn masses(&self) -> Vec<f64> {
        self.pdfs.iter().zip(&self.places).map(|(pdf, (_, area))| pdf * area).collect()
    }

    /// In words, which of two coordinates is wrong: by the rows of the cells and, where all rows have the same, by their columns.
    fn coordinates(&self, of: &str) -> Option<String> {
        let [x, y] = self.domain.coordinates();
        let (rows, columns) = self.counts.grid.ends();
        let is_right = |group: &dyn Fn(usize) -> usize, groups: usize| {
            let (mut observed, mut shares) = (vec![0; groups], vec![0.0; groups]);
            for i in 0..self.observed.len() {
                (observed[group(i)], shares[group(i)]) =
                    (observed[group(i)] + self.observed[i], shares[group(i)] + self.expected[i]);
            }
            let found = excess(&observed, &shares_of(&shares), 1);
            found.is_some_and(|[excess, spread]| excess <= CHANCE * spread)
        };
        let ends: Vec<usize> = (1..rows.len()).map(|row| self.counts.grid.number(row - 1, 0)).collect();
        let row = |i: usize| ends.partition_point(|first| *first <= i) - 1;
        let of_rows = is_right(&row, rows.len() - 1);
        let is_product = columns.iter().all(|other| *other == columns[0]);
        let width = columns[0].len() - 1;
        let of_columns = is_product && is_right(&|i| i % width, width);
        let is_clear = excess(self.observed, &shares_of(self.expected), 1);
        if !self.domain.is_plane() || is_clear.is_some_and(|[excess, spread]| excess < CLEAR * spread) {
            return None;
        }
        let told = match (of_rows, of_columns) {
            (true, true) => format!("{x} and {y} follow {of} each, but not together"),
            (true, false) => format!("{x} follows {of}, and {y} for given {x} does not"),
            (false, true) => format!("{y} follows {of}, and {x} for given {y} does not"),
            (false, false) => return None,
        };
        Some(told)
    }

    /// The mean of the pdf of a number.
    fn mean(&self) -> Option<f64> {
        let is_number = !self.domain.is_plane() && self.domain.outcomes().is_none();
        let mean = is_number.then(|| self.mean_of(&|x| x.into(), false));
        mean.filter(|mean| mean.is_finite())
    }

    /// The mean of a quantity by the pdf, or over samples that lie in each cell as the pdf does.
    fn mean_of(&self, quantity: &dyn Fn(Point) -> f64, is_of_samples: bool) -> f64 {
        let values = self.points.iter().zip(&self.pdfs).map(|(&point, pdf)| pdf * quantity(point));
        let (sums, all) = (self.sums(values), self.sums(self.pdfs.iter().copied()));
        if !is_of_samples {
            return sums.iter().sum::<f64>() / all.iter().sum::<f64>();
        }
        let of_cell = |(i, n): (usize, &u64)| if *n > 0 { sums[i] / all[i] * *n as f64 } else { 0.0 };
        self.observed.iter().enumerate().map(of_cell).sum::<f64>() / self.total
    }

    /// In words, how wide samples and pdf are: the mean and the standard deviation of a number, the mean angle with the axis of a pdf of
    /// directions. Samples lie in cells as the pdf does.
    fn widths(&self, [samples, of]: [&str; 2]) -> Result<Option<String>> {
        if let Some(centre) = self.mean() {
            let moments = |is_of_samples: bool| {
                let first = self.mean_of(&|x| f64::from(x) - centre, is_of_samples);
                let second = self.mean_of(&|x| (f64::from(x) - centre).powi(2), is_of_samples);
                format!(
                    "{} and {}",
                    significant(centre + first, 4),
                    significant((second - first * first).at_least(0.0).sqrt(), 4)
                )
            };
            let told =
                format!("{samples} have mean and standard deviation {}, {of} has {}", moments(true), moments(false));
            return Ok(Some(told).filter(|told| !told.contains("NaN")));
        }
        let Some(axis) = self.axis()? else { return Ok(None) };
        let angle = |w: Point| axis::dot(w.into(), axis.direction).within(-1.0, 1.0).acos().to_degrees();
        let (found, expected) = (self.mean_of(&angle, true), self.mean_of(&angle, false));
        let told = || {
            format!(
                "{samples} have a mean angle of {found:.2}° with the axis {} of {of}, not {expected:.2}°",
                axis.name()
            )
        };
        Ok((found - expected).is_finite().then(told))
    }
}

/// The values of two densities with these integrals, by the share of the first.
fn mixture<'a>(both: [Vec<f64>; 2], integrals: [f64; 2]) -> ByAmount<'a> {
    Box::new(move |share: f64| {
        let [of_first, of_second] = [share / integrals[0], (1.0 - share) / integrals[1]];
        Ok(both[0].iter().zip(&both[1]).map(|(a, b)| of_first * a + of_second * b).collect())
    })
}

/// A pdf of numbers that is wider or narrower about its mean.
fn spread_about<'a>(mean: f64) -> Mistake<'a> {
    let name = format!("with distances from its mean, {}, {{}} times as large", significant(mean, 4));
    Mistake::scaled(&name, move |scale, x| ((mean + (f64::from(x) - mean) / scale).into(), 1.0))
}

/// A number with its standard error, to one digit of that.
fn with_error(value: f64, error: f64) -> String {
    let digits = (-error.log10()).ceil().within(0.0, 9.0) as usize;
    format!("{value:.digits$} ± {error:.digits$}")
}

/// A number with that many significant digits.
fn significant(x: f64, digits: i32) -> String {
    let after = f64::from(digits - 1) - x.abs().at_least(f64::MIN_POSITIVE).log10().floor();
    let text = format!("{x:.*}", after.within(0.0, 9.0) as usize);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Points that fill a cell evenly: each axis has a different one of as many midpoints.
fn points_of(cell: &Cell, [count, step]: [usize; 2]) -> impl Iterator<Item = [f64; 2]> {
    let Cell { x, y } = *cell;
    let at = move |[from, to]: [f64; 2], i: usize| from + (to - from) * (i as f64 + 0.5) / count as f64;
    (0..count).map(move |i| [at(x, i), at(y, step * i % count)])
}
