//! `etalon compare`: the difference of two images, or a test whether two renderers have the same expectation.

mod expectation;

use super::console::Console;
use super::global::{Global, OUTPUT, Reports, Verdict, out, threads};
use super::map_file::short_name;
use crate::cli::style::StyleArgs;
use clap::{ArgAction, Args};
use etalon_bench::compare::{Explanation, explain};
use etalon_bench::table::Table;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{self, Comparison, DisplayMetrics, Image, ReadOptions};
use etalon_figures::output;
use etalon_figures::view::compare as view;
use etalon_figures::view::text::{counted, rounded};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Compare two images, or test whether two renderers have the same expectation
#[derive(Args)]
#[command(
    after_long_help = "Two images: mse = mean((a-b)^2), rel_mse = mean((a-b)^2 / (b^2 + 0.01)), mape = mean(|a-b| / (|b| + 0.01)), \
                        smape = mean(|a-b| / ((|a|+|b|)/2 + 0.01)), over all channel values, each also without the worst 0.1 % of \
                        them; HDR-FLIP. Writes A-vs-B.{png,svg,pdf}: the difference of the mean of R, G and B in false colour. \
                        Cube maps are compared as they are stored.\n\nWith --against: Welch's t-tests of the image mean, of \
                        low-frequency modes and of tiles, at one level. Exit code 1: different; 0: no difference found, and a bias of \
                        --detect would have been found with 90 % probability; 3: cannot tell. The book has the formulas and the \
                        layers that single images need.\n\nExamples:\n  etalon compare render.exr reference.exr\n  \
                        etalon compare mine-*.exr --against theirs-*.exr --detect 0.5%\n  \
                        etalon compare render.exr --against mitsuba-moment.exr --spp 256"
)]
#[command(next_help_heading = "Images and tests", args = [out(), threads()])]
// Two images alone have no checks to report
#[command(mut_arg("junit", |arg| arg.requires("against")), mut_arg("markdown", |arg| arg.requires("against")))]
pub struct Compare {
    /// Two images; with --against, all images of the first renderer
    #[arg(value_name = "IMAGE", required = true, help_heading = None::<&str>)]
    a: Vec<PathBuf>,
    /// Images of the second renderer: test whether both have one expectation
    #[arg(long, value_name = "IMAGE", num_args = 1.., action = ArgAction::Set)]
    against: Vec<PathBuf>,
    /// The image of --against is the expectation itself, without noise
    #[arg(long, requires = "against")]
    exact: bool,
    /// Relative bias of the whole image to find with 90 % probability: 0.01 or 1%
    #[arg(long, value_name = "W", default_value = "1%", value_parser = share, requires = "against")]
    detect: f64,
    /// Probability of calling images of one expectation different
    #[arg(long, value_name = "A", default_value = "0.01", value_parser = share, requires = "against")]
    level: f64,
    /// Samples per pixel of images with second moments that do not say it
    ///
    /// As those by Mitsuba's integrator `moment`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..), requires = "against")]
    spp: Option<u32>,
    /// Draw the difference of two images relative to |B| + 0.01
    #[arg(long, help_heading = OUTPUT, conflicts_with = "against")]
    relative: bool,
    #[command(flatten)]
    reports: Reports,
    #[command(flatten)]
    style: StyleArgs,
}

impl Compare {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        match self.a.as_slice() {
            _ if !self.against.is_empty() => self.test(global, console),
            [a, b] => self.measure(a, b, global, console),
            images => {
                let message = format!("{} given: a difference is that of two", counted(images.len(), "image"));
                Err(Error::parameter("a", message)
                    .with_hint("to test images of two renderers, give the second's by `against`"))
            }
        }
    }

    fn measure(&self, a_path: &Path, b_path: &Path, global: &Global, console: &Console) -> Result<Verdict> {
        // Images of any kind may be compared, 8-bit ones too: whether it is one stands beside the image.
        let read = |path| {
            let linear = raster::read_with_notes(path, ReadOptions::default());
            let is_clipped = matches!(linear, Err(Error::Unsupported { .. }));
            let (image, notes) = match linear {
                Err(_) if is_clipped => {
                    raster::read_with_notes(path, ReadOptions { allow_ldr: true, ..ReadOptions::default() })
                }
                linear => linear,
            }?;
            notes.iter().for_each(|note| console.warn(note));
            Ok::<_, Error>((image, is_clipped))
        };
        let name = format!("{}-vs-{}", short_name(a_path.as_os_str()), short_name(b_path.as_os_str()));
        let target = global.target();
        let stem = target.stem(&name, "", &output::DRAWING)?;
        let ((a, a_is_clipped), (b, b_is_clipped)) = (read(a_path)?, read(b_path)?);
        let size = |image: &Image| format!("{}x{} pixels", image.width(), image.height());
        let numbers = raster::compare(&a, &b).map_err(|_| {
            let message = format!("{}, but {} has {}", size(&b), a_path.display(), size(&a));
            Error::input(b_path, message).with_hint("only images of the same size can be compared")
        })?;
        // FLIP filters the images once for each exposure, which takes minutes for the largest.
        let is_small = a.pixels().len() <= LARGEST;
        let shown = is_small.then(|| raster::compare_shown(&a, &b));
        interrupt::check()?;
        if numbers.pixels == 0 {
            let message = format!("no pixel is finite both here and in {}: nothing to compare", b_path.display());
            return Err(Error::input(a_path, message).with_hint("`etalon envmap info` counts values by kind"));
        }
        let written = target.written(view::difference(&a, &b, self.relative).write(&stem, &self.style.style()?)?);
        if numbers.non_finite > 0 {
            console.warn(&format!("left out: {} with NaN or infinite values", counted(numbers.non_finite, "pixel")));
        }
        let clipped = match [a_is_clipped, b_is_clipped] {
            [false, false] => None,
            [true, true] => Some("both images have integer values (rounded, clipped at 1, decoded by the sRGB curve)"),
            _ => Some(
                "one image has integer values (rounded, clipped at 1, decoded by the sRGB curve), the other holds linear light",
            ),
        };
        clipped.iter().for_each(|text| console.warn(text));
        let explanation = is_small.then(|| explain(&a, &b)).flatten();
        let output = Output {
            numbers,
            shown: shown.unwrap_or(DisplayMetrics { hdr_flip: None, psnr: f64::NAN, ssim: None }),
            explanation,
        };
        console.saved(&output, &written, || text(&output));
        Ok(Verdict::Good)
    }
}

/// The JSON object.
#[derive(Serialize)]
struct Output {
    #[serde(flatten)]
    numbers: Comparison,
    /// Missing for images of more than [`LARGEST`] pixels.
    #[serde(flatten)]
    shown: DisplayMetrics,
    /// What would explain most of the difference.
    explanation: Option<Explanation>,
}

/// Most pixels of an image for metrics of what is shown and for explanations.
const LARGEST: usize = 1 << 22;

fn text(Output { numbers, shown, explanation }: &Output) -> String {
    let trimmed = |value: f64| format!("{} without the worst 0.1 %", rounded(value, 4));
    let metrics = [
        ("mse", numbers.mse, trimmed(numbers.mse_trimmed)),
        ("rmse", numbers.rmse, String::new()),
        ("rel_mse", numbers.rel_mse, trimmed(numbers.rel_mse_trimmed)),
        ("mape", numbers.mape, trimmed(numbers.mape_trimmed)),
        ("smape", numbers.smape, trimmed(numbers.smape_trimmed)),
        ("hdr_flip", shown.hdr_flip.unwrap_or(f64::NAN), String::new()),
        ("psnr", shown.psnr, "dB".to_owned()),
        ("ssim", shown.ssim.unwrap_or(f64::NAN), String::new()),
        ("max_abs", numbers.max_abs, String::new()),
        ("mean_a", numbers.mean_a, String::new()),
        ("mean_b", numbers.mean_b, String::new()),
    ];
    let explained = explanation.as_ref().map(|Explanation { change, mse_left }| {
        format!("{change}: this leaves {:.2} % of the mean squared error\n", 100.0 * mse_left)
    });
    let metrics = Table::of(&metrics)
        .words("", |(name, ..)| name)
        .numbers("", |(_, value, _)| rounded(*value, 4))
        .words("", |(.., more)| more);
    metrics.text() + &explained.unwrap_or_default()
}

/// Reads a share, as a fraction or in percent, between 0 and 1.
fn share(text: &str) -> std::result::Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let value = number.trim().parse::<f64>().ok().map(|value| value * unit);
    value.filter(|v| *v > 0.0 && *v < 1.0).ok_or("not a share between 0 and 1, such as 0.01 or 1%".into())
}

#[cfg(test)]
mod tests {
    #[test]
    fn shares_are_fractions_or_percent() {
        let read = |text| super::share(text).ok();
        assert_eq!([read("0.01"), read("1%"), read("0.5 %")], [Some(0.01), Some(0.01), Some(0.005)]);
        assert!(["", "0", "1", "100%", "-1%", "nan", "inf", "x"].into_iter().all(|text| read(text).is_none()));
    }
}
