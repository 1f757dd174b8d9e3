//! `etalon compare A… --against B…`: whether two renderers have the same expectation.

use super::Compare;
use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict};
use etalon_bench::compare::{Answer, Compared, Explanation, FamilyResult, Needed, NotFinite, Plan, Side, compare};
use etalon_core::error::{Error, Result};
use etalon_figures::output::{self, Saving, name_of_pair};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::compare as view;
use etalon_figures::view::compare::{sentence, text};
use etalon_figures::view::text::p_is;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// The JSON object.
#[derive(Serialize)]
struct Output {
    answer: Answer,
    sentence: String,
    level: f64,
    detect: f64,
    /// Smallest relative bias of the whole image that would have been found with 90 % probability.
    uniform_bias: Option<f64>,
    /// The same of one tile, relative to the image's mean; the median over the tiles.
    tile_bias: Option<f64>,
    /// The same, relative to the tile's own mean.
    own_tile_bias: Option<f64>,
    images_a: usize,
    images_b: usize,
    non_finite: usize,
    /// The first image with such a pixel.
    first_non_finite: Option<NotFinite>,
    tile_side: usize,
    /// What would find a bias of `detect`, if this does not.
    needed: Option<Needed>,
    /// Variance of the noise of an image declared exact, by that of the other side's mean.
    noise_of_exact: Option<f64>,
    /// Whether the images would be different without that noise.
    noise_hides_difference: bool,
    /// What would explain the difference between the means of both sides.
    explanation: Option<Explanation>,
    families: Vec<Family>,
}

#[derive(Serialize)]
struct Family {
    family: &'static str,
    tests: usize,
    dominated: usize,
    /// Corrected for the number of tests; below the level, the images differ.
    p: Option<f64>,
    worst: Option<String>,
    channel: Option<&'static str>,
    mean_a: Option<f64>,
    mean_b: Option<f64>,
    standard_error: Option<f64>,
    /// A − B in parts of the mean of B, for a tile of its own mean, and the ends of its interval.
    bias: Option<f64>,
    bias_low: Option<f64>,
    bias_high: Option<f64>,
    untested: Option<&'static str>,
}

impl Compare {
    /// Tests the images of both sides.
    pub(super) fn test(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let start = Instant::now();
        self.reports.check()?;
        let name = name_of_pair(&self.a, "against", &self.against);
        let (target, style) = (global.target(), self.style.style()?);
        let stem = target.stem(&name, "", &output::STUDY)?;
        let bar = console.busy("compare");
        let a = Side::read(&self.a, self.spp)?;
        let b = match self.against.as_slice() {
            [path] if self.exact => Side::read_exact(path)?,
            _ if self.exact => return Err(Error::parameter("exact", "several images are not one without noise")),
            paths => Side::read(paths, self.spp)?,
        };
        a.notes.iter().chain(&b.notes).for_each(|note| console.warn(note));
        if a.shares_seeds(&b) {
            console.warn(
                "images of both sides have the same seed: one renderer makes correlated images of it, which \
                          the test takes for independent ones",
            );
        }
        let compared = compare(a, b, Plan { level: self.level, detect: self.detect })?;
        bar.finish_and_clear();
        let mut saving = Saving::default();
        saving.add(output::write(&stem, &view::drawing(&compared), &style, &view::csv(&compared)?));
        let of_side = |paths: &[PathBuf]| match paths {
            [only] => only.display().to_string(),
            [first, ..] => format!("{} ({} images)", first.display(), paths.len()),
            [] => String::new(),
        };
        let sides = format!("{} against {}", of_side(&self.a), of_side(&self.against));
        saving.add(self.reports.write(&checks(&compared, &sides, start.elapsed().as_secs_f64())));
        let (files, saved) = saving.end();
        for (tiles, side) in compared.constant_tiles.into_iter().zip(["A", "B"]).filter(|(tiles, _)| *tiles > 0) {
            console.warn(&format!(
                "{} to the last bit in all images of {side}, though not on the other side: if there is noise, the seed does \
                          not reach it",
                if tiles == 1 { "one tile is equal".into() } else { format!("{tiles} tiles are equal") }
            ));
        }
        let shown = result(&compared);
        console.saved(&shown, &target.written(files), || text(&compared));
        saved?;
        Ok(match compared.answer {
            // Whatever else is said, NaN is a wrong result
            _ if compared.not_finite.is_some() => Verdict::Rejected,
            Answer::Different | Answer::NotFinite => Verdict::Rejected,
            Answer::NoDifferenceFound => Verdict::Good,
            Answer::CannotTell | Answer::NotIndependent => Verdict::Inconclusive,
        })
    }
}

fn result(compared: &Compared) -> Output {
    let bias = |family: &FamilyResult| compared.bias(family, &family.worst?);
    let family = |family: &FamilyResult| Family {
        bias: bias(family).map(|bias| bias.value),
        bias_low: bias(family).map(|bias| bias.low),
        bias_high: bias(family).map(|bias| bias.high),
        family: family.family.name(),
        tests: family.tests.len(),
        dominated: family.dominated,
        p: family.adjusted_p,
        worst: family.worst.map(|test| test.functional.to_string()),
        channel: family.worst.map(|test| compared.channels[test.channel]),
        mean_a: family.worst.map(|test| test.means[0]),
        mean_b: family.worst.map(|test| test.means[1]),
        standard_error: family.worst.map(|test| test.difference.standard_error),
        untested: family.untested,
    };
    Output {
        answer: compared.answer,
        sentence: sentence(compared),
        level: compared.plan.level,
        detect: compared.plan.detect,
        uniform_bias: compared.uniform_bias,
        tile_bias: compared.tile_bias,
        own_tile_bias: compared.own_tile_bias,
        images_a: compared.images[0],
        images_b: compared.images[1],
        non_finite: compared.non_finite,
        first_non_finite: compared.not_finite.clone(),
        tile_side: compared.tile_side,
        needed: compared.needed,
        noise_of_exact: compared.noise_of_exact,
        noise_hides_difference: compared.noise_hides_difference,
        explanation: compared.explanation.clone(),
        families: compared.families.iter().map(family).collect(),
    }
}

/// A check for each family of tests, and one for the run's answer where that is none.
fn checks(compared: &Compared, sides: &str, seconds: f64) -> Checks {
    let mut checks: Vec<Check> = compared.families.iter().map(|family| check(compared, sides, family)).collect();
    let name = match compared.answer {
        Answer::CannotTell => Some("power"),
        Answer::NotIndependent => Some("independence"),
        Answer::Different | Answer::NoDifferenceFound | Answer::NotFinite => None,
    };
    checks.extend(compared.not_finite.as_ref().map(|place| Check {
        group: sides.to_owned(),
        name: "finite".into(),
        verdict: Some(etalon_stats::Verdict::Reject),
        message: view::where_not_finite(place),
        details: String::new(),
        seconds: None,
    }));
    checks.extend(name.map(|name| Check {
        group: sides.to_owned(),
        name: name.into(),
        verdict: Some(etalon_stats::Verdict::Inconclusive),
        message: sentence(compared),
        details: String::new(),
        seconds: None,
    }));
    Checks { title: format!("etalon compare {sides}"), list: checks, seconds }
}

/// A family is rejected if its p is below the level; it is skipped where nothing can be said of it.
fn check(compared: &Compared, sides: &str, family: &FamilyResult) -> Check {
    let verdict = match (compared.answer, family.adjusted_p) {
        (Answer::NotIndependent, _) | (_, None) => None,
        (_, Some(p)) if p < compared.plan.level => Some(etalon_stats::Verdict::Reject),
        (_, Some(_)) => Some(etalon_stats::Verdict::Accept),
    };
    let p = family.adjusted_p.map_or(family.untested.unwrap_or("nothing that can be tested").into(), p_is);
    let most = view::most(compared, family).map_or(String::new(), |most| format!("; {most}"));
    let dominated = match family.dominated {
        0 => String::new(),
        count => format!("; {count} of {} dominated by a few samples", family.tests.len()),
    };
    // An acceptance is worth what it would have found
    let power = match (verdict, compared.uniform_bias) {
        (Some(etalon_stats::Verdict::Accept), Some(_)) if compared.answer == Answer::NoDifferenceFound => {
            format!("; {}", sentence(compared))
        }
        _ => String::new(),
    };
    let message = format!("{p}{most}{dominated}{power}");
    let is_rejected = verdict == Some(etalon_stats::Verdict::Reject);
    let why = compared.explanation.as_ref().filter(|_| is_rejected);
    let details = why.map_or(String::new(), |of| format!("{message}; between the means: {}", view::explained(of)));
    Check { group: sides.to_owned(), name: family.family.name().into(), verdict, message, details, seconds: None }
}
