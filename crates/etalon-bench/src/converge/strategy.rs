//! The registry of sampling strategies: their names, and what each asks of the renderer.

use etalon_core::bsdf::NormalSampling;
use etalon_core::envmap::samplers::{self, MapSampling};
use etalon_core::error::{Error, Result};
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::Scene;
use etalon_core::scene::scattering::ScatterModel;
use etalon_render::{Sampling, Settings};
use serde::Serialize;
use std::str::FromStr;

/// A sampling strategy, named by [`DEFAULT`], or by another one of [`methods`] and then any of [`SUFFIXES`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Strategy {
    /// The name from which it was parsed.
    pub name: String,
    settings: Settings,
}

/// The name of the strategy by which `etalon render` renders a scene.
pub const DEFAULT: &str = "default";

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
/// `mis-NAME` another; the name of fixed lights stands for itself.
pub fn methods() -> Vec<(String, String)> {
    let default = (DEFAULT, "what `etalon render` does with the scene");
    let named = METHODS.map(|(name, doc, _)| (name, doc));
    let mut names: Vec<(String, String)> =
        [default].into_iter().chain(named).map(|(name, doc)| (name.into(), doc.into())).collect();
    for entry in samplers::ALL.iter().skip(1) {
        let (name, doc) = (entry.name, entry.doc);
        if entry.has_fixed_lights() {
            names.push((entry.name_with_k(), format!("light; the environment: {doc}")));
            continue;
        }
        if entry.complete {
            names.push((format!("light-{name}"), format!("light; the environment: {doc}")));
        }
        names.push((format!("mis-{name}"), format!("mis; the environment: {doc}")));
    }
    names
}

/// What a name may end in, after a plus sign; what that does, in words and to the settings, of which it makes `None` if it
/// cannot be added.
pub type Suffix = (&'static str, &'static str, fn(Settings) -> Option<Settings>);

pub const SUFFIXES: [Suffix; 4] = [
    ("lt", "light tracing as a third technique of mis", |settings| {
        let is_mis = matches!(settings.sampling, Sampling::Mis | Sampling::MisLt);
        is_mis.then_some(Settings { sampling: Sampling::MisLt, ..settings })
    }),
    ("adaptive", "more camera paths in pixels with more noise", |settings| {
        Some(Settings { adaptive: true, ..settings })
    }),
    ("independent", "independent random numbers in place of Sobol's", |settings| {
        Some(Settings { stream: StreamKind::Independent, ..settings })
    }),
    ("all-normals", "rough metal samples the distribution of all normals in place of the visible ones", |settings| {
        Some(Settings { model: ScatterModel { normals: NormalSampling::Ndf, ..settings.model }, ..settings })
    }),
];

impl FromStr for Strategy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let mut parts = name.split('+');
        let method = parts.next().unwrap_or_default();
        if method == DEFAULT {
            return match parts.next() {
                None => Ok(Self { name: name.to_owned(), settings: Settings::usual() }),
                Some(_) => Err(Error::parameter("strategies", format!("{DEFAULT} has no suffix, and \"{name}\" does"))
                    .with_hint("a suffix changes a strategy that is named, such as mis+lt")),
            };
        }
        let (sampling, density) = directions(method).ok_or_else(|| {
            let known: Vec<String> = methods().into_iter().map(|(name, _)| name).collect();
            Error::parameter("strategies", format!("there is no strategy \"{name}\"")).with_hint(format!(
                "strategies: {}; then {}",
                known.join(", "),
                SUFFIXES.map(|(suffix, ..)| format!("+{suffix}")).join(", ")
            ))
        })?;
        let mut settings = Settings { sampling, density: Some(density), ..Settings::default() };
        for part in parts {
            let (.., apply) = SUFFIXES.iter().find(|(suffix, ..)| *suffix == part).ok_or_else(|| {
                let known = SUFFIXES.map(|(suffix, ..)| format!("+{suffix}")).join(" and in ");
                Error::parameter("strategies", format!("\"{name}\" ends in \"+{part}\""))
                    .with_hint(format!("a strategy may end in {known}"))
            })?;
            settings = apply(settings).ok_or_else(|| {
                Error::parameter("strategies", format!("\"{name}\" ends in \"+{part}\""))
                    .with_hint("light tracing is added to mis")
            })?;
        }
        Ok(Self { name: name.to_owned(), settings })
    }
}

/// How a method samples directions; `None` for an unknown or impossible one.
fn directions(name: &str) -> Option<(Sampling, MapSampling)> {
    if let Some((_, _, sampling)) = METHODS.iter().find(|(method, ..)| *method == name) {
        return Some((*sampling, MapSampling::MAP));
    }
    let prefixes = [("light-", Sampling::Light), ("mis-", Sampling::Mis)];
    let stripped = prefixes.into_iter().find_map(|(prefix, sampling)| Some((sampling, name.strip_prefix(prefix)?)));
    // A name without a prefix must be that of fixed lights.
    let (sampling, density) = stripped.unwrap_or((Sampling::Light, name));
    let density: MapSampling = density.parse().ok()?;
    // Fixed lights have no pdf for MIS, and light sampling alone needs a pdf that is positive wherever there is light.
    let possible = match density.has_fixed_lights() {
        true => sampling == Sampling::Light,
        false => stripped.is_some() && (sampling == Sampling::Mis || density.entry().complete),
    };
    possible.then_some((sampling, density))
}

impl Strategy {
    /// The strategies that are compared by default, that of `etalon render` among them. A map of few texels does not allow all of
    /// them.
    pub fn usual(scene: &Scene) -> Vec<Self> {
        let (names, texels) = match &scene.environment {
            Some(environment) => (
                "hemisphere+independent light+independent light mis mis-cosine-compensated light-cosine \
                 light-cosine+adaptive default median-cut-64",
                environment.map.geometry().width() * environment.map.geometry().height(),
            ),
            None => {
                ("hemisphere+independent hemisphere bsdf light+independent light mis+independent mis mis+lt default", 0)
            }
        };
        let strategies = names.split_whitespace().filter_map(|name| name.parse().ok());
        strategies.filter(|strategy: &Self| strategy.settings(0).map_sampling().regions() as usize <= texels).collect()
    }

    /// The strategy of settings that leave nothing to the render, on a scene, which may have no map.
    pub fn of(settings: &Settings, scene: &Scene) -> Option<Self> {
        let plain = if settings.sampling == Sampling::MisLt { Sampling::Mis } else { settings.sampling };
        let (method, ..) = METHODS.iter().find(|(.., sampling)| *sampling == plain)?;
        let density = settings.map_sampling();
        let mut name = if density == MapSampling::MAP || scene.environment.is_none() {
            (*method).to_owned()
        } else if density.has_fixed_lights() {
            density.to_string()
        } else {
            format!("{method}-{density}")
        };
        // A suffix that changes nothing is one that the settings have.
        for (suffix, ..) in SUFFIXES.iter().filter(|(.., apply)| apply(*settings) == Some(*settings)) {
            name += &format!("+{suffix}");
        }
        name.parse().ok()
    }

    pub fn settings(&self, seed: u64) -> Settings {
        Settings { seed, ..self.settings }
    }

    /// Whether it is that of `etalon render`.
    pub fn is_default(&self) -> bool {
        self.settings.choose
    }

    /// Whether its random numbers are independent, which those of the default are not.
    pub fn is_independent(&self) -> bool {
        self.settings.stream == StreamKind::Independent
    }

    /// Whether fixed lights stand for the environment, which the default never has.
    pub fn has_fixed_lights(&self) -> bool {
        self.settings.map_sampling().has_fixed_lights()
    }

    /// Checks that the scene has an environment map if the strategy needs one.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has none.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        let needs_map = !self.is_default() && self.settings.map_sampling() != MapSampling::MAP;
        if scene.environment.is_some() || !needs_map {
            return Ok(());
        }
        let message = format!("{} needs an environment map, and the scene {} has none", self.name, scene.name);
        Err(Error::parameter("strategies", message).with_hint("for its area lights: light, bsdf, mis, hemisphere"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::EnvMap;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::scene::{Environment, builtin};
    use std::sync::Arc;

    #[test]
    fn names_mean_what_they_say() {
        let (furnace, _) = builtin::furnace();
        for (name, _) in methods().into_iter().filter(|(name, _)| name != DEFAULT) {
            for suffix in ["", "+independent", "+all-normals", "+lt+adaptive+independent+all-normals"] {
                let name = name.replace('K', "16") + suffix;
                if suffix.contains("lt") && !name.starts_with("mis") {
                    assert!(name.parse::<Strategy>().is_err(), "{name}");
                    continue;
                }
                let strategy: Strategy = name.parse().unwrap();
                assert_eq!(strategy.name, name);
                assert_eq!(Strategy::of(&strategy.settings, &furnace), Some(strategy.clone()));
                assert_eq!(strategy.is_independent(), suffix.contains("independent"));
                let settings = strategy.settings(1);
                assert_eq!(settings.adaptive, suffix.contains("adaptive"), "{name}");
                assert_eq!(settings.model.normals == NormalSampling::Ndf, suffix.contains("all-normals"), "{name}");
            }
        }
        let wrong = "ligth light+ light+sobol median-cut- median-cut--1 median-cut-1e3 K cosine light-cosine-compensated \
             mis-median-cut-4 default+adaptive default-4";
        for wrong in wrong.split(' ').chain([""]) {
            assert!(wrong.parse::<Strategy>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_cornell_box_without_a_map_has_no_regions() {
        let (cornell, _) = builtin::cornell_lambert();
        let (furnace, _) = builtin::furnace();
        let check = |name: &str, scene| name.parse::<Strategy>().unwrap().check(scene).is_ok();
        assert!(check("mis", &cornell) && !check("median-cut-4", &cornell) && check("median-cut-4", &furnace));
        assert!(Strategy::usual(&cornell).iter().all(|s| s.check(&cornell).is_ok()));
        // The furnace has a map of 4 x 2 texels.
        assert_eq!((Strategy::usual(&cornell).len(), Strategy::usual(&furnace).len()), (9, 8));
    }

    #[test]
    fn the_default_is_that_of_render() {
        let default: Strategy = DEFAULT.parse().unwrap();
        assert!(default.is_default() && !default.is_independent() && !default.has_fixed_lights());
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let (sphere, _) = builtin::sphere_env(Environment::upright(map, "sun", 1.0));
        for scene in [builtin::cornell_lambert().0, builtin::furnace().0, sphere] {
            assert_eq!(default.settings(7), Settings { seed: 7, ..Settings::usual() });
            assert!(default.check(&scene).is_ok() && Strategy::usual(&scene).contains(&default));
            assert!(!default.settings(7).map_sampling().has_fixed_lights());
        }
        let error = "default+lt".parse::<Strategy>().unwrap_err().to_string();
        assert!(error.contains("default has no suffix"), "{error}");
    }
}
