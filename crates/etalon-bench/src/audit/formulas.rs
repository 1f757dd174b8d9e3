//! Formulas that one exact check decides: a quantity that is 0 at every angle, on both sides of the glass, if the formula is right.
//!
//! A misprint is a formula that a report's text has wrong and its program has right; its effect is what it would do if taken at
//! its word.

use super::{ETA, Erratum, ErratumCurves, Nature, ROUNDING, Suspect, at_all_angles, curve, exact, mean_by_cosine};
use crate::validation::Case;
use etalon_core::errata::images::median_without_half;
use etalon_core::errata::interface::{
    reciprocal_of_signed_cosine, reflected_sine_without_sign, refracted_cosine_of_squared_difference,
    refracted_normal_part_under_root, refracted_radiance_over_square, refracted_sine_of_itself,
    refracts_where_above_one, schlick_incident_cosine, schlick_of_fifth_power, schlick_refracted_cosine,
};
use etalon_core::errata::microfacet::reflected_pdf_by_determinant;
use etalon_core::optics::dielectric;
use etalon_stats::{Atom, Directions, Point, Pole, Protocol, Sample, density, sampler};
use std::f64::consts::FRAC_1_SQRT_2;

/// A formula as printed (first of each pair) and corrected (second).
struct Formula {
    name: &'static str,
    title: &'static str,
    report: &'static str,
    nature: Nature,
    formula: [&'static str; 2],
    test: &'static str,
    /// What the check finds wrong.
    found: &'static str,
    /// By how much it is wrong at a cosine and an η.
    wrong: [fn(f64, f64) -> f64; 2],
    /// A quantity of an image by either formula, and its name.
    effect: [fn() -> f64; 2],
    error_of: &'static str,
    /// None of a misprint.
    curves: Option<Curves>,
}

/// Both formulas over angles outside, in degrees.
struct Curves {
    /// Label of the y axis.
    y: &'static str,
    formulas: [fn(f64) -> f64; 2],
}

const INSIDE: f64 = 1.0 / ETA;

fn cos(degrees: f64) -> f64 {
    degrees.to_radians().cos()
}

fn sine(cos: f64) -> f64 {
    (1.0 - cos * cos).sqrt()
}

fn is_refracted(cos: f64, eta: f64) -> bool {
    dielectric::eta_cos_t(cos, eta).is_some()
}

/// The share of light that passes at a cosine from inside.
fn leaves(cos: f64) -> f64 {
    dielectric::fresnel(cos, INSIDE).transmittance()
}

/// Reflected and refracted flux minus the incident one, of radiance that is refracted. The flux of the refracted beam is its radiance
/// over η².
fn lost(cos: f64, eta: f64, refracted: fn(f64, f64) -> f64) -> f64 {
    let fresnel = dielectric::fresnel(cos, eta);
    (fresnel.unpolarized() + refracted(fresnel.transmittance(), eta) / (eta * eta) - 1.0).abs()
}

fn times_square(transmitted: f64, eta: f64) -> f64 {
    transmitted * eta * eta
}

/// Schlick's approximation for light that comes back along the refracted direction; `None` if there is none.
fn schlick_from_there(cos: f64, eta: f64) -> Option<f64> {
    dielectric::eta_cos_t(cos, eta).map(|g| dielectric::schlick(g / eta, 1.0 / eta))
}

/// The distance of a refracted sine from Snell's law, where there is refraction.
fn from_snell(cos: f64, eta: f64, refracted: f64) -> f64 {
    if is_refracted(cos, eta) { (eta * refracted - sine(cos)).abs() } else { 0.0 }
}

fn cosine_of_difference(cos: f64, eta: f64) -> Option<f64> {
    dielectric::eta_cos_t(cos, eta).map(|g| g / eta)
}

/// The distance of a refracted direction's length from 1.
fn from_unit(cos: f64, eta: f64, refracted: Option<f64>) -> f64 {
    refracted.map_or(0.0, |z| (((1.0 - cos * cos) / (eta * eta) + z * z).sqrt() - 1.0).abs())
}

/// The refracted direction's part along the normal, for a cosine with its sign.
fn normal_part(cos: f64, eta: f64) -> f64 {
    cosine_of_difference(cos.abs(), eta).map_or(f64::NAN, |z| -z.copysign(cos))
}

/// The distance of a part along the normal from the correct one, where there is refraction; the cosine is negative inside.
fn from_normal_part(cos: f64, eta: f64, part: fn(f64, f64) -> f64) -> f64 {
    let signed = if eta < 1.0 { -cos } else { cos };
    if is_refracted(cos, eta) { (part(signed, eta) - normal_part(signed, eta)).abs() } else { 0.0 }
}

fn opposite_sine(sin: f64) -> f64 {
    -sin
}

/// The distance of a reflected tangential part from the opposite of that of the direction.
fn from_mirror(cos: f64, reflected: fn(f64) -> f64) -> f64 {
    (reflected(sine(cos)) + sine(cos)).abs()
}

/// 1 if a mirror seen at 45° shows the half-space opposite, 0 if not.
fn bright_opposite(reflected: fn(f64) -> f64) -> f64 {
    f64::from(u8::from(reflected(FRAC_1_SQRT_2) < 0.0))
}

/// The distance of the light of a perfect reflector from 1: a BSDF of 1/|cos| times |cos|. From inside the cosine is negative.
fn from_all_light(cos: f64, eta: f64, reciprocal: fn(f64) -> f64) -> f64 {
    let signed = if eta < 1.0 { -cos } else { cos };
    (reciprocal(signed) * cos - 1.0).abs()
}

fn reciprocal_of_modulus(cos: f64) -> f64 {
    1.0 / cos.abs()
}

/// A thin ring of half-vectors about the viewer is reflected to a ring of twice the angle, of the same probability: by how much the
/// pdf of the reflections misses it.
fn from_ring(cos: f64, pdf: fn(f64, f64) -> f64) -> f64 {
    /// Half the width of the ring, in the cosine.
    const HALF: f64 = 1e-4;
    if !(HALF..=1.0 - HALF).contains(&cos) {
        return 0.0;
    }
    let twice = |cos: f64| (2.0 * cos.acos()).cos();
    let ring = (twice(cos + HALF) - twice(cos - HALF)) / (2.0 * HALF);
    (pdf(1.0, cos) * ring - 1.0).abs()
}

fn over_determinant(d: f64, cos: f64) -> f64 {
    d / (4.0 * cos)
}

const FORMULAS: [Formula; 9] = [
    Formula {
        name: "radiance",
        title: "radiance into glass: 1/n² for n²",
        report: "second report",
        nature: Nature::Error,
        formula: ["T(1 − r²)/(nᵣ² (eᵢ·n)), nᵣ = index of eᵣ over that of eᵢ", "T(1 − r²) nᵣ²/(eᵢ·n)"],
        test: "reflected and refracted flux against the incident one, at every angle from both sides",
        found: "of the incident flux, lost or added:",
        wrong: [|c, eta| lost(c, eta, refracted_radiance_over_square), |c, eta| lost(c, eta, times_square)],
        effect: [|| refracted_radiance_over_square(1.0, INSIDE), || times_square(1.0, INSIDE)],
        error_of: "light inside glass, seen from outside",
        curves: Some(Curves {
            y: "radiance into glass",
            formulas: [
                |a| refracted_radiance_over_square(dielectric::fresnel(cos(a), ETA).transmittance(), ETA),
                |a| times_square(dielectric::fresnel(cos(a), ETA).transmittance(), ETA),
            ],
        }),
    },
    Formula {
        name: "far-side",
        title: "reflectance by the refracted angle",
        report: "second report",
        nature: Nature::Error,
        formula: [
            "refracted: 1 − r(dᵣ⁻¹(eᵣ))², Schlick's polynomial of the cosine of eᵣ; reflected: r(eᵢ)²",
            "the same with an r that both directions of a path share: of the cosine on the less dense side",
        ],
        test: "reflected and refracted light against the incident light, at every angle from both sides",
        found: "of the incident light, lost or added:",
        wrong: [
            |c, eta| schlick_refracted_cosine(c, eta).map_or(0.0, |r| (schlick_incident_cosine(c, eta) - r).abs()),
            |c, eta| schlick_from_there(c, eta).map_or(0.0, |r| (dielectric::schlick(c, eta) - r).abs()),
        ],
        effect: [
            || {
                let refracted = |c| 1.0 - schlick_refracted_cosine(c, ETA).unwrap_or(1.0);
                mean_by_cosine(|c| schlick_incident_cosine(c, ETA) + refracted(c))
            },
            || 1.0,
        ],
        error_of: "light after glass, from outside",
        curves: Some(Curves {
            y: "reflected + refracted",
            formulas: [
                |a| 1.0 + schlick_incident_cosine(cos(a), ETA) - schlick_refracted_cosine(cos(a), ETA).unwrap_or(1.0),
                |a| 1.0 + dielectric::schlick(cos(a), ETA) - schlick_from_there(cos(a), ETA).unwrap_or(1.0),
            ],
        }),
    },
    Formula {
        name: "refracted-set",
        title: "refraction where > 1",
        report: "second report",
        nature: Nature::Misprint,
        formula: ["refracted where √(1 − (eᵢ·n)²)/nᵣ > 1", "refracted where √(1 − (eᵢ·n)²)/nᵣ ≤ 1"],
        test: "is there a refracted direction, at every angle from both sides",
        found: "the set and the existence of a refracted direction disagree:",
        wrong: [
            |c, eta| f64::from(u8::from(refracts_where_above_one(c, eta) != is_refracted(c, eta))),
            |c, eta| f64::from(u8::from(((1.0 - c * c) / (eta * eta) <= 1.0) != is_refracted(c, eta))),
        ],
        effect: [
            || mean_by_cosine(|c| if refracts_where_above_one(c, INSIDE) { leaves(c) } else { 0.0 }),
            || mean_by_cosine(leaves),
        ],
        error_of: "light that leaves glass",
        curves: None,
    },
    Formula {
        name: "itself",
        title: "refraction by itself",
        report: "second report",
        nature: Nature::Misprint,
        formula: ["the tangential part of eᵢ by eᵢ itself: 0", "the tangential part of eᵢ by that of eᵣ"],
        test: "Snell's law at every angle from both sides",
        found: "sines that differ from Snell's law by up to",
        wrong: [|c, eta| from_snell(c, eta, refracted_sine_of_itself()), |c, eta| from_snell(c, eta, sine(c) / eta)],
        effect: [|| refracted_sine_of_itself(), || mean_by_cosine(|c| sine(c) / ETA)],
        error_of: "displacement by refraction",
        curves: None,
    },
    Formula {
        name: "difference",
        title: "(1 − e·n)² for 1 − (e·n)²",
        report: "second report",
        nature: Nature::Misprint,
        formula: ["refracted cosine √(1 − (1 − eᵢ·n)²/nᵣ²)", "refracted cosine √(1 − (1 − (eᵢ·n)²)/nᵣ²)"],
        test: "length of the refracted direction, at every angle from both sides",
        found: "refracted directions of a length other than 1, by up to",
        wrong: [
            |c, eta| from_unit(c, eta, refracted_cosine_of_squared_difference(c, eta)),
            |c, eta| from_unit(c, eta, cosine_of_difference(c, eta)),
        ],
        effect: [
            || mean_by_cosine(|c| f64::from(u8::from(refracted_cosine_of_squared_difference(c, INSIDE).is_some()))),
            || mean_by_cosine(|c| f64::from(u8::from(is_refracted(c, INSIDE)))),
        ],
        error_of: "light that leaves glass",
        curves: None,
    },
    Formula {
        name: "root",
        title: "a root over sgn and n",
        report: "second report",
        nature: Nature::Misprint,
        formula: [
            "√(1 − (1 − (eᵢ·n)²)/nᵣ² sgn(eᵢ·n) n), a root of a vector: here of its part along n",
            "√(1 − (1 − (eᵢ·n)²)/nᵣ²) sgn(eᵢ·n) n",
        ],
        test: "part of the refracted direction along n, at every angle from both sides",
        found: "parts along n that are wrong by up to",
        wrong: [
            |c, eta| from_normal_part(c, eta, refracted_normal_part_under_root),
            |c, eta| from_normal_part(c, eta, normal_part),
        ],
        effect: [
            || mean_by_cosine(|c| f64::from(u8::from(refracted_normal_part_under_root(-c, INSIDE) > 0.0))),
            || mean_by_cosine(|c| f64::from(u8::from(normal_part(-c, INSIDE) > 0.0))),
        ],
        error_of: "light that leaves glass",
        curves: None,
    },
    Formula {
        name: "signs",
        title: "reflection without signs",
        report: "second report",
        nature: Nature::Misprint,
        formula: [
            "eᵢ = the components of eᵣ, without a sign",
            "eᵢ = those of −eᵣ along the surface, that of eᵣ along n",
        ],
        test: "law of reflection at every angle",
        found: "tangential parts that differ from the law of reflection by up to",
        wrong: [|c, _| from_mirror(c, reflected_sine_without_sign), |c, _| from_mirror(c, opposite_sine)],
        // A viewer at 45° in a dark half-space looks at a mirror that should show the bright half-space opposite.
        effect: [|| bright_opposite(reflected_sine_without_sign), || bright_opposite(opposite_sine)],
        error_of: "light of the opposite side in a mirror",
        curves: None,
    },
    Formula {
        name: "modulus",
        title: "the cosine without modulus",
        report: "second report",
        nature: Nature::Misprint,
        formula: ["1/(eᵢ·n) for light from either side", "1/|eᵢ·n|"],
        test: "light of a perfect reflector, at every angle from both sides",
        found: "reflected light is wrong by up to",
        wrong: [
            |c, eta| from_all_light(c, eta, reciprocal_of_signed_cosine),
            |c, eta| from_all_light(c, eta, reciprocal_of_modulus),
        ],
        effect: [|| reciprocal_of_signed_cosine(-1.0), || 1.0],
        error_of: "light reflected inside",
        curves: None,
    },
    Formula {
        name: "determinant",
        title: "pdf by the determinant",
        report: "second report",
        nature: Nature::Misprint,
        formula: ["p(eᵢ) = D det(∂eᵢ/∂h)", "p(eᵢ) = D/det(∂eᵢ/∂h), the determinant being 4 eᵣ·h"],
        test: "probability of a ring of half-vectors and of the ring of their reflections, at every angle",
        found: "probabilities of both rings differ by up to a share of",
        wrong: [|c, _| from_ring(c, reflected_pdf_by_determinant), |c, _| from_ring(c, over_determinant)],
        // Light of smooth metal is D over the pdf.
        effect: [|| 1.0 / reflected_pdf_by_determinant(1.0, 1.0), || 1.0 / over_determinant(1.0, 1.0)],
        error_of: "light of smooth metal at 0°",
        curves: None,
    },
];

pub fn suspects() -> Vec<Suspect> {
    FORMULAS.iter().map(suspect).collect()
}

fn suspect(row: &Formula) -> Suspect {
    let erratum = Erratum {
        title: row.title,
        report: row.report,
        nature: row.nature,
        printed: row.formula[0],
        right: row.formula[1],
        test: row.test,
        error_in_picture: row.effect[0]() / row.effect[1]() - 1.0,
        error_of: row.error_of,
        curves: row.curves.as_ref().map(|curves| ErratumCurves {
            x: "/{θ} outside (degrees)",
            every: 30.0,
            y: curves.y,
            printed: curve(0.0, 90.0, curves.formulas[0]),
            right: curve(0.0, 90.0, curves.formulas[1]),
            scattered: false,
        }),
        ..Erratum::default()
    };
    let case = |name: &str, wrong| at_all_angles(&format!("{}/{name}", row.name), row.found, wrong);
    (erratum, [case("printed", row.wrong[0]), case("right", row.wrong[1])])
}

/// Misprints that take a test of their own: formulas that a report's text has wrong and its program has right, and what each would
/// do if taken at its word.
pub fn misprints() -> Vec<Suspect> {
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
