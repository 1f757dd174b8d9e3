//! `etalon compare`: the difference of two images, as numbers and in false colour.

use super::console::Console;
use super::global::{Global, Verdict};
use super::map_file::short_name;
use crate::error::{Error, Result};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Shading};
use crate::interrupt;
use crate::output;
use crate::raster::{self, Comparison, Image, ReadOptions};
use crate::view::text::counted;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Compare two images
#[derive(Args)]
#[command(after_help = "mse = mean((a-b)^2), rel_mse = mean((a-b)^2 / (b^2 + 0.01)), over all channel values. Writes \
                        A-vs-B.{png,svg,pdf}: the difference of the mean of R, G and B in false colour. Cube maps are compared \
                        as they are stored.\n\nExample:\n  etalon \
                        compare render.exr reference.exr")]
pub struct Compare {
    a: PathBuf,
    b: PathBuf,
}

impl Compare {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        // Images of any kind may be compared, 8-bit ones too.
        let read = |path| {
            let (image, notes) = raster::read_with_notes(path, ReadOptions { allow_ldr: true })?;
            notes.iter().for_each(|note| console.warn(note));
            Ok::<_, Error>(image)
        };
        let name = format!("{}-vs-{}", short_name(self.a.as_os_str()), short_name(self.b.as_os_str()));
        let target = global.target(&["a", "b"]);
        let stem = target.stem(&name, "", &output::DRAWING)?;
        let (a, b) = (read(&self.a)?, read(&self.b)?);
        let numbers = raster::compare(&a, &b)?;
        // FLIP filters the images once for each exposure, which takes minutes for the largest.
        let flip = (a.pixels().len() <= LARGEST_FLIP).then(|| raster::hdr_flip(&a, &b)).flatten();
        interrupt::check()?;
        if numbers.pixels == 0 {
            let message = format!("no pixel is finite both here and in {}: nothing to compare", self.b.display());
            return Err(Error::input(&self.a, message).with_hint("`etalon envmap info` counts values by kind"));
        }
        let written = target.written(difference(&a, &b).write(&stem)?);
        if numbers.non_finite > 0 {
            console.warn(&format!("left out: {} with NaN or infinite values", counted(numbers.non_finite, "pixel")));
        }
        console.saved(&Output { numbers, hdr_flip: flip }, &written, || {
            let Comparison { mse, rmse, rel_mse, mape, smape, max_abs, mean_a, mean_b, .. } = numbers;
            let trimmed = |value: f64| format!("   {value:.6e} without the worst 0.1 %");
            [
                ("mse", mse, trimmed(numbers.mse_trimmed)),
                ("rmse", rmse, String::new()),
                ("rel_mse", rel_mse, trimmed(numbers.rel_mse_trimmed)),
                ("mape", mape, trimmed(numbers.mape_trimmed)),
                ("smape", smape, trimmed(numbers.smape_trimmed)),
                ("hdr_flip", flip.unwrap_or(f64::NAN), String::new()),
                ("max_abs", max_abs, String::new()),
                ("mean_a", mean_a, String::new()),
                ("mean_b", mean_b, String::new()),
            ]
            .map(|(name, value, more)| format!("{name:<8} {value:.6e}{more}\n"))
            .concat()
        });
        Ok(Verdict::Good)
    }
}

/// The JSON object.
#[derive(Serialize)]
struct Output {
    #[serde(flatten)]
    numbers: Comparison,
    /// Missing where it is not defined, as for a black reference, and for images of more than [`LARGEST_FLIP`] pixels.
    hdr_flip: Option<f64>,
}

/// Most pixels of an image for HDR-FLIP.
const LARGEST_FLIP: usize = 1 << 22;
/// Longest side of the drawing of the difference, in pixels.
const LONGEST_SIDE: usize = 2048;

/// Difference of (R + G + B)/3 in diverging colours around 0.
fn difference(a: &Image, b: &Image) -> Drawing {
    let (width, height) = (a.width(), a.height());
    // Large images are averaged over squares of pixels.
    let side = width.max(height).div_ceil(LONGEST_SIDE);
    let at = |x: usize, y: usize| (a.get(x, y).as_dvec3() - b.get(x, y).as_dvec3()).element_sum() / 3.0;
    let square = |x: usize, y: usize| {
        let (columns, rows) = (x..width.min(x + side), y..height.min(y + side));
        let count = (columns.len() * rows.len()) as f64;
        rows.flat_map(|y| columns.clone().map(move |x| at(x, y))).sum::<f64>() / count
    };
    let rows = (0..height).step_by(side);
    let values: Vec<f64> = rows.flat_map(|y| (0..width).step_by(side).map(move |x| square(x, y))).collect();
    // A scale that holds 99 % of the differences: a single bright pixel does not hide the others
    let mut sizes: Vec<f64> = values.iter().filter(|v| v.is_finite()).map(|v| v.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let limit = sizes.get(sizes.len() * 99 / 100).copied().filter(|v| *v > 0.0);
    let limit = limit.or(sizes.last().copied()).unwrap_or(0.0);
    let label = "difference of (R + G + B)/3 (1 % exceed the scale)";
    let map = Heatmap::new(width.div_ceil(side), values, Shading::Diverging, label).range(-limit, limit);
    let (width, height) = (width as f64, height as f64);
    let panel = Panel::new(Axis::linear("column").range(0.0, width), Axis::linear("row").range(height, 0.0))
        .title("A − B: blue where A is darker, red where it is brighter")
        .heatmap(map);
    let longer = 480.0 / width.max(height);
    Plot::new([panel]).frame_size(width * longer, height * longer).draw()
}
