//! The registry of sampling strategies: their names, and what each asks of the renderer.

use crate::bsdf::NormalSampling;
use crate::envmap::samplers::{self, MapSampling};
use crate::error::{Error, Result};
use crate::render::{Sampling, Settings};
use crate::sampling::stream::StreamKind;
use crate::scene::Scene;
use serde::Serialize;
use std::str::FromStr;

/// A sampling strategy, named by one of [`methods`], then any of [`SUFFIXES`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Strategy {
    /// The name from which it was parsed.
    pub name: String,
    sampling: Sampling,
    density: MapSampling,
    stream: StreamKind,
    normals: NormalSampling,
    adaptive: bool,
}

impl From<Strategy> for String {
    fn from(strategy: Strategy) -> Self {
        strategy.name
    }
}

/// The methods whose names contain no environment-map sampler: name, what it does, and the setting of the renderer.
const METHODS: [(&str, &str, Sampling); 4] = [
    ("light", "by the light: the environment's radiance, the area lights' solid angles", Sampling::Light),
    ("bsdf", "by the material (cosine at diffuse surfaces)", Sampling::Bsdf),
    ("hemisphere", "uniformly over the hemisphere", Sampling::Hemisphere),
    ("mis", "light and bsdf by multiple importance sampling", Sampling::Mis),
];

/// The name of every method of sampling directions, and what it does; `K` stands for a number of regions.
///
/// The list follows from the registry of environment-map samplers: `light` and `mis` use the first one; `light-NAME` and
/// `mis-NAME` another; the name of a sampler of regions alone means light sampling by it.
pub fn methods() -> Vec<(String, String)> {
    let mut names: Vec<(String, String)> = METHODS.map(|(name, doc, _)| (name.into(), doc.into())).into();
    for entry in samplers::ALL.iter().skip(1) {
        let sampling = MapSampling::new(entry);
        let (name, doc) = (entry.name, entry.doc);
        if entry.has_regions {
            names.push((format!("{name}-K"), format!("light; the environment: {doc}")));
        } else if entry.complete {
            names.push((format!("light-{name}"), format!("light; the environment: {doc}")));
        }
        if sampling.has_fixed_lights() {
            continue;
        }
        let suffix = if entry.has_regions { "-K" } else { "" };
        let note = if sampling.needs_normal() && entry.complete { "; at diffuse surfaces, light alone" } else { "" };
        names.push((format!("mis-{name}{suffix}"), format!("mis; the environment: {doc}{note}")));
    }
    names
}

/// What a name may end in, after a plus sign; what that does, in words and to the strategy, of which it makes `None` if it
/// cannot be added.
pub type Suffix = (&'static str, &'static str, fn(Strategy) -> Option<Strategy>);

/// All suffixes.
pub const SUFFIXES: [Suffix; 4] = [
    ("lt", "light tracing as a third technique of mis", |strategy| {
        (strategy.sampling == Sampling::Mis).then_some(Strategy { sampling: Sampling::MisLt, ..strategy })
    }),
    ("adaptive", "more camera paths in pixels with more noise", |strategy| {
        Some(Strategy { adaptive: true, ..strategy })
    }),
    ("independent", "independent random numbers in place of Sobol's", |strategy| {
        Some(Strategy { stream: StreamKind::Independent, ..strategy })
    }),
    ("all-normals", "rough metal samples the distribution of all normals in place of the visible ones", |strategy| {
        Some(Strategy { normals: NormalSampling::Ndf, ..strategy })
    }),
];

impl FromStr for Strategy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut parts = name.split('+');
        let (sampling, density) = directions(parts.next().unwrap_or_default()).ok_or_else(|| {
            let known: Vec<String> = methods().into_iter().map(|(name, _)| name).collect();
            Error::parameter("strategies", format!("there is no strategy \"{name}\"")).with_hint(format!(
                "strategies: {}; then {}",
                known.join(", "),
                SUFFIXES.map(|(suffix, ..)| format!("+{suffix}")).join(", ")
            ))
        })?;
        let mut strategy = Self {
            name: name.to_owned(),
            sampling,
            density,
            stream: StreamKind::Sobol,
            normals: NormalSampling::Vndf,
            adaptive: false,
        };
        for part in parts {
            let (.., apply) = SUFFIXES.iter().find(|(suffix, ..)| *suffix == part).ok_or_else(|| {
                let known = SUFFIXES.map(|(suffix, ..)| format!("+{suffix}")).join(" and in ");
                Error::parameter("strategies", format!("\"{name}\" ends in \"+{part}\""))
                    .with_hint(format!("a strategy may end in {known}"))
            })?;
            strategy = apply(strategy).ok_or_else(|| {
                Error::parameter("strategies", format!("\"{name}\" ends in \"+{part}\""))
                    .with_hint("light tracing is added to mis")
            })?;
        }
        Ok(strategy)
    }
}

/// How a method samples directions; `None` for an unknown or impossible one.
fn directions(name: &str) -> Option<(Sampling, MapSampling)> {
    if let Some((_, _, sampling)) = METHODS.iter().find(|(method, ..)| *method == name) {
        return Some((*sampling, MapSampling::MAP));
    }
    let prefixes = [("light-", Sampling::Light), ("mis-", Sampling::Mis)];
    let stripped = prefixes.into_iter().find_map(|(prefix, sampling)| Some((sampling, name.strip_prefix(prefix)?)));
    // A name without a prefix must be that of a sampler of regions.
    let (sampling, density) = stripped.unwrap_or((Sampling::Light, name));
    let density: MapSampling = density.parse().ok()?;
    if stripped.is_none() && !density.entry().has_regions {
        return None;
    }
    // Fixed lights have no pdf for MIS, and light sampling alone needs a pdf that is positive wherever there is light.
    let alone = sampling == Sampling::Light;
    let possible = if density.has_fixed_lights() { alone } else { !alone || density.entry().complete };
    possible.then_some((sampling, density))
}

impl Strategy {
    /// The strategies that are compared by default. That of `etalon render` is among them. A map of few texels does not allow
    /// all of them.
    pub fn usual(scene: &Scene) -> Vec<Self> {
        let (names, texels) = match &scene.environment {
            Some(environment) => (
                "hemisphere+independent light+independent light mis mis-cosine-compensated light-cosine \
                 mis-cosine-compensated+lt+adaptive strata-64 median-cut-64",
                environment.map.geometry().width() * environment.map.geometry().height(),
            ),
            None => (
                "hemisphere+independent hemisphere bsdf light+independent light mis+independent mis mis+lt mis+lt+adaptive",
                0,
            ),
        };
        let strategies = names.split_whitespace().filter_map(|name| name.parse().ok());
        strategies.filter(|strategy: &Self| strategy.density.regions() as usize <= texels).collect()
    }

    /// The settings of a render by this strategy.
    pub fn settings(&self, seed: u64) -> Settings {
        let Self { sampling, density, stream, normals, adaptive, .. } = *self;
        let mut settings = Settings { sampling, density: Some(density), stream, seed, adaptive, ..Settings::default() };
        settings.model.normals = normals;
        settings
    }

    /// Whether its random numbers are independent.
    pub fn is_independent(&self) -> bool {
        self.stream == StreamKind::Independent
    }

    /// Whether fixed lights stand for the environment.
    pub fn has_fixed_lights(&self) -> bool {
        self.density.has_fixed_lights()
    }

    /// Checks that the scene has an environment map if the strategy needs one.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has none.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        if scene.environment.is_some() || self.density == MapSampling::MAP {
            return Ok(());
        }
        let message = format!("{} needs an environment map, and the scene {} has none", self.name, scene.name);
        Err(Error::parameter("strategies", message).with_hint("for its area lights: light, bsdf, mis, hemisphere"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::EnvMap;
    use crate::envmap::synthetic::Synthetic;
    use crate::scene::{Environment, builtin};
    use std::sync::Arc;

    #[test]
    fn names_mean_what_they_say() {
        for (name, _) in methods() {
            for suffix in ["", "+independent", "+all-normals", "+lt+adaptive+independent+all-normals"] {
                let name = name.replace('K', "16") + suffix;
                if suffix.contains("lt") && !name.starts_with("mis") {
                    assert!(name.parse::<Strategy>().is_err(), "{name}");
                    continue;
                }
                let strategy: Strategy = name.parse().unwrap();
                assert_eq!(strategy.name, name);
                assert_eq!(strategy.is_independent(), suffix.contains("independent"));
                assert_eq!(strategy.settings(1).adaptive, suffix.contains("adaptive"), "{name}");
                let normals = strategy.settings(1).model.normals;
                assert_eq!(normals == NormalSampling::Ndf, suffix.contains("all-normals"), "{name}");
            }
        }
        let wrong =
            "ligth light+ light+sobol strata- strata--1 median-cut-1e3 K cosine light-cosine-compensated mis-median-cut-4";
        for wrong in wrong.split(' ').chain([""]) {
            assert!(wrong.parse::<Strategy>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_cornell_box_without_a_map_has_no_regions() {
        let (cornell, _) = builtin::cornell_lambert();
        let (furnace, _) = builtin::furnace();
        let check = |name: &str, scene| name.parse::<Strategy>().unwrap().check(scene).is_ok();
        assert!(check("mis", &cornell) && !check("strata-16", &cornell) && check("strata-16", &furnace));
        assert!(Strategy::usual(&cornell).iter().all(|s| s.check(&cornell).is_ok()));
        // The furnace has a map of 4 x 2 texels.
        assert_eq!((Strategy::usual(&cornell).len(), Strategy::usual(&furnace).len()), (9, 7));
    }

    #[test]
    fn what_renders_by_default_is_compared_by_default() {
        let (cornell, _) = builtin::cornell_lambert();
        let (furnace, _) = builtin::furnace();
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let (sphere, _) = builtin::sphere_env(Environment::upright(map, "sun", 1.0));
        let same = |scene: &Scene| {
            let render = Settings::usual(scene);
            let settings = |strategy: &Strategy| strategy.settings(1);
            let key = |s: &Settings| (s.sampling, s.adaptive, s.stream, s.map_sampling().density());
            let has_map = scene.environment.is_some();
            Strategy::usual(scene).iter().map(settings).any(|s| {
                let (a, b) = (key(&s), key(&render));
                if has_map { a == b } else { (a.0, a.1, a.2) == (b.0, b.1, b.2) }
            })
        };
        assert!(same(&cornell) && same(&furnace) && same(&sphere));
    }
}
