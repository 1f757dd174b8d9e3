//! `etalon compare`: the difference of two images, of many images from one, or a test whether two renderers have the same expectation.

mod each;
mod expectation;
mod pair;

use super::console::Console;
use super::global::{Global, OUTPUT, Reports, Verdict, out, threads};
use crate::cli::style::StyleArgs;
use crate::cli::values::{choice, fraction, share};
use clap::{ArgAction, ArgGroup, Args};
use etalon_bench::compare::{Explanation, Limit, METRICS, Measured, Metric, explain_turned, with_interval};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::raster::{self, Image, ReadOptions};
use etalon_figures::view::checks::Check;
use etalon_figures::view::compare::{self as view, explained};
use etalon_figures::view::text::{counted, rounded};
use std::path::{Path, PathBuf};

/// Compare two images, many with one, or test whether two renderers have the same expectation
#[derive(Args)]
#[command(
    after_long_help = "Metrics: mse = mean((a-b)^2), rel_mse = mean((a-b)^2 / (b^2 + 0.01)), mape = mean(|a-b| / (|b| + 0.01)), \
                        smape = mean(|a-b| / ((|a|+|b|)/2 + 0.01)), over all channel values, each also without the worst 0.1 % of \
                        them; HDR-FLIP, PSNR and SSIM of the images as shown. B is the reference. Cube maps are compared as they are stored.\n\n\
                        Two images: writes A-vs-B.{png,svg,pdf}: A, B, and in false colour the difference of the mean of R, G and B.\n\n\
                        With --each: a row for each image, as text and as IMAGES-vs-REF.csv, and IMAGES-vs-REF.{png,svg,pdf}: every image beside its \
                        difference, all on one scale, with a green frame where the difference is unlike that of most places; rejected ones in an orange frame. IMAGES is how their names \
                        begin, or their folder. A PNG beside a given .exr, .pfm or .hdr file of the same name is left out. An image that cannot be read, or without --at-most and --reject one of another size, does not stop \
                        the others; the exit code is 2 then.\n\n\
                        With --at-most: exit code 1 if a metric of an image is larger, a pixel is not finite, or (with --each) its size is another. With --reject: if it has a usual mistake or differs by more than noise (mistake), or has the values of the reference or of an image before it (copy).\n\nWith --against: Welch's t-tests of the image mean, of \
                        low-frequency modes and of tiles, at one level. The bias is that of the channel that differs most (`etalon converge`: of the mean of all \
                        channels), in percent of the mean of B, that of a tile in percent of the tile's own. Exit code 1: different; 0: no difference found, and a bias of \
                        --detect would have been found with 90 % probability; 3: cannot tell, with the numbers of images that would find it. The book has the formulas and the \
                        layers that single images need.\n\nExamples:\n  etalon render sphere-env -s 1 -o a.exr && etalon render sphere-env -o b.exr && etalon compare a.exr b.exr\n  etalon compare render.exr reference.exr\n  \
                        etalon compare render.exr golden.exr --at-most flip=.05 --junit golden.xml\n  \
                        etalon compare --each students/*.png --reference reference.png --sort flip --reject mistake,copy\n  \
                        etalon compare mine-*.exr --against theirs-*.exr --detect 0.5%\n  \
                        etalon compare render.exr --against mitsuba-moment.exr --spp 256"
)]
#[command(next_help_heading = "Images and tests", args = [out(), threads()])]
// Two images alone have no checks to report
#[command(group = ArgGroup::new("checked").args(["against", "each", "at_most"]).multiple(true))]
#[command(mut_arg("junit", |arg| arg.requires("checked")), mut_arg("markdown", |arg| arg.requires("checked")))]
pub struct Compare {
    /// Two images; with --against, all images of the first renderer
    #[arg(value_name = "IMAGE", required_unless_present = "each", conflicts_with = "each", help_heading = None::<&str>)]
    a: Vec<PathBuf>,
    /// Compare each of these images with the image of --reference
    #[arg(long, value_name = "IMAGE", num_args = 1.., action = ArgAction::Set, requires = "reference", conflicts_with = "against")]
    each: Vec<PathBuf>,
    /// The image that each is compared with
    #[arg(long, value_name = "IMAGE", requires = "each")]
    reference: Option<PathBuf>,
    /// Sort the table of --each by a metric, the best first [default: as given]
    ///
    /// mse, rel_mse, flip, ssim, psnr, rmse, mape, smape or max_abs.
    #[arg(long, value_name = "METRIC", value_parser = metric, requires = "each")]
    sort: Option<&'static Metric>,
    /// Reject an image of which a metric is larger: flip=.05,mse=.01
    ///
    /// METRIC is mse, rel_mse, flip, rmse, mape, smape or max_abs.
    #[arg(long, value_name = "METRIC=N,...", value_parser = limit, value_delimiter = ',', action = ArgAction::Set, conflicts_with = "against")]
    at_most: Vec<Limit>,
    /// Reject an image of --each for these reasons, whatever its metrics
    #[arg(long, value_name = "WHY,...", value_parser = choice(REASONS), value_delimiter = ',', action = ArgAction::Set, requires = "each")]
    reject: Vec<Reason>,
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
    #[arg(long, help_heading = OUTPUT, conflicts_with_all = ["against", "each"])]
    relative: bool,
    #[command(flatten)]
    reports: Reports,
    #[command(flatten)]
    style: StyleArgs,
}

impl Compare {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        match (self.a.as_slice(), &self.reference) {
            ([], Some(reference)) => self.measure_each(reference, global, console),
            (_, Some(_)) => {
                Err(Error::parameter("reference", "it is the reference of the images of `each`, and there are none")
                    .with_hint("give the images by `each`; to compare two, give one after the other"))
            }
            _ if !self.against.is_empty() => self.test(global, console),
            ([a, b], None) => self.measure(a, b, global, console),
            (images, None) => {
                let message = format!("{} given: a difference is that of two", counted(images.len(), "image"));
                Err(Error::parameter("a", message).with_hint(
                    "to compare many images with one, give them by `each` and the one by `reference`; to test images of two \
                     renderers, give the second's by `against`",
                ))
            }
        }
    }

    /// A check for each limit of an image.
    fn checks(&self, group: &str, measured: &Measured) -> Vec<Check> {
        let one = |limit: &Limit| {
            let verdict =
                if limit.holds(measured) { etalon_stats::Verdict::Accept } else { etalon_stats::Verdict::Reject };
            let found = rounded(limit.metric.of(measured), 4).replace("NaN", "not defined");
            let (title, most) = (limit.metric.title, limit.most);
            let said = match measured.numbers.non_finite {
                0 => format!("{title} is {found}, at most {most} allowed"),
                count => {
                    format!("{}, which no limit allows; {title} of the others is {found}", view::not_finite(count))
                }
            };
            let why = why(measured).map_or(String::new(), |why| format!("; {why}"));
            Check {
                group: group.to_owned(),
                name: limit.metric.name.into(),
                verdict: Some(verdict),
                message: said + &why,
                details: String::new(),
                seconds: None,
            }
        };
        self.at_most.iter().map(one).collect()
    }

    /// Whether an image keeps all limits.
    fn is_within(&self, measured: &Measured) -> bool {
        self.at_most.iter().all(|limit| limit.holds(measured))
    }
}

/// Why an image of many is rejected beside limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reason {
    Mistake,
    Copy,
}

const REASONS: [(&str, &str, Reason); 2] = [
    ("mistake", "A usual mistake, or a difference that is more than noise", Reason::Mistake),
    ("copy", "The values of the reference, or of an image before it", Reason::Copy),
];

/// What explains the difference, or that nothing does.
fn why(measured: &Measured) -> Option<String> {
    measured.explanation.as_ref().map(explained).or_else(|| unknown(measured))
}

/// Means that differ by less are not told.
const TOLD: f64 = 0.01;

/// What is said of a difference that nothing explains.
fn unknown(measured: &Measured) -> Option<String> {
    (measured.beyond_noise == Some(true)).then(|| match measured.ratio_of_means {
        Some([ratio, half_width]) => {
            let ratio = with_interval(ratio, half_width);
            format!("more than noise: the mean of A is {ratio} times that of B; noise hides what explains it")
        }
        None => {
            let ratio = measured.numbers.mean_a / measured.numbers.mean_b;
            let is_told = (ratio - 1.0).abs() >= TOLD && ratio.is_finite();
            let mean = if is_told { format!("; the mean of A is {ratio:.2} times that of B") } else { String::new() };
            format!("more than noise, and no usual mistake explains it{mean}")
        }
    })
}

/// What is said of pixels that are not finite, if there are any.
fn left_out(measured: &Measured) -> Option<String> {
    let count = measured.numbers.non_finite;
    (count > 0).then(|| view::left_out(count))
}

/// An image of any kind, 8-bit ones too.
struct Input {
    image: Image,
    /// What must be known of the file.
    notes: Vec<String>,
    /// Whether its values are integers, and so clipped at 1.
    is_clipped: bool,
}

fn read(path: &Path) -> Result<Input> {
    let linear = raster::read_with_notes(path, ReadOptions::default());
    let is_clipped = matches!(linear, Err(Error::Unsupported { .. }));
    let (image, notes) = match linear {
        Err(_) if is_clipped => {
            raster::read_with_notes(path, ReadOptions { allow_ldr: true, ..ReadOptions::default() })
        }
        linear => linear,
    }?;
    Ok(Input { image, notes, is_clipped })
}

impl Input {
    /// Linear light as integers have it, which end at 1.
    fn clipped(self) -> Self {
        let image = self.image.map(|p| if p.is_finite() { p.min(Rgb::ONE) } else { p });
        Self { image, is_clipped: true, ..self }
    }
}

/// What is said of two images of different sizes.
struct OtherSize {
    /// Columns and rows of A and of B.
    sizes: [[usize; 2]; 2],
    /// A turn that makes the sizes equal, and the difference noise.
    explanation: Option<Explanation>,
}

impl OtherSize {
    /// "360x480, not 480x360".
    fn text(&self) -> String {
        let [[w, h], [b_w, b_h]] = self.sizes;
        format!("{w}x{h}, not {b_w}x{b_h}")
    }

    fn error(&self, a_path: &Path, b_path: &Path) -> Error {
        let [[w, h], [b_w, b_h]] = self.sizes;
        let hint = match &self.explanation {
            Some(turn) => format!("only images of the same size can be compared; {}", explained(turn)),
            None => "only images of the same size can be compared".into(),
        };
        Error::input(b_path, format!("{b_w}x{b_h} pixels, but {} has {w}x{h}", a_path.display())).with_hint(hint)
    }
}

/// The metrics of two images of files.
fn measure(a_path: &Path, a: &Input, b_path: &Path, b: &Input) -> Result<std::result::Result<Measured, OtherSize>> {
    let size = |of: &Input| [of.image.width(), of.image.height()];
    let ([w, h], [b_w, b_h]) = (size(a), size(b));
    if [w, h] != [b_w, b_h] {
        let explanation = ([w, h] == [b_h, b_w]).then(|| explain_turned(&a.image, &b.image)).flatten();
        return Ok(Err(OtherSize { sizes: [[w, h], [b_w, b_h]], explanation }));
    }
    let measured = Measured::of(&a.image, &b.image, [a.is_clipped, b.is_clipped])?;
    if measured.numbers.pixels == 0 {
        let message = format!("no pixel is finite both here and in {}: nothing to compare", b_path.display());
        return Err(Error::input(a_path, message).with_hint("`etalon envmap info` counts values by kind"));
    }
    Ok(Ok(measured))
}

fn metric(name: &str) -> std::result::Result<&'static Metric, String> {
    let known = || METRICS.iter().map(|metric| metric.name).collect::<Vec<_>>().join(", ");
    Metric::named(name).ok_or_else(|| format!("no metric; known are {}", known()))
}

/// Reads a limit, `flip=.05`.
fn limit(text: &str) -> std::result::Result<Limit, String> {
    let (name, most) = text.split_once('=').ok_or("no limit such as flip=.05")?;
    let metric = metric(name.trim())?;
    if metric.is_similarity {
        return Err(format!(
            "{} is larger for images that are more alike; limit an error, such as flip=.05",
            metric.name
        ));
    }
    let most = fraction(most).filter(|most| *most >= 0.0);
    Ok(Limit { metric, most: most.ok_or("no number of 0 or more after =")? })
}

#[cfg(test)]
mod tests {
    #[test]
    fn limits_are_of_errors() {
        let read = |text| super::limit(text).map(|limit| (limit.metric.name, limit.most));
        assert_eq!(read("flip=5%"), Ok(("flip", 0.05)));
        assert_eq!([read("flip=.05"), read("hdr_flip= 1e-2")], [Ok(("flip", 0.05)), Ok(("flip", 0.01))]);
        assert!(["flip", "flip=", "flip=-1", "flip=nan", "ssim=.9", "x=1"].into_iter().all(|text| read(text).is_err()));
    }
}
