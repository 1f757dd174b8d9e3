//! Misprints that take a test of their own: formulas that a report's text has wrong and its program has right, and what each would
//! do if taken at its word.

use super::{ETA, Erratum, Nature, ROUNDING, Suspect, exact, mean_by_cosine};
use crate::validation::Case;
use etalon_core::errata::images::median_without_half;
use etalon_core::errata::interface::schlick_of_fifth_power;
use etalon_core::optics::dielectric;
use etalon_stats::{Atom, Directions, Point, Pole, Protocol, Sample, density, sampler};

pub fn suspects() -> Vec<Suspect> {
    vec![schlick_power(), median_pixel()]
}

fn schlick_power() -> Suspect {
    const THETA: f64 = 40.0;
    let (sin, cos) = THETA.to_radians().sin_cos();
    let case = |name: &str, formula: fn(f64, f64) -> f64| {
        Case::of(format!("audit/schlick-power/{name}"), Directions::sphere(Pole::Z), move || {
            let points = [[-sin, 0.0, cos], [-sin / ETA, 0.0, -(1.0 - (sin / ETA).powi(2)).sqrt()]];
            let draw = move |u: &[f64]| Some(Sample::atom(points[usize::from(u[0] >= formula(cos, ETA))]));
            let reflected = dielectric::schlick(cos, ETA);
            let atoms = vec![Atom::new(points[0], reflected), Atom::new(points[1], 1.0 - reflected)];
            (sampler(1, draw), density(|_: Point| 0.0).with_atoms(atoms))
        })
    };
    let [printed, right] = [schlick_of_fifth_power as fn(f64, f64) -> f64, dielectric::schlick];
    let erratum = Erratum {
        title: "Schlick's power",
        report: "second report",
        nature: Nature::Misprint,
        printed: "F₀ + (1 − F₀)(1 − (e·n)⁵)",
        right: "F₀ + (1 − F₀)(1 − e·n)⁵",
        test: "chi-square of reflected and refracted directions from outside at 40°",
        error_in_picture: mean_by_cosine(|c| printed(c, ETA)) / mean_by_cosine(|c| right(c, ETA)) - 1.0,
        error_of: "light reflected outside",
        ..Erratum::default()
    };
    (erratum, [case("printed", printed), case("right", right)])
}

fn median_pixel() -> Suspect {
    const PIXELS: usize = 1024;
    let half = |energies: &[f64]| {
        let total: f64 = energies.iter().sum();
        let mut before = 0.0;
        energies.iter().position(|e| {
            before += e;
            2.0 * before >= total
        })
    };
    let printed = |energies: &[f64]| Some(median_without_half(energies));
    // The larger part of a row of equal pixels, which is cut once.
    let larger = |median: &dyn Fn(&[f64]) -> Option<usize>| {
        let before = median(&[1.0; PIXELS]).map_or(0, |i| i + 1);
        before.max(PIXELS - before) as f64 / PIXELS as f64
    };
    let case = |name: &str, share: f64| {
        Case::new(format!("audit/median/{name}"), move |_: &Protocol, _| {
            let violation =
                (share > 0.5 + ROUNDING).then(|| format!("one part has {:.0} % of the energy", 100.0 * share));
            Ok(exact(violation, PIXELS as u64))
        })
    };
    // By construction: under a uniform sky all light is at the last pixel, the nadir, below the floor.
    let floor = |cosine: f64| cosine.max(0.0);
    let erratum = Erratum {
        title: "the median without the half",
        report: "first report",
        nature: Nature::Misprint,
        printed: "median pixel: sum up to i = total sum",
        right: "median pixel: sum up to i = half of the total sum",
        test: "shares of the energy on both sides of the cut, uniform sky",
        error_in_picture: floor(-1.0) / floor(1.0) - 1.0,
        error_of: "light on a floor, uniform sky",
        ..Erratum::default()
    };
    (erratum, [case("printed", larger(&printed)), case("right", larger(&half))])
}
