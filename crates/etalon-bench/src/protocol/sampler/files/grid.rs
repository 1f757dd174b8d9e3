//! A pdf that is constant on the cells of a grid, from a table or a lat-long image.

use super::lines::Lines;
use crate::protocol::sampler::Space;
use etalon_core::envmap::LatLong;
use etalon_core::error::{Error, Result};
use etalon_core::memory;
use etalon_core::raster::{self, ReadOptions};
use etalon_stats::{Density, Directions, Point, Pole};
use std::path::Path;

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
        let values = if space.is_transposed() {
            memory::request(size_of_val(&values[..]), || table(path))?;
            (0..values.len()).map(|i| values[i % rows * columns + i / rows]).collect()
        } else {
            values
        };
        Ok(Self { steps: space.steps([rows, columns]), values, space })
    }

    /// Whether `claimed` is the pdf at `point` up to rounding of both, in text or to f32.
    pub(super) fn agrees(&self, point: Point, claimed: f64) -> bool {
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
    pub(super) fn value(&self, point: Point) -> f64 {
        self.space.domain().to_chart(point).map_or(0.0, |place| self.at(place))
    }

    /// The domain of the pdf.
    pub fn space(&self) -> Space {
        self.space
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
        let space = Space::Directions(Directions::sphere(Pole::Y));
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
