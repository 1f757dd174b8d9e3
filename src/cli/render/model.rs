//! Flags for the scattering model: the correct formulas, approximations, the reports' errors.

use crate::cli::values::choice;
use clap::{ArgAction, Args};
use etalon_core::bsdf::{DielectricFresnel, NormalSampling};
use etalon_core::errata::microfacet::MetalErrors;
use etalon_core::error::{Error, Result};
use etalon_core::scene::ScatterModel;

/// Which formulas to use.
#[derive(Args)]
#[command(next_help_heading = "Scattering model")]
pub struct ModelArgs {
    /// Reflectance of glass [default: exact]
    ///
    /// The Fresnel equations, or Schlick's approximation.
    ///
    /// Schlick's approximation has the cosine on the less dense side.
    #[arg(long, value_parser = choice([
        ("exact", "", DielectricFresnel::Exact),
        ("schlick", "", DielectricFresnel::Schlick),
    ]))]
    fresnel: Option<DielectricFresnel>,
    /// How rough metal samples directions [default: visible]
    ///
    /// By the visible normals (VNDF), by those of GGX that do not reflect below the surface (bounded VNDF), by all normals
    /// (NDF), or uniformly over the hemisphere.
    #[arg(long, value_parser = choice(NormalSampling::ALL.map(|normals| (normals.name(), "", normals))))]
    normals: Option<NormalSampling>,
    /// Correct formulas, or errors of the second report
    ///
    /// All of its errors (report), or single ones with commas between them.
    #[arg(long, value_delimiter = ',', action = ArgAction::Set, value_name = "NAME,...", default_value = "exact",
          value_parser = choice(MODELS.iter().map(|model| (model.0, model.1, model))))]
    model: Vec<&'static Model>,
}

/// A value of `--model`: name, help and errors.
type Model = (&'static str, &'static str, ScatterModel);

/// All of them.
static MODELS: [Model; 6] = [
    ("exact", "The correct formulas", ScatterModel::EXACT),
    ("report", "All errors below together", ScatterModel::SECOND_REPORT),
    (
        "fresnel-at-normal",
        "Metal: reflectance at the angle with the shading normal, not the microfacet normal; f(wo, wi) and f(wi, wo) then \
         differ by up to 2 % (blue of silver), 13 % (aluminium), 82 % (copper), 105 % (iron), 148 % (gold)",
        of_metal(MetalErrors { fresnel_at_normal: true, ..MetalErrors::NONE }),
    ),
    (
        "approximate-fresnel",
        "Metal: a reflectance that drops a term, with an error below 0.007 for gold and copper",
        of_metal(MetalErrors { approximate_fresnel: true, ..MetalErrors::NONE }),
    ),
    (
        "single-cosine-schlick",
        "Glass: Schlick's approximation with the cosine on the ray's own side; inside glass of 1.5 at 40 degrees it \
         reflects 0.041 instead of 0.245, and 0.573 instead of 0.596 of uniform light from inside",
        ScatterModel { dielectric: DielectricFresnel::SingleCosineSchlick, ..ScatterModel::EXACT },
    ),
    (
        "lambda-pi",
        "Metal: pi instead of its root in Lambda, which is then wrong by a factor of up to 1.77 (grazing), so that G exceeds 1 \
         (up to 1.051)",
        of_metal(MetalErrors { lambda_with_pi: true, ..MetalErrors::NONE }),
    ),
];

const fn of_metal(metal: MetalErrors) -> ScatterModel {
    ScatterModel { metal, ..ScatterModel::EXACT }
}

impl ModelArgs {
    /// The model that the flags select; an error where two of them exclude each other.
    pub fn model(&self) -> Result<ScatterModel> {
        if self.model.len() > 1 && self.model.iter().any(|model| model.2 == ScatterModel::EXACT) {
            return Err(Error::parameter("model", "exact excludes the report's errors"));
        }
        let has = |flag: fn(&ScatterModel) -> bool| self.model.iter().any(|model| flag(&model.2));
        let metal = MetalErrors {
            fresnel_at_normal: has(|model| model.metal.fresnel_at_normal),
            approximate_fresnel: has(|model| model.metal.approximate_fresnel),
            lambda_with_pi: has(|model| model.metal.lambda_with_pi),
        };
        if metal != MetalErrors::NONE && !matches!(self.normals, None | Some(NormalSampling::Ndf)) {
            return Err(Error::parameter("normals", "the report's metal samples directions by all normals")
                .with_hint("omit `normals`, or the errors of metal"));
        }
        let report = DielectricFresnel::SingleCosineSchlick;
        let has_its_glass = self.model.iter().any(|model| model.2.dielectric == report);
        if has_its_glass && self.fresnel.is_some() {
            return Err(Error::parameter("fresnel", "the report's glass has its own reflectance")
                .with_hint("omit `fresnel`, or single-cosine-schlick"));
        }
        let dielectric = if has_its_glass { report } else { self.fresnel.unwrap_or_default() };
        Ok(ScatterModel { normals: self.normals.unwrap_or_default(), dielectric, metal })
    }

    pub fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    pub fn has_fresnel(&self) -> bool {
        self.fresnel.is_some()
    }

    pub fn names(&self) -> String {
        self.model.iter().map(|model| model.0).collect::<Vec<_>>().join(",")
    }
}
