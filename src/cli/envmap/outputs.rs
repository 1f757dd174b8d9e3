//! The results of a subcommand for several numbers of samples or regions.

use crate::cli::global::Verdict;
use crate::error::{Error, Result};
use serde::Serialize;

/// The JSON object: a result for each number.
#[derive(Serialize)]
pub struct Outputs<T> {
    pub map: String,
    pub results: Vec<T>,
    pub interrupted: bool,
}

impl<T> Outputs<T> {
    /// Collects `all` results; after an interruption, those that were finished.
    pub fn of(map: &str, all: impl Iterator<Item = Result<T>>) -> Result<Self> {
        let mut outputs = Self { map: map.to_owned(), results: Vec::new(), interrupted: false };
        for result in all {
            match result {
                Err(Error::Interrupted) if !outputs.results.is_empty() => {
                    outputs.interrupted = true;
                    break;
                }
                result => outputs.results.push(result?),
            }
        }
        Ok(outputs)
    }

    pub fn verdict(&self) -> Verdict {
        if self.interrupted { Verdict::Inconclusive } else { Verdict::Good }
    }
}
