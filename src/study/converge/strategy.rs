//! Names of sampling strategies, and what each asks of the renderer.

use crate::bsdf::Normals;
use crate::envmap::cut::Split;
use crate::error::{Error, Result};
use crate::render::{LightDensity, RegionCount, Sampling, Settings};
use crate::sampling::stream::StreamKind;
use crate::scene::Scene;
use serde::Serialize;
use std::str::FromStr;

/// A sampling strategy by its name: a way of choosing directions, then `+independent` for independent random numbers in
/// place of Sobol's, `+all-normals` for rough metal that draws all facets in place of the visible ones.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Strategy {
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

/// Every way of choosing directions, and what it does. `K` stands for a number of regions.
pub const NAMES: [(&str, &str); 10] = [
    ("light", "by the light: the environment's radiance, the lamps' solid angles"),
    ("light-cosine", "the same, the environment's radiance times the cosine"),
    ("bsdf", "by the material (cosine at diffuse surfaces)"),
    ("hemisphere", "evenly over the hemisphere"),
    ("mis", "light and bsdf by multiple importance sampling"),
    ("mis-cosine", "light-cosine and bsdf; at diffuse surfaces, light-cosine alone"),
    ("mis-compensated", "the same as mis, the environment's radiance less its mean"),
    ("strata-K", "an environment's region by its energy, evenly within: without bias"),
    ("median-cut-K", "K fixed lights in place of the environment, by energy: with bias"),
    ("variance-cut-K", "the same, by variance"),
];

impl FromStr for Strategy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut parts = name.split('+');
        let (sampling, density) = directions(parts.next().unwrap_or_default()).ok_or_else(|| {
            let known: Vec<_> = NAMES.iter().map(|(name, _)| *name).collect();
            Error::parameter("strategies", format!("there is no strategy \"{name}\""))
                .with_hint(format!("strategies: {}; then +independent, +all-normals", known.join(", ")))
        })?;
        let mut strategy =
            Self { name: name.to_owned(), sampling, density, stream: StreamKind::Sobol, normals: Normals::Visible };
        for suffix in parts {
            match suffix {
                "independent" => strategy.stream = StreamKind::Independent,
                "all-normals" => strategy.normals = Normals::All,
                _ => {
                    return Err(Error::parameter("strategies", format!("\"{name}\" ends in \"+{suffix}\""))
                        .with_hint("a strategy may end in +independent and in +all-normals"));
                }
            }
        }
        Ok(strategy)
    }
}

fn directions(name: &str) -> Option<(Sampling, LightDensity)> {
    let regions = |prefix: &str| name.strip_prefix(prefix)?.parse::<RegionCount>().ok();
    if let Some(n) = regions("strata-") {
        return Some((Sampling::Light, LightDensity::Strata(n)));
    }
    for (prefix, split) in [("median-cut-", Split::Energy), ("variance-cut-", Split::Variance)] {
        if let Some(n) = regions(prefix) {
            return Some((Sampling::Light, LightDensity::CutLights(n, split)));
        }
    }
    Some(match name {
        "light" => (Sampling::Light, LightDensity::Map),
        "light-cosine" => (Sampling::Light, LightDensity::Cosine),
        "bsdf" => (Sampling::Bsdf, LightDensity::Map),
        "hemisphere" => (Sampling::Hemisphere, LightDensity::Map),
        "mis" => (Sampling::Mis, LightDensity::Map),
        "mis-cosine" => (Sampling::Mis, LightDensity::Cosine),
        "mis-compensated" => (Sampling::Mis, LightDensity::Compensated),
        _ => return None,
    })
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
        Err(Error::parameter("strategies", message).with_hint("for its lamps: light, bsdf, mis, hemisphere"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn names_mean_what_they_say() {
        for (name, _) in NAMES {
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
