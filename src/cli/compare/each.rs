//! `etalon compare --each IMAGE… --reference B`: many images against one.

use super::{Compare, Input, left_out, measure, read};
use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict};
use crate::cli::map_file::short_name;
use etalon_bench::compare::{Explanation, Limit, METRICS, Measured, Metric};
use etalon_bench::table::Table;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{Comparison, DisplayMetrics};
use etalon_figures::output::{self, Saving, name_of_pair};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::compare::{self as view, Shown, Thumbnail};
use etalon_figures::view::text::{LINE, counted, rounded, wrapped};
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// An image and what came of it.
struct Entry {
    file: String,
    result: std::result::Result<Done, Error>,
}

struct Done {
    measured: Measured,
    thumbnail: Thumbnail,
    notes: Vec<String>,
    is_clipped: bool,
    is_rejected: bool,
}

/// The JSON object.
#[derive(Serialize)]
struct Output<'a> {
    reference: String,
    images: Vec<Record<'a>>,
    rejected: usize,
    unreadable: usize,
    interrupted: bool,
}

#[derive(Serialize)]
struct Record<'a> {
    file: &'a str,
    #[serde(flatten)]
    measured: Option<&'a Measured>,
    rejected: Option<bool>,
    error: Option<String>,
}

/// A line of the table. Field names are the CSV columns.
#[derive(Default, Serialize)]
struct Row {
    file: String,
    mse: Option<f64>,
    rel_mse: Option<f64>,
    hdr_flip: Option<f64>,
    ssim: Option<f64>,
    psnr: Option<f64>,
    rmse: Option<f64>,
    mape: Option<f64>,
    smape: Option<f64>,
    max_abs: Option<f64>,
    mean: Option<f64>,
    mean_of_reference: Option<f64>,
    non_finite: Option<usize>,
    identical: Option<bool>,
    explanation: Option<String>,
    rejected: Option<bool>,
    error: Option<String>,
}

impl Compare {
    pub(super) fn measure_each(&self, reference: &Path, global: &Global, console: &Console) -> Result<Verdict> {
        let start = Instant::now();
        self.reports.check()?;
        let (target, style) = (global.target(), self.style.style()?);
        let (images, left_out): (Vec<_>, Vec<_>) =
            self.each.iter().cloned().partition(|image| !is_preview(image, &self.each));
        if let [first, ..] = left_out.as_slice() {
            let pngs = counted(left_out.len(), "PNG");
            console.note(&format!(
                "{pngs} left out, as {}: the float image of that name beside it is compared",
                first.display()
            ));
        }
        let stem = target.stem(&name_of_pair(&images, "vs", &[reference.into()]), "", &output::STUDY)?;
        let b = read(reference)?;
        b.notes.iter().for_each(|note| console.warn(note));
        let bar = console.progress(images.len() as u64, "compare", "images");
        let mut entries: Vec<Entry> = images.par_iter().map(|path| self.entry(path, reference, &b, &bar)).collect();
        bar.finish_and_clear();
        // What was compared before an interruption is told
        entries.retain(|entry| !matches!(entry.result, Err(Error::Interrupted)));
        let missing = images.len() - entries.len();
        if entries.is_empty() {
            return Err(Error::Interrupted);
        }
        if let Some(metric) = self.sort {
            sort(&mut entries, metric);
        }
        let compared = || entries.iter().filter_map(|entry| entry.result.as_ref().ok());
        compared().flat_map(|done| &done.notes).for_each(|note| console.warn(note));
        let others = compared().filter(|done| done.is_clipped != b.is_clipped).count();
        if others > 0 {
            let (those, the_reference) =
                if b.is_clipped { ("linear light", "integer values") } else { ("integer values", "linear light") };
            console.warn(&format!(
                "{others} of {} have {those}, and {} has {the_reference}: what is clipped at 1 differs; use a reference of the same kind",
                counted(entries.len(), "image"),
                reference.display()
            ));
        }
        let mut saving = Saving::default();
        let cells: Vec<Shown> = entries.iter().map(shown).collect();
        let sheet = view::sheet((&reference.display().to_string(), &b.image), &cells);
        let rows: Vec<Row> = entries.iter().map(row).collect();
        saving.add(output::write(&stem, &sheet, &style, &output::csv(&rows)?));
        let list = entries.iter().flat_map(|entry| self.checks_of(entry, reference)).collect();
        let title = format!("etalon compare --each against {}", reference.display());
        let mut checks = Checks { title, list, seconds: start.elapsed().as_secs_f64() };
        if missing > 0 {
            let left_out = format!("{} not compared", counted(missing, "image"));
            console.warn(&format!("interrupted: {left_out}"));
            checks.interrupted(&left_out);
        }
        saving.add(self.reports.write(&checks));
        let (files, saved) = saving.end();
        let count = |is: fn(&Entry) -> bool| entries.iter().filter(|entry| is(entry)).count();
        let rejected = count(|entry| entry.result.as_ref().is_ok_and(|done| done.is_rejected));
        let unreadable = count(|entry| entry.result.is_err());
        let images = entries.iter().map(record).collect();
        let interrupted = missing > 0;
        let output = Output { reference: reference.display().to_string(), images, rejected, unreadable, interrupted };
        console.saved(&output, &target.written(files), || self.text(&entries, [rejected, unreadable]));
        saved?;
        // What could not be compared is told after the results of all others
        match entries.into_iter().find_map(|entry| entry.result.err()) {
            Some(error) => Err(error),
            None => Ok(Verdict::of(rejected == 0, interrupted)),
        }
    }

    /// Compares one image; of it, only what the sheet shows is kept.
    fn entry(&self, path: &Path, reference: &Path, b: &Input, bar: &ProgressBar) -> Entry {
        let result = interrupt::check().and_then(|()| read(path)).and_then(|a| {
            let measured = measure(path, &a, reference, b)?;
            let is_rejected = !self.is_within(&measured);
            let (thumbnail, is_clipped) = (Thumbnail::new(&a.image, &b.image), a.is_clipped);
            Ok(Done { thumbnail, is_rejected, is_clipped, notes: a.notes, measured })
        });
        bar.inc(1);
        Entry { file: path.display().to_string(), result }
    }

    fn checks_of(&self, entry: &Entry, reference: &Path) -> Vec<Check> {
        let group = format!("{} against {}", entry.file, reference.display());
        let plain = |name: &str, verdict, message: String| {
            let (name, details) = (name.into(), String::new());
            vec![Check { group: group.clone(), name, verdict: Some(verdict), message, details, seconds: None }]
        };
        match &entry.result {
            Err(error) => plain("file", etalon_stats::Verdict::Inconclusive, error.to_string()),
            Ok(done) if self.at_most.is_empty() => {
                plain("file", etalon_stats::Verdict::Accept, remark(&done.measured).unwrap_or_default())
            }
            Ok(done) => self.checks(&group, &done.measured),
        }
    }

    fn text(&self, entries: &[Entry], [rejected, unreadable]: [usize; 2]) -> String {
        let number = |entry: &Entry, metric: &Metric| match &entry.result {
            Ok(done) => match metric.of(&done.measured) {
                value if value.is_nan() => "-".into(),
                value => rounded(value, 3),
            },
            Err(_) => String::new(),
        };
        let mut table = Table::of(entries).words("image", |entry| &entry.file);
        // The usual ones, and those that were asked for
        let is_asked = |metric: &Metric| {
            let limits = self.at_most.iter().map(|limit| limit.metric);
            limits.chain(self.sort).any(|asked| asked.name == metric.name)
        };
        let shown = METRICS.iter().enumerate().filter(|(i, metric)| *i < USUAL || is_asked(metric));
        for (_, metric) in shown {
            table = table.numbers(metric.title, |entry| number(entry, metric));
        }
        let about = |entry: &Entry| match &entry.result {
            Ok(done) => {
                let rejected = done.is_rejected.then(|| self.exceeded(&done.measured));
                rejected.into_iter().chain(remark(&done.measured)).collect()
            }
            Err(error) => vec![error.to_string()],
        };
        let mut text = String::new();
        if !self.at_most.is_empty() {
            text += &format!("rejected: {rejected} of {}", counted(entries.len(), "image"));
            text += &if unreadable > 0 { format!("; {unreadable} not compared\n") } else { "\n".to_owned() };
        }
        text + &table.text_with(|entry, line| {
            line + &about(entry).iter().map(|about| wrapped(about, "  ", LINE)).collect::<String>()
        })
    }

    /// The limits that an image exceeds.
    fn exceeded(&self, measured: &Measured) -> String {
        // A metric that is not defined is above every limit
        let is_above = |limit: &&Limit| {
            let value = limit.metric.of(measured);
            value.is_nan() || value > limit.most
        };
        let above = self.at_most.iter().filter(is_above);
        let above = above.map(|limit| format!("{} above {}", limit.metric.title, limit.most));
        let holes = (measured.numbers.non_finite > 0).then(|| "pixels that are not finite".to_owned());
        format!("rejected: {}", above.chain(holes).collect::<Vec<_>>().join(", "))
    }
}

/// Whether an image is a PNG beside whose file stands one of floats with its name, among `all` that are given.
fn is_preview(image: &Path, all: &[PathBuf]) -> bool {
    let is = |path: &Path, known: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(known));
    let is_of_floats = |path: &PathBuf| FLOATS.iter().any(|known| is(path, known));
    is(image, "png")
        && all.iter().any(|other| is_of_floats(other) && other.with_extension("") == image.with_extension(""))
}

const FLOATS: [&str; 3] = ["exr", "pfm", "hdr"];

/// The first so many metrics are in every table.
const USUAL: usize = 5;

/// The best first; what could not be compared, or has no such metric, at the end.
fn sort(entries: &mut [Entry], metric: &Metric) {
    let key = |entry: &Entry| {
        let value = entry.result.as_ref().map_or(f64::NAN, |done| metric.of(&done.measured));
        let worse = if metric.is_similarity { -value } else { value };
        (entry.result.is_err(), worse.is_nan(), worse)
    };
    entries.sort_by(|a, b| {
        let ((a_err, a_nan, a), (b_err, b_nan, b)) = (key(a), key(b));
        (a_err, a_nan).cmp(&(b_err, b_nan)).then(a.total_cmp(&b))
    });
}

/// What is to be said of an image beside its metrics.
fn remark(measured: &Measured) -> Option<String> {
    let Measured { explanation, identical, .. } = measured;
    let same = identical.then(|| "the same values as the reference".to_owned());
    let parts = [same, explanation.as_ref().map(view::explained), left_out(measured)];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

fn shown(entry: &Entry) -> Shown<'_> {
    let name = short_name(entry.file.as_ref());
    match &entry.result {
        Err(_) => Shown { caption: format!("{name}: not compared"), thumbnail: None, is_rejected: false },
        Ok(Done { measured, thumbnail, is_rejected, .. }) => {
            let metric = |name: &str| Metric::named(name).map_or(f64::NAN, |metric| metric.of(measured));
            let parts = [("FLIP", "flip"), ("relative MSE", "rel_mse"), ("SSIM", "ssim"), ("PSNR", "psnr")];
            let numbers =
                parts.map(|(title, name)| (title, metric(name))).into_iter().filter(|(_, value)| value.is_finite());
            let numbers: Vec<String> = numbers.map(|(title, v)| format!("{title}\u{a0}{}", rounded(v, 3))).collect();
            let change = match &measured.explanation {
                Some(explanation) => format!("; {}", view::headline(explanation)),
                None if measured.identical => "; the same values as the reference".into(),
                None => String::new(),
            };
            let rejected = if *is_rejected { ", rejected" } else { "" };
            let caption = format!("{name}{rejected}: {}{change}", numbers.join(", "));
            Shown { caption, thumbnail: Some(thumbnail), is_rejected: *is_rejected }
        }
    }
}

fn record(entry: &Entry) -> Record<'_> {
    let done = entry.result.as_ref().ok();
    Record {
        file: &entry.file,
        measured: done.map(|done| &done.measured),
        rejected: done.map(|done| done.is_rejected),
        error: entry.result.as_ref().err().map(ToString::to_string),
    }
}

fn row(entry: &Entry) -> Row {
    let file = entry.file.clone();
    let Done { measured, is_rejected, .. } = match &entry.result {
        Ok(done) => done,
        Err(error) => return Row { file, error: Some(error.to_string()), ..Row::default() },
    };
    let Measured { numbers, shown, explanation, identical } = measured;
    let DisplayMetrics { hdr_flip, psnr, ssim } = *shown;
    let Comparison { mse, rel_mse, rmse, mape, smape, max_abs, mean_a, mean_b, non_finite, .. } = *numbers;
    Row {
        file,
        mse: Some(mse),
        rel_mse: Some(rel_mse),
        hdr_flip,
        ssim,
        psnr: Some(psnr).filter(|psnr| !psnr.is_nan()),
        rmse: Some(rmse),
        mape: Some(mape),
        smape: Some(smape),
        max_abs: Some(max_abs),
        mean: Some(mean_a),
        mean_of_reference: Some(mean_b),
        non_finite: Some(non_finite),
        identical: Some(*identical),
        explanation: explanation.as_ref().map(Explanation::told),
        rejected: Some(*is_rejected),
        error: None,
    }
}
