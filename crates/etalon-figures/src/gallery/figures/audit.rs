//! The errors of the two reports, what they print beside the correction: `audit`.

use crate::figure::{Anchor, Axis, Level, Page, Panel, Plot, Rect, Stroke, Text, theme};
use crate::gallery::figure::{self, Place};
use crate::gallery::prelude::*;
use crate::view::text::{capitalized, power_of_ten};
use etalon_bench::audit::{self, Erratum, ErratumCurves, Nature};
use etalon_stats::Verdict;

pub fn figures() -> Vec<Maker> {
    vec![maker("audit", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let errata = audit::audit(&inputs.protocol())?;
    let checks = errata.iter().flat_map(|erratum| {
        let Erratum { title, verdict, right_verdict, .. } = erratum;
        [
            Check::is_true(format!("rejected as printed: {title}"), *verdict == Verdict::Reject),
            Check::is_true(format!("accepted as corrected: {title}"), *right_verdict == Verdict::Accept),
        ]
    });
    // Misprints stand last, and in the table alone
    let drawn: Vec<Drawn> = errata.iter().map_while(|erratum| Some((erratum, erratum.curves.as_ref()?))).collect();
    let (sheet, places) = sheet(&drawn);
    let [width, height] = [sheet.width, sheet.height];
    let content = Content::new(sheet.into(), &errata, checks.collect())?;
    let rows = errata.iter().enumerate().map(|(i, erratum)| {
        let place = places.get(i).map(|place| {
            let share = [place.x / width, place.y / height, place.width / width, place.height / height];
            Place { panel: letter(i), share }
        });
        row(erratum, place)
    });
    Ok(Content { errata: rows.collect(), ..content })
}

fn row(erratum: &Erratum, place: Option<Place>) -> figure::Erratum {
    figure::Erratum {
        printed: format!("{}, {}: {}", erratum.report, erratum.nature.name(), erratum.printed),
        right: erratum.right.to_owned(),
        test: match &erratum.violation {
            Some(violation) => format!("{}: {violation}", erratum.test),
            None => erratum.test.to_owned(),
        },
        // What an exact check rejects needs no p-value.
        p_value: erratum.p.filter(|_| erratum.violation.is_none()),
        picture_error: consequence(erratum),
        place,
    }
}

/// Panels in a row, the size of a frame, and of the text under it.
const COLUMNS: usize = 5;
const FRAME: [f64; 2] = [190.0, 140.0];
const LINE: f64 = 16.0;
const GAP: f64 = 18.0;
const EDGE: f64 = 12.0;
/// What stands right of a panel's frame.
const MARGIN: f64 = 22.0;
/// The formula as printed, and the corrected one.
const PRINTED: Stroke = Stroke { colour: theme::ERRATUM, width: theme::LINE, dash: theme::DASHED };
const CORRECTED: Stroke = Stroke::solid(theme::CORRECTED, theme::LINE);

/// What a panel shows.
type Drawn<'a> = (&'a Erratum, &'a ErratumCurves);

/// A panel for each erratum, with the verdicts and the error of an image below it; and the place of each panel.
fn sheet(errata: &[Drawn]) -> (Page, Vec<Rect>) {
    // Lay out panels in a grid, with three lines of text below each
    let panels: Vec<Page> = errata.iter().enumerate().map(|(i, drawn)| panel(*drawn, letter(i))).collect();
    let largest = |size: fn(&Page) -> f64| panels.iter().map(size).fold(0.0, f64::max);
    let (width, below) = (largest(|panel| panel.width) + GAP, largest(|panel| panel.height));
    let height = below + 3.0 * LINE + 1.5 * GAP;
    let rows = errata.len().div_ceil(COLUMNS);
    let head = EDGE + theme::LABEL_SIZE + GAP;
    let columns = COLUMNS.min(errata.len());
    let mut sheet = Page::new(2.0 * EDGE + columns as f64 * width - GAP, head + rows as f64 * height - GAP, 2.0);
    let right = sheet.width;
    legend(&mut sheet, right / 2.0);
    let mut places = Vec::new();
    for (i, (drawing, (erratum, _))) in panels.into_iter().zip(errata).enumerate() {
        let (x, y) = (EDGE + (i % COLUMNS) as f64 * width, head + (i / COLUMNS) as f64 * height);
        // What an exact check rejects needs no p-value.
        let p = erratum.p.filter(|_| erratum.violation.is_none());
        let lines = [
            (PRINTED.colour, format!("as printed: {}", verdict(erratum.verdict, p))),
            (CORRECTED.colour, format!("corrected: {}", verdict(erratum.right_verdict, erratum.right_p))),
            (theme::INK, effect(erratum)),
        ];
        places.push(Rect::new(x, y, width - GAP, height - 1.5 * GAP));
        let middle = x + drawing.width - MARGIN - 0.5 * FRAME[0];
        // Titles have one or two lines, and frames of a row stand at one height
        let top = y + below - drawing.height;
        sheet.append(drawing, x, top);
        for (k, (colour, line)) in lines.into_iter().enumerate() {
            let at = [middle, y + below + LINE * k as f64];
            let text = Text::new(at, theme::NOTE_SIZE, line).held(Anchor::Middle, Level::Top);
            sheet.text(text.coloured(colour));
        }
    }
    (sheet, places)
}

/// The letter of a panel.
fn letter(index: usize) -> char {
    (b'a' + index as u8) as char
}

fn panel((erratum, curves): Drawn, letter: char) -> Page {
    let differences = differences(curves);
    let (curves, y) = match &differences {
        Some(differences) => (differences, Axis::linear(format!("error of {}", curves.y))),
        None => (curves, Axis::linear(curves.y)),
    };
    let x = Axis::linear(curves.x).every(curves.every);
    // Scattered are places on a map, whose first row is at the top.
    let [x, y] = match curves.scattered {
        true => [x.range(-0.2, 4.2), y.range(8.2, 3.8).every(1.0)],
        false => [x, beyond(y, curves)],
    };
    let panel = Panel::new(x, y).title(format!("{letter}  {}", capitalized(erratum.title)));
    let panel = if curves.scattered {
        let dots = panel.dots("", CORRECTED.colour, curves.right.clone());
        dots.dots("", PRINTED.colour, curves.printed.clone())
    } else {
        panel.line("", CORRECTED, curves.right.clone()).line("", PRINTED, curves.printed.clone())
    };
    Plot::new([panel]).frame_size(FRAME[0], FRAME[1]).draw().natural()
}

/// The error of the printed curve, which is drawn in place of both curves where it is small.
fn differences(curves: &ErratumCurves) -> Option<ErratumCurves> {
    /// Least error for which the curves are drawn, over the range of the corrected one.
    const SEEN: f64 = 0.05;
    let pairs = || curves.printed.iter().zip(&curves.right);
    let printed: Vec<[f64; 2]> = pairs().map(|(printed, right)| [right[0], printed[1] - right[1]]).collect();
    let [low, high] = [f64::min, f64::max].map(|of| curves.right.iter().map(|point| point[1]).fold(f64::NAN, of));
    let is_seen = curves.scattered || printed.iter().any(|[_, difference]| difference.abs() > SEEN * (high - low));
    let right = curves.right.iter().map(|[x, _]| [*x, 0.0]).collect();
    (!is_seen).then(|| ErratumCurves { printed, right, ..curves.clone() })
}

/// An axis that ends a little beyond the curves, so that those at the end are seen.
fn beyond(axis: Axis, curves: &ErratumCurves) -> Axis {
    const MARGIN: f64 = 0.06;
    let values = || [&curves.printed, &curves.right].into_iter().flatten().map(|point| point[1]);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let margin = MARGIN * (high - low);
    axis.range(low - margin, high + margin)
}

fn legend(sheet: &mut Page, middle: f64) {
    const SAMPLE: f64 = 26.0;
    for (stroke, name, from) in [(PRINTED, "as printed or published", -190.0), (CORRECTED, "corrected", 40.0)] {
        let (x, y) = (middle + from, EDGE + 0.5 * theme::LABEL_SIZE);
        sheet.line([[x, y], [x + SAMPLE, y]], stroke);
        sheet.text(Text::new([x + SAMPLE + 8.0, y], theme::LABEL_SIZE, name).held(Anchor::Start, Level::Middle));
    }
}

fn verdict(verdict: Verdict, p: Option<f64>) -> String {
    let word = match verdict {
        Verdict::Accept => "accepted",
        Verdict::Reject => "rejected",
        Verdict::Inconclusive => "inconclusive",
    };
    match p {
        None => format!("{word} by an exact check"),
        Some(p) if p >= 1e-3 => format!("{word}, /{{p}} = {p:.2}"),
        Some(p) => format!("{word}, /{{p}} {}", power_of_ten(p)),
    }
}

/// "light on a floor: −12.3 %"; a misprint has this only if it is taken at its word.
fn consequence(erratum: &Erratum) -> String {
    let at_its_word = if erratum.nature == Nature::Misprint { "if taken at its word, " } else { "" };
    format!("{at_its_word}{}", effect(erratum))
}

/// "light on a floor: −12.3 %".
fn effect(erratum: &Erratum) -> String {
    format!("{}: {}", erratum.error_of, change(erratum.error_in_picture))
}

/// A relative error: "−12.3 %", or the factor where it is at least 2 or at most ½, "× 4.42".
fn change(error: f64) -> String {
    let factor = 1.0 + error;
    if factor > 0.5 && factor < 2.0 {
        let sign = if error < 0.0 { '−' } else { '+' };
        return format!("{sign}{:.1} %", 100.0 * error.abs());
    }
    // Three digits, without zeros at the end
    let decimals = if factor == 0.0 { 0 } else { (2 - factor.abs().log10().floor() as i32).max(0) as usize };
    let text = format!("{factor:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("× {}", text.replace('-', "−"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_errors_are_factors() {
        let shown = [-0.084, 0.668, -0.46, 3.4205, 8.078, -2.0, -1.0, -0.9375].map(change);
        assert_eq!(shown, ["−8.4 %", "+66.8 %", "−46.0 %", "× 4.42", "× 9.08", "× −1", "× 0", "× 0.0625"]);
    }
}
