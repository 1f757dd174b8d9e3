//! The reports' claims as rows of tables, and pictures of the places that claims are about.

use super::depth::tone_mapped;
use super::text::superscript;
use crate::figure::{Colour, Drawing, Rgb8, contact_sheet, theme};
use etalon_bench::claims::{self, Bound, Claim, Finding, Place, PlacePicture, Unit};
use etalon_bench::depth::Depths;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::raster::Image;
use serde::Serialize;

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

/// A quarter of an image's width is shown of each place, more where the place is larger.
const SHOWN: usize = 4;
/// Pixels between a place and its frame.
const MARGIN: usize = 3;
/// A place and what surrounds it.
const AROUND: f64 = 1.25;

/// Each place in the image with all light, framed, beside its class alone.
pub fn places(pictures: &[PlacePicture], depths: &Depths) -> Drawing {
    let whole = depths.image(0);
    let widths = pictures.iter().map(|picture| width_around(whole, &picture.place));
    let width = widths.max().unwrap_or(1);
    let cells = pictures.iter().zip('a'..).flat_map(
        |(PlacePicture { title, word, depth, class, place, share, .. }, letter)| {
            let image = depths.image(*depth);
            let part = surroundings(image, place, width);
            let title = format!("({letter}) {title}: image of depth\u{a0}{depth}");
            let factor = brightening(&cut(class, &part));
            let share = with_error([share.value, share.error()], Unit::Percent);
            let alone =
                format!("{} alone, exposure ×\u{a0}{factor}: {share} of the light in the frame", in_words(word));
            let class = cut(class, &part).map(|p| p * factor);
            [
                (title, framed(&tone_mapped(&cut(image, &part)), place, &part)),
                (alone, framed(&tone_mapped(&class), place, &part)),
            ]
        },
    );
    contact_sheet("Places in the image, and the paths that light them", 4, &cells.collect::<Vec<_>>())
}

/// A class of paths from the light to the eye: "light → mirror → glass → eye".
fn in_words(word: &str) -> String {
    let events = [
        ("SₜSₜ", "through glass"),
        ("Sᵣ", "off glass"),
        ("Sₘ", "off the mirror"),
        ("Sᵢ", "in glass"),
        ("D", "off a wall"),
    ];
    let Some(class) = word.strip_prefix('L').and_then(|rest| rest.strip_suffix('E')) else { return word.to_owned() };
    let said = events.iter().fold(class.to_owned(), |said, (event, words)| said.replace(event, &format!("{words} → ")));
    format!("light → {said}eye").replace(" →", "\u{a0}→")
}

/// The width of a part of an image of 4 to 3 around a place.
fn width_around(image: &Image, place: &Place) -> usize {
    let size = [0, 1].map(|axis| AROUND * (place.to[axis] - place.from[axis]) as f64);
    (size[0].max(size[1] * 4.0 / 3.0) as usize).max(image.width() / SHOWN)
}

/// A part of an image of 4 to 3 around a place.
fn surroundings(image: &Image, place: &Place, width: usize) -> Place {
    let whole = [image.width(), image.height()];
    let width = width.min(whole[0]);
    let size = [width, (width * 3 / 4).clamp(1, whole[1])];
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
