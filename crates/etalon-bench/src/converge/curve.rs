//! The error of one strategy as its samples and its time grow: levels from replicates, the slope, and whether it is bias.

use super::contender::Contender;
use super::doubling::Times;
use super::reference::Reference;
use super::strategy::Strategy;
use crate::fit;
use etalon_core::error::Result;
use etalon_core::raster::{Comparison, DisplayMetrics, Image};
use etalon_stats::Extremes;
use etalon_stats::estimate::{Difference, Estimate};
use glam::DVec3;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One replicate at one number of samples.
#[derive(Debug, Clone)]
pub struct Measured {
    pub spp: u32,
    pub times: Times,
    /// Against the reference.
    pub errors: Comparison,
    /// Mean HDR-FLIP and the image, in the first replicate.
    pub shown: Option<(DisplayMetrics, Image)>,
}

/// All replicates at one number of samples. Errors carry 95 % intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    pub spp: u32,
    /// Mean times of a render, without its preparation.
    pub cpu_seconds: f64,
    /// See `cpu_seconds`.
    pub wall_seconds: f64,
    pub mse: Estimate,
    /// Mean squared error over the squared reference.
    pub rel_mse: Estimate,
    /// Mean HDR-FLIP of the first replicate.
    pub flip: Option<f64>,
    /// PSNR in dB of the first replicate; see [`DisplayMetrics`].
    pub psnr: f64,
    /// SSIM of the first replicate.
    pub ssim: Option<f64>,
    /// 1 / (MSE · processor time); the MSE includes the bias.
    pub efficiency: f64,
}

impl Level {
    /// √MSE; NaN where the reference's noise hides it.
    pub fn rmse(&self) -> f64 {
        self.mse.value.sqrt()
    }

    pub fn rmse_band(&self) -> [f64; 2] {
        self.mse.positive().map(f64::sqrt)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CurveVerdict {
    /// The error of the mean over all replicates is more than chance explains: the curve flattens.
    Biased,
    /// The slope's interval comes within [`SLOPE_MARGIN`] of −½.
    MonteCarlo,
    /// The slope's interval lies further below −½.
    Faster,
    /// The slope's interval lies further above −½.
    Slower,
    /// Too few replicates or levels.
    Unknown,
}

/// What a renderer's process needs, by a fit of its time over the samples: start-up + time per sample · spp.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeFit {
    /// Wall-clock seconds before the first sample.
    pub startup_wall_seconds: Estimate,
    /// Processor seconds before the first sample.
    pub startup_cpu_seconds: Estimate,
    pub wall_seconds_per_spp: Estimate,
    pub cpu_seconds_per_spp: Estimate,
}

impl TimeFit {
    /// By weighted least squares (see [`fit::relative_line`]); `None` unless the processor time per sample is positive beyond
    /// two standard errors. Wall-clock time, which other programs on the machine disturb, decides nothing.
    pub(super) fn new(runs: &[&Run]) -> Option<Self> {
        let line = |time: fn(Times) -> f64| {
            let points = runs.iter().flat_map(|run| run.levels.iter().map(|m| [f64::from(m.spp), time(m.times)]));
            fit::relative_line(&points.collect::<Vec<_>>())
        };
        let [startup_cpu_seconds, cpu_seconds_per_spp] = line(|t| t.cpu)?;
        let [startup_wall_seconds, wall_seconds_per_spp] = line(|t| t.wall).unwrap_or_default();
        let fit = Self { startup_wall_seconds, startup_cpu_seconds, wall_seconds_per_spp, cpu_seconds_per_spp };
        is_separated(cpu_seconds_per_spp).then_some(fit)
    }

    /// Whether there is no such fit without one of the replicates.
    pub(super) fn rests_on_one(runs: &[Run]) -> bool {
        let without =
            |i: usize| runs.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, run)| run).collect::<Vec<_>>();
        (0..runs.len()).any(|i| Self::new(&without(i)).is_none())
    }
}

/// Whether a time per sample is told from 0.
fn is_separated(slope: Estimate) -> bool {
    slope.value > 2.0 * slope.standard_error
}

#[derive(Debug, Clone, Serialize)]
pub struct Curve {
    /// Whose errors they are.
    pub strategy: String,
    #[serde(skip)]
    pub contender: Contender,
    /// Renders with seeds of their own.
    pub replicates: usize,
    /// By samples per pixel, ascending.
    pub levels: Vec<Level>,
    /// p of RMSE ∝ sppᵖ from [`FIT_FROM`] samples per pixel on.
    pub slope: Estimate,
    /// Mean squared bias of the last level; its standard error has the reference's noise in it.
    pub bias2: Estimate,
    /// The conclusion from slope and bias.
    pub verdict: CurveVerdict,
    /// Mean over the image of the contender, relative to that of the reference, minus 1.
    pub mean_bias: Estimate,
    /// The smallest [`Curve::mean_bias`] that is found with 90 % probability.
    pub detectable_mean_bias: f64,
    /// The smallest root mean square of the pixels' biases that is found with 90 % probability, over the mean of the reference; NaN
    /// where pixels are not tested, against a reference of unknown noise.
    pub detectable_rms_bias: f64,
    /// Mean wall-clock time of the preparation: tables, trees; of a renderer, its start-up.
    pub preparation_seconds: f64,
    /// Start-up and time per sample of a renderer; `None` for ours, whose preparation is timed by itself, and where the
    /// time does not grow measurably with the samples. Then the whole time counts.
    pub times: Option<TimeFit>,
    /// Each replicate's measurements, without its images.
    #[serde(skip)]
    pub runs: Vec<Run>,
    /// The first replicate's image at each level.
    #[serde(skip)]
    pub images: Vec<Image>,
}

/// Levels with fewer samples per pixel are left out of the fit: so few Sobol' points are not stratified yet.
pub const FIT_FROM: u32 = 4;
/// Levels that a slope needs.
pub const FIT_LEVELS: usize = 3;
/// Slopes that differ by less are the same: over a thousand times the samples, errors differ by 15 %.
pub const SLOPE_MARGIN: f64 = 0.02;
/// The share of the last level's mean squared error that the squared bias of the pixels has at least to be called bias.
const LEAST_BIAS: f64 = 0.01;
/// Replicates from which bias can be told from chance.
pub const REPLICATES_FOR_VERDICT: usize = 3;
/// Level of each of both t-tests for bias, of the pixels and of the image's mean.
pub const BIAS_LEVEL: f64 = 5e-3;

/// The result of one replicate.
#[derive(Debug, Clone)]
pub struct Run {
    pub seed: u64,
    /// By samples per pixel, ascending.
    pub levels: Vec<Measured>,
    /// The image at the last level, until its bias is known.
    pub last: Option<Image>,
    /// Wall-clock seconds before the first sample.
    pub preparation: f64,
    /// The strategy that was chosen for the scene.
    pub chosen: Option<Strategy>,
}

impl Curve {
    /// What the default does with the scene, if all replicates did the same.
    pub fn chosen(&self) -> Option<&Strategy> {
        let first = self.runs.first()?.chosen.as_ref().filter(|_| self.contender.is_default())?;
        self.runs.iter().all(|run| run.chosen.as_ref() == Some(first)).then_some(first)
    }

    /// Whether the replicates of the default do not all do the same.
    pub fn is_chosen_differently(&self) -> bool {
        self.contender.is_default() && self.runs.windows(2).any(|pair| pair[0].chosen != pair[1].chosen)
    }

    /// Whether it has replicates enough to say that no bias is found.
    pub fn is_tested(&self) -> bool {
        self.replicates >= REPLICATES_FOR_VERDICT || self.verdict == CurveVerdict::Biased
    }

    /// As many times the samples find a bias of the mean of `share` with 90 % probability; `None` if the noise of the reference, which
    /// they do not reduce, hides it.
    pub fn samples_to_find(&self, share: f64) -> Option<f64> {
        let own = Estimate::mean(&relative_biases(&self.runs)).standard_error.powi(2);
        let all = self.mean_bias.standard_error.powi(2);
        let times = own / (all * (share / self.detectable_mean_bias).powi(2) - (all - own));
        (times > 0.0 && times.is_finite()).then_some(times)
    }

    /// Whether its times are those of whole processes, start-up included.
    pub fn includes_start_up(&self) -> bool {
        self.contender.is_timed_from_outside() && self.times.is_none()
    }

    /// From at least one replicate, all with the same levels; with `times`, start-up does not count.
    pub fn new(
        contender: &Contender,
        mut runs: Vec<Run>,
        reference: &Reference,
        times: Option<TimeFit>,
    ) -> Result<Self> {
        let count = runs[0].levels.len();
        let (shown, images): (Vec<DisplayMetrics>, Vec<_>) =
            runs[0].levels.iter_mut().filter_map(|level| level.shown.take()).unzip();
        let everyone: Vec<&Run> = runs.iter().collect();
        let means = mean_times(&everyone, times);
        let level = |i: usize| {
            let all = |f: &dyn Fn(&Measured) -> f64| runs.iter().map(|run| f(&run.levels[i])).collect::<Vec<_>>();
            let mse = Estimate::mean(&all(&|m| m.errors.mse));
            let Times { cpu: cpu_seconds, wall: wall_seconds } = means[i];
            Level {
                spp: runs[0].levels[i].spp,
                cpu_seconds,
                wall_seconds,
                mse,
                rel_mse: Estimate::mean(&all(&|m| m.errors.rel_mse)),
                flip: shown[i].hdr_flip,
                psnr: shown[i].psnr,
                ssim: shown[i].ssim,
                efficiency: 1.0 / (mse.value * cpu_seconds),
            }
        };
        let levels: Vec<Level> = (0..count).map(level).collect();
        // Fit a slope for each replicate over the levels above the noise of the reference.
        let least = reference.facts.rmse.powi(2);
        let fitted: Vec<usize> =
            (0..count).filter(|&i| levels[i].spp >= FIT_FROM && levels[i].mse.value > least).collect();
        let slope_of = |run: &Run| {
            let points = fitted.iter().map(|&i| [f64::from(levels[i].spp), run.levels[i].errors.mse.sqrt()]);
            fit::log_log_slope(&points.collect::<Vec<_>>())
        };
        let slope = if fitted.len() < FIT_LEVELS {
            Estimate::default()
        } else {
            Estimate::mean(&runs.iter().map(slope_of).collect::<Vec<_>>())
        };
        let bias2 = bias2(&runs, reference)?;
        let mean_bias = mean_bias(&runs, reference, bias2);
        // What differs in the pixels may be noise of the reference, where that is unknown
        let in_pixels = if reference.is_of_unknown_noise() { Estimate::default() } else { bias2 };
        let verdict = verdict(slope, [in_pixels, mean_bias], runs.len(), levels.last());
        let [detectable_rms_bias, detectable_mean_bias] =
            detectable([in_pixels, mean_bias], runs.len(), levels.last(), reference.facts.mean);
        let measured = runs.iter().map(|run| run.preparation).sum::<f64>() / runs.len() as f64;
        let preparation_seconds = times.map_or(measured, |fit| fit.startup_wall_seconds.value);
        runs.iter_mut().for_each(|run| run.last = None);
        Ok(Self {
            strategy: contender.name().to_owned(),
            contender: contender.clone(),
            replicates: runs.len(),
            levels,
            slope,
            bias2,
            mean_bias,
            detectable_mean_bias,
            detectable_rms_bias,
            verdict,
            preparation_seconds,
            times,
            runs,
            images,
        })
    }

    /// The logarithm of the efficiency after `seconds` of processor time, 1/(MSE · seconds), its error by the jackknife over the
    /// replicates. Between levels the MSE follows a power law; beyond them, the efficiency stays. It has no interval if
    /// the time per sample is not told from 0 without one of the replicates.
    pub fn log_efficiency_at(&self, seconds: f64) -> Estimate {
        Estimate::jackknife(&self.runs, |some| {
            let fit = if self.times.is_some() { TimeFit::new(some) } else { None };
            if fit.is_some() != self.times.is_some() {
                return f64::NAN;
            }
            let mean = |i: usize| some.iter().map(|run| run.levels[i].errors.mse).sum::<f64>() / some.len() as f64;
            let points: Vec<[f64; 2]> =
                mean_times(some, fit).iter().enumerate().map(|(i, times)| [times.cpu, mean(i)]).collect();
            let (Some(first), Some(last)) = (points.first(), points.last()) else { return f64::NAN };
            let [time, mse] = match seconds {
                early if early <= first[0] => *first,
                late if late >= last[0] => *last,
                _ => [seconds, fit::log_log_at(&points, seconds).unwrap_or(f64::NAN)],
            };
            -(mse * time).ln()
        })
    }

    /// The level whose processor time is nearest to `seconds`, by their ratio.
    pub fn nearest(&self, seconds: f64) -> Option<usize> {
        let ratio = |level: &Level| (level.cpu_seconds / seconds).ln().abs();
        (0..self.levels.len()).min_by(|&a, &b| ratio(&self.levels[a]).total_cmp(&ratio(&self.levels[b])))
    }

    /// Processor time until the RMSE is down to `rmse`, between levels as a power law; `None` if it never is.
    pub fn time_to(&self, rmse: f64) -> Option<f64> {
        let first = self.levels.first().filter(|level| level.rmse() <= rmse);
        let points: Vec<[f64; 2]> = self.levels.iter().rev().map(|l| [l.rmse(), l.cpu_seconds]).collect();
        first.map(|level| level.cpu_seconds).or_else(|| fit::log_log_at(&points, rmse))
    }
}

/// The mean times of each level; by a fit, those of its samples alone. The wall-clock time is NaN where that of a sample is not told
/// from 0.
fn mean_times(runs: &[&Run], fit: Option<TimeFit>) -> Vec<Times> {
    let level = |i: usize| {
        let mean = |f: fn(Times) -> f64| runs.iter().map(|run| f(run.levels[i].times)).sum::<f64>() / runs.len() as f64;
        let spp = f64::from(runs[0].levels[i].spp);
        fit.map_or_else(
            || Times { wall: mean(|t| t.wall), cpu: mean(|t| t.cpu) },
            |fit| {
                let wall = fit.wall_seconds_per_spp;
                let wall = if is_separated(wall) { wall.value * spp } else { f64::NAN };
                Times { wall, cpu: fit.cpu_seconds_per_spp.value * spp }
            },
        )
    };
    (0..runs[0].levels.len()).map(level).collect()
}

/// The mean of the last level's images over that of the reference, minus 1. The standard error has that of the reference in it;
/// the pixels of a reference are independent. Where its noise is unknown, all that the pixels differ by may be noise.
fn mean_bias(runs: &[Run], reference: &Reference, bias2: Estimate) -> Estimate {
    let estimate = Estimate::mean(&relative_biases(runs));
    let of_reference = if reference.is_of_unknown_noise() {
        (bias2.value.at_least(0.0) / reference.facts.pixels as f64).sqrt()
    } else {
        reference.mean_error()
    };
    let of_reference = of_reference / reference.facts.mean;
    let standard_error = estimate.standard_error.hypot(of_reference);
    let ratio = if estimate.standard_error > 0.0 { estimate.half_width / estimate.standard_error } else { 2.0 };
    Estimate { standard_error, half_width: standard_error * ratio, ..estimate }
}

/// The mean of the last level's image over that of the reference, minus 1, by replicate.
fn relative_biases(runs: &[Run]) -> Vec<f64> {
    let errors = runs.iter().filter_map(|run| Some(run.levels.last()?.errors));
    errors.map(|e| e.mean_a / e.mean_b - 1.0).collect()
}

/// The mean over all pixels of the squared bias of the last level, which replicates do not average away.
///
/// With x̄ the mean image of R replicates, MSE(x̄) = bias² + variance/R, while the mean MSE of one replicate is
/// bias² + variance; so bias² = (R MSE(x̄) − mean MSE)/(R − 1). Without bias it comes out about 0, and may be below.
/// Unknown from fewer than three replicates.
fn bias2(runs: &[Run], reference: &Reference) -> Result<Estimate> {
    let images: Vec<(&Image, f64)> =
        runs.iter().filter_map(|run| Some((run.last.as_ref()?, run.levels.last()?.errors.mse))).collect();
    let Some((first, _)) = images.first() else { return Ok(Estimate::default()) };
    reference.compare(first)?;
    // The jackknife leaves one out, and the estimate needs two.
    if images.len() < REPLICATES_FOR_VERDICT {
        return Ok(Estimate::default());
    }
    // bias² = (R MSE(x̄) − mean MSE)/(R − 1), its error by leaving out each replicate.
    let estimate = Estimate::jackknife(&images, |some| {
        let n = some.len() as f64;
        let images: Vec<&Image> = some.iter().map(|(image, _)| *image).collect();
        // Errors of mismatched sizes were returned above.
        let of_mean = reference.compare(&mean(&images)).map_or(f64::NAN, |c| c.mse);
        let mean_mse = some.iter().map(|(_, mse)| mse).sum::<f64>() / n;
        (n * of_mean - mean_mse) / (n - 1.0)
    });
    // Add the noise of the reference, which the replicates have in common.
    let widened = estimate.standard_error.hypot(reference.mse_resolution());
    let ratio = if estimate.standard_error > 0.0 { estimate.half_width / estimate.standard_error } else { 2.0 };
    Ok(Estimate { standard_error: widened, half_width: widened * ratio, ..estimate })
}

fn mean(images: &[&Image]) -> Image {
    let mut sums = vec![DVec3::ZERO; images[0].pixels().len()];
    for image in images {
        sums.iter_mut().zip(image.pixels()).for_each(|(sum, p)| *sum += p.as_dvec3());
    }
    let pixels = sums.into_iter().map(|sum| (sum / images.len() as f64).as_vec3()).collect();
    Image::from_pixels(images[0].width(), images[0].height(), pixels)
}

/// The smallest root mean square of the pixels' biases, over the `mean` of the reference, and the smallest relative bias of the mean
/// that the tests of [`verdict`] find with 90 % probability.
fn detectable([bias2, mean_bias]: [Estimate; 2], replicates: usize, last: Option<&Level>, mean: f64) -> [f64; 2] {
    let found = |estimate: Estimate, level: f64| {
        let Estimate { value, standard_error, .. } = estimate;
        Difference { value, standard_error, dof: replicates as f64 - 1.0, allowance: 0.0 }.detectable(level)
    };
    let least = LEAST_BIAS * last.map_or(f64::NAN, |level| level.mse.value);
    // The test of the pixels is one-sided.
    let squared = found(bias2, 2.0 * BIAS_LEVEL);
    let squared = if squared.is_nan() { squared } else { squared.at_least(least) };
    [squared.sqrt() / mean, found(mean_bias, BIAS_LEVEL)]
}

/// Bias must be significant by a t-test of the replicates: that of the pixels, and then at least a hundredth of the last level's
/// mean squared error, or that of the whole image.
fn verdict(
    slope: Estimate,
    [bias2, mean_bias]: [Estimate; 2],
    replicates: usize,
    last: Option<&Level>,
) -> CurveVerdict {
    let last = last.map_or(f64::NAN, |level| level.mse.value);
    let least = LEAST_BIAS * last;
    let beyond = |estimate: Estimate, tail: f64| {
        let t = StudentsT::new(0.0, 1.0, replicates as f64 - 1.0).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - tail));
        estimate.value.abs() > t * estimate.standard_error
    };
    let in_pixels = bias2.value > least && beyond(bias2, BIAS_LEVEL);
    if in_pixels || beyond(mean_bias, 0.5 * BIAS_LEVEL) {
        CurveVerdict::Biased
    } else if replicates < REPLICATES_FOR_VERDICT || !slope.half_width.is_finite() {
        CurveVerdict::Unknown
    } else if slope.high() < -0.5 - SLOPE_MARGIN {
        CurveVerdict::Faster
    } else if slope.low() > -0.5 + SLOPE_MARGIN {
        CurveVerdict::Slower
    } else {
        CurveVerdict::MonteCarlo
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::math::Rgb;
    use etalon_core::raster::{compare, compare_shown};
    use etalon_core::scene::Request;

    /// Replicates of a renderer by the wall-clock and processor seconds of its images of 1, 4, 16 and 64 samples per pixel.
    fn curve(times: &[[[f64; 2]; 4]]) -> Curve {
        let white = || Image::from_fn(2, 1, |_, _| Rgb::ONE);
        let request = Request { width: 2, height: 1, spp: 1, light_samples: 1, max_depth: 1 };
        let reference = Reference::given(white(), &request, "white".into()).unwrap();
        let run = |(i, times): (usize, &[[f64; 2]; 4])| {
            let level = |(spp, [wall, cpu]): (u32, [f64; 2])| {
                let mse = (1.0 + 0.01 * i as f64) / f64::from(spp);
                let errors = Comparison { mse, ..compare(&white(), &white()).unwrap() };
                let shown = Some((compare_shown(&white(), &white()), white()));
                Measured { spp, times: Times { wall, cpu }, errors, shown }
            };
            Run {
                seed: i as u64,
                levels: [1, 4, 16, 64].into_iter().zip(*times).map(level).collect(),
                last: None,
                preparation: 0.0,
                chosen: None,
            }
        };
        let runs: Vec<Run> = times.iter().enumerate().map(run).collect();
        let fit = TimeFit::new(&runs.iter().collect::<Vec<_>>());
        let contender = Contender::from("mis".parse::<super::super::strategy::Strategy>().unwrap());
        Curve::new(&contender, runs, &reference, fit).unwrap()
    }

    /// A record of a renderer in NumPy on a busy machine.
    const BUSY: [[[f64; 2]; 4]; 5] = [
        [[0.327, 0.1354], [0.349, 0.1370], [0.289, 0.1483], [0.367, 0.1830]],
        [[0.300, 0.1354], [0.329, 0.1379], [0.324, 0.1425], [0.418, 0.1725]],
        [[0.279, 0.1376], [0.345, 0.1395], [0.418, 0.1577], [0.468, 0.1795]],
        [[0.404, 0.1297], [0.424, 0.1361], [1.022, 0.1708], [0.573, 0.2165]],
        [[0.275, 0.1269], [0.388, 0.1194], [0.395, 0.1337], [0.556, 0.1634]],
    ];

    #[test]
    fn wall_clock_times_do_not_disturb_what_is_measured_in_processor_time() {
        let noisy = curve(&BUSY);
        let quiet = curve(&BUSY.map(|run| run.map(|[_, cpu]| [cpu, cpu])));
        let none = curve(&BUSY.map(|run| run.map(|[_, cpu]| [0.0, cpu])));
        let seconds = quiet.levels[3].cpu_seconds;
        let [noisy_found, quiet_found, none_found] =
            [&noisy, &quiet, &none].map(|curve| curve.log_efficiency_at(seconds));
        assert_eq!((noisy_found, none_found), (quiet_found, quiet_found));
        assert!(quiet_found.half_width < 2.0_f64.ln(), "{quiet_found:?}");
        assert!(none.levels[3].wall_seconds.is_nan() && none.levels[3].cpu_seconds == seconds);
    }

    #[test]
    fn a_bias_that_would_have_been_found_is_found() {
        // With 8 replicates, t of 7 degrees of freedom is 4.03 at 0.5 % on both sides, and 3.50 on one.
        let of = |value: f64, error: f64| Estimate { value, half_width: 2.0 * error, standard_error: error };
        let level = Level { mse: of(1.0, 0.1), ..curve(&BUSY).levels[0].clone() };
        let [rms, mean] = detectable([of(0.0, 0.01), of(0.0, 0.002)], 8, Some(&level), 2.0);
        assert!(mean > 4.03 * 0.002 && mean < 10.0 * 0.002, "{mean}");
        assert!(rms > 0.5 * (3.50 * 0.01_f64).sqrt() && rms < 0.5 * 0.1_f64.sqrt(), "{rms}");
        let slope = of(-0.5, 0.0);
        let verdict = |bias2, mean_bias| verdict(slope, [of(bias2, 0.01), of(mean_bias, 0.002)], 8, Some(&level));
        assert_eq!(verdict((2.0 * rms).powi(2), 0.0), CurveVerdict::Biased);
        assert_eq!((verdict(0.0, mean), verdict(0.0, 0.0)), (CurveVerdict::Biased, CurveVerdict::MonteCarlo));
        let unknown = super::verdict(slope, [of(f64::NAN, f64::NAN); 2], 2, Some(&level));
        assert_eq!(unknown, CurveVerdict::Unknown, "of two replicates no bias is known");
        // A squared bias below a hundredth of the mean squared error does not count.
        assert!((detectable([of(0.0, 1e-9), of(0.0, 0.002)], 8, Some(&level), 1.0)[0] - 0.1).abs() < 1e-12);
    }

    #[test]
    fn as_many_times_the_samples_find_a_bias() {
        let mut found = curve(&BUSY);
        found.runs.iter_mut().zip([0.9, 1.1, 1.0, 0.95, 1.05]).for_each(|(run, a)| run.levels[3].errors.mean_a = a);
        // Noise of the renderer alone: a quarter of the bias takes 16 times the samples
        found.mean_bias = Estimate::mean(&relative_biases(&found.runs));
        found.detectable_mean_bias = 0.2;
        assert!((found.samples_to_find(0.05).unwrap() - 16.0).abs() < 1e-9);
        // Half of the variance is the reference's
        found.mean_bias.standard_error *= 2.0_f64.sqrt();
        assert!((found.samples_to_find(0.2).unwrap() - 1.0).abs() < 1e-9);
        assert!(found.samples_to_find(0.15).unwrap() > 2.0 && found.samples_to_find(0.14).is_none());
    }

    #[test]
    fn a_time_per_sample_that_rests_on_one_replicate_gives_no_interval() {
        // Without the first replicate the slope is 1.2 standard errors, with both 2.4.
        let both = [[0.1, 0.101, 0.104, 0.118], [0.1, 0.103, 0.101, 0.1035]];
        let curve = curve(&both.map(|run| run.map(|seconds| [seconds; 2])));
        assert!(curve.times.is_some() && TimeFit::rests_on_one(&curve.runs));
        let found = curve.log_efficiency_at(0.1);
        assert!(found.value.is_finite() && found.half_width == f64::INFINITY, "{found:?}");
        assert!(!TimeFit::rests_on_one(&self::curve(&BUSY).runs));
    }
}
