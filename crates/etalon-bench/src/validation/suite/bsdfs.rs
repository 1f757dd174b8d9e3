//! Directions that BSDFs scatter into: diffuse ones, rough conductors by every way to sample their normals and by other
//! errors, and materials with one or two directions (mirrors, polished metal, refraction, glass from both sides).
//!
//! Everything in f32 as renders do it, with random numbers of 24 bits; the pdfs are those by which renders divide. The
//! directions and probabilities of smooth materials are computed here from the laws of reflection, Snell and Fresnel, in
//! f64 and in their textbook form, independently of the materials' code.

use super::super::families::Scattering;
use super::{ALPHAS, DEGREES, DISTRIBUTIONS, boundary, bsdf, in_lanes, metal, short, towards};
use crate::validation::case::{Case, direction_density};
use etalon_core::bsdf::{Bsdf, BsdfSample, Mixture, NormalSampling, Scatter, families};
use etalon_core::math::Rgb;
use etalon_core::optics::metals::SILVER;
use etalon_core::optics::microfacet::Distribution;
use etalon_core::scene::{Conductor, Material, ScatterModel};
use etalon_render::probe::{
    Bsdfs, LANES, Lane, Scattered, TransportMode, at, eval_many, reverse_pdf_many, sample_cosine_hemisphere,
    sample_many, set,
};
use etalon_stats::bsdf::{Bsdf as _, Energy};
use etalon_stats::{Atom, Directions, Mass, Pole, Sample, sampler};
use glam::{DQuat, DVec3, Vec3};
use std::collections::HashSet;
use std::f64::consts::FRAC_1_PI;

/// The cases, each with its BSDF's name in the registry.
pub fn cases() -> Vec<(&'static str, Case)> {
    let mut cases: Vec<_> = [rough(), dielectric(), anisotropic(), layered(), smooth()].into_iter().flatten().collect();
    // Every other BSDF of the list, on both sides.
    let known: HashSet<&str> = cases.iter().map(|(bsdf, _)| *bsdf).collect();
    for (name, bsdf) in families().map(|family| (family.name, family.with(&family.defaults()))) {
        if known.contains(bsdf.name()) {
            continue;
        }
        for degrees in [0.0, 30.0, 60.0, 85.0] {
            for (side, wo) in [("outside", towards(degrees)), ("inside", -towards(degrees))] {
                let name = format!("bsdf/{name}/{side}/{degrees}");
                cases.push(with_found_atoms(name, bsdf.clone(), wo));
            }
        }
    }
    cases
}

/// Materials with a pdf. Every roughness meets half of the angles with visible normals, the other half with all normals; the other
/// distribution the other way round.
fn rough() -> Vec<(&'static str, Case)> {
    let mut cases = Vec::new();
    let half = Directions::hemisphere(Pole::Z);
    for (d, (name, _)) in DISTRIBUTIONS.into_iter().enumerate() {
        for (a, alpha) in ALPHAS.into_iter().enumerate() {
            for (t, degrees) in DEGREES.into_iter().enumerate() {
                let ways = [("all", NormalSampling::Ndf), ("visible", NormalSampling::Vndf)];
                let (how, normals) = ways[(a + t + d) % 2];
                let bsdf = metal(name, [alpha; 2]).with_normals(normals);
                let name = format!("bsdf/{name}/{how}/{alpha}/{degrees}");
                cases.push(scattered(name, half, bsdf, towards(degrees), Mass::AtMostOne));
            }
        }
        // Uniform over the hemisphere for every roughness.
        for degrees in DEGREES {
            let bsdf = metal(name, [0.25; 2]).with_normals(NormalSampling::Hemisphere);
            let name = format!("bsdf/{name}/hemisphere/0.25/{degrees}");
            cases.push(scattered(name, half, bsdf, towards(degrees), Mass::Exactly(1.0)));
        }
    }
    for alpha in [0.005, 0.05, 0.25, 0.5] {
        for degrees in [0.0, 40.0, 80.0] {
            let bsdf = bsdf("errata-conductor", &[alpha, SILVER.eta[0], SILVER.k[0]]);
            let name = format!("bsdf/report-metal/{alpha}/{degrees}");
            cases.push(scattered(name, half, bsdf, towards(degrees), Mass::AtMostOne));
        }
    }
    let diffuse = bsdf("diffuse", &[0.5]);
    for (side, wo) in [("outside", towards(60.0)), ("inside", -towards(60.0))] {
        let sphere = Directions::sphere(Pole::Z);
        cases.push(scattered(format!("bsdf/diffuse/{side}"), sphere, diffuse.clone(), wo, Mass::Exactly(1.0)));
    }
    cases.extend([("up", DVec3::Z), ("slanted", DVec3::new(0.48, -0.6, 0.64))].map(|(n, w)| diffuse_in_lanes(n, w)));
    cases
}

/// Rough dielectrics: every roughness at half of the angles, the other distribution at the other half, from both sides, the medium
/// on the far side being denser or not.
fn dielectric() -> Vec<(&'static str, Case)> {
    let mut cases = Vec::new();
    let sphere = Directions::sphere(Pole::Z);
    for (d, (name, _)) in DISTRIBUTIONS.into_iter().enumerate() {
        for (a, alpha) in ALPHAS.into_iter().enumerate() {
            for (t, degrees) in DEGREES.into_iter().enumerate().filter(|(t, _)| (a + t + d) % 2 == 0) {
                // Each roughness and each angle meets several of these.
                let sides =
                    [(1.5, "outside"), (1.5, "inside"), (2.4, "outside"), (1.0 / 2.4, "outside"), (2.4, "inside")];
                // Light that a less dense medium refracts at grazing angles leaves in a sliver at the horizon, over which the
                // integral of the pdf is not known well enough.
                let (eta, side) = match sides[(a + t + 2 * d) % sides.len()] {
                    (eta, "outside") if eta < 1.0 && degrees > 89.5 => (1.5, "outside"),
                    other => other,
                };
                let wo = if side == "inside" { -towards(degrees) } else { towards(degrees) };
                let bsdf = boundary(name, [alpha; 2], eta);
                let name = format!("bsdf/{name}-glass/{alpha}/{eta:.3}/{side}/{degrees}");
                cases.push(scattered(name, sphere, bsdf, wo, Mass::AtMostOne));
            }
        }
        // Indices that differ little.
        for (alpha, eta) in [(0.1, 1.01), (0.5, 1.001), (0.5, 0.99)] {
            let bsdf = boundary(name, [alpha; 2], eta);
            let name = format!("bsdf/{name}-glass/{alpha}/{eta}/outside/50");
            cases.push(scattered(name, sphere, bsdf, towards(50.0), Mass::AtMostOne));
        }
    }
    cases
}

/// Metals and dielectrics of different widths along x and y, seen from an azimuth between; bounded visible normals.
fn anisotropic() -> Vec<(&'static str, Case)> {
    let mut cases = Vec::new();
    let (half, sphere) = (Directions::hemisphere(Pole::Z), Directions::sphere(Pole::Z));
    let ways = [("visible", NormalSampling::Vndf), ("all", NormalSampling::Ndf)];
    let turned = |degrees| DQuat::from_rotation_z(0.7) * towards(degrees);
    let bounded = |alpha| metal("ggx", alpha).with_normals(NormalSampling::Bounded);
    for (alpha, angles) in [([0.1, 0.5], [0.0, 60.0]), ([1.0, 0.05], [60.0, 89.0]), ([1e-3, 0.3], [60.0, 89.0])] {
        let [ax, ay] = alpha;
        for (degrees, (how, normals)) in angles.into_iter().zip(ways) {
            for (name, _) in DISTRIBUTIONS {
                let tested = format!("bsdf/{name}/{how}/{ax}-{ay}/{degrees}");
                let bsdf = metal(name, alpha).with_normals(normals);
                cases.push(scattered(tested, half, bsdf, turned(degrees), Mass::AtMostOne));
                let tested = format!("bsdf/{name}-glass/{ax}-{ay}/1.5/outside/{degrees}");
                let bsdf = boundary(name, alpha, 1.5);
                cases.push(scattered(tested, sphere, bsdf, turned(degrees), Mass::AtMostOne));
            }
            let name = format!("bsdf/ggx/bounded/{ax}-{ay}/{degrees}");
            cases.push(scattered(name, half, bounded(alpha), turned(degrees), Mass::AtMostOne));
        }
    }
    for alpha in ALPHAS {
        let bsdf = bounded([alpha; 2]);
        cases.push(scattered(format!("bsdf/ggx/bounded/{alpha}/80"), half, bsdf, towards(80.0), Mass::AtMostOne));
    }
    cases
}

/// Metals with multiple scattering, coated diffuse surfaces, mixtures.
fn layered() -> Vec<(&'static str, Case)> {
    let mut cases = Vec::new();
    let (half, sphere) = (Directions::hemisphere(Pole::Z), Directions::sphere(Pole::Z));
    let model = ScatterModel::default();
    for (name, distribution) in DISTRIBUTIONS {
        let registered = match distribution {
            Distribution::Beckmann => "compensated-beckmann",
            Distribution::Ggx => "compensated-ggx",
        };
        for (alpha, angles) in [([0.1, 0.1], [60.0, 89.0]), ([1.0, 1.0], [0.0, 80.0]), ([0.1, 0.6], [40.0, 89.0])] {
            for degrees in angles {
                let metal = Conductor::new(SILVER.eta_rgb(), SILVER.k_rgb(), 0.0, distribution);
                let alpha = alpha.map(|alpha: f64| alpha as f32);
                // It computes a table.
                let make =
                    move || Material::Conductor(Conductor { alpha, multiple_scattering: true, ..metal }).bsdf(model);
                let name = format!("bsdf/{name}/multiple/{}-{}/{degrees}", alpha[0], alpha[1]);
                cases.push((registered, made_when_run(name, half, make, towards(degrees), Mass::AtMostOne)));
            }
        }
    }
    let coat = bsdf("coated-diffuse", &[0.5, ETA]);
    for degrees in OUTSIDE {
        for (side, wo) in [("outside", towards(degrees)), ("inside", -towards(degrees))] {
            let name = format!("bsdf/coated-diffuse/{side}/{degrees}");
            cases.push(with_mirror(name, coat.clone(), wo, 0.5));
        }
    }
    let diffuse = || bsdf("diffuse", &[0.5]);
    let mix = |parts: [(f32, Bsdf); 2]| Bsdf::Mixture(Mixture::new(parts));
    cases.push(scattered(
        "bsdf/mixture/diffuse-metal".into(),
        half,
        mix([(0.3, diffuse()), (0.6, metal("beckmann", [0.3; 2]))]),
        towards(60.0),
        Mass::AtMostOne,
    ));
    cases.push(scattered(
        "bsdf/mixture/glass-glass".into(),
        sphere,
        mix([(0.5, boundary("ggx", [0.2; 2], 1.5)), (0.5, boundary("ggx", [0.5; 2], 2.0))]),
        towards(40.0),
        Mass::AtMostOne,
    ));
    cases.push(with_mirror(
        "bsdf/mixture/mirror-diffuse".into(),
        mix([(0.3, bsdf("mirror", &[1.0])), (0.6, diffuse())]),
        towards(60.0),
        1.0,
    ));
    cases
}

/// A BSDF that reflects diffusely, and into the mirror direction with a probability which is that of a coat on a base of
/// this albedo for light of `ETA`, or a third for an albedo of 1.
fn with_mirror(name: String, bsdf: Bsdf, wo: DVec3, albedo: f64) -> (&'static str, Case) {
    with_atoms(name, bsdf, wo, move |exact| {
        let probability = if albedo < 1.0 { coat_probability(exact.z.abs(), albedo) } else { 1.0 / 3.0 };
        (vec![reflected(exact, probability)], Mass::Exactly(1.0))
    })
}

/// F over F and what the base reflects through the coat, by sums over angles in f64.
fn coat_probability(cos: f64, albedo: f64) -> f64 {
    let n = 20_000;
    let term = |i: i32| {
        let z = (f64::from(i) + 0.5) / f64::from(n);
        2.0 * z * fresnel(DVec3::new((1.0 - z * z).sqrt(), 0.0, -z)) / f64::from(n)
    };
    let inside: f64 = (0..n).map(term).sum();
    let f = fresnel(DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos));
    let base = (1.0 - f) * (1.0 - inside) * albedo / (1.0 - albedo * inside);
    f / (f + base)
}

/// One sample in this number is compared, to the last bit, with that of the scalar code.
const COMPARED: usize = 8;

/// The directions that `bsdf` samples for `wo`, with the BSDF's name in the registry.
fn scattered(name: String, domain: Directions, bsdf: Bsdf, wo: DVec3, mass: Mass) -> (&'static str, Case) {
    (bsdf.name(), made_when_run(name, domain, move || bsdf.clone(), wo, mass))
}

/// The directions that the BSDF samples for `wo`, as the kernel samples them: in lanes.
fn made_when_run(
    name: String,
    domain: Directions,
    make: impl Fn() -> Bsdf + Send + Sync + 'static,
    wo: DVec3,
    mass: Mass,
) -> Case {
    let wo: Vec3 = wo.as_vec3();
    Case::of(name, domain, move || {
        let bsdf = make();
        let of_pdf = bsdf.clone();
        let views = wo.to_array().map(|x| [x; LANES]);
        let draw = move |[choice, u]: &[[Lane; 2]; 2], count| {
            let mut out = Scattered::default();
            let (bsdfs, mode) = (Bsdfs::Same(&bsdf), TransportMode::Radiance);
            sample_many(bsdfs, mode, &views, [&choice[0], &u[0], &u[1]], count, &mut out);
            let of_lane = |i| {
                let sample = out.sample(i)?;
                if i % COMPARED > 0 {
                    return Some((sample, true));
                }
                let scalar = bsdf.sample(wo, choice[0][i], [u[0][i], u[1][i]]);
                // Black samples are left out of the lanes, but not of the scalar samples.
                let agrees = scalar == Some(sample) || scalar.is_some_and(|s| s.weight == Rgb::ZERO);
                Some((sample, agrees))
            };
            let samples: Vec<_> = (0..count).map(of_lane).collect();
            // The values and pdfs of these directions, also in lanes.
            for (i, (sample, _)) in samples.iter().enumerate().filter_map(|(i, s)| Some((i, s.as_ref()?))) {
                set(&mut out.wi, i, sample.wi);
            }
            eval_many(bsdfs, &views, count, &mut out);
            reverse_pdf_many(bsdfs, &views, count, &mut out);
            let tested = |(i, found): (usize, Option<(BsdfSample, bool)>)| {
                let (sample, mut agrees) = found?;
                if i % COMPARED == 0 {
                    agrees &= (at(&out.weight, i), out.pdf[i]) == bsdf.eval_pdf(wo, sample.wi);
                    agrees &= out.reverse_pdf[i] == bsdf.pdf(sample.wi, wo);
                }
                let pdf = if agrees { f64::from(sample.pdf) } else { f64::NAN };
                Some(Sample::with_pdf(sample.wi.as_dvec3().to_array(), pdf))
            };
            samples.into_iter().enumerate().map(tested).collect()
        };
        let pdf = move |wi: DVec3| f64::from(of_pdf.pdf(wo, wi.as_vec3()));
        (in_lanes(draw), direction_density(pdf).with_mass(mass))
    })
}

/// Directions in which the kernel lets paths continue at diffuse surfaces.
fn diffuse_in_lanes(name: &str, normal: DVec3) -> (&'static str, Case) {
    let case = Case::of(format!("bsdf/diffuse/lanes-{name}"), Directions::sphere(Pole::Z), move || {
        let draw = move |[u]: &[[Lane; 2]; 1], count| {
            let normals = normal.as_vec3().to_array().map(|axis| [axis; LANES]);
            let mut wi = [[0.0; LANES]; 3];
            sample_cosine_hemisphere(&normals, u, count, &mut wi);
            (0..count).map(|i| Some(Sample::new(at(&wi, i).as_dvec3().to_array()))).collect()
        };
        // Rounding may move directions below the surface.
        let pdf = move |wi: DVec3| (wi.dot(normal).max(0.0)) * FRAC_1_PI;
        (in_lanes(draw), direction_density(pdf))
    });
    ("diffuse", case)
}

/// The glass of the tests, and angles through its critical one of 41.81 degrees inside.
const ETA: f64 = 1.5;
const INSIDE: [f64; 7] = [0.0, 20.0, 35.0, 41.0, 41.7, 42.0, 80.0];
const OUTSIDE: [f64; 5] = [0.0, 30.0, 60.0, 85.0, 89.9];

/// Materials without one.
fn smooth() -> Vec<(&'static str, Case)> {
    let (mirror, polished) = (bsdf("mirror", &[1.0]), bsdf("smooth-conductor", &[1.0, 3.0]));
    let (glass, refraction) = (bsdf("dielectric", &[ETA]), bsdf("refraction", &[1.0, ETA]));
    let mut cases = vec![
        in_atoms("bsdf/mirror/outside".into(), mirror.clone(), towards(60.0), |wo| vec![reflected(wo, 1.0)]),
        in_atoms("bsdf/mirror/inside".into(), mirror, -towards(60.0), |wo| vec![reflected(wo, 1.0)]),
        in_atoms("bsdf/polished-metal".into(), polished, towards(60.0), |wo| vec![reflected(wo, 1.0)]),
    ];
    let outside = OUTSIDE.map(|degrees| ("outside", degrees, towards(degrees)));
    let inside = INSIDE.map(|degrees| ("inside", degrees, -towards(degrees)));
    for (side, degrees, wo) in outside.into_iter().chain(inside) {
        cases.push(in_atoms(format!("bsdf/glass/{side}/{degrees}"), glass.clone(), wo, |wo| {
            let r = fresnel(wo);
            let passing = refracted(wo).map(|wt| Atom::new(wt.to_array(), 1.0 - r));
            [reflected(wo, r)].into_iter().chain(passing).collect()
        }));
        // Beyond the critical angle there must be no samples.
        cases.push(in_atoms(format!("bsdf/refraction/{side}/{degrees}"), refraction.clone(), wo, |wo| {
            refracted(wo).map(|wt| Atom::new(wt.to_array(), 1.0)).into_iter().collect()
        }));
    }
    cases
}

fn reflected(wo: DVec3, probability: f64) -> Atom {
    Atom::new([-wo.x, -wo.y, wo.z], probability)
}

/// Index of refraction of the far side over that of `wo`'s.
fn eta_from(wo: DVec3) -> f64 {
    if wo.z < 0.0 { 1.0 / ETA } else { ETA }
}

/// By Snell's law; `None` beyond the critical angle.
fn refracted(wo: DVec3) -> Option<DVec3> {
    let eta = eta_from(wo);
    let sin = wo.x.hypot(wo.y) / eta;
    (sin < 1.0).then(|| DVec3::new(-wo.x / eta, -wo.y / eta, (1.0 - sin * sin).sqrt().copysign(-wo.z)))
}

/// The mean of r∥² and r⊥² by Fresnel's equations.
fn fresnel(wo: DVec3) -> f64 {
    let Some(wt) = refracted(wo) else { return 1.0 };
    let (eta, cos, cos_t) = (eta_from(wo), wo.z.abs(), wt.z.abs());
    let parallel = (eta * cos - cos_t) / (eta * cos + cos_t);
    let perpendicular = (cos - eta * cos_t) / (cos + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// The directions that `bsdf` samples for `wo`: must be the `atoms` for the direction rounded to f32.
fn in_atoms(name: String, bsdf: Bsdf, wo: DVec3, atoms: fn(DVec3) -> Vec<Atom>) -> (&'static str, Case) {
    with_atoms(name, bsdf, wo, move |exact| {
        let atoms = atoms(exact);
        let mass = atoms.iter().map(|atom| atom.probability).sum();
        (atoms, Mass::Exactly(mass))
    })
}

/// The directions that `bsdf` samples for `wo`, its delta lobes with the probabilities that it declares.
fn with_found_atoms(name: String, bsdf: Bsdf, wo: DVec3) -> (&'static str, Case) {
    if bsdf.lobes().iter().all(|lobe| !lobe.is_delta()) {
        return scattered(name, Directions::sphere(Pole::Z), bsdf, wo, Mass::AtMostOne);
    }
    let scattering = Scattering::new(bsdf.clone(), Energy::AtMostOne);
    with_atoms(name, bsdf, wo, move |exact| {
        let lobes = scattering.delta_lobes(exact.to_array()).into_iter();
        (lobes.map(|lobe| Atom::new(lobe.wi, lobe.probability)).collect(), Mass::AtMostOne)
    })
}

/// The directions that `bsdf` samples for `wo`, with the atoms and the mass that `law` has for the direction rounded to f32.
fn with_atoms(
    name: String,
    bsdf: Bsdf,
    wo: DVec3,
    law: impl Fn(DVec3) -> (Vec<Atom>, Mass) + Send + Sync + 'static,
) -> (&'static str, Case) {
    let wo: Vec3 = wo.as_vec3();
    let registered = bsdf.name();
    let case = Case::of(name, Directions::sphere(Pole::Z), move || {
        let (bsdf, of_pdf) = (bsdf.clone(), bsdf.clone());
        let draw = move |u: &[f64]| {
            let sample = bsdf.sample(wo, short(u[0]), [short(u[1]), short(u[2])])?;
            let wi = sample.wi.as_dvec3().to_array();
            Some(if sample.is_delta() {
                Sample { atom: true, ..Sample::new(wi) }
            } else {
                Sample::with_pdf(wi, f64::from(sample.pdf))
            })
        };
        let pdf = move |wi: DVec3| f64::from(of_pdf.pdf(wo, wi.as_vec3()));
        let (atoms, mass) = law(wo.as_dvec3());
        (sampler(3, draw), direction_density(pdf).with_mass(mass).with_atoms(atoms))
    });
    (registered, case)
}
