//! Errors of print: formulas that a report's text has wrong and its program has right, and what each would do if taken at its
//! word.

use super::erratum::{
    ETA, Erratum, ErratumCurves, Nature, ROUNDING, Suspect, at_all_angles, curve, exact, mean_by_cosine,
};
use crate::errata::fresnel::schlick_of_fifth_power;
use crate::errata::maps::median_without_half;
use crate::errata::microfacet::reflected_pdf_by_determinant;
use crate::errata::reflection::{reciprocal_of_signed_cosine, reflected_sine_without_sign};
use crate::errata::refraction::{
    refracted_cosine_of_squared_difference, refracted_sine_of_itself, refracts_where_above_one,
};
use crate::optics::{dielectric, schlick};
use crate::study::validation::Case;
use etalon_stats::{Atom, Directions, Pole, Protocol, Sample, density, sampler};
use std::f64::consts::FRAC_1_SQRT_2;

pub fn suspects() -> Vec<Suspect> {
    vec![
        set_of_refraction(),
        schlick_power(),
        direction_of_itself(),
        squared_difference(),
        mirrored_back(),
        signed_cosine(),
        determinant(),
        median_pixel(),
    ]
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
        printed: "refracted where (1 − (eᵢ·n)²)/nᵣ² > 1",
        right: "refracted where (1 − (eᵢ·n)²)/nᵣ² ≤ 1",
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
        title: "(1 − e·n)² for 1 − (e·n)²",
        report: "second report",
        nature: Nature::Print,
        printed: "refracted cosine √(1 − (1 − eᵢ·n)²/nᵣ²)",
        right: "refracted cosine √(1 − (1 − (eᵢ·n)²)/nᵣ²)",
        test: "length of the refracted direction, at every angle from both sides",
        error_in_picture: leaves(printed) / leaves(right) - 1.0,
        error_of: "light that leaves glass",
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

fn mirrored_back() -> Suspect {
    // The tangential parts of a direction and its reflection are opposite.
    let law = |reflected: fn(f64) -> f64| {
        move |cos: f64, _: f64| {
            let sin = (1.0 - cos * cos).sqrt();
            (reflected(sin) + sin).abs()
        }
    };
    let right = |sin: f64| -sin;
    let printed = reflected_sine_without_sign;
    let angle = |reflected: fn(f64) -> f64| curve(0.0, 90.0, |a| reflected(a.to_radians().sin()).asin().to_degrees());
    // A viewer at 45° in a dark half-space looks at a mirror that should show the bright half-space opposite.
    let opposite = |reflected: fn(f64) -> f64| f64::from(u8::from(reflected(FRAC_1_SQRT_2) < 0.0));
    let erratum = Erratum {
        title: "reflection without signs",
        report: "second report",
        nature: Nature::Print,
        printed: "eᵢ = the components of eᵣ, without a sign",
        right: "eᵢ = those of −eᵣ along the surface, that of eᵣ along n",
        test: "law of reflection at every angle",
        error_in_picture: opposite(printed) / opposite(right) - 1.0,
        error_of: "light of the opposite side in a mirror",
        curves: ErratumCurves {
            x: "/{θ}ᵣ (degrees)",
            every: 30.0,
            y: "/{θ}ᵢ (degrees)",
            printed: angle(printed),
            right: angle(right),
            scattered: false,
        },
        ..Erratum::default()
    };
    let what = "tangential parts that differ from the law of reflection by up to";
    let case = |name: &str, reflected| at_all_angles(name, what, law(reflected));
    (erratum, [case("signs/printed", printed), case("signs/right", right)])
}

fn signed_cosine() -> Suspect {
    // A BSDF of 1/|cos| sends back the light of a mirror: times |cos|, it is 1. From inside, the cosine with n is negative.
    let wrong = |reciprocal: fn(f64) -> f64| {
        move |cos: f64, eta: f64| {
            let signed = if eta < 1.0 { -cos } else { cos };
            (reciprocal(signed) * cos - 1.0).abs()
        }
    };
    let printed = reciprocal_of_signed_cosine;
    let right = |cos: f64| 1.0 / cos.abs();
    let at = |reciprocal: fn(f64) -> f64| {
        curve(5.0, 175.0, |degrees| {
            let cos = degrees.to_radians().cos();
            if cos.abs() < 0.05 { f64::NAN } else { reciprocal(cos) * cos.abs() }
        })
    };
    let erratum = Erratum {
        title: "the cosine without modulus",
        report: "second report",
        nature: Nature::Print,
        printed: "R/(eᵢ·n) and T/(nᵣ² (eᵢ·n))",
        right: "the same with |eᵢ·n|",
        test: "light of a perfect reflector, at every angle from both sides",
        error_in_picture: printed(-1.0) / right(-1.0) - 1.0,
        error_of: "light reflected inside",
        curves: ErratumCurves {
            x: "angle with /{n} (degrees)",
            every: 45.0,
            y: "reflected light",
            printed: at(printed),
            right: at(right),
            scattered: false,
        },
        ..Erratum::default()
    };
    let what = "reflected light is wrong by up to";
    let case = |name: &str, reciprocal| at_all_angles(name, what, wrong(reciprocal));
    (erratum, [case("modulus/printed", printed), case("modulus/right", right)])
}

fn determinant() -> Suspect {
    /// Half the width of a ring of half-vectors, in their cosine.
    const HALF: f64 = 1e-4;
    // A ring of half-vectors about the viewer is reflected to a ring of twice the angle: the probability of both is the same.
    let wrong = |pdf: fn(f64, f64) -> f64| {
        move |cos: f64, _: f64| {
            if !(HALF..=1.0 - HALF).contains(&cos) {
                return 0.0;
            }
            let twice = |cos: f64| (2.0 * cos.acos()).cos();
            let ring = (twice(cos + HALF) - twice(cos - HALF)) / (2.0 * HALF);
            (pdf(1.0, cos) * ring - 1.0).abs()
        }
    };
    let right = |d: f64, cos: f64| d / (4.0 * cos);
    let printed = reflected_pdf_by_determinant;
    let erratum = Erratum {
        title: "pdf by the determinant",
        report: "second report",
        nature: Nature::Print,
        printed: "p(eᵢ) = D det(∂eᵢ/∂h)",
        right: "p(eᵢ) = D/det(∂eᵢ/∂h), the determinant being 4 eᵣ·h",
        test: "probability of a ring of half-vectors and of the ring of their reflections, at every angle",
        error_in_picture: right(1.0, 1.0) / printed(1.0, 1.0) - 1.0,
        error_of: "light of smooth metal at 0°",
        curves: ErratumCurves {
            x: "angle of /{e}ᵣ and /{h} (degrees)",
            every: 30.0,
            y: "pdf over /{D}",
            printed: curve(0.0, 85.0, |a| printed(1.0, a.to_radians().cos())),
            right: curve(0.0, 85.0, |a| right(1.0, a.to_radians().cos())),
            scattered: false,
        },
        ..Erratum::default()
    };
    let what = "probabilities of both rings differ by up to a share of";
    let case = |name: &str, pdf| at_all_angles(name, what, wrong(pdf));
    (erratum, [case("determinant/printed", printed), case("determinant/right", right)])
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
