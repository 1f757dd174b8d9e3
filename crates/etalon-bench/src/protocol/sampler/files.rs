//! Samples and a pdf from files, for samplers that cannot be called.
//!
//! Samples: CSV with a header, one point a row (see [`Space::names`]) and perhaps its pdf in a column `pdf`. The pdf: a grid of
//! values, each constant over its part of the domain (see [`GridDensity`]).

use crate::protocol::sampler::Space;
use etalon_core::envmap::LatLong;
use etalon_core::error::{Error, Place, Result};
use etalon_core::files::{self, without_bom};
use etalon_core::import::place::{quote, real};
use etalon_core::memory;
use etalon_core::raster::{self, ReadOptions};
use etalon_stats::{Density, Directions, Point, Pole, Sample, Sampler};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
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
        // NumPy marks a header as a comment.
        let line = line.trim_start_matches('#');
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
            out.push(Some(Sample { pdf: claimed.map(agreed), ..Sample::new(point) }));
        }
        Ok(())
    }

    fn finite_len(&self) -> Option<u64> {
        Some(self.reader().left)
    }
}

const VALUES: usize = 1 << 24;

/// Values on rectangles of a domain's chart; its mass is declared to be 1.
#[derive(Debug)]
pub struct GridDensity {
    space: Space,
    /// Lines of the chart between the rectangles, for each axis.
    steps: [Vec<f64>; 2],
    /// Value of each rectangle, those along the second axis next to each other.
    values: Vec<f64>,
}

impl GridDensity {
    /// Reads a table of numbers without a header: rows of equal length, with commas.
    pub fn read_csv(space: Space, path: &Path) -> Result<Self> {
        let domain = space.domain();
        space.steps([1, 1])?;
        let (mut rows, mut columns, values) = read_table(path)?;
        if !domain.is_plane() {
            if rows > 1 && columns > 1 {
                return Err(Error::input(path, format!("{rows} × {columns} values where a row or a column belongs")));
            }
            (rows, columns) = (rows * columns, 1);
        }
        if let Some(outcomes) = domain.outcomes().filter(|n| *n != rows) {
            return Err(Error::input(path, format!("{rows} values for {outcomes} outcomes")));
        }
        let values = if domain.is_transposed() {
            memory::request(size_of_val(&values[..]), || table(path))?;
            (0..values.len()).map(|i| values[i % rows * columns + i / rows]).collect()
        } else {
            values
        };
        Ok(Self { steps: space.steps([rows, columns])?, values, space })
    }

    /// Whether `claimed` is the pdf at `point` up to rounding of both, in text or to f32.
    fn agrees(&self, point: Point, claimed: f64) -> bool {
        const ROUNDING: f64 = 1e-5;
        let Some([x, y]) = self.space.domain().to_chart(point) else { return false };
        let near = |at: f64| [(at - ROUNDING).max(0.0), at, (at + ROUNDING).min(1f64.next_down())];
        near(x).iter().any(|&x| {
            near(y).iter().any(|&y| {
                let pdf = self.at([x, y]);
                (claimed - pdf).abs() <= ROUNDING * pdf
            })
        })
    }

    fn at(&self, chart: [f64; 2]) -> f64 {
        let [i, j] = [0, 1].map(|axis| self.steps[axis].partition_point(|&step| step <= chart[axis]));
        self.values[i * (self.steps[1].len() + 1) + j]
    }

    /// The pdf at a point, 0 outside of the domain.
    fn value(&self, point: Point) -> f64 {
        self.space.domain().to_chart(point).map_or(0.0, |place| self.at(place))
    }

    /// The domain of the pdf.
    pub fn space(&self) -> Space {
        self.space.clone()
    }

    /// Reads a lat-long image of densities per sr, with the orientation of environment maps: +y is up, and columns go from
    /// +x towards +z ([`LatLong`](etalon_core::envmap)). The channels must be equal. Also returns the reader's notes (see
    /// [`read_lat_long`](raster::read_lat_long)).
    pub fn read_image(path: &Path) -> Result<(Self, Vec<String>)> {
        let (image, notes) = raster::read_lat_long(path, ReadOptions::default())?;
        let (width, height) = (image.width(), image.height());
        if image.pixels().iter().any(|p| p.x != p.y || p.y != p.z) {
            return Err(Error::unsupported(path, "a density of several colours").with_hint("write one channel, Y"));
        }
        memory::request(width * height * size_of::<f64>(), || table(path))?;
        let space = Space::new("sphere", Directions::sphere(Pole::Y));
        let [rows, turns] = LatLong::new(width, height).edges();
        let edges = [&[0.0], &turns[..], &[1.0]].concat();
        let columns: Vec<usize> =
            edges.windows(2).map(|edge| ((1.25 - 0.5 * (edge[0] + edge[1])).fract() * width as f64) as usize).collect();
        let row = |y: usize| columns.iter().map(move |&x| (x, y));
        let values = (0..height).flat_map(row).map(|(x, y)| f64::from(image.get(x.min(width - 1), y).x)).collect();
        Ok((Self { steps: [rows, turns], values, space }, notes))
    }
}

impl Density for GridDensity {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> etalon_stats::Result<()> {
        out.extend(points.iter().map(|&point| self.value(point)));
        Ok(())
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        Some(self.steps.clone())
    }
}

/// What the memory of a table is for.
fn table(path: &Path) -> String {
    format!("{}, a table of densities", path.display())
}

/// A table without a header: the number of its rows and columns, and the values row by row.
fn read_table(path: &Path) -> Result<(usize, usize, Vec<f64>)> {
    let mut lines = Lines::open(path)?;
    let (mut rows, mut columns, mut values) = (0, 0, Vec::new());
    while let Some(row) = lines.numbers()? {
        if rows > 0 && row.len() != columns {
            return Err(lines.error(format!("{} numbers in a row, {columns} in those before", row.len())));
        }
        (rows, columns) = (rows + 1, row.len());
        row.into_iter().try_for_each(|value| memory::push(&mut values, value, || table(path)))?;
        if values.len() > VALUES {
            return Err(Error::limit(path, format!("more than {VALUES} values")));
        }
    }
    if values.is_empty() { Err(Error::input(path, "the file is empty")) } else { Ok((rows, columns, values)) }
}

/// Longest line, in bytes.
const LONGEST: u64 = 1 << 20;

struct Lines {
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

    /// The next line that is neither empty nor, below the first, a comment; `None` at the end.
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
            let is_comment = self.number > 1 && self.line.starts_with(b"#");
            if !self.line.trim_ascii().is_empty() && !is_comment {
                break;
            }
        }
        let text = std::str::from_utf8(&self.line).map_err(|_| self.error("the line is not UTF-8"))?;
        Ok(Some(text.trim()))
    }

    /// The numbers of the next line that is neither empty nor a comment, with commas between them; none of them is NaN.
    pub fn numbers(&mut self) -> Result<Option<Vec<f64>>> {
        while self.next()?.is_some_and(|line| line.starts_with('#')) {}
        let line = std::str::from_utf8(&self.line).unwrap_or_default().trim();
        if line.is_empty() {
            return Ok(None);
        }
        let number = |word: &str| real(word.trim()).ok_or_else(|| format!("{} is not a number", quote(word.trim())));
        let numbers: std::result::Result<Vec<f64>, String> = line.split(',').map(number).collect();
        numbers.map(Some).map_err(|message| self.error(message))
    }
}
