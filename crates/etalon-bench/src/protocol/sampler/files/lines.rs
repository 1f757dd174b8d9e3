//! Lines of a text file, one at a time and none too long.

use etalon_core::error::{Error, Place, Result};
use etalon_core::files::{self, without_bom};
use etalon_core::import::place::{quote, real};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Longest line, in bytes.
const LONGEST: u64 = 1 << 20;

pub struct Lines {
    path: PathBuf,
    file: BufReader<File>,
    line: Vec<u8>,
    number: usize,
}

impl Lines {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Unsupported`] for a pipe or a device.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::io(path, e))?;
        if !file.metadata().map_err(|e| Error::io(path, e))?.is_file() {
            return Err(Error::unsupported(path, "not a file that can be read twice"));
        }
        files::note_input(path);
        Ok(Self { path: path.to_owned(), file: BufReader::with_capacity(1 << 16, file), line: Vec::new(), number: 0 })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// An error in the line that was read last.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::input(&self.path, message).at(Place::Text { line: self.number, column: 1 })
    }

    /// The next line that is not empty; `None` at the end.
    pub fn next(&mut self) -> Result<Option<&str>> {
        loop {
            self.line.clear();
            let read = (&mut self.file).take(LONGEST).read_until(b'\n', &mut self.line);
            if read.map_err(|e| Error::io(&self.path, e))? == 0 {
                return Ok(None);
            }
            self.number += 1;
            if self.line.len() as u64 == LONGEST {
                return Err(self.error(format!("the line is longer than {LONGEST} bytes")));
            }
            if self.number == 1 {
                self.line.drain(..self.line.len() - without_bom(&self.line).len());
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        let text = std::str::from_utf8(&self.line).map_err(|_| self.error("the line is not UTF-8"))?;
        Ok(Some(text.trim()))
    }

    /// The numbers of the next line that is not empty, with commas between them; none of them is NaN.
    pub fn numbers(&mut self) -> Result<Option<Vec<f64>>> {
        let Some(line) = self.next()? else { return Ok(None) };
        let number = |word: &str| real(word.trim()).ok_or_else(|| format!("{} is not a number", quote(word.trim())));
        let numbers: std::result::Result<Vec<f64>, String> = line.split(',').map(number).collect();
        numbers.map(Some).map_err(|message| self.error(message))
    }
}
