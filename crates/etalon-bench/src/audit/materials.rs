//! The reports' glass: Schlick's polynomial of the incident cosine, inside as outside. The second report's metal: the pdf that it
//! prints, its Fresnel term, its shadowing, its approximation of Fresnel's equations.

use super::{ETA, Erratum, ErratumCurves, Nature, Suspect, curve, exact, mean_by_cosine};
use crate::validation::{Case, direction_density};
use etalon_core::bsdf::{
    ConductorFresnel, Dielectric, DielectricFresnel, ErrataConductor, Scatter, pdf_without_cosine,
};
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::errata::microfacet::{MetalErrors, lambda_with_pi};
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::optics::conductor::{fresnel, fresnel_approximate};
use etalon_core::optics::dielectric;
use etalon_core::optics::metals::{COPPER, METALS};
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::sampling::normals::SampleNormals;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::sampling::{hash, warp};
use etalon_stats::cubature::integrate;
use etalon_stats::{Atom, Directions, Grid, Mass, Point, Pole, Protocol, Sample, density, sampler};
use glam::DVec3;

/// Angle of incidence inside the glass in degrees, below the critical angle of 43.6°.
const THETA: f64 = 40.0;

pub fn glass() -> Suspect {
    let (sin, cos) = THETA.to_radians().sin_cos();
    let case = |name: &str, printed: bool| {
        Case::of(format!("audit/glass/{name}"), Directions::sphere(Pole::Z), move || {
            let (reflectance, transmittance, eta) = (Rgb::ONE, Rgb::ONE, ETA as f32);
            let fresnel = if printed { DielectricFresnel::SingleCosineSchlick } else { DielectricFresnel::Exact };
            let glass = Dielectric { reflectance, transmittance, eta, fresnel };
            let wo = DVec3::new(sin, 0.0, -cos).as_vec3();
            let draw = move |u: &[f64]| {
                glass.sample(wo, u[0] as f32, [0.5; 2]).map(|sample| Sample::atom(sample.wi.as_dvec3().to_array()))
            };
            let truth = dielectric::fresnel(cos, 1.0 / ETA);
            let reflected = truth.unpolarized();
            let atom = |point: [f64; 3], probability| Atom::new(point, probability);
            // Exact directions and probabilities of reflection and refraction.
            let atoms = vec![
                atom([-sin, 0.0, -cos], reflected),
                atom([-sin * ETA, 0.0, truth.cos_t.unwrap_or(0.0)], 1.0 - reflected),
            ];
            (sampler(1, draw), density(|_: Point| 0.0).with_atoms(atoms))
        })
    };
    let printed = |cos: f64| schlick_incident_cosine(cos, 1.0 / ETA);
    let right = |cos: f64| dielectric::fresnel(cos, 1.0 / ETA).unpolarized();
    let erratum = Erratum {
        title: "Schlick's cosine inside glass",
        report: "both reports",
        printed: "F₀ + (1 − F₀)(1 − cos θᵢ)⁵ on both sides",
        right: "Fresnel's equations; Schlick's cosine is that on the less dense side",
        test: "chi-square of reflected and refracted directions from inside at 40°",
        error_in_picture: mean_by_cosine(|cos| {
            if dielectric::eta_cos_t(cos, 1.0 / ETA).is_some() { printed(cos) } else { 1.0 }
        }) / mean_by_cosine(right)
            - 1.0,
        error_of: "light reflected inside",
        curves: Some(ErratumCurves {
            x: "/{θ} inside (degrees)",
            every: 30.0,
            y: "reflectance",
            printed: curve(0.0, 90.0, |a| printed(a.to_radians().cos())),
            right: curve(0.0, 90.0, |a| right(a.to_radians().cos())),
            scattered: false,
        }),
        ..Erratum::default()
    };
    (erratum, [case("printed", true), case("right", false)])
}

const ALPHA: f64 = 0.5;
/// The channel in which copper varies most with the angle.
const BLUE: usize = 2;
/// Pairs of directions on which reciprocity is tested.
const PAIRS: u32 = 1 << 14;
/// Relative difference of equal reflectances by rounding in f32.
const ROUNDING: f64 = 1e-4;
/// Smaller reflectances count as 0.
const FAINTEST: f64 = 1e-30;

pub fn metals() -> Result<Vec<Suspect>> {
    Ok(vec![printed_density()?, fresnel_at_normal()?, shadowing_with_pi()?, approximate_fresnel()])
}

/// The direction in the plane of incidence at that angle in degrees, to the far side of the normal where positive.
fn at(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(-sin, 0.0, cos.max(0.0))
}

/// The direction towards a viewer at that angle in degrees.
fn viewer(degrees: f64) -> DVec3 {
    let w = at(degrees);
    DVec3::new(-w.x, 0.0, w.z)
}

fn facet(wo: DVec3, wi: DVec3) -> DVec3 {
    (wo + wi).normalize()
}

/// ∫ f cos θᵢ over the hemisphere, for f in f64.
fn albedo(f: impl Fn(DVec3) -> f64 + Sync) -> Result<f64> {
    let reflected = direction_density(move |wi: DVec3| f(wi) * wi.z);
    let cells = Grid::equal([8, 8], None);
    Ok(integrate(&Directions::hemisphere(Pole::Z), &reflected, &cells)?.values.iter().sum())
}

/// D G₂/(4 cos θₒ cos θᵢ).
fn brdf(wo: DVec3, wi: DVec3) -> f64 {
    let facets = Beckmann::new(ALPHA);
    0.25 * facets.d(facet(wo, wi).to_array()) * facets.g2_over_cosines(wo.to_array(), wi.to_array())
}

fn metal(errors: MetalErrors) -> ErrataConductor {
    let fresnel = ConductorFresnel::new(COPPER.eta_rgb(), COPPER.k_rgb());
    ErrataConductor { distribution: Beckmann::new(ALPHA as f32), fresnel, errors }
}

fn printed_density() -> Result<Suspect> {
    const SEEN_AT: f64 = 30.0;
    let wo = viewer(SEEN_AT);
    let case = |name: &str, printed: bool| {
        Case::of(format!("audit/density/{name}"), Directions::hemisphere(Pole::Z), move || {
            let metal = metal(MetalErrors::ALL);
            let draw = move |u: &[f64]| {
                let sample = metal.sample(wo.as_vec3(), 0.0, [u[0] as f32, u[1] as f32])?;
                Some(Sample::new(sample.wi.as_dvec3().to_array()))
            };
            let pdf = move |wi: DVec3| {
                let (wo, wi) = (wo.as_vec3(), wi.as_vec3());
                f64::from(if printed { pdf_without_cosine(metal.distribution, wo, wi) } else { metal.pdf(wo, wi) })
            };
            (sampler(2, draw), direction_density(pdf).with_mass(Mass::AtMostOne))
        })
    };
    let facets = Beckmann::new(ALPHA);
    let right = move |wi: DVec3| {
        let m = facet(wo, wi);
        0.25 * facets.pdf_ndf(m.to_array()) / wo.dot(m)
    };
    // The estimator divides by the printed pdf: its mean has a factor cos θₘ.
    let lost = albedo(|wi| brdf(wo, wi) * facet(wo, wi).z)? / albedo(|wi| brdf(wo, wi))?;
    let erratum = Erratum {
        title: "pdf of facets without cos θₘ",
        report: "second report",
        printed: "p(ωᵢ) = D(m)/(4 ωₒ·m)",
        right: "p(ωᵢ) = D(m) cos θₘ/(4 ωₒ·m)",
        test: "chi-square of the report's own directions, α = 0.5 at 30°",
        error_in_picture: lost - 1.0,
        error_of: "albedo at 30°",
        curves: Some(ErratumCurves {
            x: "/{θ}_{i} (degrees)",
            every: 45.0,
            y: "pdf (1/sr)",
            printed: curve(-90.0, 90.0, |a| right(at(a)) / facet(wo, at(a)).z),
            right: curve(-90.0, 90.0, |a| right(at(a))),
            scattered: false,
        }),
        ..Erratum::default()
    };
    Ok((erratum, [case("printed", true), case("right", false)]))
}

fn fresnel_at_normal() -> Result<Suspect> {
    const SEEN_AT: f64 = 60.0;
    let wo = viewer(SEEN_AT);
    let case = |name: &str, at_normal: bool| {
        let metal = metal(MetalErrors { fresnel_at_normal: at_normal, ..MetalErrors::NONE });
        Case::new(format!("audit/reciprocity/{name}"), move |protocol: &Protocol, round| {
            let asymmetry = largest_asymmetry(&metal, hash::key([protocol.seed, round, 0]));
            let violation = (asymmetry > ROUNDING)
                .then(|| format!("f(ωₒ, ωᵢ) and f(ωᵢ, ωₒ) differ by up to {:.0} %", 100.0 * asymmetry));
            Ok(exact(violation, u64::from(PAIRS)))
        })
    };
    let reflectance = |cos: f64| fresnel(cos, COPPER.eta[BLUE], COPPER.k[BLUE]).unpolarized();
    let of_facet = move |wi: DVec3| reflectance(wo.dot(facet(wo, wi)));
    let changed = albedo(|wi| brdf(wo, wi) * reflectance(wi.z))? / albedo(|wi| brdf(wo, wi) * of_facet(wi))?;
    let erratum = Erratum {
        title: "Fresnel at the surface's normal, not the facet's",
        report: "second report",
        printed: "F(ωᵢ·n)",
        right: "F(ωᵢ·m)",
        test: "reciprocity f(ωₒ, ωᵢ) = f(ωᵢ, ωₒ) of copper, pair by pair",
        error_in_picture: changed - 1.0,
        error_of: "albedo at 60°, copper, blue",
        curves: Some(ErratumCurves {
            x: "/{θ}_{i} (degrees)",
            every: 45.0,
            y: "/{F}, blue of copper",
            printed: curve(-90.0, 90.0, |a| reflectance(at(a).z)),
            right: curve(-90.0, 90.0, |a| of_facet(at(a))),
            scattered: false,
        }),
        ..Erratum::default()
    };
    Ok((erratum, [case("printed", true), case("right", false)]))
}

/// The largest relative difference of f(wo, wi) and f(wi, wo) over random pairs.
fn largest_asymmetry(metal: &ErrataConductor, seed: u64) -> f64 {
    let pair = |i: u32| {
        let stream = Independent::new(seed, 0, i);
        let [wo, wi] = [0, 1].map(|d| warp::uniform_hemisphere(stream.pair(d)).as_vec3());
        let (there, back) = (metal.eval(wo, wi).as_dvec3(), metal.eval(wi, wo).as_dvec3());
        // Compare where both reflectances are well above 0.
        let smaller = there.min(back).min_element();
        if smaller > FAINTEST { ((there - back).abs() / there.min(back)).max_element() } else { 0.0 }
    };
    (0..PAIRS).map(pair).fold(0.0, f64::max)
}

fn shadowing_with_pi() -> Result<Suspect> {
    const SEEN_AT: f64 = 60.0;
    let facets = Beckmann::new(ALPHA);
    let lambda = move |w: DVec3| lambda_with_pi(w.z / (ALPHA * w.truncate().length()));
    let printed_g1 = move |w: DVec3| 1.0 / (1.0 + lambda(w));
    let wo = viewer(SEEN_AT);
    let case = |name: &str, printed: bool| {
        Case::of(format!("audit/shadowing/{name}"), Directions::hemisphere(Pole::Z), move || {
            let draw = move |u: &[f64]| Some(Sample::new(facets.sample_vndf(wo.to_array(), [u[0], u[1]])));
            let g1 = if printed { printed_g1(wo) } else { facets.g1(wo.to_array()) };
            (
                sampler(2, draw),
                direction_density(move |m: DVec3| facets.d(m.to_array()) * wo.dot(m).max(0.0) * g1 / wo.z),
            )
        })
    };
    let printed = albedo(|wi| {
        let g2 = 1.0 / (1.0 + lambda(wo) + lambda(wi));
        0.25 * facets.d(facet(wo, wi).to_array()) * g2 / (wo.z * wi.z)
    })?;
    let erratum = Erratum {
        title: "shadowing with π for √π",
        report: "second report (its course)",
        printed: "Λ = ½ (erf a − 1 + exp(−a²)/(a π))",
        right: "Λ = ½ (erf a − 1 + exp(−a²)/(a √π))",
        test: "integral and chi-square of the visible normals, α = 0.5 at 60°",
        error_in_picture: printed / albedo(|wi| brdf(wo, wi))? - 1.0,
        error_of: "albedo at 60°",
        curves: Some(ErratumCurves {
            x: "/{θ} (degrees)",
            every: 30.0,
            y: "/{G}_{1}",
            printed: curve(1.0, 89.9, |a| printed_g1(at(a))),
            right: curve(1.0, 89.9, |a| facets.g1(at(a).to_array())),
            scattered: false,
        }),
        ..Erratum::default()
    };
    Ok((erratum, [case("printed", true), case("right", false)]))
}

fn approximate_fresnel() -> Suspect {
    const ANGLES: u32 = 900;
    // f64 rounds what both ways of computing the exact reflectance have in common.
    const ROUNDING: f64 = 1e-12;
    let case = |name: &str, formula: fn(f64, f64, f64) -> f64| {
        Case::new(format!("audit/conductor/{name}"), move |_: &Protocol, _| {
            let indices = METALS.iter().flat_map(|metal| metal.eta.into_iter().zip(metal.k));
            let angles = |i: u32| (f64::from(i) * 90.0 / f64::from(ANGLES)).to_radians().cos().max(0.0);
            let errors = indices.flat_map(|(eta, k)| {
                (0..=ANGLES).map(move |i| (formula(angles(i), eta, k) - by_complex_root(angles(i), eta, k)).abs())
            });
            let largest = errors.fold(0.0, f64::max);
            let violation = (largest > ROUNDING).then(|| format!("reflectances differ by up to {largest:.4}"));
            Ok(exact(violation, 3 * METALS.len() as u64 * u64::from(ANGLES + 1)))
        })
    };
    let [printed, right]: [fn(f64, f64, f64) -> f64; 2] =
        [|c, eta, k| fresnel_approximate(c, eta, k).unpolarized(), |c, eta, k| fresnel(c, eta, k).unpolarized()];
    let (eta, k) = (COPPER.eta[BLUE], COPPER.k[BLUE]);
    let erratum = Erratum {
        title: "conductors approximated for ∣n∣² ≫ 1",
        report: "second report (its course)",
        nature: Nature::Approximation,
        printed: "sin² θ dropped against η² + k²",
        right: "Fresnel's equations of a complex index",
        test: "all metals at every angle, against complex arithmetic",
        error_in_picture: mean_by_cosine(|c| printed(c, eta, k)) / mean_by_cosine(|c| right(c, eta, k)) - 1.0,
        error_of: "albedo, copper, blue",
        curves: Some(ErratumCurves {
            x: "/{θ} (degrees)",
            every: 30.0,
            y: "/{R}, blue of copper",
            printed: curve(0.0, 90.0, |a| printed(a.to_radians().cos().max(0.0), eta, k)),
            right: curve(0.0, 90.0, |a| right(a.to_radians().cos().max(0.0), eta, k)),
            scattered: false,
        }),
        ..Erratum::default()
    };
    (erratum, [case("printed", printed), case("right", right)])
}

/// The reflectance of unpolarized light as the equations stand: the complex z = √((η + ik)² − sin² θ), r⊥ = (c − z)/(c + z) and
/// r∥ = (n²c − z)/(n²c + z).
fn by_complex_root(c: f64, eta: f64, k: f64) -> f64 {
    let n2 = [eta * eta - k * k, 2.0 * eta * k];
    let z2 = [n2[0] - (1.0 - c * c), n2[1]];
    let modulus = z2[0].hypot(z2[1]);
    let z = [((modulus + z2[0]) / 2.0).sqrt(), ((modulus - z2[0]) / 2.0).sqrt()];
    let ratio = |a: [f64; 2]| {
        let of = |sign: f64| (a[0] + sign * z[0]).powi(2) + (a[1] + sign * z[1]).powi(2);
        of(-1.0) / of(1.0)
    };
    0.5 * (ratio([c, 0.0]) + ratio([n2[0] * c, n2[1] * c]))
}
