//! Flags for the scattering model: the correct formulas, approximations, the reports' conventions.

use crate::bsdf::{DielectricFresnel, NormalSampling};
use crate::errata::Conventions;
use crate::error::{Error, Result};
use crate::scene::ScatterModel;
use clap::{ArgAction, Args, ValueEnum};

/// Which formulas to use.
#[derive(Args)]
pub struct ModelArgs {
    /// Reflectance of glass: the Fresnel equations, or Schlick's approximation with the cosine on the less dense side
    #[arg(long, value_enum)]
    fresnel: Option<FresnelName>,
    /// How rough metal samples directions: by the visible normals (VNDF), by all normals (NDF), or uniformly over the
    /// hemisphere
    #[arg(long, value_enum)]
    normals: Option<NormalsName>,
    /// The correct formulas (exact), all conventions of the second report's renderer (report), or single ones of
    /// them, with commas between them
    #[arg(long, value_enum, value_delimiter = ',', action = ArgAction::Set, value_name = "NAME[,NAME...]", default_value = "exact")]
    model: Vec<ModelName>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FresnelName {
    Exact,
    Schlick,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum NormalsName {
    Visible,
    All,
    Hemisphere,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ModelName {
    /// The correct formulas
    Exact,
    /// All conventions below together
    Report,
    /// Metal: reflectance at the angle with the shading normal, not the microfacet normal; f(wo, wi) and f(wi, wo) then
    /// differ by up to 2 % (blue of silver), 13 % (aluminium), 82 % (copper), 105 % (iron), 148 % (gold)
    FresnelAtNormal,
    /// Metal: a reflectance that drops a term, with an error below 0.007 for gold and copper
    ApproximateFresnel,
    /// Glass: Schlick's approximation with the cosine on the ray's own side; inside glass of 1.5 at 40 degrees it
    /// reflects 0.041 instead of 0.245, and 0.573 instead of 0.596 of uniform light from inside
    SingleCosineSchlick,
    /// Metal: pi instead of its root in Lambda, which is then wrong by a factor of up to 1.77 (grazing), so that G exceeds 1
    /// (up to 1.051)
    LambdaPi,
    /// Radiance from rectangular area lights divided by the distance, not its square: 0.9 to 1.8 times the light in the
    /// report's Cornell box
    InverseDistance,
}

impl ModelArgs {
    /// The model that the flags select; an error where two of them exclude each other.
    pub fn model(&self) -> Result<ScatterModel> {
        let mut model = ScatterModel {
            normals: match self.normals.unwrap_or(NormalsName::Visible) {
                NormalsName::Visible => NormalSampling::Vndf,
                NormalsName::All => NormalSampling::Ndf,
                NormalsName::Hemisphere => NormalSampling::Hemisphere,
            },
            dielectric: match self.fresnel.unwrap_or(FresnelName::Exact) {
                FresnelName::Exact => DielectricFresnel::Exact,
                FresnelName::Schlick => DielectricFresnel::Schlick,
            },
            ..ScatterModel::default()
        };
        if self.model.contains(&ModelName::Exact) && self.model.iter().any(|name| *name != ModelName::Exact) {
            return Err(Error::parameter("model", "exact excludes the reports' conventions"));
        }
        let all = self.model.contains(&ModelName::Report);
        let has = |name| all || self.model.contains(&name);
        let conventions = Conventions {
            fresnel_at_normal: has(ModelName::FresnelAtNormal),
            approximate_fresnel: has(ModelName::ApproximateFresnel),
            single_cosine_schlick: has(ModelName::SingleCosineSchlick),
            lambda_with_pi: has(ModelName::LambdaPi),
            inverse_distance: has(ModelName::InverseDistance),
            ..Conventions::CORRECT
        };
        model.conventions = conventions;
        if conventions.change_metal() && !matches!(self.normals, None | Some(NormalsName::All)) {
            return Err(Error::parameter("normals", "the report's metal samples directions by all normals")
                .with_hint("omit `normals`, or the conventions for metal"));
        }
        if conventions.single_cosine_schlick && self.fresnel.is_some() {
            return Err(Error::parameter("fresnel", "the report's glass has its own reflectance")
                .with_hint("omit `fresnel`, or single-cosine-schlick"));
        }
        Ok(model)
    }

    /// The names of the model, for the image's metadata.
    pub fn names(&self) -> String {
        let name = |value: &ModelName| value.to_possible_value().map(|v| v.get_name().to_owned());
        self.model.iter().filter_map(name).collect::<Vec<_>>().join(",")
    }
}
