//! Whole BSDFs: values, weights, pdfs and energy of every BSDF of the registry, each against the others.
//!
//! Exact checks for many parameters and angles; those that integrate, or take samples, for fewer. Samples against the pdf are
//! tested by the family `bsdf`.

use super::super::case::Case;
use super::super::scattering::Scattering;
use super::super::whole;
use super::inputs::{DISTRIBUTIONS, towards};
use etalon_core::bsdf::{DielectricFresnel, NormalSampling};
use etalon_core::math::Rgb;
use etalon_core::optics::metals::GOLD;
use etalon_core::optics::microfacet::Distribution;
use etalon_core::scene::{Conductor, Dielectric, Material, ScatterModel};
use etalon_stats::Outcome;
use etalon_stats::bsdf::{Direction, Energy, same_light, same_values};
use std::sync::Arc;

/// A BSDF with its parameters.
struct Configuration {
    name: String,
    material: Material,
    model: ScatterModel,
    energy: Energy,
    /// Whether checks that integrate or sample are done too.
    light: bool,
}

impl Configuration {
    fn new(name: impl Into<String>, material: Material) -> Self {
        let model = ScatterModel::default();
        Self { name: name.into(), material, model, energy: Energy::AtMostOne, light: true }
    }

    fn scattering(&self) -> Scattering {
        Scattering::new(&self.material, self.model, self.energy)
    }
}

/// Angles in degrees, from both sides of the surface.
const DEGREES: [f64; 12] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99, 90.01, 91.0, 100.0, 120.0, 150.0, 180.0];
/// Those at which BSDFs are sampled and integrated.
const FEW_DEGREES: [f64; 3] = [25.0, 75.0, 140.0];

const ALPHAS: [f32; 6] = [1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0];
const ETAS: [f32; 5] = [1.0 / 2.4, 1.0 / 1.5, 1.05, 1.5, 2.4];

/// A metal without colour: channels that are equal are integrated once.
fn metal(alpha: [f32; 2], distribution: Distribution) -> Conductor {
    let (eta, k) = (Rgb::splat(0.5), Rgb::splat(2.5));
    Conductor { eta, k, alpha, distribution, two_sided: false, multiple_scattering: false }
}

fn gold(alpha: [f32; 2], distribution: Distribution) -> Conductor {
    Conductor { eta: GOLD.eta_rgb(), k: GOLD.k_rgb(), ..metal(alpha, distribution) }
}

/// A metal that reflects all light but 10⁻⁸.
fn lossless(alpha: f32, distribution: Distribution) -> Conductor {
    Conductor { eta: Rgb::ONE, k: Rgb::splat(2e4), ..metal([alpha; 2], distribution) }
}

/// All configurations.
fn configurations() -> Vec<Configuration> {
    let (reflectance, transmittance, albedo) = (Rgb::splat(0.9), Rgb::splat(0.8), Rgb::new(0.2, 0.5, 1.0));
    let clear = |eta| Material::Dielectric(Dielectric::clear(eta));
    let schlick = ScatterModel { dielectric: DielectricFresnel::Schlick, ..ScatterModel::default() };
    let erroneous = ScatterModel::SECOND_REPORT;
    let bounded = ScatterModel { normals: NormalSampling::Bounded, ..ScatterModel::default() };
    let lossy = Dielectric { reflectance, transmittance, ..Dielectric::clear(1.5) };
    let mixed = [(0.4, Material::Diffuse { albedo }), (0.6, Material::Conductor(metal([0.2; 2], Distribution::Ggx)))];
    let polished = [(0.5, Material::Diffuse { albedo }), (0.5, Material::Mirror { reflectance })];
    let conserved =
        |configuration: Configuration, error| Configuration { energy: Energy::Conserved(error), ..configuration };
    let mut all = vec![
        Configuration::new("diffuse", Material::Diffuse { albedo }),
        Configuration::new("mirror", Material::Mirror { reflectance }),
        Configuration::new("refraction", Material::Refraction { transmittance, eta: 1.5 }),
        conserved(Configuration::new("dielectric/1.5", clear(1.5)), 0.0),
        conserved(Configuration::new("dielectric/0.4", clear(0.4)), 0.0),
        Configuration::new("dielectric/lossy", Material::Dielectric(lossy)),
        Configuration { model: schlick, ..conserved(Configuration::new("dielectric/schlick", clear(1.5)), 0.0) },
        Configuration::new("smooth-conductor", Material::Conductor(gold([0.0; 2], Distribution::Ggx))),
        Configuration::new("coated-diffuse/1.5", Material::CoatedDiffuse { albedo, eta: 1.5 }),
        Configuration::new("coated-diffuse/2.4", Material::CoatedDiffuse { albedo, eta: 2.4 }),
        Configuration::new("mixture", Material::Mixture(mixed.into())),
        Configuration::new("mixture/mirror", Material::Mixture(polished.into())),
        Configuration {
            model: erroneous,
            energy: Energy::MayExceedOne("the report's shadowing term does"),
            ..Configuration::new("errata-conductor", Material::Conductor(gold([0.3; 2], Distribution::Beckmann)))
        },
    ];
    for (name, distribution) in DISTRIBUTIONS {
        for alpha in ALPHAS {
            let light = alpha == 0.1 || alpha == 0.5;
            let metal = Material::Conductor(metal([alpha; 2], distribution));
            all.push(Configuration { light, ..Configuration::new(format!("{name}/{alpha}"), metal.clone()) });
            if distribution == Distribution::Ggx {
                let name = format!("{name}/bounded/{alpha}");
                all.push(Configuration { light, model: bounded, ..Configuration::new(name, metal) });
            }
            for eta in ETAS {
                let light = [(0.1, 1.0 / 1.5), (0.5, 1.5)].contains(&(alpha, eta));
                let glass = Material::Dielectric(Dielectric::rough(eta, alpha, distribution));
                let name = format!("{name}-dielectric/{eta:.3}/{alpha}");
                all.push(Configuration { light, ..Configuration::new(name, glass) });
            }
        }
        let (alpha, brushed) = ([0.05, 0.4], metal([0.05, 0.4], distribution));
        let glass = Dielectric { alpha, distribution, ..Dielectric::clear(1.5) };
        all.push(Configuration::new(format!("{name}/anisotropic"), Material::Conductor(brushed)));
        // With multiple scattering a lossless metal reflects all light, to the error of its table.
        for alpha in [0.01, 0.3, 1.0] {
            let metal = Conductor { multiple_scattering: true, ..gold([alpha; 2], distribution) };
            let name = format!("compensated-{name}/{alpha}");
            all.push(Configuration { light: false, ..Configuration::new(name.clone(), Material::Conductor(metal)) });
            let white = Conductor { multiple_scattering: true, ..lossless(alpha, distribution) };
            let white = Configuration::new(format!("{name}/lossless"), Material::Conductor(white));
            all.push(conserved(white, 1e-3));
        }
        all.push(Configuration::new(format!("{name}-dielectric/anisotropic"), Material::Dielectric(glass)));
    }
    all
}

/// The directions at these angles, in no symmetric position to the tangents.
fn directions(degrees: &[f64]) -> Vec<Direction> {
    let turned = |&degrees: &f64| {
        let w = towards(degrees);
        glam::DVec3::new(0.8 * w.x, 0.6 * w.x, w.z).as_vec3().as_dvec3().to_array()
    };
    degrees.iter().map(turned).collect()
}

/// The cases. BSDFs are made when a case runs: some compute tables.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for configuration in configurations().into_iter().map(Arc::new) {
        let exact = Arc::clone(&configuration);
        cases.push(Case::new(format!("whole/{}/exact", configuration.name), move |protocol, round| {
            whole::exact(&exact.scattering(), &directions(&DEGREES), protocol, round)
        }));
        if configuration.light {
            // Conductors are black from below.
            let is_metal = matches!(configuration.material, Material::Conductor(_));
            let few_degrees = if is_metal { &FEW_DEGREES[..2] } else { &FEW_DEGREES };
            cases.push(Case::new(format!("whole/{}/light", configuration.name), move |protocol, round| {
                whole::light(&configuration.scattering(), &directions(few_degrees), protocol, round)
            }));
        }
    }
    cases.extend(limits());
    cases
}

/// Names in the registry of the BSDFs that are tested.
#[cfg(test)]
pub fn tested() -> std::collections::HashSet<&'static str> {
    configurations().iter().map(|configuration| configuration.scattering().bsdf.name()).collect()
}

/// Pairs that must agree: a rough boundary of α = 10⁻³ and a smooth one, to a few α; a lobe of weight 0 and none.
fn limits() -> Vec<Case> {
    const ALPHA: f32 = 1e-3;
    let mut cases = Vec::new();
    for (name, distribution) in DISTRIBUTIONS {
        let metal = |alpha| Material::Conductor(gold([alpha; 2], distribution));
        let rough = Material::Dielectric(Dielectric::rough(1.5, ALPHA, distribution));
        let smooth = Material::Dielectric(Dielectric::clear(1.5));
        let paint = Material::Diffuse { albedo: Rgb::splat(0.5) };
        let mixture = Material::Mixture([(1.0, paint.clone()), (0.0, metal(0.3))].into());
        cases.extend([
            limit(format!("whole/limit/smooth-dielectric/{name}"), [rough, smooth], Some(5.0 * ALPHA)),
            limit(format!("whole/limit/smooth-conductor/{name}"), [metal(ALPHA), metal(0.0)], Some(5.0 * ALPHA)),
            limit(format!("whole/limit/weight-of-zero/{name}"), [mixture, paint], None),
        ]);
    }
    cases
}

/// Compares two BSDFs by what they do to smooth light, or value by value.
fn limit(name: String, pair: [Material; 2], tolerance: Option<f32>) -> Case {
    Case::new(name, move |protocol, _| {
        let [a, b] = pair.clone().map(|material| Configuration::new("", material).scattering());
        let compare = |wo: Direction| match tolerance {
            Some(tolerance) => same_light(&a, &b, wo, f64::from(tolerance), protocol),
            None => same_values(&a, &b, wo, protocol),
        };
        let all = directions(&[0.0, 30.0, 70.0, 150.0]).into_iter().map(compare);
        let all = all.collect::<etalon_stats::Result<Vec<Outcome>>>()?.into_iter();
        Ok(all.reduce(|first, next| if first.violation.is_some() { first } else { next }).unwrap_or_default())
    })
}
