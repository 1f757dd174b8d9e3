//! What a sweep visits, by number.

use etalon_core::build::Build;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_stats::bsdf::{ALL, Family};
use etalon_stats::sweep::{Configuration, Finding, Space, Strategy, confirm, screen};
use serde::{Deserialize, Serialize};

/// Families of BSDFs, of this program or of another.
pub type Families = Vec<Box<dyn Family>>;

/// A family as files of a sweep name it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Described {
    name: String,
    /// Name, default value and range.
    parameters: Vec<(String, f64, [f64; 2])>,
}

/// A sweep without its families, as its file tells of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Description {
    version: String,
    families: Vec<Described>,
    strategy: String,
    configurations: u64,
    seed: u64,
    detect: f64,
    level: f64,
    /// The columns of checks, in this order.
    checks: Vec<String>,
}

/// Most configurations of all families: what a file and the memory hold.
const MOST: u64 = 2_000_000;
const STRATEGIES: [(&str, Strategy); 3] =
    [("grid", Strategy::Grid), ("random", Strategy::Random), ("edges", Strategy::Edges)];

impl Description {
    /// A sweep of at most `configurations` of each family, whose screen finds a relative error `detect` with 90 % probability, and
    /// which rejects any right BSDF with probability `level` at most.
    ///
    /// # Errors
    /// [`Error::Parameter`] for values that no sweep can have.
    pub fn new(
        families: &Families,
        strategy: Strategy,
        configurations: u64,
        seed: u64,
        [detect, level]: [f64; 2],
    ) -> Result<Self> {
        if configurations == 0 || configurations.saturating_mul(families.len() as u64) > MOST {
            return Err(Error::parameter("configurations", format!("{configurations} configurations of each family"))
                .with_hint(format!("use 1 to {MOST} of all families together")));
        }
        if !(1e-3..=0.5).contains(&detect) {
            return Err(Error::parameter("detect", format!("error {detect}"))
                .with_hint("use a relative error from 0.001 to 0.5"));
        }
        if !(level > 0.0 && level < 1.0) {
            return Err(Error::parameter("level", format!("level {level}")).with_hint("use a probability such as 0.01"));
        }
        let described = |family: &dyn Family| Described {
            name: family.name().to_owned(),
            parameters: family.parameters().into_iter().map(|p| (p.name, p.value, p.range)).collect(),
        };
        let name = STRATEGIES.iter().find(|(_, known)| *known == strategy).map_or("", |(name, _)| name);
        Ok(Self {
            version: Build::current().id(),
            families: families.iter().map(|family| described(&**family)).collect(),
            strategy: name.to_owned(),
            configurations,
            seed,
            detect,
            level,
            checks: ALL.iter().map(|check| check.name.to_owned()).collect(),
        })
    }

    pub fn families(&self) -> impl Iterator<Item = &str> {
        self.families.iter().map(|family| family.name.as_str())
    }

    /// How configurations are chosen, in words.
    pub fn strategy(&self) -> &str {
        &self.strategy
    }

    /// The error that the screen finds.
    pub fn detect(&self) -> f64 {
        self.detect
    }

    /// The probability that a sweep of right BSDFs rejects any.
    pub fn level(&self) -> f64 {
        self.level
    }

    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// In what another sweep differs, in words; `None` if it is the same.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let list = |of: &Self| of.families().collect::<Vec<_>>().join(" ");
        let entries = |of: &Self| {
            [
                ("build", of.version.clone()),
                ("families", list(of)),
                ("strategy", of.strategy.clone()),
                ("configurations", of.configurations.to_string()),
                ("seed", of.seed.to_string()),
                ("detect", of.detect.to_string()),
                ("level", of.level.to_string()),
                ("checks", of.checks.join(" ")),
                ("parameters of the families", format!("{:?}", of.families)),
            ]
        };
        let differs = entries(self).into_iter().zip(entries(other)).find(|((_, mine), (_, theirs))| mine != theirs);
        differs.map(|((name, mine), (_, theirs))| match name {
            "parameters of the families" => format!("other {name}"),
            _ => format!("{name}: {theirs} here, {mine} there"),
        })
    }
}

pub struct Plan {
    pub description: Description,
    families: Families,
    spaces: Vec<Space>,
}

impl Plan {
    /// The sweep of these families that `description` tells of.
    ///
    /// # Errors
    /// Those of [`Family::with`].
    pub fn new(description: Description, families: Families) -> Result<Self> {
        let strategy = strategy(&description.strategy);
        let space = |family: &dyn Family| Space::new(family, strategy, description.configurations, description.seed);
        let spaces = families.iter().map(|family| space(&**family)).collect::<etalon_stats::Result<_>>()?;
        Ok(Self { description, families, spaces })
    }

    /// The number of configurations of all families together.
    pub fn len(&self) -> u64 {
        self.spaces.iter().map(Space::len).sum()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether configurations should be computed one after the other: see [`Family::is_sequential`].
    pub fn is_sequential(&self) -> bool {
        self.families.iter().any(|family| family.is_sequential())
    }

    /// The largest number of configurations of a family.
    pub fn largest(&self) -> u64 {
        self.spaces.iter().map(Space::len).max().unwrap_or(0)
    }

    pub fn family(&self, index: usize) -> &dyn Family {
        &*self.families[index]
    }

    /// The index of the family and the configuration of that number, from 0.
    pub fn get(&self, number: u64) -> (usize, Configuration) {
        let mut rest = number;
        for (index, space) in self.spaces.iter().enumerate() {
            if rest < space.len() {
                return (index, space.get(rest));
            }
            rest -= space.len();
        }
        (0, self.spaces[0].get(number))
    }

    /// All checks of one configuration.
    ///
    /// # Errors
    /// As [`screen`].
    pub fn screen(&self, number: u64) -> Result<Vec<Finding>> {
        let (family, configuration) = self.get(number);
        Ok(screen(self.family(family), &configuration, self.description.detect, interrupt::requested)?)
    }
}

fn strategy(name: &str) -> Strategy {
    STRATEGIES.iter().find(|(known, _)| *known == name).map(|(_, strategy)| *strategy).unwrap_or_default()
}

/// Splits a replay into the family and the configuration, and the check if one is named.
///
/// # Errors
/// [`Error::Parameter`] with the name `replay`.
pub fn replay<'a>(
    text: &str,
    families: &'a Families,
    detect: f64,
) -> Result<(&'a dyn Family, Configuration, Vec<Finding>)> {
    let (name, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    let Some(family) = families.iter().find(|family| family.name() == name) else {
        let names: Vec<&str> = families.iter().map(|family| family.name()).collect();
        return Err(Error::parameter("replay", format!("there is no family \"{name}\""))
            .with_hint(format!("the families: {}", names.join(", "))));
    };
    let (configuration, check) = Configuration::parse(&**family, rest)?;
    let known = |check: &String| ALL.iter().any(|known| known.name == *check);
    if let Some(check) = check.as_ref().filter(|check| !known(check)) {
        let names: Vec<&str> = ALL.iter().map(|check| check.name).collect();
        return Err(Error::parameter("replay", format!("there is no check \"{check}\""))
            .with_hint(format!("the checks: {}", names.join(", "))));
    }
    let mut findings = Vec::new();
    for (index, known) in ALL.iter().enumerate() {
        if check.as_ref().is_none_or(|check| *check == known.name) {
            findings.extend(confirm(&**family, &configuration, index, detect, interrupt::requested)?);
        }
    }
    Ok((&**family, configuration, findings))
}
