//! Flags for the scattering model: the correct formulas, approximations, the reports' conventions.

use crate::bsdf::{DielectricFresnel, NormalSampling};
use crate::cli::values::choice;
use crate::errata::Conventions;
use crate::error::{Error, Result};
use crate::scene::ScatterModel;
use clap::{ArgAction, Args};

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
    /// Correct formulas, or conventions of the second report
    ///
    /// All of its conventions (report), or single ones with commas between them.
    #[arg(long, value_delimiter = ',', action = ArgAction::Set, value_name = "NAME,...", default_value = "exact",
          value_parser = choice(MODELS.iter().map(|model| (model.0, model.1, model))))]
    model: Vec<&'static Model>,
}

/// A value of `--model`: name, help and conventions.
type Model = (&'static str, &'static str, Conventions);

/// All of them.
static MODELS: [Model; 6] = [
    ("exact", "The correct formulas", Conventions::CORRECT),
    ("report", "All conventions below together", Conventions { truncated_tone: false, ..Conventions::SECOND_REPORT }),
    (
        "fresnel-at-normal",
        "Metal: reflectance at the angle with the shading normal, not the microfacet normal; f(wo, wi) and f(wi, wo) then \
         differ by up to 2 % (blue of silver), 13 % (aluminium), 82 % (copper), 105 % (iron), 148 % (gold)",
        Conventions { fresnel_at_normal: true, ..Conventions::CORRECT },
    ),
    (
        "approximate-fresnel",
        "Metal: a reflectance that drops a term, with an error below 0.007 for gold and copper",
        Conventions { approximate_fresnel: true, ..Conventions::CORRECT },
    ),
    (
        "single-cosine-schlick",
        "Glass: Schlick's approximation with the cosine on the ray's own side; inside glass of 1.5 at 40 degrees it \
         reflects 0.041 instead of 0.245, and 0.573 instead of 0.596 of uniform light from inside",
        Conventions { single_cosine_schlick: true, ..Conventions::CORRECT },
    ),
    (
        "lambda-pi",
        "Metal: pi instead of its root in Lambda, which is then wrong by a factor of up to 1.77 (grazing), so that G exceeds 1 \
         (up to 1.051)",
        Conventions { lambda_with_pi: true, ..Conventions::CORRECT },
    ),
];

impl ModelArgs {
    /// The model that the flags select; an error where two of them exclude each other.
    pub fn model(&self) -> Result<ScatterModel> {
        if self.model.len() > 1 && self.model.iter().any(|model| model.2 == Conventions::CORRECT) {
            return Err(Error::parameter("model", "exact excludes the reports' conventions"));
        }
        let has = |flag: fn(&Conventions) -> bool| self.model.iter().any(|model| flag(&model.2));
        let conventions = Conventions {
            fresnel_at_normal: has(|c| c.fresnel_at_normal),
            approximate_fresnel: has(|c| c.approximate_fresnel),
            single_cosine_schlick: has(|c| c.single_cosine_schlick),
            lambda_with_pi: has(|c| c.lambda_with_pi),
            ..Conventions::CORRECT
        };
        if conventions.change_metal() && !matches!(self.normals, None | Some(NormalSampling::Ndf)) {
            return Err(Error::parameter("normals", "the report's metal samples directions by all normals")
                .with_hint("omit `normals`, or the conventions for metal"));
        }
        if conventions.single_cosine_schlick && self.fresnel.is_some() {
            return Err(Error::parameter("fresnel", "the report's glass has its own reflectance")
                .with_hint("omit `fresnel`, or single-cosine-schlick"));
        }
        Ok(ScatterModel {
            normals: self.normals.unwrap_or_default(),
            dielectric: self.fresnel.unwrap_or_default(),
            conventions,
        })
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
