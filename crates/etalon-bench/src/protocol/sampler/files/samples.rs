//! Samples from a file: a sampler of finitely many.

use super::grid::GridDensity;
use super::lines::Lines;
use etalon_core::error::{Error, Result};
use etalon_core::import::place::quote;
use etalon_stats::{Sample, Sampler};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A file of samples that is read once, from the beginning to the end.
///
/// A pdf in the file is compared with the grid's allowing for rounding of text and f32: what agrees is taken for equal.
pub struct SampleFile {
    density: Arc<GridDensity>,
    reader: Mutex<Reader>,
}

struct Reader {
    lines: Lines,
    /// Where the point's columns are, in the order of its header, and that of `pdf`.
    columns: Vec<usize>,
    pdf: Option<usize>,
    left: u64,
    row: Vec<f64>,
}

impl SampleFile {
    /// Opens the file at `path`, which should hold samples of `density`, and counts its rows.
    pub fn open(path: &Path, density: Arc<GridDensity>) -> Result<Self> {
        let mut counted = Lines::open(path)?;
        let mut rows = 0u64;
        while counted.next()?.is_some() {
            rows += 1;
        }
        let mut lines = Lines::open(path)?;
        let Some(line) = lines.next()? else { return Err(Error::input(path, "the file is empty")) };
        let names: Vec<String> = line.split(',').map(|name| name.trim().to_lowercase()).collect();
        let find = |name: &str| names.iter().position(|other| other == name);
        let headers = density.space().names();
        let found = headers
            .iter()
            .find_map(|wanted| Some((wanted, wanted.iter().map(|name| find(name)).collect::<Option<Vec<usize>>>()?)));
        let Some((header, columns)) = found else {
            let wanted: Vec<String> = headers.iter().map(|header| header.join(",")).collect();
            let message = format!("the header {} has no columns {}", quote(&names.join(",")), wanted.join(" or "));
            return Err(lines.error(message));
        };
        let pdf = find("pdf");
        // A column that nobody asked for, or for the second time.
        if let Some(i) = (0..names.len()).find(|i| !columns.contains(i) && pdf != Some(*i)) {
            let (name, wanted) = (quote(&names[i]), header.join(","));
            return Err(lines.error(format!("the column {name} has no meaning beside {wanted} and pdf")));
        }
        let reader = Reader { lines, columns, pdf, left: rows - 1, row: Vec::new() };
        Ok(Self { density, reader: Mutex::new(reader) })
    }

    fn reader(&self) -> std::sync::MutexGuard<'_, Reader> {
        // Nothing that panics happens while it is held.
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Reader {
    /// Reads the next row: the numbers of the point, and the pdf if there is one.
    fn next(&mut self) -> Result<Option<f64>> {
        self.left = self.left.saturating_sub(1);
        let Some(numbers) = self.lines.numbers()? else {
            return Err(Error::input(self.lines.path(), "the file ends early: it was changed"));
        };
        let (found, columns) = (numbers.len(), self.columns.len() + usize::from(self.pdf.is_some()));
        if found != columns {
            return Err(self.lines.error(format!("{found} numbers in a row under a header of {columns} columns")));
        }
        self.row.clear();
        self.row.extend(self.columns.iter().map(|&column| numbers[column]));
        Ok(self.pdf.map(|column| numbers[column]))
    }
}

impl Sampler for SampleFile {
    /// The random numbers only count the samples.
    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let mut reader = self.reader();
        for _ in u {
            let claimed = reader.next()?;
            let Some(point) = self.density.space().point(&reader.row) else {
                return Err(reader.lines.error("no point of the domain has such numbers").into());
            };
            let agreed = |claimed: f64| match self.density.agrees(point, claimed) {
                true => self.density.value(point),
                false => claimed,
            };
            out.push(Some(Sample { point, pdf: claimed.map(agreed), atom: false }));
        }
        Ok(())
    }

    fn finite_len(&self) -> Option<u64> {
        Some(self.reader().left)
    }
}
