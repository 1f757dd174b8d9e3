//! Usual mistakes of samplers and pdfs, recognised by the density that they lead to.
//!
//! Where samples do not follow the pdf, each mistake is tried: it is named if the counts follow its density as well as chance
//! lets them. Where samples carry another pdf than the density has, the two are compared value by value in the same way.

mod axis;
mod centre;
mod counts;
pub mod curve;
pub mod map;
mod marginals;
mod pairs;

pub use counts::{Kinds, SAMPLES_TO_NAME, facts, is_clear, is_open, of_counts, of_others};
pub use pairs::{EQUAL, FEWEST_PAIRS, Pair, common_factor, of_one_variable, of_pairs, of_power, of_samples, of_side};

use crate::domain::{Domain, Point};
use crate::error::{Error, Result};
use crate::sampler::Density;
use std::f64::consts::PI;
use std::ops::Range;
use std::rc::Rc;

/// Values of a density, in batches that may fail.
type Asked<'a> = Box<dyn Fn(&[Point]) -> Result<Vec<f64>> + 'a>;

/// Values of the two parts of a density.
type Parts<'a> = Box<dyn Fn(&[Point]) -> Result<[Vec<f64>; 2]> + 'a>;

/// Where a motion by some amount takes a point, and the factor of densities there.
type Motion<'a> = dyn Fn(f64, Point) -> (Point, f64) + 'a;

/// What samples follow because of a mistake, up to a factor.
pub enum Follows<'a> {
    /// This density, whatever the pdf is.
    Density(Box<dyn Fn(Point) -> f64 + 'a>),
    /// This density where the pdf is positive.
    Within(Box<dyn Fn(Point) -> f64 + 'a>),
    /// The pdf times this factor.
    Times(Box<dyn Fn(Point) -> f64 + 'a>),
    /// The pdf at this point.
    At(Box<dyn Fn(Point) -> Point + 'a>),
    /// The pdf, times some factor in a part of the domain.
    TimesIn(Box<dyn Fn(Point) -> bool + 'a>),
    /// A power of the pdf's value, one of those that are usual.
    Power,
    /// The pdf, times a factor, at the place where a motion by some amount, of these limits, takes the point.
    Moved {
        /// The least and the largest amount.
        limits: [f64; 2],
        /// The amount that changes nothing.
        rest: f64,
        /// The place and the factor.
        place: Box<Motion<'a>>,
    },
    /// The first of two parts with some share, and the second with the rest.
    Mixed(Parts<'a>),
    /// This density with some share, and the pdf with the rest.
    Added(Box<dyn Fn(Point) -> f64 + 'a>),
    /// The values that are asked for at these points.
    Asked(Asked<'a>),
}

/// A usual mistake.
pub struct Mistake<'a> {
    /// The density's name, or what is done to the pdf: "times cos θ"; `{}` stands for the amount of a motion, or the share of a part.
    pub name: String,
    /// The density that samples follow.
    pub follows: Follows<'a>,
    /// Whether it is not tried on counts: other errors make the same of a factor that has two values.
    pub needs_exact_numbers: bool,
}

impl<'a> Mistake<'a> {
    fn new(name: &str, follows: Follows<'a>) -> Self {
        Self { name: name.to_owned(), follows, needs_exact_numbers: false }
    }

    /// Samples of this density.
    pub fn density(name: &str, density: impl Fn(Point) -> f64 + 'a) -> Self {
        Self::new(name, Follows::Density(Box::new(density)))
    }

    /// Samples of this density where the pdf is positive.
    pub fn within(name: &str, density: impl Fn(Point) -> f64 + 'a) -> Self {
        Self::new(name, Follows::Within(Box::new(density)))
    }

    /// A factor that the samples have and the pdf has not, and the reverse.
    pub fn factor(name: &str, factor: impl Fn(Point) -> f64 + 'a) -> [Self; 2] {
        let factor = Rc::new(factor);
        let times = factor.clone();
        [
            Self::new(&format!("times {name}"), Follows::Times(Box::new(move |point| times(point)))),
            Self::new(&format!("divided by {name}"), Follows::Times(Box::new(move |point| 1.0 / factor(point)))),
        ]
    }

    /// A factor that is not tried on counts.
    pub fn exact_factor(name: &str, factor: impl Fn(Point) -> f64 + 'a) -> [Self; 2] {
        Self::factor(name, factor).map(|mistake| Self { needs_exact_numbers: true, ..mistake })
    }

    /// Samples that follow the pdf at another place.
    pub fn at(name: &str, place: impl Fn(Point) -> Point + 'a) -> Self {
        Self::new(name, Follows::At(Box::new(place)))
    }

    /// Samples that follow what these values are in proportion to.
    pub fn asked(name: &str, values: impl Fn(&[Point]) -> Result<Vec<f64>> + 'a) -> Self {
        Self::new(name, Follows::Asked(Box::new(values)))
    }

    /// Samples that follow the pdf at places that a motion by some amount leads to.
    pub fn moved(name: &str, limits: [f64; 2], place: impl Fn(f64, Point) -> Point + 'a) -> Self {
        let place = Box::new(move |amount, point| (place(amount, point), 1.0));
        Self::new(name, Follows::Moved { limits, rest: 0.0, place })
    }

    /// Samples whose distances from somewhere are too large by a factor: the pdf at a nearer place, times a factor.
    pub fn scaled(name: &str, place: impl Fn(f64, Point) -> (Point, f64) + 'a) -> Self {
        Self::new(name, Follows::Moved { limits: SCALES, rest: 1.0, place: Box::new(place) })
    }

    /// A factor of any size in a part of the domain, such as the side of refracted light.
    pub fn factor_in(name: &str, is_inside: impl Fn(Point) -> bool + 'a) -> Self {
        Self::new(&format!("times {{}} {name}"), Follows::TimesIn(Box::new(is_inside)))
    }

    /// Samples of two parts with other shares.
    pub fn mixed(name: &str, parts: impl Fn(&[Point]) -> Result<[Vec<f64>; 2]> + 'a) -> Self {
        Self::new(name, Follows::Mixed(Box::new(parts)))
    }

    /// Samples of the pdf, and some of another density.
    pub fn added(name: &str, density: impl Fn(Point) -> f64 + 'a) -> Self {
        let name = format!("mixed with {name}, whose share is {{}}");
        Self::new(&name, Follows::Added(Box::new(density)))
    }

    /// What is followed in place of `of`, such as "the pdf".
    fn told(&self, of: &str) -> String {
        match self.follows {
            Follows::Density(_) | Follows::Within(_) => self.name.clone(),
            _ => format!("{of} {}", self.name),
        }
    }

    /// Whether it needs an amount.
    fn is_family(&self) -> bool {
        use Follows::{Added, Mixed, Moved, Power, TimesIn};
        matches!(self.follows, Moved { .. } | Mixed(_) | Added(_) | TimesIn(_) | Power)
    }

    /// Whether it changes the pdf's values where they are.
    fn is_local(&self) -> bool {
        matches!(self.follows, Follows::Times(_) | Follows::TimesIn(_) | Follows::Power)
    }

    /// Whether the pdf's values at the points themselves are enough.
    fn is_known(&self) -> bool {
        !matches!(self.follows, Follows::At(_) | Follows::Asked(_)) && !self.is_family()
    }

    /// The densities at `points`, where the pdf has the values `pdfs`.
    fn values(&self, density: &dyn Density, points: &[Point], pdfs: &[f64]) -> Result<Vec<f64>> {
        let both = points.iter().zip(pdfs);
        Ok(match &self.follows {
            Follows::Density(of) => points.iter().map(|&point| of(point)).collect(),
            Follows::Within(of) => both.map(|(&point, pdf)| if *pdf > 0.0 { of(point) } else { 0.0 }).collect(),
            Follows::Times(factor) => both.map(|(&point, pdf)| pdf * factor(point)).collect(),
            Follows::At(place) => asked(density, &points.iter().map(|&point| place(point)).collect::<Vec<_>>())?,
            // Nothing is known without an amount: see `fitted`.
            Follows::Moved { .. } | Follows::Mixed(_) | Follows::Added(_) | Follows::TimesIn(_) | Follows::Power => {
                vec![f64::NAN; points.len()]
            }
            Follows::Asked(values) => {
                let batches = points.chunks(BATCH).map(values).collect::<Result<Vec<_>>>();
                batches?.concat()
            }
        })
    }
}

/// What a function is, by pairs of the variable, ascending, and the logarithm of the function.
type Hint = fn(&[[f64; 2]]) -> String;

/// A quantity of points, whose powers pdfs and values of functions lack, or have besides.
pub struct Variable<'a> {
    /// As factors are named: "cos θ".
    pub name: &'static str,
    /// The quantity.
    pub at: Box<dyn Fn(Point) -> f64 + 'a>,
    /// What a factor is that depends on nothing else, ", as a Fresnel term is", by values and logarithms of the factor; `None` if it is not
    /// looked for.
    pub of: Option<Hint>,
}

impl<'a> Variable<'a> {
    /// A quantity of this name.
    pub fn new(name: &'static str, at: impl Fn(Point) -> f64 + 'a) -> Self {
        Self { name, at: Box::new(at), of: None }
    }

    /// A quantity on which a factor may depend alone.
    #[must_use]
    pub fn of(self, what: Hint) -> Self {
        Self { of: Some(what), ..self }
    }
}

/// The variables of a density and of its domain.
fn variables<'a>(domain: &'a dyn Domain, density: &'a dyn Density) -> Vec<Variable<'a>> {
    density.variables().into_iter().chain(domain.variables()).collect()
}

/// Factors by which distances may be too large.
const SCALES: [f64; 2] = [0.1, 10.0];

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
    let mut all = vec![
        Mistake::density("a uniform density", |_| 1.0),
        Mistake::within("a uniform density where the pdf is positive", |_| 1.0),
    ];
    if domain.measure().is_finite() {
        all.push(Mistake::added("a uniform density", |_| 1.0));
    }
    all.extend(domain.mistakes());
    all.extend(variables(domain, density).into_iter().flat_map(|variable| Mistake::factor(variable.name, variable.at)));
    all.extend(density.mistakes());
    all.push(Mistake::new("to the power of {}", Follows::Power));
    // A set, or a table, that is shifted by one entry
    if let Some(n) = domain.outcomes() {
        all.extend(of_sets(density, n));
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

/// The outcomes of n that end at one of them.
type EndAt = fn(usize, usize) -> Range<usize>;

/// Indices of a finite set that are off by one, around its ends or kept within them; and sums for single outcomes.
fn of_sets(density: &dyn Density, n: usize) -> Vec<Mistake<'_>> {
    let mut all = Vec::new();
    for (by, towards) in [(1, "next"), (n.max(1) - 1, "previous")] {
        let name = format!("of the {towards} outcome");
        all.push(Mistake::at(&name, move |point| ((usize::from(point) + by) % n).into()));
    }
    let kept: [(&str, EndAt); 3] = [
        ("with indices that are one too low, kept at 0", |i, n| if i == 0 { 0..2 } else { i + 1..n.min(i + 2) }),
        ("with indices that are one too high, kept at the last", |i, n| match i + 1 == n {
            true => n - 2..n,
            false => i.saturating_sub(1)..i,
        }),
        ("summed up to each outcome", |i, _| 0..i + 1),
    ];
    let sums = |(name, end_at): (&str, EndAt)| {
        Mistake::asked(name, move |points| {
            let pdf = asked(density, &(0..n).map(Point::from).collect::<Vec<_>>())?;
            Ok(points.iter().map(|&point| pdf[end_at(usize::from(point), n)].iter().sum()).collect())
        })
    };
    all.extend(kept.into_iter().filter(|_| (2..=MOST_CELLS).contains(&n)).map(sums));
    all
}

/// What was found; nothing at an error other than a cancellation.
pub fn unless_cancelled<T>(found: Result<Option<T>>) -> Result<Option<T>> {
    match found {
        Err(Error::Cancelled) => Err(Error::Cancelled),
        found => Ok(found.unwrap_or(None)),
    }
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
            // Exactly by the derivatives of the map; a triangle in cos θ has no name.
            (|u| direction((1.0 - u[0]).powf(0.2), u[1]), false, "samples follow 5 times the pdf times (cos θ)^4, not"),
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
    fn names_hold_within_cells_and_whatever_the_seed() {
        let of_seeds = |domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density| -> Vec<String> {
            let of = |seed| validate(domain, sampler, density, &Protocol { seed, ..Protocol::default() }).unwrap();
            (1..=16).map(|seed| of(seed).to_string()).collect()
        };
        // Half diffuse, half a lobe of half vectors, whose pdf lacks 1/(4 ωo · h): by the cells of the sphere as dense at the pole as cos θ/sin θ
        let draw = |u: &[f64]| {
            let cos = if u[0] < 0.5 { (1.0 - u[1]).sqrt() } else { 2.0 * (1.0 - u[1]).powf(2.0 / 31.0) - 1.0 };
            Some(Sample::new(direction(cos, u[2]))).filter(|_| cos > 0.0)
        };
        let pdf = |w: [f64; 3]| {
            let of_half = 31.0 / TAU * (0.5 * (1.0 + w[2])).sqrt().powi(30);
            if w[2] > 0.0 { 0.5 * w[2] / PI + 0.5 * of_half } else { 0.0 }
        };
        let density = crate::density(pdf).with_mass(crate::Mass::AtMostOne);
        for text in of_seeds(&Directions::sphere(Pole::Z), &sampler(3, draw), &density) {
            assert!(!text.contains("cos θ/sin θ"), "{text}");
        }
        // The pdf times sin θ, whose integral is wrong, too
        let lobe = sampler(2, |u: &[f64]| Some(Sample::new(direction(u[0].powf(1.0 / 21.0), u[1]))));
        let pdf = crate::density(|w: [f64; 3]| 21.0 / TAU * w[2].powi(20) * (1.0 - w[2] * w[2]).sqrt());
        for text in of_seeds(&Directions::hemisphere(Pole::Z), &lobe, &pdf) {
            assert!(text.contains("the pdf divided by sin θ"), "{text}");
        }
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
        // Three numbers that are not exponential
        let normalized = sampler(3, |u: &[f64]| {
            let sum: f64 = u.iter().sum();
            Some(Sample::new([u[0] / sum, u[1] / sum]))
        });
        let triangle = told(&crate::Barycentric, &normalized, &crate::density(|_: [f64; 2]| 2.0));
        assert!(triangle.contains("samples follow a density in proportion to 1/max(b0, b1, b2)³"), "{triangle}");
        // Few outcomes, and a factor that is the square of a rate
        let few = [0.05, 0.3, 0.1, 0.25, 0.2, 0.1];
        let cdf: Vec<f64> = few
            .iter()
            .scan(0.0, |sum, w| {
                *sum += w;
                Some(*sum)
            })
            .collect();
        let drawn =
            sampler(1, move |u: &[f64]| Some(Sample::new((cdf.partition_point(|end| *end <= u[0]) + 1).min(5))));
        let shifted = told(&Discrete { outcomes: 6 }, &drawn, &crate::density(move |i: usize| few[i]));
        assert!(shifted.contains("with indices that are one too high, kept at the last"), "{shifted}");
        let path = sampler(1, |u: &[f64]| Some(Sample::new(-2.7 * (1.0 - u[0]).ln())));
        let long =
            told(&crate::HalfLine { from: 0.0, width: 1.0 }, &path, &crate::density(|x: f64| 2.7 * (-2.7 * x).exp()));
        assert!(long.contains("times as large") && long.contains("7.3"), "{long}");
    }

    /// Samples of a lobe about an axis of its own, by the cosine of the angle with it, and their pdf by this cosine.
    fn of_lobe(cos: fn(f64) -> f64, pdf: fn(f64) -> f64, around: [f64; 3]) -> String {
        const AXIS: [f64; 3] = [0.6, 0.0, 0.8];
        let pole = [0.0, 0.0, 1.0];
        let draw = move |u: &[f64]| Some(Sample::new(axis::turn_to(pole, around, direction(cos(u[0]), u[1]))));
        let density = crate::density(move |w: [f64; 3]| pdf(axis::dot(w, AXIS)));
        told(&Directions::sphere(Pole::Z), &sampler(2, draw), &density)
    }

    #[test]
    fn mistakes_around_the_axis_of_a_pdf_are_named() {
        const NARROW: f64 = 0.98;
        let cone = |cos: f64| if cos > NARROW { 1.0 / (TAU * (1.0 - NARROW)) } else { 0.0 };
        let wide = |cos: f64| 5.0 / TAU * cos.max(0.0).powi(4);
        let phong = |cos: f64| 21.0 / TAU * cos.max(0.0).powi(20);
        let own = [0.6, 0.0, 0.8];
        type Of = fn(f64) -> f64;
        let cases: [(Of, Of, [f64; 3], &str); 7] = [
            (|u| (u * NARROW.acos()).cos(), cone, own, "a density in proportion to 1/sin γ where the pdf is positive"),
            (
                |u| 1.0 - u * (1.0 - (2.0 * NARROW.acos()).cos()),
                cone,
                own,
                "the pdf with angles to its axis (0.60, 0.00, 0.80) that are 1.99",
            ),
            (
                |u| 1.0 - u * (1.0 - NARROW),
                cone,
                [0.0, 0.0, 1.0],
                "the pdf around (0.00, 0.00, 1.00) in place of its axis (0.60, 0.00, 0.80)",
            ),
            (|u| (1.0 - u).powf(1.0 / 4.0), wide, own, "the pdf divided by cos γ, γ the angle with its axis"),
            (|u| (1.0 - u).powf(1.0 / 21.0), phong, [0.6, 0.48, 0.64], "the pdf around (0.60, 0.4"),
            (|u| (1.0 - u).powf(1.0 / 33.0), phong, own, " its axis (0.60, 0.00, 0.80) that are 0."),
            // A lobe with another profile has no name.
            (|u| 1.0 - 0.2 * u.powi(2), phong, own, "samples have a mean angle of 1"),
        ];
        for (cos, pdf, around, name) in cases {
            let text = of_lobe(cos, pdf, around);
            assert!(text.contains(name), "{name}: {text}");
            assert_eq!(text.contains("samples follow"), !name.contains("mean angle"), "{text}");
        }
    }

    #[test]
    fn mistakes_in_one_of_two_coordinates_are_named() {
        // f(x, y) = 1 + (2x − 1)(2y − 1)/2 + (2x − 1)/2, whose marginals are 1 + (2x − 1)/2 and 1
        let pdf = |[x, y]: [f64; 2]| 1.0 + 0.5 * (2.0 * x - 1.0) * (2.0 * y - 1.0) + 0.5 * (2.0 * x - 1.0);
        // The density 1 + a (2x − 1) of [0, 1]
        let linear = |a: f64, u: f64| {
            if a.abs() < 1e-9 { u } else { ((1.0 - a).powi(2) + 4.0 * a * u).sqrt().mul_add(0.5, 0.5 * (a - 1.0)) / a }
        };
        let conditional = move |x: f64, u: f64| linear(0.5 * (2.0 * x - 1.0) / (1.0 + 0.5 * (2.0 * x - 1.0)), u);
        type Draw<'a> = Box<dyn Fn(&[f64]) -> [f64; 2] + Sync + 'a>;
        let cases: [(Draw, &str); 3] = [
            (Box::new(move |u| [linear(0.5, u[0]), u[1]]), "the pdf with y uniform"),
            (
                Box::new(move |u| [u[0], conditional(u[0], u[1])]),
                "the pdf with x uniform, and y by its conditional pdf",
            ),
            (Box::new(move |u| [linear(0.5, u[0]), conditional(0.9, u[1])]), ""),
        ];
        for (draw, name) in cases {
            let text = told(&Square, &sampler(2, |u: &[f64]| Some(Sample::new(draw(u)))), &crate::density(pdf));
            assert!(text.contains(name) && text.contains("samples follow") != name.is_empty(), "{name}: {text}");
        }
        // A table whose rows are other than each other, sampled by one conditional pdf
        let table = |[x, y]: [f64; 2]| if (x < 0.5) == (y < 0.25) { 1.6 } else { 0.4 };
        let mass = 1.0;
        let pdf = move |at: [f64; 2]| table(at) / mass;
        let steps = [vec![0.5], vec![0.25]];
        let even = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1]])));
        let text = told(&Square, &even, &crate::density(pdf).with_steps(steps));
        assert!(text.contains("samples follow a uniform density"), "{text}");
    }

    #[test]
    fn one_random_number_for_two_coordinates_is_named() {
        let polar = |r: f64, u: f64| [r * (TAU * u).cos(), r * (TAU * u).sin()];
        let disk = crate::Disk { radius: 1.0 };
        let once = sampler(2, |u: &[f64]| Some(Sample::new(polar(u[0].sqrt(), u[0]))));
        let text = told(&disk, &once, &crate::density(|_: [f64; 2]| 1.0 / PI));
        assert!(
            text.contains("samples have φ as a function of r, as if one random number were used for both"),
            "{text}"
        );
        let lobe = sampler(2, |u: &[f64]| Some(Sample::new(direction(u[1].powf(0.2), 1.0 - u[1]))));
        let text =
            told(&Directions::hemisphere(Pole::Z), &lobe, &crate::density(|w: [f64; 3]| 5.0 / TAU * w[2].powi(4)));
        assert!(text.contains("samples have φ as a function of cos θ"), "{text}");
        // Numbers that depend on each other without a curve
        let mixed = sampler(3, |u: &[f64]| Some(Sample::new([u[0], if u[2] < 0.2 { u[1] } else { u[0] * u[1] }])));
        let text = told(&Square, &mixed, &crate::density(|_: [f64; 2]| 1.0));
        assert!(!text.contains("as a function of"), "{text}");
    }

    #[test]
    fn mistakes_of_widths_ends_and_shares_are_named() {
        let line = Line { from: -4.0, to: 6.0 };
        let normal = |u: &[f64]| (-2.0 * (1.0 - u[0]).ln()).sqrt() * (TAU * u[1]).cos();
        let gauss = |x: f64| (-0.5 * (x - 1.0).powi(2) / 0.25).exp() / (0.25 * TAU).sqrt();
        let wide = sampler(2, move |u: &[f64]| Some(Sample::new(1.0 + normal(u))).filter(|_| normal(u).abs() < 4.9));
        let text = told(&line, &wide, &crate::density(gauss));
        assert!(text.contains("the pdf with distances from its mean, 1, 2"), "{text}");
        let decay =
            sampler(1, |u: &[f64]| Some(Sample::new((-(1.0 - u[0] * (1.0 - (-20f64).exp())).ln() / 2.0).min(10.0))));
        let rate = |x: f64| 0.5 * (-0.5 * x).exp() / (1.0 - (-5f64).exp());
        let text = told(&Line { from: 0.0, to: 10.0 }, &decay, &crate::density(rate));
        assert!(text.contains("the pdf with distances from the lower end that are 0.2"), "{text}");
        // Indices that are kept in a set
        let weights = [0.1, 0.2, 0.15, 0.05, 0.3, 0.12, 0.08];
        let drawn = move |u: f64| (0..7).find(|&i| u < weights[..=i].iter().sum()).unwrap_or(6);
        let low = sampler(1, move |u: &[f64]| Some(Sample::new(drawn(u[0]).saturating_sub(1))));
        let text = told(&Discrete { outcomes: 7 }, &low, &crate::density(move |i: usize| weights[i]));
        assert!(text.contains("the pdf with indices that are one too low, kept at 0"), "{text}");
        // An atom of another probability
        let mixed = sampler(2, |u: &[f64]| Some(if u[0] < 0.3 { Sample::atom(0.5) } else { Sample::new(u[1]) }));
        let half = crate::density(|_: f64| 0.6).with_atoms(vec![crate::Atom::new(0.5, 0.4)]);
        let text = told(&Line::UNIT, &mixed, &half);
        assert!(text.contains("samples follow the pdf, and probabilities are wrong: that of atom 0 is 0."), "{text}");
        // Shares of lobes that do not add to 1
        let lacking = crate::density(|x: f64| 1.6 * x).with_mass(crate::Mass::AtMostOne);
        let text = told(&Line::UNIT, &sampler(1, |u: &[f64]| Some(Sample::new(u[0].sqrt()))), &lacking);
        assert!(
            text.contains("follow the pdf, and every draw returns a sample, though the pdf integrates to 0.8000"),
            "{text}"
        );
        // A mixture with a uniform part
        let lobe = sampler(2, |u: &[f64]| Some(Sample::new(if u[0] < 0.3 { u[1] } else { u[1].sqrt().sqrt() })));
        let text = told(&Line::UNIT, &lobe, &crate::density(|x: f64| 0.5 + 2.0 * x.powi(3)));
        let [found, expected] = ["samples follow the pdf with a share of 0.29", ", not 0.500, for its uniform part"];
        assert!(text.contains(found) && text.contains(expected), "{text}");
        // Rejection sampling that takes the last candidate after two attempts
        let rejected = sampler(3, |u: &[f64]| Some(Sample::new(if u[1] <= u[0] { u[0] } else { u[2] })));
        let text = told(&Line::UNIT, &rejected, &crate::density(|x: f64| 2.0 * x));
        assert!(text.contains("the pdf mixed with a uniform density, whose share is 0.49"), "{text}");
        // Half of the samples are clamped to an edge.
        let clamped = sampler(2, |u: &[f64]| Some(Sample::new([u[0], u[1].min(0.5)])));
        let text = told(&Square, &clamped, &crate::density(|_: [f64; 2]| 1.0));
        assert!(text.contains("% of the samples have the same"), "{text}");
        let other = crate::density(|_: f64| 0.3).with_atoms(vec![crate::Atom::new(0.5, 0.7)]);
        let text = told(&Line::UNIT, &mixed, &other);
        assert!(text.contains("the probabilities of atom 0 and of all other samples are exchanged"), "{text}");
    }

    #[test]
    fn integrals_and_carried_pdfs_say_by_what_they_are_wrong() {
        let half = Directions::hemisphere(Pole::Z);
        let uniform = sampler(2, |u: &[f64]| Some(Sample::new(uniform_hemisphere(u))));
        let text = told(&half, &uniform, &crate::density(|_: [f64; 3]| 1.0 / PI));
        let factor =
            "samples follow the pdf up to a factor: the pdf is 2.000 times as large as samples say: the pdf integrates";
        assert!(text.contains(factor), "{text}");
        let text = told(&half, &uniform, &crate::density(|_: [f64; 3]| 0.5));
        assert!(text.contains(" = π, not to 1"), "{text}");
        let pdf = |w: [f64; 3]| beckmann_pdf(0.5, w);
        type Pdf = fn([f64; 3]) -> f64;
        let changes: [(Pdf, &str); 5] = [
            (|w| beckmann_pdf(0.5, w) * PI, "what samples carry is 3.141593 = π times the pdf"),
            (|w| beckmann_pdf(0.5, w) / w[2], "what samples carry is the pdf divided by cos θ"),
            (|w| 2.0 * w[2] / PI, "what samples carry is in proportion to cos θ/π"),
            (|w| beckmann_pdf(0.49, w), "what samples carry is the pdf times a function of cos θ alone"),
            (|w| beckmann_pdf(0.5, w) * (1.0 + 0.1 * (20.0 * w[0] + 15.0 * w[1]).sin()), ""),
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
        let names = domains.iter().flat_map(|domain| all(*domain, &table)).map(|mistake| mistake.name);
        let planes = domains.iter().filter(|domain| domain.is_plane());
        let of_planes = planes.flat_map(|domain| marginals::of(*domain, &table, &[]).unwrap()).map(|(name, _)| name);
        for name in names.chain(of_planes) {
            let name = name.split(" along ").next().unwrap().split(" {}").next().unwrap();
            let name = if name.starts_with("a density") { name.split(" (").next().unwrap() } else { name };
            let name = if name.starts_with("at (") { "at (x, -z, y)" } else { name };
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
