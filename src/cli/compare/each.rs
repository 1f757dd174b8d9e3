//! `etalon compare --each IMAGE… --reference B`: many images against one.

use super::{Compare, Input, OtherSize, REASONS, Reason, left_out, measure, read, unknown};
use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict};
use crate::cli::map_file::short_name;
use etalon_bench::compare::{Explanation, Limit, METRICS, Measured, Metric};
use etalon_bench::table::Table;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{Comparison, Image};
use etalon_figures::output::{self, Saving, name_of_pair};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::compare::{self as view, Shown, Thumbnail};
use etalon_figures::view::text::{LINE, counted, rounded, wrapped};
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// An image and what came of it.
struct Entry {
    file: String,
    result: std::result::Result<Done, Error>,
    /// A file before it with the same pixels.
    same_as: Option<String>,
    /// The limits that it exceeds, and what else rejects it.
    rejections: Vec<Rejection>,
}

struct Done {
    measured: std::result::Result<Measured, OtherSize>,
    thumbnail: Thumbnail,
    /// By which images with the same pixels are known.
    hash: u64,
    notes: Vec<String>,
    is_clipped: bool,
    /// Whether values above 1, which the reference cannot have, were cut here.
    is_cut: bool,
}

impl Done {
    /// Whether nothing is wrong except that integers end at 1.
    fn is_only_clipped(&self, explanation: &Explanation) -> bool {
        explanation.is_clip_alone && self.is_clipped
    }
}

/// Why an image is rejected.
#[derive(Clone, Copy)]
enum Rejection {
    Limit(Limit),
    Reason(Reason),
    NotFinite,
    Size,
    Unreadable,
}

impl Rejection {
    /// In files.
    fn name(self) -> &'static str {
        match self {
            Self::Limit(limit) => limit.metric.name,
            Self::Reason(reason) => REASONS.iter().find(|(.., known)| *known == reason).map_or("", |(name, ..)| *name),
            Self::NotFinite => "finite",
            Self::Size => "size",
            Self::Unreadable => "unreadable",
        }
    }

    /// In words.
    fn text(self) -> String {
        match self {
            Self::Limit(limit) => format!("{} above {}", limit.metric.title, limit.most),
            Self::Reason(Reason::Mistake) => "differs by more than noise".into(),
            Self::Reason(Reason::Copy) => "a copy".into(),
            Self::NotFinite => "pixels that are not finite".into(),
            Self::Size => "another size".into(),
            Self::Unreadable => "cannot be read".into(),
        }
    }
}

impl Entry {
    fn measured(&self) -> Option<&Measured> {
        self.result.as_ref().ok()?.measured.as_ref().ok()
    }

    fn is_rejected(&self) -> bool {
        !self.rejections.is_empty()
    }

    /// Why it has no metrics.
    fn problem(&self) -> Option<String> {
        match &self.result {
            Err(error) => Some(error.to_string()),
            Ok(Done { measured: Err(other), .. }) => Some(format!("{} pixels", other.text())),
            Ok(_) => None,
        }
    }

    fn explanation(&self) -> Option<&Explanation> {
        match &self.result.as_ref().ok()?.measured {
            Ok(measured) => measured.explanation.as_ref(),
            Err(other) => other.explanation.as_ref(),
        }
    }
}

/// The JSON object.
#[derive(Serialize)]
struct Output<'a> {
    reference: String,
    images: Vec<Record<'a>>,
    rejected: usize,
    unreadable: usize,
    interrupted: bool,
    seconds: f64,
}

#[derive(Serialize)]
struct Record<'a> {
    file: &'a str,
    #[serde(flatten)]
    measured: Option<&'a Measured>,
    /// The turn of an image of another size.
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<&'a Explanation>,
    same_as: Option<&'a str>,
    rejected: Option<bool>,
    limits: Vec<&'static str>,
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
        // Without any image there is nothing to write
        if entries.iter().all(|entry| entry.result.is_err())
            && let Some(error) = entries.iter_mut().find_map(take_error)
        {
            return Err(error);
        }
        name_equal(&mut entries);
        entries.iter_mut().for_each(|entry| self.reject(entry));
        if let Some(metric) = self.sort {
            sort(&mut entries, metric);
        }
        let compared = || entries.iter().filter_map(|entry| entry.result.as_ref().ok());
        compared().flat_map(|done| &done.notes).for_each(|note| console.warn(note));
        let is_other = |entry: &&Entry| entry.result.as_ref().is_ok_and(|done| done.is_clipped != b.is_clipped);
        let others: Vec<&str> = entries.iter().filter(is_other).map(|entry| entry.file.as_str()).collect();
        if !others.is_empty() {
            let more = match others.len().saturating_sub(NAMED) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let names = others[..others.len().min(NAMED)].join(", ");
            let reference = reference.display();
            console.warn(&match b.is_clipped {
                true => format!("{names}{more}: linear light, compared up to 1, where {reference} is clipped"),
                false => format!(
                    "{names}{more}: integer values, which end at 1, and {reference} has larger ones: this is called no mistake, but metrics are worse for it"
                ),
            });
        }
        let mut saving = Saving::default();
        let cells: Vec<Shown> = entries.iter().map(|entry| shown(entry, &entries, self)).collect();
        let sheet = view::sheet((&reference.display().to_string(), &b.image), &cells);
        saving.add(output::write(&stem, &sheet, &style, &csv(&entries)?));
        let list = entries.iter().flat_map(|entry| self.checks_of(entry, reference)).collect();
        let title = format!("etalon compare --each against {}", reference.display());
        let seconds = start.elapsed().as_secs_f64();
        let mut checks = Checks { title, list, seconds };
        if missing > 0 {
            let left_out = format!("{} not compared", counted(missing, "image"));
            console.warn(&format!("interrupted: {left_out}"));
            checks.interrupted(&left_out);
        }
        saving.add(self.reports.write(&checks));
        let (files, saved) = saving.end();
        let count = |is: fn(&Entry) -> bool| entries.iter().filter(|entry| is(entry)).count();
        let rejected = count(Entry::is_rejected);
        let unreadable = count(|entry| match &entry.result {
            Err(_) => true,
            Ok(done) => done.measured.is_err() && !entry.is_rejected(),
        });
        let images = entries.iter().map(record).collect();
        let interrupted = missing > 0;
        let output =
            Output { reference: reference.display().to_string(), images, rejected, unreadable, interrupted, seconds };
        console.saved(&output, &target.written(files), || self.text(&entries, [rejected, unreadable], seconds));
        saved?;
        // What could not be compared is told after the results of all others
        let failed = |entry: Entry| match entry.result {
            Err(error) => Some(error),
            Ok(Done { measured: Err(other), .. }) if entry.rejections.is_empty() => {
                Some(other.error(entry.file.as_ref(), reference))
            }
            Ok(_) => None,
        };
        match entries.into_iter().find_map(failed) {
            Some(error) => Err(error),
            None => Ok(Verdict::of(rejected == 0, interrupted)),
        }
    }

    /// Compares one image; of it, only what the sheet shows is kept.
    fn entry(&self, path: &Path, reference: &Path, b: &Input, bar: &ProgressBar) -> Entry {
        let mut is_read = false;
        let result = interrupt::check().and_then(|()| read(path)).and_then(|a| {
            is_read = true;
            let (is_clipped, hash) = (a.is_clipped, hash(&a.image));
            let a = if b.is_clipped { a.clipped() } else { a };
            let measured = measure(path, &a, reference, b)?;
            let thumbnail = match &measured {
                Ok(_) => Thumbnail::new(&a.image, &b.image),
                Err(_) => Thumbnail::of_another_size(&a.image, &b.image),
            };
            let is_cut = a.is_clipped && !is_clipped;
            Ok(Done { measured, thumbnail, hash, notes: a.notes, is_clipped, is_cut })
        });
        bar.inc(1);
        let rejections = match &result {
            Ok(Done { measured: Ok(measured), .. }) => self.rejections(measured),
            _ if !self.judges() => Vec::new(),
            Ok(_) => vec![Rejection::Size],
            // What was read and cannot be measured has no finite pixel
            Err(_) if is_read => vec![Rejection::NotFinite],
            Err(_) => vec![Rejection::Unreadable],
        };
        Entry { file: path.display().to_string(), result, same_as: None, rejections }
    }

    fn checks_of(&self, entry: &Entry, reference: &Path) -> Vec<Check> {
        let group = format!("{} against {}", entry.file, reference.display());
        let plain = |name: &str, verdict, message: String| {
            let (name, details) = (name.into(), String::new());
            vec![Check { group: group.clone(), name, verdict: Some(verdict), message, details, seconds: None }]
        };
        match (entry.measured(), entry.problem()) {
            (Some(measured), _) if self.judges() => {
                let rejected =
                    |reason| entry.rejections.iter().any(|e| matches!(e, Rejection::Reason(r) if *r == reason));
                let verdict = |reason| match rejected(reason) {
                    true => etalon_stats::Verdict::Reject,
                    false => etalon_stats::Verdict::Accept,
                };
                let reasons = REASONS.into_iter().filter(|(.., reason)| self.reject.contains(reason));
                let of_reason = |(name, _, reason)| plain(name, verdict(reason), remark(entry).unwrap_or_default());
                let checks = self.checks(&group, measured).into_iter().chain(reasons.flat_map(of_reason));
                // A limit says it too
                let holes = Some(measured.numbers.non_finite).filter(|holes| *holes > 0 && self.at_most.is_empty());
                let finite = |holes| plain("finite", etalon_stats::Verdict::Reject, view::not_finite(holes));
                checks.chain(holes.into_iter().flat_map(finite)).collect()
            }
            (Some(_), _) => plain("file", etalon_stats::Verdict::Accept, remark(entry).unwrap_or_default()),
            (None, problem) => {
                let turned = entry.explanation().map(view::explained);
                let message: Vec<String> = problem.into_iter().chain(turned).collect();
                // What cannot be read is an error of its own
                let rejected = entry.is_rejected() && entry.result.is_ok();
                let verdict =
                    if rejected { etalon_stats::Verdict::Reject } else { etalon_stats::Verdict::Inconclusive };
                plain(if rejected { "size" } else { "file" }, verdict, message.join("; "))
            }
        }
    }

    fn text(&self, entries: &[Entry], [rejected, unreadable]: [usize; 2], seconds: f64) -> String {
        let number = |entry: &Entry, metric: &Metric| match entry.measured().map(|measured| metric.of(measured)) {
            Some(value) if value.is_nan() => "-".into(),
            Some(value) => rounded(value, 3),
            None => String::new(),
        };
        let mut table = Table::of(entries).words("image", |entry| &entry.file);
        // The usual ones, and those that were asked for
        let shown = METRICS.iter().enumerate().filter(|(i, metric)| *i < USUAL || self.asks_for(metric));
        for (_, metric) in shown {
            let heading = metric.heading();
            table = table.numbers(&heading, |entry| number(entry, metric));
        }
        let about = |entry: &Entry| -> Vec<String> {
            let texts: Vec<String> = entry.rejections.iter().map(|rejection| rejection.text()).collect();
            let rejected = entry.is_rejected().then(|| format!("rejected: {}", texts.join(", ")));
            rejected.into_iter().chain(remark(entry)).collect()
        };
        let mut text = String::new();
        if self.judges() {
            text += &format!("rejected: {rejected} of {}", counted(entries.len(), "image"));
            text += &if unreadable > 0 { format!("; {unreadable} not compared\n") } else { "\n".to_owned() };
        }
        text += &table.text_with(|entry, line| {
            line + &about(entry).iter().map(|about| wrapped(about, "  ", LINE)).collect::<String>()
        });
        text + &format!("{} in {seconds:.1} s\n", counted(entries.len(), "image"))
    }

    /// Whether a metric has a limit, or sorts.
    fn asks_for(&self, metric: &Metric) -> bool {
        self.at_most.iter().map(|limit| limit.metric).chain(self.sort).any(|asked| asked.name == metric.name)
    }

    /// Whether images are accepted or rejected.
    fn judges(&self) -> bool {
        !self.at_most.is_empty() || !self.reject.is_empty()
    }

    /// Rejects an image for the reasons that are given.
    fn reject(&self, entry: &mut Entry) {
        let Entry { result: Ok(done), same_as, rejections, .. } = entry else { return };
        let Ok(measured) = &done.measured else { return };
        let holds = |reason: &&Reason| match reason {
            // Integers end at 1
            Reason::Mistake => match &measured.explanation {
                Some(explanation) => !done.is_only_clipped(explanation),
                None => measured.beyond_noise == Some(true),
            },
            Reason::Copy => measured.identical || same_as.is_some(),
        };
        rejections.extend(self.reject.iter().filter(holds).map(|reason| Rejection::Reason(*reason)));
    }

    /// The limits that an image exceeds.
    fn rejections(&self, measured: &Measured) -> Vec<Rejection> {
        let above =
            self.at_most.iter().filter(|limit| !limit.holds_of_rest(measured)).map(|limit| Rejection::Limit(*limit));
        let has_holes = measured.numbers.non_finite > 0 && self.judges();
        above.chain(has_holes.then_some(Rejection::NotFinite)).collect()
    }
}

/// The error of an image that could not be read.
fn take_error(entry: &mut Entry) -> Option<Error> {
    let interrupted = Err(Error::Interrupted);
    if entry.result.is_err() { std::mem::replace(&mut entry.result, interrupted).err() } else { None }
}

/// The hash of the bits of all pixels.
fn hash(image: &Image) -> u64 {
    let mut hasher = DefaultHasher::new();
    (image.width(), image.height()).hash(&mut hasher);
    image.pixels().iter().for_each(|p| p.to_array().map(f32::to_bits).hash(&mut hasher));
    hasher.finish()
}

/// Says of each image which one before it has the same pixels.
fn name_equal(entries: &mut [Entry]) {
    let mut first: HashMap<u64, String> = HashMap::new();
    for entry in entries {
        let Ok(done) = &entry.result else { continue };
        // A file may be given twice
        entry.same_as = first.get(&done.hash).filter(|twin| **twin != entry.file).cloned();
        first.entry(done.hash).or_insert_with(|| entry.file.clone());
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

/// So many files are named in a warning.
const NAMED: usize = 3;

/// The first n metrics are in every table.
const USUAL: usize = 5;

/// The best first; what could not be compared, or has no such metric, at the end.
fn sort(entries: &mut [Entry], metric: &Metric) {
    let key = |entry: &Entry| {
        let value = entry.measured().map_or(f64::NAN, |measured| metric.of(measured));
        let worse = if metric.is_similarity { -value } else { value };
        (entry.measured().is_none(), worse.is_nan(), worse)
    };
    entries.sort_by(|a, b| {
        let ((a_err, a_nan, a), (b_err, b_nan, b)) = (key(a), key(b));
        (a_err, a_nan).cmp(&(b_err, b_nan)).then(a.total_cmp(&b))
    });
}

/// What is to be said of an image beside its metrics.
fn remark(entry: &Entry) -> Option<String> {
    let parts = said(entry, &view::explained);
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// The same in parts, an explanation as `explained` tells it.
fn said(entry: &Entry, explained: &dyn Fn(&Explanation) -> String) -> Vec<String> {
    let twin = entry.same_as.as_ref().map(|twin| format!("same pixels as {twin}"));
    let is_only_clipped = |of: &Explanation| entry.result.as_ref().is_ok_and(|done| done.is_only_clipped(of));
    let explanation = entry.explanation().map(|explanation| match is_only_clipped(explanation) {
        true => "differs only where it is clipped at 1".to_owned(),
        false => of_one(&explained(explanation)),
    });
    let parts = match entry.measured() {
        Some(measured) => {
            let up_to = if entry.result.as_ref().is_ok_and(|done| done.is_cut) { " up to 1" } else { "" };
            let same = measured.identical.then(|| format!("the same values as the reference{up_to}"));
            [same, explanation.or_else(|| unknown(measured).map(|told| of_one(&told))), left_out(measured), twin]
        }
        None => [entry.problem(), explanation, twin, None],
    };
    parts.into_iter().flatten().collect()
}

/// An explanation of one of many images, none of which is called A; B is the blue channel, too, in lists of channels.
fn of_one(explanation: &str) -> String {
    let words: Vec<&str> = explanation.split(' ').collect();
    let is_channel = |word: &&str| matches!(word.trim_end_matches(','), "R" | "G" | "B");
    let told = |i: usize| {
        let (before, rest) = words[i].split_at(usize::from(words[i].starts_with('(')));
        let letter = rest.trim_end_matches([',', ';', ':', ')']);
        let next = words.get(i + 1);
        let is_in_list = next.is_some_and(|next| *next == "of" || letter != rest && is_channel(next))
            || i > 0 && words[i - 1].ends_with(',') && is_channel(&words[i - 1]);
        let name = match letter {
            "A" => "it",
            "B" if !is_in_list => "the reference",
            _ => return words[i].to_owned(),
        };
        format!("{before}{name}{}", &rest[letter.len()..])
    };
    (0..words.len()).map(told).collect::<Vec<_>>().join(" ")
}

/// An image of the sheet: below its name what rejects it, the metrics that are asked for, or else FLIP and PSNR, and what is to be said of it.
fn shown<'a>(entry: &'a Entry, entries: &[Entry], compare: &Compare) -> Shown<'a> {
    let has_name = |other: &&Entry| short_name(other.file.as_ref()) == short_name(entry.file.as_ref());
    let file = Path::new(&entry.file);
    // Two files may differ in their extension, or in their folder
    let name = match entries.iter().filter(has_name).map(|other| Path::new(&other.file).file_name()).collect::<Vec<_>>()
    {
        same if same.len() < 2 => short_name(file.as_ref()),
        same if same.iter().filter(|other| **other == file.file_name()).count() < 2 => {
            file.file_name().unwrap_or_default().to_string_lossy().into_owned()
        }
        _ => entry.file.clone(),
    };
    let above = entry.rejections.iter().filter(|rejection| matches!(rejection, Rejection::Limit(_)));
    let above: Vec<String> = above.map(|rejection| rejection.text()).collect();
    let rejected = match above.join(", ") {
        _ if !entry.is_rejected() => String::new(),
        above if above.is_empty() => ", rejected".into(),
        above => format!(", rejected ({above})"),
    };
    let is_any_asked = METRICS.iter().any(|metric| compare.asks_for(metric));
    let is_shown = |metric: &&Metric| match is_any_asked {
        true => compare.asks_for(metric),
        false => ["flip", "psnr"].contains(&metric.name),
    };
    let numbers = entry.measured().map(|measured| {
        let shown = METRICS.iter().filter(is_shown).map(|metric| (metric, metric.of(measured)));
        let finite = shown.filter(|(_, value)| value.is_finite());
        finite.map(|(metric, value)| view::of_metric(metric, value)).collect::<Vec<_>>().join(", ")
    });
    let numbers = numbers.filter(|numbers| !numbers.is_empty());
    let parts: Vec<String> = numbers.into_iter().chain(said(entry, &Explanation::headline)).collect();
    let thumbnail = entry.result.as_ref().ok().map(|done| &done.thumbnail);
    Shown {
        caption: format!("{name}{rejected}: {}", parts.join("; ")),
        thumbnail,
        is_rejected: entry.is_rejected(),
        is_explained: entry.explanation().is_some_and(|explanation| !explanation.in_part),
    }
}

fn record(entry: &Entry) -> Record<'_> {
    let measured = entry.measured();
    Record {
        file: &entry.file,
        measured,
        explanation: entry.explanation().filter(|_| measured.is_none()),
        same_as: entry.same_as.as_deref(),
        rejected: Some(entry.is_rejected()).filter(|is_rejected| measured.is_some() || *is_rejected),
        limits: entry.rejections.iter().map(|rejection| rejection.name()).collect(),
        error: entry.problem(),
    }
}

/// A row for each image, as CSV.
fn csv(entries: &[Entry]) -> Result<Vec<u8>> {
    let number = |of: fn(&Comparison) -> f64| move |entry: &Entry| entry.measured().map(|done| of(&done.numbers));
    Table::of(entries)
        .field("file", |entry| &entry.file)
        .field("mse", number(|numbers| numbers.mse))
        .field("rel_mse", number(|numbers| numbers.rel_mse))
        .field("hdr_flip", |entry| entry.measured()?.shown.hdr_flip)
        .field("ssim", |entry| entry.measured()?.shown.ssim)
        .field("psnr", |entry| entry.measured().map(|done| done.shown.psnr).filter(|psnr| !psnr.is_nan()))
        .field("rmse", number(|numbers| numbers.rmse))
        .field("mape", number(|numbers| numbers.mape))
        .field("smape", number(|numbers| numbers.smape))
        .field("max_abs", number(|numbers| numbers.max_abs))
        .field("mean", number(|numbers| numbers.mean_a))
        .field("mean_of_reference", number(|numbers| numbers.mean_b))
        .field("non_finite", |entry| entry.measured().map(|done| done.numbers.non_finite))
        .field("identical", |entry| entry.measured().map(|done| done.identical))
        .field("explanation", |entry| entry.explanation().map(Explanation::told))
        .field("mse_left", |entry| entry.explanation().map(|found| found.mse_left).filter(|left| !left.is_nan()))
        .field("beyond_noise", |entry| entry.measured()?.beyond_noise)
        .field("same_as", |entry| entry.same_as.as_ref())
        .field("rejected", |entry| record(entry).rejected)
        .field("limits", |entry| Some(record(entry)).filter(|of| of.rejected.is_some()).map(|of| of.limits.join(";")))
        .field("error", Entry::problem)
        .csv()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_not_called_a_and_b_and_channels_keep_their_names() {
        for (of_two, expected) in [
            (
                "A is 1.23 ± 0.01 times as bright as B (multiply A by 0.81)",
                "it is 1.23 ± 0.01 times as bright as the reference (multiply it by 0.81)",
            ),
            ("R, G, B of A are G, B, R of B", "R, G, B of it are G, B, R of the reference"),
            ("R, G, B of A are B, G, R of B", "R, G, B of it are B, G, R of the reference"),
            (
                "A is clipped at 1, and clamp B: no value of A is larger",
                "it is clipped at 1, and clamp the reference: no value of it is larger",
            ),
        ] {
            assert_eq!(of_one(of_two), expected);
        }
    }
}
