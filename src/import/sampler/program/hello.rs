//! How a program introduces itself.

use super::peer::{Peer, fault};
use crate::error::Result;
use crate::import::place::quote;
use crate::import::sampler::number::{Notation, number};
use crate::import::sampler::space::Space;
use crate::stats::Mass;

/// The version of the protocol.
const VERSION: &str = "1";
/// Most uniform numbers of one sample.
const DIMENSIONS: usize = 64;
/// Most atoms.
const ATOMS: usize = 4096;

/// What a program says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Hello {
    pub name: String,
    /// Uniform numbers that a sample takes; `None` if the program has random numbers of its own.
    pub dimension: Option<usize>,
    pub mass: Mass,
    pub domain: Option<Space>,
    /// Whether it can tell the numbers that a point is drawn from.
    pub invert: bool,
    /// How numbers are written after the greeting.
    pub notation: Notation,
    /// One line for each atom: its point and its probability.
    pub atoms: Vec<String>,
}

impl Hello {
    /// Greets the program and reads what it says.
    pub fn of(peer: &mut dyn Peer) -> Result<Self> {
        let answer = peer.ask(format!("etalon {VERSION}\n"), 1 + ATOMS)?;
        let mut lines = answer.lines();
        let first = lines.next().unwrap_or_default();
        let wrong = |message: &str| fault(peer.name(), format!("its greeting {} {message}", quote(first)));
        let mut words = first.split_ascii_whitespace();
        if [words.next(), words.next()] != [Some("etalon"), Some(VERSION)] {
            return Err(wrong(&format!("does not begin with \"etalon {VERSION}\"")));
        }
        let mut hello = Self {
            name: "exec".to_owned(),
            dimension: Some(2),
            mass: Mass::Exactly(1.0),
            domain: None,
            invert: false,
            notation: Notation::Text,
            atoms: lines.map(str::to_owned).collect(),
        };
        for word in words {
            let (key, value) =
                word.split_once('=').ok_or_else(|| wrong(&format!("has {}, not KEY=VALUE", quote(word))))?;
            let refused = || wrong(&format!("has {}, which has no meaning", quote(word)));
            match key {
                "name" => hello.name = value.to_owned(),
                "dimension" => {
                    let dimension = value.parse().ok().filter(|n| *n <= DIMENSIONS);
                    let dimension =
                        dimension.ok_or_else(|| wrong(&format!("has a dimension not 0 to {DIMENSIONS}")))?;
                    hello.dimension = (dimension > 0).then_some(dimension);
                }
                "mass" if value == "at-most-1" => hello.mass = Mass::AtMostOne,
                "mass" => {
                    let mass = number(value).filter(|mass| (0.0..=1.0).contains(mass));
                    hello.mass = Mass::Exactly(mass.ok_or_else(|| wrong("has a mass that is not from 0 to 1"))?);
                }
                "domain" => hello.domain = Some(value.parse().map_err(|_| refused())?),
                "invert" => {
                    hello.invert = match value {
                        "yes" => true,
                        "no" => false,
                        _ => return Err(refused()),
                    }
                }
                "numbers" => {
                    hello.notation = match value {
                        "text" => Notation::Text,
                        "bits" => Notation::Bits,
                        _ => return Err(refused()),
                    }
                }
                _ => return Err(refused()),
            }
        }
        Ok(hello)
    }
}
