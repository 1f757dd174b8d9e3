//! Usual mistakes of samplers and pdfs, recognised by the density that they lead to.
//!
//! Where samples do not follow the pdf, each mistake is tried: it is named if the counts follow its density as well as chance
//! lets them. Where samples carry another pdf than the density has, the two are compared value by value in the same way.

use crate::domain::{Domain, Point};
use crate::error::{Error, Result};
use crate::extremes::Extremes;
use crate::grid::Cell;
use crate::outcome::Counts;
use crate::power::chi_square;
use crate::sampler::Density;
use std::f64::consts::PI;

/// Values of a density, in batches that may fail.
type Asked<'a> = Box<dyn Fn(&[Point]) -> Result<Vec<f64>> + 'a>;

/// Where a motion by some amount takes a point.
type Motion<'a> = dyn Fn(f64, Point) -> Point + 'a;

/// What samples follow because of a mistake, up to a factor.
pub enum Follows<'a> {
    /// This density, whatever the pdf is.
    Density(Box<dyn Fn(Point) -> f64 + 'a>),
    /// The pdf times this factor.
    Times(Box<dyn Fn(Point) -> f64 + 'a>),
    /// The pdf at this point.
    At(Box<dyn Fn(Point) -> Point + 'a>),
    /// This power of the pdf's value.
    Power(f64),
    /// The pdf at the place where a motion by some amount, of these limits, takes the point.
    Moved {
        /// The least and the largest amount.
        limits: [f64; 2],
        /// The place.
        place: Box<Motion<'a>>,
    },
    /// The values that are asked for at these points.
    Asked(Asked<'a>),
}

/// A usual mistake.
pub struct Mistake<'a> {
    /// The density's name, or what is done to the pdf: "times cos θ"; `{}` stands for the amount of a motion.
    pub name: String,
    /// The density that samples follow.
    pub follows: Follows<'a>,
    /// Whether it is not tried on counts: other errors make the same of a factor that has two values.
    pub needs_exact_numbers: bool,
}

impl<'a> Mistake<'a> {
    /// Samples of this density.
    pub fn density(name: &str, density: impl Fn(Point) -> f64 + 'a) -> Self {
        Self { name: name.to_owned(), follows: Follows::Density(Box::new(density)), needs_exact_numbers: false }
    }

    /// A factor that the samples have and the pdf has not, and the reverse.
    pub fn factor(name: &str, factor: impl Fn(Point) -> f64 + Copy + 'a) -> [Self; 2] {
        let times = Follows::Times(Box::new(factor));
        let divided = Follows::Times(Box::new(move |point| 1.0 / factor(point)));
        [
            Self { name: format!("times {name}"), follows: times, needs_exact_numbers: false },
            Self { name: format!("divided by {name}"), follows: divided, needs_exact_numbers: false },
        ]
    }

    /// A factor that is not tried on counts.
    pub fn exact_factor(name: &str, factor: impl Fn(Point) -> f64 + Copy + 'a) -> [Self; 2] {
        Self::factor(name, factor).map(|mistake| Self { needs_exact_numbers: true, ..mistake })
    }

    /// Samples that follow the pdf at another place.
    pub fn at(name: &str, place: impl Fn(Point) -> Point + 'a) -> Self {
        Self { name: name.to_owned(), follows: Follows::At(Box::new(place)), needs_exact_numbers: false }
    }

    /// Samples that follow what these values are in proportion to.
    pub fn asked(name: &str, values: impl Fn(&[Point]) -> Result<Vec<f64>> + 'a) -> Self {
        Self { name: name.to_owned(), follows: Follows::Asked(Box::new(values)), needs_exact_numbers: false }
    }

    /// Samples that follow the pdf at places that a motion by some amount leads to.
    pub fn moved(name: &str, limits: [f64; 2], place: impl Fn(f64, Point) -> Point + 'a) -> Self {
        Self {
            name: name.to_owned(),
            follows: Follows::Moved { limits, place: Box::new(place) },
            needs_exact_numbers: false,
        }
    }

    /// What is followed in place of `of`, such as "the pdf".
    fn told(&self, of: &str) -> String {
        match self.follows {
            Follows::Density(_) => self.name.clone(),
            _ => format!("{of} {}", self.name),
        }
    }

    /// Whether it needs an amount.
    fn is_family(&self) -> bool {
        matches!(self.follows, Follows::Moved { .. })
    }

    /// Whether it changes the pdf's values where they are.
    fn is_local(&self) -> bool {
        matches!(self.follows, Follows::Times(_) | Follows::Power(_))
    }

    /// Whether the pdf's values at the points themselves are enough.
    fn is_known(&self) -> bool {
        !matches!(self.follows, Follows::At(_) | Follows::Asked(_) | Follows::Moved { .. })
    }

    /// The densities at `points`, where the pdf has the values `pdfs`.
    fn values(&self, density: &dyn Density, points: &[Point], pdfs: &[f64]) -> Result<Vec<f64>> {
        Ok(match &self.follows {
            Follows::Density(of) => points.iter().map(|&point| of(point)).collect(),
            Follows::Times(factor) => points.iter().zip(pdfs).map(|(&point, pdf)| pdf * factor(point)).collect(),
            Follows::At(place) => asked(density, &points.iter().map(|&point| place(point)).collect::<Vec<_>>())?,
            Follows::Power(power) => pdfs.iter().map(|pdf| pdf.powf(*power)).collect(),
            // Nothing is known without an amount: see `fitted`.
            Follows::Moved { .. } => vec![f64::NAN; points.len()],
            Follows::Asked(values) => {
                let batches = points.chunks(BATCH).map(values).collect::<Result<Vec<_>>>();
                batches?.concat()
            }
        })
    }
}

/// Points that a density is asked for at a time, and most cells that are compared.
const BATCH: usize = 3600;
const MOST_CELLS: usize = 1 << 12;

/// The pdf at `points`, in batches that a program in another process can answer.
fn asked(density: &dyn Density, points: &[Point]) -> Result<Vec<f64>> {
    let mut values = Vec::with_capacity(points.len());
    points.chunks(BATCH).try_for_each(|batch| density.pdf(batch, &mut values))?;
    Ok(values)
}

/// All mistakes that are tried: those of any pdf, of the domain, of this density and of its table.
fn all<'a>(domain: &'a dyn Domain, density: &'a dyn Density) -> Vec<Mistake<'a>> {
    let mut all = vec![Mistake::density("a uniform density", |_| 1.0)];
    all.extend(domain.mistakes());
    all.extend(density.mistakes());
    all.extend(POWERS.map(|(power, name)| Mistake {
        name: format!("to the power of {name}"),
        follows: Follows::Power(power),
        needs_exact_numbers: false,
    }));
    // A set, or a table, that is shifted by one entry
    if let Some(n) = domain.outcomes() {
        for (by, towards) in [(1, "next"), (n.max(1) - 1, "previous")] {
            let name = format!("of the {towards} outcome");
            all.push(Mistake::at(&name, move |point| ((usize::from(point) + by) % n).into()));
        }
        return all;
    }
    let steps: [Vec<f64>; 2] = density.steps().unwrap_or_default();
    for (axis, lines) in steps.into_iter().enumerate().filter(|(_, lines)| !lines.is_empty()) {
        for (by, towards) in [(1, "next"), (lines.len(), "previous")] {
            let lines = lines.clone();
            let shifted = move |point: Point| {
                let Some(mut at) = domain.to_chart(point) else { return point };
                let entry = (lines.partition_point(|line| *line <= at[axis]) + by) % (lines.len() + 1);
                let end = |entry: usize| if entry == 0 { 0.0 } else { lines.get(entry - 1).copied().unwrap_or(1.0) };
                at[axis] = 0.5 * (end(entry) + end(entry + 1));
                domain.point_at(at)
            };
            all.push(Mistake::at(&format!("of the {towards} entry along {}", domain.axes()[axis]), shifted));
        }
    }
    all
}

/// Points of each cell at which densities are compared, along the two axes.
const POINTS: [usize; 2] = [8, 4];
/// The share of the noncentrality of the counts that a mistake may leave unexplained, of at most 1 per sample (an error of
/// 100 %): midpoints are not exact, and samples may have small errors besides.
const LEFT: f64 = 0.002;
/// The share of the pdf's excess that a mistake may leave, also where chance leaves more.
const MOST: f64 = 0.1;
/// Samples after which an excess within chance says that the shape is right.
const TOLD: u64 = 1 << 16;
/// The same of a shift or a turn, whose amounts can be had for many errors, and of a factor.
const MOST_FITTED: f64 = 0.02;
/// Standard deviations of the statistic that count as chance, and those from which there is something to explain.
const CHANCE: f64 = 2.5;
const CLEAR: f64 = 10.0;
/// The share of pairs that must have a ratio.
const MOST_PAIRS: f64 = 0.9;
/// Powers that exponents which are wrong by a simple factor make, and their names.
const POWERS: [(f64, &str); 6] =
    [(1.0 / 3.0, "1/3"), (0.5, "1/2"), (2.0 / 3.0, "2/3"), (1.5, "3/2"), (2.0, "2"), (3.0, "3")];
/// Steps and golden sections of the search for an amount, with the smaller part of a section.
const STEPS: usize = 36;
const SECTIONS: usize = 12;
const GOLDEN: f64 = 0.381_966_011_250_105;
/// The share of samples that must lie in cells of which a mistake says the pdf; and a moved pdf, which may fit a part by chance.
const HELD: f64 = 0.5;
const MOST_HELD: f64 = 0.9;
/// The logarithm of a factor that counts as 1.
const SCALE: f64 = 0.02;
/// Fewer degrees of freedom are explained by too many densities.
const FEWEST: usize = 5;

/// The mistake that explains the counts of the cells, if the density does not and one does: "[samples] follow cos θ/π, not
/// [the pdf]".
///
/// # Errors
/// [`Error::Cancelled`]. Where the density fails otherwise, at points that it was not made for, nothing is named.
pub fn of_counts(
    domain: &dyn Domain,
    density: &dyn Density,
    counts: &Counts,
    [samples, of]: [&str; 2],
    kinds: Kinds,
) -> Result<Option<String>> {
    let explained = Table::new(domain, density, counts).and_then(|table| table.explained([samples, of], kinds));
    unless_cancelled(explained)
}

/// Which mistakes are tried.
#[derive(Clone, Copy, PartialEq)]
pub enum Kinds {
    /// All.
    All,
    /// Those that change values where they are: of counts that are no numbers of independent samples.
    Local,
}

/// Whether counts say if they differ from the shape of what is expected: so clearly that a mistake can be named, or not at all.
pub fn is_clear(counts: &Counts) -> bool {
    let cells = counts.grid.len();
    let (observed, expected) = (&counts.observed[..cells], &counts.expected[..cells]);
    let shares = shares_of(expected);
    let is_told = observed.iter().sum::<u64>() >= TOLD;
    excess(observed, &shares)
        .is_none_or(|[excess, spread]| excess * MOST > CHANCE * spread || is_told && excess <= CHANCE * spread)
}

/// Whether nothing is expected: counts are compared with the smallest number in place of 0.
fn is_zero(expected: f64) -> bool {
    expected <= f64::MIN_POSITIVE
}

/// The shares that the density expects.
fn shares_of(expected: &[f64]) -> Vec<Option<f64>> {
    expected.iter().map(|&expected| Some(if is_zero(expected) { 0.0 } else { expected })).collect()
}

/// Statistic minus degrees of freedom of counts against shares, and the standard deviation of that. Cells without a share are
/// left out; the others must hold most samples.
fn excess(observed: &[u64], shares: &[Option<f64>]) -> Option<[f64; 2]> {
    let known: Vec<(u64, f64)> = observed.iter().zip(shares).filter_map(|(n, share)| Some((*n, (*share)?))).collect();
    let (observed, shares): (Vec<u64>, Vec<f64>) = known.into_iter().unzip();
    let (total, sum) = (observed.iter().sum::<u64>() as f64, shares.iter().sum::<f64>());
    let is_valid = shares.iter().all(|share| share.is_finite() && *share >= 0.0) && sum > 0.0;
    let expected: Vec<f64> = shares.iter().map(|share| (share / sum * total).at_least(f64::MIN_POSITIVE)).collect();
    let test = chi_square(&observed, &expected).filter(|test| is_valid && test.dof >= FEWEST)?;
    Some([test.statistic - test.dof as f64, (2.0 * test.dof as f64).sqrt()])
}

/// What was found; nothing at an error other than a cancellation.
fn unless_cancelled(found: Result<Option<String>>) -> Result<Option<String>> {
    match found {
        Err(Error::Cancelled) => Err(Error::Cancelled),
        found => Ok(found.unwrap_or(None)),
    }
}

/// What a mistake leaves unexplained of the statistic, the standard deviation of that by chance, and its rank among others of the
/// same shape.
struct Explained {
    left: f64,
    spread: f64,
    rank: usize,
    name: String,
}

/// The rank of factors that make the integral another one.
const OTHER_FACTOR: usize = 2;

/// The counts of the cells, with points of them.
struct Table<'a> {
    domain: &'a dyn Domain,
    density: &'a dyn Density,
    cells: Vec<Cell>,
    observed: &'a [u64],
    expected: &'a [f64],
    total: f64,
    /// As many of each cell as there are [`PER_CELL`].
    points: Vec<Point>,
    /// The pdf there.
    pdfs: Vec<f64>,
}

/// Points of each cell.
const PER_CELL: usize = POINTS[0] * POINTS[1];

impl<'a> Table<'a> {
    fn new(domain: &'a dyn Domain, density: &'a dyn Density, counts: &'a Counts) -> Result<Self> {
        let cells: Vec<Cell> = counts.grid.cells().collect();
        let (observed, expected) = (&counts.observed[..cells.len()], &counts.expected[..cells.len()]);
        let is_small = cells.len() <= MOST_CELLS;
        let parts = if domain.is_plane() { POINTS } else { [PER_CELL, 1] };
        let all = cells.iter().filter(|_| is_small).flat_map(|cell| midpoints(cell, parts));
        let points: Vec<Point> = all.map(|at| domain.point_at(at)).collect();
        let pdfs = if is_small { asked(density, &points)? } else { Vec::new() };
        let total = observed.iter().sum::<u64>() as f64;
        Ok(Self { domain, density, cells, observed, expected, total, points, pdfs })
    }

    fn excess(&self, shares: &[Option<f64>]) -> Option<[f64; 2]> {
        excess(self.observed, shares)
    }

    /// The shares of cells by the density's `values` at the points, NaN where it is not known. Integrals are sums over the
    /// midpoints; where values are the pdf's own, changed, they are in proportion to the pdf's known integrals.
    fn shares(&self, values: &[f64], is_local: bool) -> Vec<Option<f64>> {
        let share = |(i, cell): (usize, &Cell)| {
            let within = i * PER_CELL..(i + 1) * PER_CELL;
            let [of_pdf, sum] = [&self.pdfs, values].map(|values| values[within.clone()].iter().sum::<f64>());
            let share = match is_local {
                true if is_zero(self.expected[i]) => 0.0,
                true => self.expected[i] * sum / of_pdf,
                false => cell.area() * sum,
            };
            // Where no point meets the pdf, or one of them has none, the share is not known.
            let is_known = !(share.is_nan() || values[within].iter().any(|value| value.is_nan()));
            is_known.then_some(share)
        };
        self.cells.iter().enumerate().map(share).collect()
    }

    /// What shares leave unexplained, if that is as little as chance leaves, or little of `of_pdf`, the excess of the pdf.
    fn is_explained(&self, of_pdf: f64, [left, spread]: [f64; 2]) -> bool {
        let most = (CHANCE * spread).at_most(MOST * of_pdf).at_least(LEFT * of_pdf.at_most(self.total));
        left <= most
    }

    fn explanation(&self, mistake: &Mistake, of_pdf: f64, of: &str) -> Result<Option<Explained>> {
        let values = mistake.values(self.density, &self.points, &self.pdfs)?;
        let is_local = mistake.is_local();
        let shares = self.shares(&values, is_local);
        let sum = shares.iter().flatten().sum::<f64>();
        let keeps_integral = is_local && (self.total / sum).ln().abs() < SCALE;
        let found = self.excess(&shares).filter(|left| self.held(&shares) >= HELD && self.is_explained(of_pdf, *left));
        // Factors that make the integral right, then densities, then factors of another integral, then powers
        let rank = match mistake.follows {
            Follows::Times(_) if keeps_integral => 0,
            Follows::Times(_) => OTHER_FACTOR,
            Follows::Power(_) => OTHER_FACTOR + 1,
            _ => 1,
        };
        Ok(found.map(|[left, spread]| Explained { left, spread, rank, name: mistake.told(of) }))
    }

    /// The amount by which a family explains the counts, if one does.
    fn fitted(&self, family: &Mistake, of_pdf: f64, of: &str) -> Result<Option<String>> {
        let Follows::Moved { limits, place } = &family.follows else { return Ok(None) };
        let left_by = |amount: f64| -> Result<[f64; 2]> {
            let shares = self.shares(&self.pdf_at(|point| place(amount, point))?, false);
            let found = self.excess(&shares).filter(|_| self.held(&shares) >= MOST_HELD);
            Ok(found.unwrap_or([f64::INFINITY, 0.0]))
        };
        // The best of equal steps, then between its neighbours by golden sections
        let step = (limits[1] - limits[0]) / STEPS as f64;
        let steps = (0..=STEPS).map(|i| limits[0] + i as f64 * step);
        let all = steps.map(|amount| Ok((amount, left_by(amount)?[0]))).collect::<Result<Vec<(f64, f64)>>>()?;
        let best = all.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some(best) = best.filter(|(_, left)| left.is_finite()) else { return Ok(None) };
        let (mut low, mut high) = (best.0 - step, best.0 + step);
        let [mut first, mut second] = [low + GOLDEN * (high - low), high - GOLDEN * (high - low)];
        let [mut by_first, mut by_second] = [left_by(first)?[0], left_by(second)?[0]];
        for _ in 0..SECTIONS {
            if by_first < by_second {
                (high, second, by_second) = (second, first, by_first);
                first = low + GOLDEN * (high - low);
                by_first = left_by(first)?[0];
            } else {
                (low, first, by_first) = (first, second, by_second);
                second = high - GOLDEN * (high - low);
                by_second = left_by(second)?[0];
            }
        }
        let amount = 0.5 * (low + high);
        let left = left_by(amount)?;
        let text = format!("{amount:.3}").trim_end_matches('0').trim_end_matches('.').to_owned();
        // An amount can be had for many errors: it must explain more than what has none.
        let is_explained = left[0] <= (CHANCE * left[1]).at_most(MOST_FITTED * of_pdf);
        Ok(is_explained.then(|| family.told(of).replace("{}", &text)))
    }

    /// The pdf at places of the points; NaN where they are outside of the domain.
    fn pdf_at(&self, place: impl Fn(Point) -> Point) -> Result<Vec<f64>> {
        let places: Vec<Point> = self.points.iter().map(|&point| place(point)).collect();
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

    fn explained(&self, [samples, of]: [&str; 2], kinds: Kinds) -> Result<Option<String>> {
        let all_of = shares_of(self.expected);
        let Some([of_pdf, spread]) = self.excess(&all_of).filter(|_| !self.points.is_empty()) else { return Ok(None) };
        if of_pdf <= CHANCE * spread {
            // What chance hides of the shape must be little beside the factor.
            let ratio = self.expected.iter().sum::<f64>() / self.total;
            let is_factor = ratio.is_finite() && MOST_FITTED * self.total * ratio.ln().powi(2) > CHANCE * spread;
            let ratio = if ratio < 0.1 { format!("{ratio:.1e}") } else { format!("{ratio:.2}") };
            let told = || format!("{samples} follow {of} up to a factor: {of} is {ratio} times as large");
            return Ok(is_factor.then(told));
        }
        if of_pdf.is_nan() || of_pdf < CLEAR * spread {
            return Ok(None);
        }
        // Mistakes that need no other values of the pdf come first, and those with an amount last.
        let is_tried = |mistake: &Mistake| !mistake.needs_exact_numbers && (kinds == Kinds::All || mistake.is_local());
        let (families, others): (Vec<Mistake>, Vec<Mistake>) =
            all(self.domain, self.density).into_iter().filter(is_tried).partition(Mistake::is_family);
        let (known, other): (Vec<Mistake>, Vec<Mistake>) = others.into_iter().partition(Mistake::is_known);
        let follow = |name: String| Ok(Some(format!("{samples} follow {name}, not {of}")));
        for (group, is_place) in [(known, false), (other, true)] {
            let found =
                group.iter().map(|mistake| self.explanation(mistake, of_pdf, of)).collect::<Result<Vec<_>>>()?;
            let mut found: Vec<Explained> = found.into_iter().flatten().collect();
            let best = found.iter().map(|explained| explained.left).fold(f64::INFINITY, f64::at_most);
            found.retain(|Explained { left, spread, .. }| *left <= best + CHANCE * spread);
            // Places that a symmetry makes equal are all named; of densities of one shape, the one of the first rank.
            if is_place && !found.is_empty() {
                return follow(found.into_iter().map(|explained| explained.name).collect::<Vec<_>>().join(" or "));
            }
            if let Some(first) = found.into_iter().min_by_key(|explained| explained.rank) {
                let proportional = if first.rank == OTHER_FACTOR { "a density in proportion to " } else { "" };
                return follow(format!("{proportional}{}", first.name));
            }
        }
        for family in &families {
            if let Some(name) = self.fitted(family, of_pdf, of)? {
                return follow(name);
            }
        }
        Ok(None)
    }
}

/// The midpoints of the parts of a cell.
fn midpoints(cell: &Cell, parts: [usize; 2]) -> impl Iterator<Item = [f64; 2]> {
    let (Cell { x, y }, [columns, rows]) = (*cell, parts);
    let at = |[from, to]: [f64; 2], i: usize, n: usize| from + (to - from) * (i as f64 + 0.5) / n as f64;
    (0..columns * rows).map(move |i| [at(x, i / rows, columns), at(y, i % rows, rows)])
}

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
) -> Result<Option<String>> {
    let explained = explained_pairs(domain, density, pairs, of);
    unless_cancelled(explained.map(|name| name.map(|name| format!("{found} {name}"))))
}

fn explained_pairs(domain: &dyn Domain, density: &dyn Density, pairs: &[Pair], of: &str) -> Result<Option<String>> {
    // Where both are 0, they have no ratio.
    let pairs = pairs.iter().copied().filter(|(_, both)| *both != [0.0; 2]);
    let (points, values): (Vec<Point>, Vec<[f64; 2]>) = pairs.unzip();
    let known: Vec<f64> = values.iter().map(|[_, known]| *known).collect();
    let factor_of = |values_of: &[f64]| {
        let ratios = values.iter().zip(values_of).map(|([found, _], value)| found / value);
        let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect();
        let enough = ratios.len() >= FEWEST_PAIRS && ratios.len() as f64 >= MOST_PAIRS * values.len() as f64;
        common_factor(&ratios).filter(|_| enough)
    };
    let is_one = |factor: f64| (factor - 1.0).abs() <= EQUAL;
    if let Some(factor) = factor_of(&known) {
        return Ok((!is_one(factor)).then(|| format!("is {} times {of}", number(factor))));
    }
    // Those that explain the numbers themselves, all of them where a symmetry or an angle makes several equal; else their shape.
    let (mut exact, mut shape) = (Vec::new(), None);
    let is_positive = known.iter().filter(|known| **known > 0.0).count() as f64 >= MOST_PAIRS * known.len() as f64;
    for mistake in all(domain, density).into_iter().filter(|mistake| !mistake.is_family()) {
        let Some(factor) = factor_of(&mistake.values(density, &points, &known)?) else { continue };
        let name = mistake.told(of);
        match mistake.follows {
            Follows::Density(_) if is_positive => shape = shape.or(Some(format!("has the shape of {name}"))),
            Follows::Density(_) => {}
            _ if is_one(factor) => exact.push(name),
            _ => shape = shape.or(Some(format!("is {} times {name}", number(factor)))),
        }
    }
    if !exact.is_empty() {
        return Ok(Some(format!("is {}", exact.join(" or "))));
    }
    // The power by the largest and the least value, if it holds for all
    let ln: Vec<[f64; 2]> =
        values.iter().map(|both| both.map(f64::ln)).filter(|both| both[0].is_finite() && both[1].is_finite()).collect();
    let end = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    if let (None, Some(least), Some(most)) = (&shape, ln.iter().min_by(end), ln.iter().max_by(end)) {
        let power = (most[0] - least[0]) / (most[1] - least[1]);
        let powers: Vec<f64> = known.iter().map(|known| known.powf(power)).collect();
        if let Some(factor) = factor_of(&powers).filter(|_| power.is_finite() && power.abs() > EQUAL) {
            let factor = if is_one(factor) { String::new() } else { format!("{} times ", number(factor)) };
            return Ok(Some(format!("is {factor}{of} to the power of {}", number(power))));
        }
    }
    // The pdf of another outcome
    if let Some(n) = domain.outcomes().filter(|n| *n <= MOST_CELLS) {
        let mut all = asked(density, &(0..n).map(Point::from).collect::<Vec<_>>())?;
        all.sort_unstable_by(f64::total_cmp);
        let near = |found: f64| {
            let i = all.partition_point(|pdf| *pdf < found * (1.0 - ROUNDED));
            all.get(i).is_some_and(|pdf| *pdf <= found * (1.0 + ROUNDED))
        };
        if values.len() >= FEWEST_PAIRS && values.iter().all(|[found, _]| near(*found)) {
            return Ok(Some(format!("is {of} of other outcomes")));
        }
    }
    Ok(shape)
}

/// The least of `ratios`, if all are equal to it.
pub fn common_factor(ratios: &[f64]) -> Option<f64> {
    let [least, most] = [f64::at_most, f64::at_least].map(|of| ratios.iter().copied().reduce(of).unwrap_or(f64::NAN));
    (most <= least * (1.0 + EQUAL)).then_some(least)
}

/// A number with its meaning, if it is one of those that are forgotten: "6.28319 = 2π".
pub fn number(value: f64) -> String {
    let text = format!("{value:.6}").trim_end_matches('0').trim_end_matches('.').to_owned();
    let text = if (1e-3..1e5).contains(&value.abs()) { text } else { format!("{value:.4e}") };
    constant(value, EQUAL)
        .map_or(text.clone(), |name| if name == text { name.to_owned() } else { format!("{text} = {name}") })
}

/// The name of the constant that `value` is, up to a relative error of `error`.
pub fn constant(value: f64, error: f64) -> Option<&'static str> {
    const ALL: [(f64, &str); 17] = [
        (PI, "π"),
        (2.0 * PI, "2π"),
        (4.0 * PI, "4π"),
        (0.5 * PI, "π/2"),
        (0.25 * PI, "π/4"),
        (1.0 / PI, "1/π"),
        (0.5 / PI, "1/(2π)"),
        (0.25 / PI, "1/(4π)"),
        (2.0 / PI, "2/π"),
        (4.0 / PI, "4/π"),
        (PI * PI, "π²"),
        (2.0 * PI * PI, "2π²"),
        (16.0 * PI * PI, "(4π)²"),
        (1.0 / (PI * PI), "1/π²"),
        (0.5 / (PI * PI), "1/(2π²)"),
        (0.5, "1/2"),
        (0.25, "1/4"),
    ];
    ALL.into_iter().find(|(known, _)| (value / known - 1.0).abs() <= error).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{beckmann, beckmann_pdf, normalize, uniform_hemisphere};
    use crate::{Directions, Discrete, Line, Pole, Protocol, Sample, Sampler, Square, Verdict, sampler, validate};
    use std::f64::consts::TAU;

    /// What is said of a rejection.
    fn told(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> String {
        let outcome = validate(domain, sampler, density, &Protocol::default()).unwrap();
        assert_eq!(outcome.verdict, Verdict::Reject, "{outcome}");
        format!("{outcome}")
    }

    fn direction(z: f64, u: f64) -> [f64; 3] {
        let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), TAU * u);
        [r * phi.cos(), r * phi.sin(), z]
    }

    #[test]
    fn usual_mistakes_of_directions_are_named() {
        let half = Directions::hemisphere(Pole::Z);
        let cosine = |w: [f64; 3]| w[2] / PI;
        let uniform = |_: [f64; 3]| 1.0 / TAU;
        type Draw = fn(&[f64]) -> [f64; 3];
        let draws: [(Draw, bool, &str); 7] = [
            (|u| direction(u[0], u[1]), true, "samples follow a uniform density, not the pdf"),
            (|u| direction((1.0 - u[0]).sqrt(), u[1]), false, "samples follow cos θ/π, not the pdf"),
            (|u| direction((0.5 * PI * u[0]).cos(), u[1]), false, "without the factor sin θ"),
            (|u| direction((1.0 - u[0] * u[0]).sqrt(), u[1]), true, "the radius of a disk is u, not √u"),
            (
                |u| direction((1.0 - u[0]).cbrt(), u[1]),
                true,
                "samples follow a density in proportion to the pdf times cos θ, not",
            ),
            // The product of two cosines and a triangle in cos θ have no name.
            (|u| direction((1.0 - u[0]).powf(0.2), u[1]), false, ""),
            (|u| direction(1.0 - (1.0 - u[0]).sqrt(), u[1]), false, ""),
        ];
        for (draw, is_cosine, name) in draws {
            let drawn = sampler(2, move |u: &[f64]| Some(Sample::new(draw(u))));
            let pdf = crate::density(move |w| if is_cosine { cosine(w) } else { uniform(w) });
            let text = told(&half, &drawn, &pdf);
            assert!(text.contains(name) && text.contains("samples follow") != name.is_empty(), "{name}: {text}");
        }
        // A lobe around another axis, seen in a mirror
        let lobe = |u: &[f64]| {
            let [x, y, z] = beckmann(0.3, u);
            normalize([x + 0.7 * z, y + 0.2 * z, z - 0.7 * x - 0.2 * y])
        };
        let sphere = Directions::sphere(Pole::Z);
        let count = |u: &[f64]| Some(Sample::new(lobe(u).map(|x| -x)));
        let around = normalize([0.7, 0.2, 1.0]);
        let vmf = |w: [f64; 3]| (8.0 * ((0..3).map(|i| w[i] * around[i]).sum::<f64>() - 1.0)).exp() * 8.0 / TAU;
        let opposite = told(&sphere, &sampler(2, count), &crate::density(vmf));
        assert!(
            !opposite.contains("samples follow"),
            "another lobe at the opposite side is no mistake of the list: {opposite}"
        );
    }

    #[test]
    fn a_density_of_another_place_is_named() {
        let sphere = Directions::sphere(Pole::Z);
        let pdf = crate::density(|[x, y, z]: [f64; 3]| (1.0 + 0.5 * x + 0.3 * y + 0.4 * z) / (4.0 * PI));
        type Change = fn([f64; 3]) -> [f64; 3];
        let changes: [(Change, &str); 3] = [
            (|w| w.map(|x| -x), "the pdf at the opposite direction"),
            (|[x, y, z]| [y, x, z], "the pdf with x and y exchanged"),
            (|[x, y, z]| [x, y, -z], "the pdf at (x, y, -z)"),
        ];
        for (change, name) in changes {
            // By rejection, from eight candidates
            let draw = move |u: &[f64]| {
                let candidates = u.chunks_exact(3).map(|u| (direction(2.0 * u[0] - 1.0, u[1]), u[2]));
                let mut accepted = candidates.filter(|([x, y, z], v)| 2.2 * v < 1.0 + 0.5 * x + 0.3 * y + 0.4 * z);
                accepted.next().map(|(w, _)| Sample::new(change(w)))
            };
            let text = told(&sphere, &sampler(60, draw), &pdf);
            assert!(text.contains(name), "{name}: {text}");
        }
    }

    #[test]
    fn tables_lines_and_sets_are_named() {
        let line = sampler(1, |u: &[f64]| Some(Sample::new(u[0].powf(0.2))));
        let reversed = told(&Line::UNIT, &line, &crate::density(|x: f64| 5.0 * (1.0 - x).powi(4)));
        assert!(reversed.contains("samples follow the pdf with both ends exchanged"), "{reversed}");
        let square = sampler(2, |u: &[f64]| Some(Sample::new([u[0].sqrt(), u[1]])));
        let exchanged = told(&Square, &square, &crate::density(|[_, y]: [f64; 2]| 2.0 * y));
        assert!(exchanged.contains("the pdf with x and y exchanged"), "{exchanged}");
        let weights: Vec<f64> = (0..16).map(|i| f64::from(1 + (i * i * i + 3 * i) % 11)).collect();
        let total: f64 = weights.iter().sum();
        let ends: Vec<f64> = weights
            .iter()
            .scan(0.0, |sum, w| {
                *sum += w / total;
                Some(*sum)
            })
            .collect();
        let drawn = sampler(1, |u: &[f64]| Some(Sample::new((ends.partition_point(|end| *end <= u[0]) + 1) % 16)));
        let shifted = told(&Discrete { outcomes: 16 }, &drawn, &crate::density(|i: usize| weights[i] / total));
        assert!(shifted.contains("samples follow the pdf of the previous outcome"), "{shifted}");
    }

    #[test]
    fn integrals_and_carried_pdfs_say_by_what_they_are_wrong() {
        let half = Directions::hemisphere(Pole::Z);
        let uniform = sampler(2, |u: &[f64]| Some(Sample::new(uniform_hemisphere(u))));
        let text = told(&half, &uniform, &crate::density(|_: [f64; 3]| 1.0 / PI));
        assert!(
            text.contains(
                "samples follow the pdf up to a factor: the pdf is 2.00 times as large: the pdf integrates to 2.0"
            ),
            "{text}"
        );
        let text = told(&half, &uniform, &crate::density(|_: [f64; 3]| 0.5));
        assert!(text.contains(" = π, not to 1"), "{text}");
        let pdf = |w: [f64; 3]| beckmann_pdf(0.5, w);
        type Pdf = fn([f64; 3]) -> f64;
        let changes: [(Pdf, &str); 4] = [
            (|w| beckmann_pdf(0.5, w) * PI, "what samples carry is 3.141593 = π times the pdf"),
            (|w| beckmann_pdf(0.5, w) / w[2], "what samples carry is the pdf divided by cos θ"),
            (|w| 2.0 * w[2] / PI, "what samples carry has the shape of cos θ/π"),
            (|w| beckmann_pdf(0.49, w), ""),
        ];
        for (carried, name) in changes {
            let drawn = sampler(2, move |u: &[f64]| {
                let w = beckmann(0.5, u);
                Some(Sample::with_pdf(w, carried(w)))
            });
            let text = told(&half, &drawn, &crate::density(pdf));
            assert!(text.contains(name) && text.contains("the largest difference"), "{name}: {text}");
            assert_eq!(text.contains("what samples carry"), !name.is_empty(), "{text}");
        }
    }

    #[test]
    fn the_books_page_has_every_mistake() {
        // A package has no book
        let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/mistakes.md");
        let Ok(page) = std::fs::read_to_string(page) else { return };
        let table = crate::density(|_: [f64; 2]| 1.0).with_steps([vec![0.5], vec![]]);
        let spheres = [Pole::Z, Pole::Y].map(|pole| [Directions::sphere(pole), Directions::hemisphere(pole)]);
        let mut domains: Vec<&dyn Domain> = vec![&Square, &Line::UNIT, &Discrete { outcomes: 6 }];
        domains.extend(spheres.as_flattened().iter().map(|directions| directions as &dyn Domain));
        for mistake in domains.into_iter().flat_map(|domain| all(domain, &table)) {
            let name = mistake.name.split(" along ").next().unwrap().split(" {}").next().unwrap();
            let name = if name.starts_with("a density") { name.split(" (").next().unwrap() } else { name };
            assert!(page.contains(&format!("*{name}")) || page.contains(&format!("*the pdf {name}")), "{name}");
        }
    }

    #[test]
    fn numbers_have_names() {
        assert_eq!(number(2.0), "2");
        assert_eq!(number(TAU), "6.283185 = 2π");
        assert_eq!(number(1.5e-7), "1.5000e-7");
    }
}
