//! The handshake: the program describes its sampler.

use super::connection::{Connection, protocol_error};
use crate::error::Result;
use crate::import::number::number;
use crate::import::place::quote;
use crate::import::sampler::space::Space;
use etalon_stats::Mass;
use std::collections::HashSet;

const VERSION: &str = "1";
/// Most random numbers of one sample.
const DIMENSIONS: usize = 64;
const ATOMS: usize = 4096;

/// A program's description of its sampler.
#[derive(Debug, Clone, PartialEq)]
pub struct Handshake {
    pub name: String,
    /// Random numbers that a sample takes; 0 if the program has random numbers of its own.
    pub dimension: usize,
    /// Integral of the pdf.
    pub mass: Mass,
    /// If the program names it.
    pub domain: Option<Space>,
    /// Whether it has the inverse of its sampler.
    pub invert: bool,
    /// One line for each atom: its point and its probability.
    pub atoms: Vec<String>,
}

impl Handshake {
    /// Sends the request and parses the response.
    pub fn of(connection: &mut dyn Connection) -> Result<Self> {
        let answer = connection.ask(format!("etalon {VERSION}\n"), 1 + ATOMS)?;
        // Some programs begin whatever they write with a byte order mark.
        let mut lines = answer.strip_prefix('\u{feff}').unwrap_or(&answer).lines();
        let first = lines.next().unwrap_or_default();
        let wrong =
            |message: &str| protocol_error(connection.name(), format!("its greeting {} {message}", quote(first)));
        let mut words = first.split_ascii_whitespace();
        if [words.next(), words.next()] != [Some("etalon"), Some(VERSION)] {
            return Err(wrong(&format!("does not begin with \"etalon {VERSION}\"")));
        }
        let mut handshake = Self {
            name: "exec".to_owned(),
            dimension: 2,
            mass: Mass::Exactly(1.0),
            domain: None,
            invert: false,
            atoms: lines.map(str::to_owned).collect(),
        };
        let mut keys = HashSet::new();
        for word in words {
            let (key, value) =
                word.split_once('=').ok_or_else(|| wrong(&format!("has {}, not KEY=VALUE", quote(word))))?;
            if !keys.insert(key) {
                return Err(wrong(&format!("has the key {} twice", quote(key))));
            }
            let refused = || wrong(&format!("has {}, which has no meaning", quote(word)));
            match key {
                "name" => handshake.name = value.to_owned(),
                "dimension" => {
                    let dimension = value.parse().ok().filter(|n| *n <= DIMENSIONS);
                    handshake.dimension =
                        dimension.ok_or_else(|| wrong(&format!("has a dimension not 0 to {DIMENSIONS}")))?;
                }
                "mass" if value == "at-most-1" => handshake.mass = Mass::AtMostOne,
                "mass" => {
                    let mass = number(value).filter(|mass| (0.0..=1.0).contains(mass));
                    handshake.mass = Mass::Exactly(mass.ok_or_else(|| wrong("has a mass that is not from 0 to 1"))?);
                }
                "domain" => handshake.domain = Some(value.parse().map_err(|_| refused())?),
                "invert" => {
                    handshake.invert = match value {
                        "yes" => true,
                        "no" => false,
                        _ => return Err(refused()),
                    }
                }
                "numbers" => {
                    return Err(
                        refused().with_hint("write hexadecimal floats (C's %a, Python's float.hex): they are exact")
                    );
                }
                _ => return Err(refused()),
            }
        }
        Ok(handshake)
    }
}
