//! The registry of sampling strategies: their names, and what each asks of the renderer.

use crate::bsdf::Normals;
use crate::envmap::cut::Split;
use crate::error::{Error, Result};
use crate::render::{LightDensity, RegionCount, Sampling, Settings};
use crate::sampling::stream::StreamKind;
use crate::scene::Scene;
use serde::Serialize;
use std::str::FromStr;

/// A sampling strategy by its name: one of [`METHODS`], then any of [`SUFFIXES`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Strategy {
    /// As it was given.
    pub name: String,
    sampling: Sampling,
    density: LightDensity,
    stream: StreamKind,
    normals: Normals,
}

impl From<Strategy> for String {
    fn from(strategy: Strategy) -> Self {
        strategy.name
    }
}

/// A way of choosing directions towards the light.
pub struct Method {
    /// Its name; one that ends in `-K` is followed by a number of regions.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    sampling: Sampling,
    density: Density,
}

/// What directions towards an environment are sampled in proportion to.
enum Density {
    /// As the renderer names it. [`LightDensity::Map`] also stands for "as the lights are" in a scene without a map.
    Of(LightDensity),
    /// By a cut of the map into so many regions.
    Regions(fn(RegionCount) -> LightDensity),
}

/// All ways of choosing directions. Samplers of environment maps enter here and nowhere else in this study.
pub const METHODS: [Method; 10] = [
    Method {
        name: "light",
        about: "by the light: the environment's radiance, the solid angles of area lights",
        sampling: Sampling::Light,
        density: Density::Of(LightDensity::Map),
    },
    Method {
        name: "light-cosine",
        about: "the same, the environment's radiance times the cosine",
        sampling: Sampling::Light,
        density: Density::Of(LightDensity::Cosine),
    },
    Method {
        name: "bsdf",
        about: "by the material (cosine at diffuse surfaces)",
        sampling: Sampling::Bsdf,
        density: Density::Of(LightDensity::Map),
    },
    Method {
        name: "hemisphere",
        about: "uniformly over the hemisphere",
        sampling: Sampling::Hemisphere,
        density: Density::Of(LightDensity::Map),
    },
    Method {
        name: "mis",
        about: "light and bsdf by multiple importance sampling; caustics by light tracing",
        sampling: Sampling::Mis,
        density: Density::Of(LightDensity::Map),
    },
    Method {
        name: "mis-cosine",
        about: "light-cosine and bsdf; at diffuse surfaces, light-cosine alone",
        sampling: Sampling::Mis,
        density: Density::Of(LightDensity::Cosine),
    },
    Method {
        name: "mis-compensated",
        about: "the same as mis, the environment's radiance minus its mean",
        sampling: Sampling::Mis,
        density: Density::Of(LightDensity::Compensated),
    },
    Method {
        name: "strata-K",
        about: "an environment's region by its energy, uniformly within: without bias",
        sampling: Sampling::Light,
        density: Density::Regions(LightDensity::Strata),
    },
    Method {
        name: "median-cut-K",
        about: "K fixed lights in place of the environment, by energy: with bias",
        sampling: Sampling::Light,
        density: Density::Regions(|k| LightDensity::CutLights(k, Split::Energy)),
    },
    Method {
        name: "variance-cut-K",
        about: "the same, by variance",
        sampling: Sampling::Light,
        density: Density::Regions(|k| LightDensity::CutLights(k, Split::Variance)),
    },
];

/// What a name may end in, after a plus sign.
pub struct Suffix {
    /// Without the plus sign.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    apply: fn(&mut Strategy),
}

/// All suffixes.
pub const SUFFIXES: [Suffix; 2] = [
    Suffix {
        name: "independent",
        about: "independent random numbers in place of Sobol's",
        apply: |strategy| strategy.stream = StreamKind::Independent,
    },
    Suffix {
        name: "all-normals",
        about: "rough metal samples the distribution of all normals in place of the visible ones",
        apply: |strategy| strategy.normals = Normals::All,
    },
];

impl Method {
    /// What the method of that name samples in proportion to; `None` if the name is another one.
    fn density(&self, name: &str) -> Option<LightDensity> {
        match self.density {
            Density::Of(density) => (self.name == name).then_some(density),
            Density::Regions(of) => Some(of(name.strip_prefix(self.name.strip_suffix('K')?)?.parse().ok()?)),
        }
    }
}

impl FromStr for Strategy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut parts = name.split('+');
        let method = parts.next().unwrap_or_default();
        let found = METHODS.iter().find_map(|known| Some((known.sampling, known.density(method)?)));
        let (sampling, density) = found.ok_or_else(|| {
            let known = METHODS.map(|method| method.name).join(", ");
            let suffixes = SUFFIXES.map(|suffix| format!("+{}", suffix.name)).join(", ");
            Error::parameter("strategies", format!("there is no strategy \"{name}\""))
                .with_hint(format!("strategies: {known}; then {suffixes}"))
        })?;
        let mut strategy =
            Self { name: name.to_owned(), sampling, density, stream: StreamKind::Sobol, normals: Normals::Visible };
        for part in parts {
            let suffix = SUFFIXES.iter().find(|suffix| suffix.name == part).ok_or_else(|| {
                Error::parameter("strategies", format!("\"{name}\" ends in \"+{part}\""))
                    .with_hint("a strategy may end in +independent and in +all-normals")
            })?;
            (suffix.apply)(&mut strategy);
        }
        Ok(strategy)
    }
}

impl Strategy {
    /// Those that are compared when nobody asks for others.
    #[must_use]
    pub fn usual(scene: &Scene) -> Vec<Self> {
        let names: &[&str] = if scene.environment.is_some() {
            &[
                "hemisphere+independent",
                "light+independent",
                "light",
                "mis",
                "mis-compensated",
                "light-cosine",
                "strata-64",
                "median-cut-64",
            ]
        } else {
            &[
                "hemisphere+independent",
                "hemisphere",
                "bsdf+independent",
                "bsdf",
                "light+independent",
                "light",
                "mis+independent",
                "mis",
            ]
        };
        names.iter().filter_map(|name| name.parse().ok()).collect()
    }

    /// The settings of a render by this strategy.
    #[must_use]
    pub fn settings(&self, seed: u64) -> Settings {
        let Self { sampling, density, stream, normals, .. } = *self;
        let mut settings = Settings { sampling, density, stream, seed, ..Settings::default() };
        settings.model.scattering.normals = normals;
        settings
    }

    /// Whether its random numbers are independent.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        self.stream == StreamKind::Independent
    }

    /// Whether fixed lights stand for the environment.
    #[must_use]
    pub fn has_fixed_lights(&self) -> bool {
        matches!(self.density, LightDensity::CutLights(..))
    }

    /// An error if the scene has no environment to sample as the strategy says.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        if scene.environment.is_some() || self.density == LightDensity::Map {
            return Ok(());
        }
        let message = format!("{} needs an environment map, and the scene {} has none", self.name, scene.name);
        Err(Error::parameter("strategies", message).with_hint("for its area lights: light, bsdf, mis, hemisphere"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn names_mean_what_they_say() {
        for Method { name, about, .. } in METHODS {
            assert!(!about.is_empty());
            for suffix in ["", "+independent", "+all-normals", "+independent+all-normals"] {
                let name = name.replace('K', "16") + suffix;
                let strategy: Strategy = name.parse().unwrap();
                assert_eq!(strategy.name, name);
                assert_eq!(strategy.is_independent(), suffix.contains("independent"));
                let normals = strategy.settings(1).model.scattering.normals;
                assert_eq!(normals == Normals::All, suffix.contains("all-normals"), "{name}");
            }
        }
        for wrong in ["", "ligth", "light+", "light+sobol", "strata-", "strata--1", "median-cut-1e3", "K"] {
            assert!(wrong.parse::<Strategy>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_room_without_a_map_has_no_regions() {
        let (room, _) = builtin::cornell_lambert();
        let (furnace, _) = builtin::furnace();
        let check = |name: &str, scene| name.parse::<Strategy>().unwrap().check(scene).is_ok();
        assert!(check("mis", &room) && !check("strata-16", &room) && check("strata-16", &furnace));
        assert!(Strategy::usual(&room).iter().all(|s| s.check(&room).is_ok()));
        assert_eq!((Strategy::usual(&room).len(), Strategy::usual(&furnace).len()), (8, 8));
    }
}
