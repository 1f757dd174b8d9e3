//! The reports' claims as tables, and pictures of the places that claims are about.

use super::depth::tone_mapped;
use super::text::superscript;
use crate::figure::{Anchor, Colour, Drawing, Level, Rgb8, Stroke, Text, contact_sheet, theme, wrapped};
use etalon_bench::claims::{Bound, Claim, Finding, Place, PlacePicture, Unit, Verdict};
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::raster::Image;
use serde::Serialize;

const EDGE: f64 = 12.0;
const GAP: f64 = 16.0;
const LINE: f64 = 15.5;
/// Space above and below the text of a row.
const PADDING: f64 = 6.0;
/// What stands left of a finding.
const BULLET: f64 = 12.0;
const HEADS: [&str; 5] = ["Claim", "In the report", "Measured", "Verdict", "Evidence"];
const WIDTHS: [f64; 5] = [235.0, 128.0, 400.0, 124.0, 135.0];

/// One finding of one claim. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ClaimRow {
    place: &'static str,
    claim: &'static str,
    report: &'static str,
    verdict: String,
    finding: String,
    value: f64,
    standard_error: f64,
    must_be: &'static str,
    bound: f64,
    holds: Option<bool>,
    evidence: String,
}

/// A row for each finding, and one for each claim without any.
pub fn rows(claims: &[Claim]) -> Vec<ClaimRow> {
    let of = |claim: &Claim| {
        let row = ClaimRow {
            place: claim.place,
            claim: claim.claim,
            report: claim.number,
            verdict: claim.answer(),
            evidence: claim.evidence.join(" "),
            ..ClaimRow::default()
        };
        let finding = |finding: &Finding| {
            let (must_be, bound) = match finding.bound {
                Bound::AtLeast(bound) => ("at least", bound),
                Bound::AtMost(bound) => ("at most", bound),
            };
            ClaimRow {
                finding: finding.what.clone(),
                value: finding.value,
                standard_error: finding.error,
                must_be,
                bound,
                holds: finding.holds().filter(|_| claim.is_judged()),
                ..row.clone()
            }
        };
        let findings: Vec<ClaimRow> = claim.findings.iter().map(finding).collect();
        if findings.is_empty() {
            vec![ClaimRow { finding: claim.remark.into(), value: f64::NAN, ..row }]
        } else {
            findings
        }
    };
    claims.iter().flat_map(of).collect()
}

/// "share of LDSᵣE …: 14.2 % ± 0.1 % (≥ 2 %)".
pub fn sentence(finding: &Finding) -> String {
    let Finding { what, value, error, unit, bound } = finding;
    let bound = match bound {
        Bound::AtLeast(bound) => format!("≥\u{a0}{}", number(*bound, *unit, 3)),
        Bound::AtMost(bound) => format!("≤\u{a0}{}", number(*bound, *unit, 3)),
    };
    format!("{what}: {} ({bound})", with_error([*value, *error], *unit))
}

/// "14.2 % ± 0.1 %"; without the error where it is 0.
fn with_error([value, error]: [f64; 2], unit: Unit) -> String {
    let error = if error > 0.0 { format!("\u{a0}±\u{a0}{}", number(error, unit, 1)) } else { String::new() };
    format!("{}{error}", number(value, unit, 3))
}

/// One place. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct PlaceRow {
    title: &'static str,
    class: String,
    depth: u32,
    x0: usize,
    y0: usize,
    x1: usize,
    y1: usize,
    share: f64,
    standard_error: f64,
}

/// A row for each place.
pub fn place_rows(pictures: &[PlacePicture]) -> Vec<PlaceRow> {
    let row = |picture: &PlacePicture| {
        let Place { from: [x0, y0], to: [x1, y1] } = picture.place;
        let PlacePicture { title, depth, share, .. } = *picture;
        let (class, standard_error) = (picture.word.clone(), share.error());
        PlaceRow { title, class, depth, x0, y0, x1, y1, share: share.value, standard_error }
    };
    pictures.iter().map(row).collect()
}

/// A number with so many significant digits.
fn number(value: f64, unit: Unit, digits: i32) -> String {
    let (value, sign) = match unit {
        Unit::Percent => (100.0 * value, "\u{a0}%"),
        Unit::Degrees => (value, "°"),
        Unit::Plain | Unit::Times => (value, ""),
    };
    if value == 0.0 || !value.is_finite() || value.fract() == 0.0 && value.abs() < 1e6 {
        return format!("{value}{sign}").replace('-', "−");
    }
    let power = value.abs().log10().floor() as i32;
    let text = if power < -4 {
        let factor = format!("{:.0}·", value / 10f64.powi(power));
        format!("{}10{}", if factor == "1·" { "" } else { &factor }, superscript(power))
    } else {
        let text = format!("{value:.*}", (digits - 1 - power).max(0) as usize);
        // A round number is as short as it can be.
        let round = text.contains('.') && (text.parse() == Ok(value) || text.ends_with("00"));
        if round { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    format!("{text}{sign}").replace('-', "−")
}

/// The colour of a verdict.
fn colour(verdict: Verdict) -> Colour {
    match verdict {
        Verdict::Holds => theme::ACCEPTED,
        Verdict::HoldsPartly => theme::INCONCLUSIVE,
        Verdict::DoesNotHold => theme::REJECTED,
        Verdict::NotTestable => theme::NO_VALUE,
    }
}

/// A line of a cell: its text, and the dot before it.
type Line = (String, Option<Colour>);

/// A table of claims: what the report says and prints, what is measured, the verdict, the figures that show it.
pub fn table(claims: &[Claim]) -> Drawing {
    let width = 2.0 * EDGE + WIDTHS.iter().sum::<f64>() + GAP * (WIDTHS.len() - 1) as f64;
    let mut sheet = Drawing::new(width, 0.0, 2.0);
    let left = |column: usize| EDGE + WIDTHS[..column].iter().sum::<f64>() + GAP * column as f64;
    let rule = |sheet: &mut Drawing, y: f64, stroke: Stroke| sheet.line([[EDGE, y], [width - EDGE, y]], stroke);
    let heavy = Stroke::solid(theme::INK, theme::LINE);
    // The head between two rules
    let mut y = EDGE;
    rule(&mut sheet, y, heavy);
    y += PADDING;
    for (column, head) in HEADS.into_iter().enumerate() {
        sheet.text(Text::new([left(column), y], theme::TICK_SIZE, head).held(Anchor::Start, Level::Top).bold());
    }
    y += LINE + PADDING - 2.0;
    rule(&mut sheet, y, Stroke::solid(theme::INK, theme::THIN));
    for (i, claim) in claims.iter().enumerate() {
        if i > 0 {
            rule(&mut sheet, y, theme::GRID);
        }
        let cells = cells(claim);
        let lines = cells.iter().map(Vec::len).max().unwrap_or(1);
        for (column, cell) in cells.into_iter().enumerate() {
            let is_verdict = HEADS[column] == "Verdict" && claim.is_judged();
            let ink = if is_verdict { colour(claim.verdict()) } else { theme::INK };
            let indent = if HEADS[column] == "Measured" { BULLET } else { 0.0 };
            for (line, (text, dot)) in cell.into_iter().enumerate() {
                let top = y + PADDING + LINE * line as f64;
                let text =
                    Text::new([left(column) + indent, top], theme::TICK_SIZE, text).held(Anchor::Start, Level::Top);
                let text = text.coloured(ink);
                sheet.text(if is_verdict { text.bold() } else { text });
                if let Some(dot) = dot {
                    sheet.circle([left(column) + 4.0, top + 4.2], 3.2, dot);
                }
            }
        }
        y += LINE * lines as f64 + 2.0 * PADDING - 4.0;
    }
    rule(&mut sheet, y, heavy);
    y += PADDING;
    // What the dots mean
    let legend =
        [(Verdict::Holds, "meets the claim"), (Verdict::DoesNotHold, "does not"), (Verdict::NotTestable, "undecided")];
    for (i, (verdict, name)) in legend.into_iter().enumerate() {
        let x = left(2) + 140.0 * i as f64;
        sheet.circle([x + 4.0, y + 4.2], 3.2, colour(verdict));
        sheet.text(Text::new([x + BULLET, y], theme::NOTE_SIZE, name).held(Anchor::Start, Level::Top));
    }
    let elsewhere = Text::new(
        [left(2) + BULLET, y + LINE],
        theme::NOTE_SIZE,
        "no dot: measured on another input than the report's",
    );
    sheet.text(elsewhere.held(Anchor::Start, Level::Top));
    let note = "Dots: a number with what the claim demands of it.";
    sheet.text(Text::new([EDGE, y], theme::NOTE_SIZE, note).held(Anchor::Start, Level::Top));
    sheet.height = (y + 2.0 * LINE + EDGE).ceil();
    sheet
}

/// The lines of each column.
fn cells(claim: &Claim) -> [Vec<Line>; 5] {
    let plain = |text: &str, column: usize| -> Vec<Line> {
        wrapped(text, WIDTHS[column]).into_iter().map(|line| (line, None)).collect()
    };
    let mut measured: Vec<Line> = Vec::new();
    for finding in &claim.findings {
        let verdict = match finding.holds() {
            Some(true) => Verdict::Holds,
            Some(false) => Verdict::DoesNotHold,
            None => Verdict::NotTestable,
        };
        let dot = claim.is_judged().then(|| colour(verdict));
        let lines = wrapped(&sentence(finding), WIDTHS[2] - BULLET).into_iter().enumerate();
        measured.extend(lines.map(|(i, line)| (line, dot.filter(|_| i == 0))));
    }
    measured.extend(wrapped(claim.remark, WIDTHS[2] - BULLET).into_iter().map(|line| (line, None)));
    let evidence = claim.evidence.iter().map(|id| ((*id).to_owned(), None)).collect();
    let place = [plain(claim.place, 1), plain(claim.number, 1)].concat();
    [plain(claim.claim, 0), place, measured, plain(&claim.answer(), 3), evidence]
}

/// A quarter of an image's width is shown of each place, more where the place is larger.
const SHOWN: usize = 4;
/// Pixels between a place and its frame.
const MARGIN: usize = 3;
/// A place and what surrounds it.
const AROUND: f64 = 1.25;

/// Each place in the image with all light, framed, beside its class alone.
pub fn places(pictures: &[PlacePicture], images: impl Fn(u32) -> Option<Image>) -> Drawing {
    let mut cells: Vec<(String, Rgb8)> = Vec::new();
    for (i, picture) in pictures.iter().enumerate() {
        let Some(image) = images(picture.depth) else { continue };
        let crop = crop(&image, &picture.place);
        let letter = (b'a' + i as u8) as char;
        let title = format!("({letter}) {}: all light at depth {}", picture.title, picture.depth);
        let factor = brightening(&cut(&picture.class, &crop));
        let class = cut(&picture.class, &crop).map(|p| p * factor);
        let share = &picture.share;
        let alone = format!(
            "{} alone, ×\u{a0}{factor}: {} of the light in the frame",
            picture.word,
            with_error([share.value, share.error()], Unit::Percent)
        );
        cells.push((title, framed(&tone_mapped(&cut(&image, &crop)), &picture.place, &crop)));
        cells.push((alone, tone_mapped(&class)));
    }
    contact_sheet("", 4, &cells)
}

/// A part of an image of 4 to 3 around a place.
fn crop(image: &Image, place: &Place) -> Place {
    let whole = [image.width(), image.height()];
    let size = [0, 1].map(|axis| AROUND * (place.to[axis] - place.from[axis]) as f64);
    let width = size[0].max(size[1] * 4.0 / 3.0).max((whole[0] / SHOWN) as f64).min(whole[0] as f64);
    let size = [width as usize, (width * 0.75) as usize].map(|side| side.max(1));
    let size = [size[0], size[1].min(whole[1])];
    let from = [0, 1].map(|axis| {
        ((place.from[axis] + place.to[axis]) / 2).saturating_sub(size[axis] / 2).min(whole[axis] - size[axis])
    });
    Place { from, to: [from[0] + size[0], from[1] + size[1]] }
}

fn cut(image: &Image, part: &Place) -> Image {
    let [width, height] = [0, 1].map(|axis| part.to[axis] - part.from[axis]);
    Image::from_fn(width, height, |x, y| image.get(part.from[0] + x, part.from[1] + y))
}

/// A factor of one digit that shows the brightest hundredth of the lit pixels at about full scale.
fn brightening(image: &Image) -> f32 {
    let mut values: Vec<f64> = image.pixels().iter().filter(|p| **p != Rgb::ZERO).map(|p| mean_rgb(*p)).collect();
    values.sort_unstable_by(f64::total_cmp);
    let Some(bright) = values.get(values.len().saturating_sub(values.len() / 100 + 1)) else { return 1.0 };
    let factor = 0.7 / bright;
    let power = 10f64.powf(factor.log10().floor());
    ((factor / power).round() * power) as f32
}

/// A frame around the place.
fn framed(image: &Rgb8, place: &Place, part: &Place) -> Rgb8 {
    let from = [0, 1].map(|axis| place.from[axis].saturating_sub(part.from[axis] + MARGIN));
    let to = [0, 1].map(|axis| (place.to[axis] + MARGIN).saturating_sub(part.from[axis]));
    let Colour { r, g, b, .. } = theme::BORDER;
    Rgb8::from_fn(image.width(), image.height(), |x, y| {
        let within = |axis: usize, at: usize| (from[axis]..to[axis]).contains(&at);
        let edge = |axis: usize, at: usize| at == from[axis] || at + 1 == to[axis];
        let on_frame = within(0, x) && within(1, y) && (edge(0, x) || edge(1, y));
        if on_frame { [r, g, b] } else { image.pixel(x, y) }
    })
}
