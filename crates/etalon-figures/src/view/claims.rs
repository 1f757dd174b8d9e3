//! The reports' claims as tables, and pictures of the places that claims are about.

use super::depth::tone_mapped;
use super::text::superscript;
use crate::figure::{Anchor, Colour, Drawing, Level, Page, Rgb8, Stroke, Text, contact_sheet, text, theme};
use etalon_bench::claims::{self, Bound, Claim, Finding, Place, PlacePicture, Unit, Verdict};
use etalon_bench::depth::Depths;
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
    let of_claim = |claim: &Claim| {
        let claims::Text { place, claim: text, number: report, evidence, remark } = claim.text;
        let (verdict, evidence, finding) = (claim.answer(), evidence.join(" "), remark.to_owned());
        let row =
            ClaimRow { place, claim: text, report, verdict, evidence, finding, value: f64::NAN, ..ClaimRow::default() };
        let of_finding = |finding: &Finding| {
            let (must_be, bound) = match finding.bound {
                Bound::AtLeast(bound) => ("at least", bound),
                Bound::AtMost(bound) => ("at most", bound),
            };
            let holds = finding.holds().filter(|_| claim.is_judged());
            let (value, standard_error) = (finding.value, finding.error);
            ClaimRow { finding: finding.what.clone(), value, standard_error, must_be, bound, holds, ..row.clone() }
        };
        if claim.findings.is_empty() { vec![row] } else { claim.findings.iter().map(of_finding).collect() }
    };
    claims.iter().flat_map(of_claim).collect()
}

/// What was measured for a claim, and the remark if there is one.
pub fn measured(claim: &Claim) -> Vec<String> {
    let remark = Some(claim.text.remark.to_owned()).filter(|remark| !remark.is_empty());
    claim.findings.iter().map(sentence).chain(remark).collect()
}

/// "share of LDSᵣE …: 14.2 % ± 0.1 % (≥ 2 %)".
fn sentence(finding: &Finding) -> String {
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

/// A number with n significant digits.
fn number(value: f64, unit: Unit, digits: i32) -> String {
    let (value, sign) = match unit {
        Unit::Percent => (100.0 * value, "\u{a0}%"),
        Unit::Degrees => (value, "°"),
        Unit::Plain => (value, ""),
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

/// A line of a cell.
struct Line {
    text: String,
    ink: Colour,
    is_bold: bool,
    indent: f64,
    /// Before the text.
    dot: Option<Colour>,
}

/// The lines of a text in a column.
fn lines(text: &str, width: f64) -> Vec<Line> {
    let line = |text| Line { text, ink: theme::INK, is_bold: false, indent: 0.0, dot: None };
    text::wrapped(text, theme::TICK_SIZE, false, width).into_iter().map(line).collect()
}

/// Claims in a column of the table; more stand in two.
const COLUMN: usize = 20;

/// A table of claims: what the report says and prints, what is measured, the verdict, the figures that show it.
pub fn table(claims: &[Claim]) -> Drawing {
    let half = if claims.len() > COLUMN { claims.len().div_ceil(2) } else { claims.len() };
    Drawing::beside(claims.chunks(half.max(1)).map(|claims| column(claims).into()).collect())
}

fn column(claims: &[Claim]) -> Page {
    let width = 2.0 * EDGE + WIDTHS.iter().sum::<f64>() + GAP * (WIDTHS.len() - 1) as f64;
    let mut sheet = Page::new(width, 0.0, 2.0);
    let lefts = [0, 1, 2, 3, 4].map(|column| EDGE + WIDTHS[..column].iter().sum::<f64>() + GAP * column as f64);
    let heavy = Stroke::solid(theme::INK, theme::LINE);
    let heads =
        HEADS.map(|head| lines(head, f64::INFINITY).into_iter().map(|line| Line { is_bold: true, ..line }).collect());
    let mut y = EDGE;
    for (i, cells) in std::iter::once(heads).chain(claims.iter().map(cells)).enumerate() {
        let stroke = [heavy, Stroke::solid(theme::INK, theme::THIN)].get(i).copied().unwrap_or(theme::GRID);
        sheet.line([[EDGE, y], [width - EDGE, y]], stroke);
        let height = LINE * cells.iter().map(Vec::len).max().unwrap_or(1) as f64 + 2.0 * PADDING - 4.0;
        for (left, cell) in lefts.into_iter().zip(cells) {
            for (n, Line { text, ink, is_bold, indent, dot }) in cell.into_iter().enumerate() {
                let top = y + PADDING + LINE * n as f64;
                let text = Text::new([left + indent, top], theme::TICK_SIZE, text).held(Anchor::Start, Level::Top);
                let text = text.coloured(ink);
                sheet.text(if is_bold { text.bold() } else { text });
                if let Some(dot) = dot {
                    sheet.circle([left + 4.0, top + 4.2], 3.2, dot);
                }
            }
        }
        y += height;
    }
    sheet.line([[EDGE, y], [width - EDGE, y]], heavy);
    // What the dots mean
    y += PADDING;
    let note = |at: [f64; 2], text: &str| Text::new(at, theme::NOTE_SIZE, text).held(Anchor::Start, Level::Top);
    let legend = [(Some(true), "meets the claim"), (Some(false), "does not"), (None, "undecided")];
    for (i, (holds, name)) in legend.into_iter().enumerate() {
        let x = lefts[2] + 140.0 * i as f64;
        sheet.circle([x + 4.0, y + 4.2], 3.2, dot(holds));
        sheet.text(note([x + BULLET, y], name));
    }
    sheet.text(note([EDGE, y], "Dots: a number with what the claim demands of it."));
    sheet.text(note([lefts[2] + BULLET, y + LINE], "no dot: measured on another input than the report's"));
    sheet.height = (y + 2.0 * LINE + EDGE).ceil();
    sheet
}

/// The colour of a finding.
fn dot(holds: Option<bool>) -> Colour {
    holds.map_or(theme::NO_VALUE, |holds| if holds { theme::ACCEPTED } else { theme::REJECTED })
}

/// The lines of each column.
fn cells(claim: &Claim) -> [Vec<Line>; 5] {
    let text = &claim.text;
    let ink = match claim.verdict() {
        _ if !claim.is_judged() => theme::INK,
        Verdict::Holds => theme::ACCEPTED,
        Verdict::HoldsPartly => theme::INCONCLUSIVE,
        Verdict::DoesNotHold => theme::REJECTED,
        Verdict::NotTestable => theme::NO_VALUE,
    };
    let findings = claim.findings.iter().map(|finding| claim.is_judged().then(|| dot(finding.holds())));
    let sentence = |(text, dot): (String, Option<Colour>)| {
        let lines = lines(&text, WIDTHS[2] - BULLET).into_iter().enumerate();
        lines.map(move |(i, line)| Line { indent: BULLET, dot: dot.filter(|_| i == 0), ..line })
    };
    let verdict = lines(&claim.answer(), WIDTHS[3]);
    [
        lines(text.claim, WIDTHS[0]),
        [lines(text.place, WIDTHS[1]), lines(text.number, WIDTHS[1])].into_iter().flatten().collect(),
        measured(claim).into_iter().zip(findings.chain([None])).flat_map(sentence).collect(),
        verdict.into_iter().map(|line| Line { ink, is_bold: claim.is_judged(), ..line }).collect(),
        text.evidence.iter().flat_map(|id| lines(id, WIDTHS[4])).collect(),
    ]
}

/// A quarter of an image's width is shown of each place, more where the place is larger.
const SHOWN: usize = 4;
/// Pixels between a place and its frame.
const MARGIN: usize = 3;
/// A place and what surrounds it.
const AROUND: f64 = 1.25;

/// Each place in the image with all light, framed, beside its class alone.
pub fn places(pictures: &[PlacePicture], depths: &Depths) -> Drawing {
    let cells = pictures.iter().zip('a'..).flat_map(
        |(PlacePicture { title, word, depth, class, place, share, .. }, letter)| {
            let image = depths.image(*depth);
            let part = surroundings(image, place);
            let title = format!("({letter}) {title}: all light at depth {depth}");
            let factor = brightening(&cut(class, &part));
            let share = with_error([share.value, share.error()], Unit::Percent);
            let alone = format!("{word} alone, ×\u{a0}{factor}: {share} of the light in the frame");
            let class = cut(class, &part).map(|p| p * factor);
            [(title, framed(&tone_mapped(&cut(image, &part)), place, &part)), (alone, tone_mapped(&class))]
        },
    );
    contact_sheet("", 4, &cells.collect::<Vec<_>>())
}

/// A part of an image of 4 to 3 around a place.
fn surroundings(image: &Image, place: &Place) -> Place {
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
