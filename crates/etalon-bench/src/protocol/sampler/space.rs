//! Domains by name.

use super::Coordinates;
use etalon_core::error::Error;
use etalon_stats::{Directions, Discrete, Line, Pole, Square};
use std::fmt;
use std::str::FromStr;

/// A domain that an external sampler can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// All directions.
    Sphere,
    /// Directions with z ≥ 0.
    Hemisphere,
    /// Pairs of numbers from 0 to 1.
    Square,
    /// Numbers from 0 to 1.
    Line,
    /// The integers from 0 up to, but not including, this one.
    Discrete(usize),
}

/// A computation over a domain that is known at run time only.
pub trait Visitor {
    /// What the computation returns.
    type Output;

    /// Runs the computation over `domain`.
    fn visit<D: Coordinates>(self, domain: D) -> Self::Output;
}

impl Space {
    /// Runs `visitor` over the domain; the pole of directions is +z.
    pub fn with<V: Visitor>(self, visitor: V) -> V::Output {
        match self {
            Self::Sphere => visitor.visit(Directions::sphere(Pole::Z)),
            Self::Hemisphere => visitor.visit(Directions::hemisphere(Pole::Z)),
            Self::Square => visitor.visit(Square),
            Self::Line => visitor.visit(Line::UNIT),
            Self::Discrete(outcomes) => visitor.visit(Discrete { outcomes }),
        }
    }
}

/// Most points of a finite set.
const OUTCOMES: usize = 1 << 20;

impl FromStr for Space {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let error = |message: String| {
            Error::parameter("domain", message).with_hint("domains: sphere, hemisphere, square, line, discrete:N")
        };
        Ok(match text {
            "sphere" => Self::Sphere,
            "hemisphere" => Self::Hemisphere,
            "square" => Self::Square,
            "line" => Self::Line,
            _ => {
                let count = text.strip_prefix("discrete:").ok_or_else(|| error(format!("unknown domain {text:?}")))?;
                let count = count.parse().ok().filter(|n| (1..=OUTCOMES).contains(n));
                Self::Discrete(count.ok_or_else(|| error(format!("{text:?} needs a number from 1 to {OUTCOMES}")))?)
            }
        })
    }
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sphere => "sphere",
            Self::Hemisphere => "hemisphere",
            Self::Square => "square",
            Self::Line => "line",
            Self::Discrete(count) => return write!(f, "discrete:{count}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visitors_get_the_domain_that_is_named() {
        struct Measure;
        impl Visitor for Measure {
            type Output = (f64, bool, Option<usize>);

            fn visit<D: Coordinates>(self, domain: D) -> Self::Output {
                (domain.measure(), domain.is_plane(), domain.outcomes())
            }
        }
        let pi = std::f64::consts::PI;
        for (name, expected) in [
            ("sphere", (4.0 * pi, true, None)),
            ("hemisphere", (2.0 * pi, true, None)),
            ("square", (1.0, true, None)),
            ("line", (1.0, false, None)),
        ] {
            assert_eq!(name.parse::<Space>().unwrap().with(Measure), expected, "{name}");
        }
        assert_eq!(Space::Discrete(6).with(Measure).2, Some(6));
    }

    #[test]
    fn names_are_read_and_written() {
        for name in ["sphere", "hemisphere", "square", "line", "discrete:6"] {
            assert_eq!(name.parse::<Space>().unwrap().to_string(), name);
        }
        for bad in ["", "disc", "discrete", "discrete:", "discrete:0", "discrete:-1", "discrete:99999999999999999999"] {
            assert!(bad.parse::<Space>().is_err(), "{bad}");
        }
    }
}
