//! Linear functionals of images: the mean, low-order cosine modes, the mean of each tile.

use etalon_core::raster::Image;
use etalon_stats::Extremes;
use etalon_stats::welch::Mean;
use serde::Serialize;
use std::f64::consts::PI;
use std::ops::Range;

/// Kinds of functionals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    Mean,
    /// Σ x cos(π i (column + ½)/width) cos(π j (row + ½)/height)/n for i, j ≤ 2, not both 0.
    LowFrequency,
    /// The mean of each tile.
    Tiles,
}

impl Family {
    pub const ALL: [Self; 3] = [Self::Mean, Self::LowFrequency, Self::Tiles];

    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::LowFrequency => "low frequency",
            Self::Tiles => "tiles",
        }
    }
}

/// What a test measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Functional {
    Mean,
    /// A mode by its numbers of half waves across and down.
    Mode([usize; 2]),
    /// A tile by its pixels: left, top, width and height.
    Tile([usize; 4]),
}

impl std::fmt::Display for Functional {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Mean => write!(f, "image"),
            Self::Mode([i, j]) => write!(f, "mode {i},{j}"),
            Self::Tile([x, y, ..]) => write!(f, "tile at {x},{y}"),
        }
    }
}

/// Most tiles of an image. The critical t grows with their number like √(2 ln n): from 10 tiles to these 192 by a quarter.
const MOST_TILES: f64 = 192.0;
/// Half waves of the highest mode.
const HIGHEST: usize = 2;
/// The mean and the modes.
pub const WAVES: usize = (HIGHEST + 1) * (HIGHEST + 1);

/// The functionals of images of one size.
pub struct Layout<'a> {
    size: [usize; 2],
    side: usize,
    valid: &'a [bool],
    /// Pixels of the image and of each tile that count.
    pixels: usize,
    in_tile: Vec<usize>,
}

/// An image in 4 × 4 blocks, beside which correlations of noise should be short.
pub struct Blocks<'a> {
    size: [usize; 2],
    valid: &'a [bool],
    pub pixels: Vec<Vec<usize>>,
}

impl<'a> Blocks<'a> {
    const PER_SIDE: usize = 4;

    pub fn new(size: [usize; 2], valid: &'a [bool]) -> Self {
        let block = |pixel: usize| {
            let at = [pixel % size[0] * Self::PER_SIDE / size[0], pixel / size[0] * Self::PER_SIDE / size[1]];
            at[1] * Self::PER_SIDE + at[0]
        };
        let mut pixels = vec![Vec::new(); Self::PER_SIDE * Self::PER_SIDE];
        (0..valid.len()).filter(|&pixel| valid[pixel]).for_each(|pixel| pixels[block(pixel)].push(pixel));
        Self { size, valid, pixels }
    }

    /// The pixels left, right, above and below, if all of them count.
    pub fn neighbours(&self, pixel: usize) -> Option<[usize; 4]> {
        let [width, height] = self.size;
        let inside = (1..width.saturating_sub(1)).contains(&(pixel % width))
            && (1..height.saturating_sub(1)).contains(&(pixel / width));
        if !inside {
            return None;
        }
        let near = [pixel - 1, pixel + 1, pixel - width, pixel + width];
        near.iter().all(|&pixel| self.valid[pixel]).then_some(near)
    }
}

/// A weighted sum of independent pixels: Σ w²σ², Σ w⁴σ⁴ and the largest w²σ².
#[derive(Debug, Clone, Copy, Default)]
pub struct Spread {
    sum: f64,
    squares: f64,
    largest: f64,
}

impl Spread {
    fn add(&mut self, variance: f64) {
        self.sum += variance;
        self.squares += variance * variance;
        self.largest = self.largest.at_least(variance);
    }

    /// Variance, Satterthwaite's degrees of freedom with one for each pixel (whose variance may come from a single sample),
    /// and the share of the noisiest pixel.
    pub fn parts(&self) -> (f64, f64, f64) {
        if self.sum > 0.0 {
            (self.sum, self.sum * self.sum / self.squares, self.largest / self.sum)
        } else {
            (0.0, f64::INFINITY, 0.0)
        }
    }
}

impl<'a> Layout<'a> {
    /// The functionals over the pixels that are `valid`, with square tiles.
    pub fn new([width, height]: [usize; 2], valid: &'a [bool]) -> Self {
        let side = ((width * height) as f64 / MOST_TILES).sqrt().ceil() as usize;
        // Whole rows and columns of tiles may be a few more than the area asks for.
        let count = |side: usize| width.div_ceil(side) * height.div_ceil(side);
        let side = (side.max(1)..).find(|side| count(*side) as f64 <= MOST_TILES).unwrap_or(width.max(height));
        let mut layout = Self { size: [width, height], side, valid, pixels: 0, in_tile: vec![0; count(side)] };
        for (i, _) in valid.iter().enumerate().filter(|(_, valid)| **valid) {
            let tile = layout.tile_of(i % width, i / width);
            layout.pixels += 1;
            layout.in_tile[tile] += 1;
        }
        layout
    }

    pub fn pixels(&self) -> usize {
        self.pixels
    }

    pub fn side(&self) -> usize {
        self.side
    }

    fn tile_of(&self, x: usize, y: usize) -> usize {
        y / self.side * self.size[0].div_ceil(self.side) + x / self.side
    }

    pub fn count(&self) -> usize {
        WAVES + self.in_tile.len()
    }

    /// The functionals of a family that any pixel counts in.
    pub fn of(&self, family: Family) -> impl Iterator<Item = usize> + '_ {
        let range: Range<usize> = match family {
            Family::Mean => 0..1,
            Family::LowFrequency => 1..WAVES,
            Family::Tiles => WAVES..self.count(),
        };
        range.filter(|i| *i < WAVES || self.in_tile[i - WAVES] > 0)
    }

    pub fn functional(&self, i: usize) -> Functional {
        match i {
            0 => Functional::Mean,
            1..WAVES => Functional::Mode([i % (HIGHEST + 1), i / (HIGHEST + 1)]),
            _ => {
                let columns = self.size[0].div_ceil(self.side);
                let [x, y] = [(i - WAVES) % columns * self.side, (i - WAVES) / columns * self.side];
                Functional::Tile([x, y, self.side.min(self.size[0] - x), self.side.min(self.size[1] - y)])
            }
        }
    }

    /// The tile `i` and those around it that any pixel counts in.
    pub fn neighbours(&self, i: usize) -> Vec<usize> {
        let [columns, rows] = self.size.map(|n| n.div_ceil(self.side));
        let [x, y] = [(i - WAVES) % columns, (i - WAVES) / columns];
        let near = |at: usize, n: usize| at.saturating_sub(1)..(at + 2).min(n);
        let tiles = near(y, rows).flat_map(|y| near(x, columns).map(move |x| y * columns + x));
        tiles.filter(|tile| self.in_tile[*tile] > 0).map(|tile| WAVES + tile).collect()
    }

    /// Gives `add` the number and the weight of every functional at every pixel that counts.
    fn weights(&self, mut add: impl FnMut(usize, usize, f64)) {
        let cosines = |n: usize| -> Vec<[f64; HIGHEST + 1]> {
            let at = |p: usize, k: usize| (PI * k as f64 * (p as f64 + 0.5) / n as f64).cos();
            (0..n).map(|p| std::array::from_fn(|k| at(p, k))).collect()
        };
        let [across, down] = self.size.map(cosines);
        for (y, down) in down.iter().enumerate() {
            for (x, across) in across.iter().enumerate() {
                let pixel = y * self.size[0] + x;
                if self.valid[pixel] {
                    for i in 0..WAVES {
                        add(pixel, i, across[i % (HIGHEST + 1)] * down[i / (HIGHEST + 1)] / self.pixels as f64);
                    }
                    let tile = self.tile_of(x, y);
                    add(pixel, WAVES + tile, 1.0 / self.in_tile[tile] as f64);
                }
            }
        }
    }

    pub fn values(&self, image: &Image) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.count()];
        self.weights(|pixel, i, weight| {
            let value = image.pixels()[pixel];
            (0..3).for_each(|c| sums[i][c] += weight * f64::from(value[c]));
        });
        sums
    }

    /// Σ |w x| of each functional: what its precision is relative to.
    pub fn scales(&self, image: &Image) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.count()];
        self.weights(|pixel, i, weight| {
            let value = image.pixels()[pixel];
            (0..3).for_each(|c| sums[i][c] += (weight * f64::from(value[c])).abs());
        });
        sums
    }

    /// The variances of all functionals, from the standard errors of independent pixels.
    pub fn spread(&self, error: &Image) -> Vec<[Spread; 3]> {
        let mut sums = vec![[Spread::default(); 3]; self.count()];
        self.weights(|pixel, i, weight| {
            let error = error.pixels()[pixel];
            (0..3).for_each(|c| sums[i][c].add((weight * f64::from(error[c])).powi(2)));
        });
        sums
    }

    /// The covariances of the mean and the modes, by channel, of independent pixels of these variances.
    pub fn covariances(&self, variances: &[[f64; 3]]) -> [[[f64; WAVES]; WAVES]; 3] {
        let mut sums = [[[0.0; WAVES]; WAVES]; 3];
        let mut weights = [0.0; WAVES];
        // The tile comes last of a pixel's functionals.
        self.weights(|pixel, i, weight| {
            if i < WAVES {
                weights[i] = weight;
                return;
            }
            for (sums, variance) in sums.iter_mut().zip(variances[pixel]) {
                for (row, a) in sums.iter_mut().zip(weights) {
                    row.iter_mut().zip(weights).for_each(|(sum, b)| *sum += a * b * variance);
                }
            }
        });
        sums
    }
}

/// What a side says about a functional in a channel.
#[derive(Clone)]
pub struct Observed {
    pub mean: Mean,
    pub dominated: bool,
}
