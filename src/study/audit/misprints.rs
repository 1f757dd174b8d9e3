//! Errors of print: formulas that a report's text has wrong and its program has right, and what each would do if taken at its
//! word.

use super::erratum::{Erratum, ErratumCurves, Nature, Suspect, curve, exact, mean_by_cosine};
use crate::errata::fresnel::schlick_of_fifth_power;
use crate::errata::maps::median_without_half;
use crate::errata::refraction::{
    refracted_cosine_of_squared_difference, refracted_sine_of_itself, refracts_where_above_one,
};
use crate::optics::{dielectric, schlick};
use crate::study::validation::Case;
use etalon_stats::{Atom, Directions, Pole, Protocol, Sample, density, sampler};

const ETA: f64 = 1.45;
/// Angles at which a formula is compared with the laws of optics.
const ANGLES: u32 = 9000;
/// Relative difference of equal numbers by rounding.
const ROUNDING: f64 = 1e-9;

pub fn suspects() -> Vec<Suspect> {
    vec![set_of_refraction(), schlick_power(), direction_of_itself(), squared_difference(), median_pixel()]
}

/// All angles of incidence, as cosines.
fn cosines() -> impl Iterator<Item = f64> {
    (0..ANGLES).map(|i| ((f64::from(i) + 0.5) * 90.0 / f64::from(ANGLES)).to_radians().cos())
}

/// A test of a formula at all angles on both sides of glass; `wrong` is its error at a cosine and an η.
fn at_all_angles(name: &str, what: &'static str, wrong: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Case {
    Case::new(format!("audit/{name}"), move |_: &Protocol, _| {
        let both = [ETA, 1.0 / ETA];
        let largest = both.iter().flat_map(|&eta| cosines().map(move |cos| (cos, eta)));
        let largest = largest.map(|(cos, eta)| wrong(cos, eta)).fold(0.0, f64::max);
        let violation = (largest > ROUNDING).then(|| format!("{what} {largest:.2}"));
        Ok(exact(violation, 2 * u64::from(ANGLES)))
    })
}

/// cos θ inside the glass from the angle in degrees, for curves.
fn from_inside(f: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    curve(0.0, 90.0, |degrees| f(degrees.to_radians().cos()))
}

/// The share of light that passes at a cosine from inside.
fn transmitted(cos: f64) -> f64 {
    dielectric::fresnel(cos, 1.0 / ETA).transmittance()
}

fn set_of_refraction() -> Suspect {
    // 1 where the set and the existence of a refracted direction disagree.
    let wrong = |is_in_set: fn(f64, f64) -> bool| {
        move |cos: f64, eta: f64| f64::from(u8::from(is_in_set(cos, eta) != dielectric::eta_cos_t(cos, eta).is_some()))
    };
    let what = "the set and the existence of a refracted direction disagree:";
    let printed = |cos: f64| if refracts_where_above_one(cos, 1.0 / ETA) { transmitted(cos) } else { 0.0 };
    let erratum = Erratum {
        title: "refraction where > 1",
        report: "second report",
        nature: Nature::Print,
        printed: "refracted where η²(1 − e_z²) > 1",
        right: "refracted where η²(1 − e_z²) ≤ 1",
        test: "is there a refracted direction, at every angle from both sides",
        error_in_picture: mean_by_cosine(printed) / mean_by_cosine(transmitted) - 1.0,
        error_of: "light that leaves glass",
        curves: ErratumCurves {
            x: "/{θ} inside (degrees)",
            every: 30.0,
            y: "transmittance",
            printed: from_inside(printed),
            right: from_inside(transmitted),
            scattered: false,
        },
        ..Erratum::default()
    };
    let right = |cos: f64, eta: f64| (1.0 - cos * cos) / (eta * eta) <= 1.0;
    let case = |name: &str, is_in_set| at_all_angles(name, what, wrong(is_in_set));
    (erratum, [case("refracted-set/printed", refracts_where_above_one), case("refracted-set/right", right)])
}

fn schlick_power() -> Suspect {
    const THETA: f64 = 40.0;
    let (sin, cos) = THETA.to_radians().sin_cos();
    let case = |name: &str, formula: fn(f64, f64) -> f64| {
        Case::of(format!("audit/schlick-power/{name}"), Directions::sphere(Pole::Z), move || {
            let points = [[-sin, 0.0, cos], [-sin / ETA, 0.0, -(1.0 - (sin / ETA).powi(2)).sqrt()]];
            let draw = move |u: &[f64]| Some(Sample::atom(points[usize::from(u[0] >= formula(cos, ETA))]));
            let reflected = schlick::schlick(cos, ETA);
            let atoms = vec![
                Atom { point: points[0], probability: reflected },
                Atom { point: points[1], probability: 1.0 - reflected },
            ];
            (sampler(1, draw), density(|_| 0.0).with_atoms(atoms))
        })
    };
    let [printed, right] = [schlick_of_fifth_power as fn(f64, f64) -> f64, schlick::schlick];
    let erratum = Erratum {
        title: "Schlick's power",
        report: "second report",
        nature: Nature::Print,
        printed: "F₀ + (1 − F₀)(1 − (e·n)⁵)",
        right: "F₀ + (1 − F₀)(1 − e·n)⁵",
        test: "chi-square of reflected and refracted directions from outside at 40°",
        error_in_picture: mean_by_cosine(|c| printed(c, ETA)) / mean_by_cosine(|c| right(c, ETA)) - 1.0,
        error_of: "light reflected outside",
        curves: ErratumCurves {
            x: "/{θ} outside (degrees)",
            every: 30.0,
            y: "reflectance",
            printed: from_inside(|c| printed(c, ETA)),
            right: from_inside(|c| right(c, ETA)),
            scattered: false,
        },
        ..Erratum::default()
    };
    (erratum, [case("printed", printed), case("right", right)])
}

fn direction_of_itself() -> Suspect {
    let sine = |cos: f64| (1.0 - cos * cos).sqrt();
    // The distance from Snell's law, where there is refraction.
    let snell = |refracted: fn(f64, f64) -> f64| {
        move |cos: f64, eta: f64| {
            let there = dielectric::eta_cos_t(cos, eta).is_some();
            if there { (eta * refracted(cos, eta) - sine(cos)).abs() } else { 0.0 }
        }
    };
    let what = "sines that differ from Snell's law by up to";
    let right = |cos: f64, eta: f64| (1.0 - cos * cos).sqrt() / eta;
    let erratum = Erratum {
        title: "refraction by itself",
        report: "second report",
        nature: Nature::Print,
        printed: "the tangential part of eᵢ by eᵢ itself: 0",
        right: "the tangential part of eᵢ by that of eᵣ",
        test: "Snell's law at every angle from both sides",
        error_in_picture: mean_by_cosine(|_| refracted_sine_of_itself()) / mean_by_cosine(|c| right(c, ETA)) - 1.0,
        error_of: "displacement by refraction",
        curves: ErratumCurves {
            x: "/{θ} outside (degrees)",
            every: 30.0,
            y: "refracted /{θ} (degrees)",
            printed: from_inside(|_| refracted_sine_of_itself().asin().to_degrees()),
            right: from_inside(|c| right(c, ETA).asin().to_degrees()),
            scattered: false,
        },
        ..Erratum::default()
    };
    let printed = |_: f64, _: f64| refracted_sine_of_itself();
    let case = |name: &str, refracted| at_all_angles(name, what, snell(refracted));
    (erratum, [case("itself/printed", printed), case("itself/right", right)])
}

fn squared_difference() -> Suspect {
    // The length of a refracted direction is 1.
    let length = |cosine: fn(f64, f64) -> Option<f64>| {
        move |cos: f64, eta: f64| {
            cosine(cos, eta).map_or(0.0, |refracted| {
                let tangential = (1.0 - cos * cos) / (eta * eta);
                ((tangential + refracted * refracted).sqrt() - 1.0).abs()
            })
        }
    };
    let what = "refracted directions of a length other than 1, by up to";
    let right = |cos: f64, eta: f64| dielectric::eta_cos_t(cos, eta).map(|g| g / eta);
    // Light that leaves: the share of directions inside with a refracted one.
    let leaves = |cosine: fn(f64, f64) -> Option<f64>| {
        mean_by_cosine(move |c| f64::from(u8::from(cosine(c, 1.0 / ETA).is_some())))
    };
    // Directions are normalized in drawing; beyond the critical angle there is none.
    let angle = |cosine: fn(f64, f64) -> Option<f64>| {
        let angles = from_inside(|c| {
            let refracted = cosine(c, 1.0 / ETA);
            refracted.map_or(f64::NAN, |z| ((1.0 - c * c).sqrt() * ETA).atan2(z).to_degrees())
        });
        angles.into_iter().filter(|point| point[1].is_finite()).collect()
    };
    let printed = refracted_cosine_of_squared_difference;
    let erratum = Erratum {
        title: "(1 − e_{z})² for 1 − e_{z}²",
        report: "second report",
        nature: Nature::Print,
        printed: "refracted cosine √(1 − η²(1 − e_z)²)",
        right: "refracted cosine √(1 − η²(1 − e_z²))",
        test: "length of the refracted direction, at every angle from both sides",
        error_in_picture: leaves(printed) / leaves(right) - 1.0,
        error_of: "directions that leave glass",
        curves: ErratumCurves {
            x: "/{θ} inside (degrees)",
            every: 30.0,
            y: "refracted /{θ} (degrees)",
            printed: angle(printed),
            right: angle(right),
            scattered: false,
        },
        ..Erratum::default()
    };
    let case = |name: &str, cosine| at_all_angles(name, what, length(cosine));
    (erratum, [case("difference/printed", printed), case("difference/right", right)])
}

fn median_pixel() -> Suspect {
    const PIXELS: usize = 1024;
    const CUTS: usize = 6;
    let half = |energies: &[f64]| {
        let total: f64 = energies.iter().sum();
        let mut before = 0.0;
        energies.iter().position(|e| {
            before += e;
            2.0 * before >= total
        })
    };
    let printed = |energies: &[f64]| Some(median_without_half(energies));
    // The largest part after some cuts of a row of equal pixels, of which the larger part is cut again.
    let largest = move |median: &dyn Fn(&[f64]) -> Option<usize>, cuts: usize| {
        let row = vec![1.0; PIXELS];
        let mut part = &row[..];
        for _ in 0..cuts {
            let (before, after) = part.split_at(median(part).map_or(0, |i| i + 1));
            part = if before.len() >= after.len() { before } else { after };
        }
        part.len() as f64 / PIXELS as f64
    };
    let case = |name: &str, share: f64| {
        Case::new(format!("audit/median/{name}"), move |_: &Protocol, _| {
            let violation =
                (share > 0.5 + ROUNDING).then(|| format!("one part has {:.0} % of the energy", 100.0 * share));
            Ok(exact(violation, PIXELS as u64))
        })
    };
    let shares =
        |median: &dyn Fn(&[f64]) -> Option<usize>| (0..=CUTS).map(|n| [n as f64, largest(median, n)]).collect();
    // Under a uniform sky the light of the one part that has any stands at its last pixel, the nadir: below the floor.
    let floor = |cosine: f64| cosine.max(0.0);
    let erratum = Erratum {
        title: "the median without the half",
        report: "first report",
        nature: Nature::Print,
        printed: "median pixel: sum up to i = total sum",
        right: "median pixel: sum up to i = half of the total sum",
        test: "shares of the energy on both sides of the cut, uniform sky",
        error_in_picture: floor(-1.0) / floor(1.0) - 1.0,
        error_of: "light on a floor, uniform sky",
        curves: ErratumCurves {
            x: "cuts",
            every: 2.0,
            y: "largest part's energy",
            printed: shares(&printed),
            right: shares(&half),
            scattered: false,
        },
        ..Erratum::default()
    };
    (erratum, [case("printed", largest(&printed, 1)), case("right", largest(&half, 1))])
}
