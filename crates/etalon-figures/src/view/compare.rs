//! Images compared: their difference in false colour; tests of their expectation as a map, as p-values, as a table and in words.

use super::converge::{Region, all_regions, framed, round};
use super::text::{LINE, capitalized, clauses, counted, finding, p_is, p_value, rounded, wrapped};
use crate::figure::{
    Axis, Colour, Drawing, Heatmap, Marker, Panel, Plot, Point, Rgb8, Shading, Stroke, contact_sheet, image_rows, theme,
};
use etalon_bench::compare::{
    Answer, Bias, Compared, Explanation, Family, FamilyResult, Functional, METRICS, Measured, Metric, Needed,
    NotFinite, Related, Tested,
};
use etalon_bench::table::Table;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use std::cmp::Ordering;

/// Longest side of the drawing of the difference, in pixels.
const LONGEST_SIDE: usize = 2048;
/// Tiles that are marked and enlarged.
const ENLARGED: usize = 3;
/// Keeps dark pixels from outweighing all others in the relative difference, as in the relative metrics.
const EPSILON: f64 = 0.01;

/// Two images with their names above their difference with its metrics. The difference is that of (R + G + B)/3, relative to |B| + 0.01 if asked for.
pub fn pair(images: [&Image; 2], names: &[String; 2], measured: &Measured, relative: bool) -> Drawing {
    let [a, b] = images;
    let (width, height) = (a.width() as f64, a.height() as f64);
    let longer = 480.0 / width.max(height);
    let stops = auto_exposure(b);
    let cell = |letter: &str, k: usize, mean: f64| {
        let image = images[k].reduced(reduction(images[k], SHOWN));
        let shown = Rgb8::new(image.width(), image.height(), to_rgb8(&image, &ToneMap::Srgb { stops }));
        (format!("{letter}: {}, mean\u{a0}{}", names[k], rounded(mean, 4)), shown)
    };
    let cells = [cell("A", 0, measured.numbers.mean_a), cell("B", 1, measured.numbers.mean_b)];
    let metrics = METRICS[..5].iter().map(|metric| (metric, metric.of(measured))).filter(|(_, v)| v.is_finite());
    let metrics: Vec<String> = metrics.map(|(metric, v)| of_metric(metric, v)).collect();
    let plot = Plot::new([difference_panel(a, b, relative)]).frame_size(width * longer, height * longer).draw();
    let title = if measured.identical {
        "A and B are the same values".into()
    } else {
        measured.explanation.as_ref().map_or_else(|| "A against B".into(), headline)
    };
    Drawing::stacked(vec![image_rows("", 2, &cells), plot], 0.5).headed(title, vec![metrics.join(", ")])
}

/// A metric and its value: "PSNR 17.5 dB".
pub fn of_metric(metric: &Metric, value: f64) -> String {
    let unit = if metric.unit.is_empty() { String::new() } else { format!("\u{a0}{}", metric.unit) };
    format!("{}\u{a0}{}{unit}", metric.title, rounded(value, 3))
}

/// The share of an image's width that the frame of a rejected one has.
const BORDER: usize = 80;
/// Longest side of an image beside its difference, in pixels.
const SHOWN: usize = 640;
/// The same on a sheet of many images.
const THUMBNAIL: usize = 240;

/// The factor by which an image is reduced to at most `longest` pixels a side.
fn reduction(image: &Image, longest: usize) -> usize {
    image.width().max(image.height()).div_ceil(longest)
}

/// What a sheet of many images shows of one: itself, and its relative difference from the reference, of the channel that differs most.
pub struct Thumbnail {
    image: Image,
    /// Nothing if the image has another size.
    difference: Vec<f64>,
}

impl Thumbnail {
    pub fn new(a: &Image, b: &Image) -> Self {
        let factor = reduction(a, THUMBNAIL);
        let (image, b) = (a.reduced(factor), b.reduced(factor));
        let relative = |(p, q): (&Rgb, &Rgb)| {
            let channels = (0..3).map(|c| f64::from(p[c] - q[c]) / (f64::from(q[c]).abs() + EPSILON));
            channels.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
        };
        Self { difference: image.pixels().iter().zip(b.pixels()).map(relative).collect(), image }
    }

    /// The thumbnail of an image whose size differs from that of the reference: as large as fits in the place of one of equal size.
    pub fn of_another_size(a: &Image, b: &Image) -> Self {
        let room = reduction(b, THUMBNAIL);
        let [width, height] = [b.width(), b.height()].map(|side| (side / room).max(1));
        let factor = a.width().div_ceil(width).max(a.height().div_ceil(height));
        Self { image: a.reduced(factor), difference: Vec::new() }
    }
}

/// An image on a sheet of many.
pub struct Shown<'a> {
    pub caption: String,
    /// `None` if it could not be read.
    pub thumbnail: Option<&'a Thumbnail>,
    pub is_rejected: bool,
    /// Whether a mistake of the whole image explains the difference: no place of it stands out.
    pub is_explained: bool,
}

/// Standard errors by which the mean difference of a place stands out.
const STANDS_OUT: f64 = 6.0;

/// Of the places whose mean difference is beyond the noise, which neighbouring pixels show, the one farthest from the median; none if there
/// is no such place.
fn worst(size @ [width, _]: [usize; 2], difference: &[f64]) -> Option<Region> {
    let of = |region: Region| {
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for y in region.y..region.y + region.side {
            // Differences relative to the reference: of a few bright dots none counts more than a pixel that is missing
            let row = difference[y * width + region.x..][..region.side].iter().map(|d| d.clamp(-1.0, 1.0));
            let row: Vec<f64> = row.filter(|d| d.is_finite()).collect();
            sum += row.iter().sum::<f64>();
            squares += row.windows(2).map(|pair| 0.5 * (pair[0] - pair[1]).powi(2)).sum::<f64>();
            count += row.len() as f64;
        }
        (sum / count, (squares / count).sqrt(), count)
    };
    let all: Vec<_> = all_regions(size).map(|region| (of(region), region)).collect();
    let median = |mut values: Vec<f64>| {
        values.retain(|value| value.is_finite());
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let usual = median(all.iter().map(|((mean, ..), _)| *mean).collect())?;
    // A place without noise is as noisy as others
    let least = median(all.iter().map(|((_, noise, _), _)| *noise).collect())?;
    let far = |(mean, ..): (f64, f64, f64)| (mean - usual).abs();
    let stands_out = |of @ (_, noise, count): (f64, f64, f64)| far(of) * count.sqrt() > STANDS_OUT * noise.max(least);
    let scored = all.into_iter().filter(|(of, _)| stands_out(*of));
    scored.max_by(|a, b| far(a.0).total_cmp(&far(b.0))).map(|(_, region)| region)
}

/// An image whose edge has the colour of what is rejected: it is as large as all others.
fn bordered(image: &Rgb8) -> Rgb8 {
    let Colour { r, g, b, .. } = theme::REJECTED;
    let (width, height) = (image.width(), image.height());
    let border = (width / BORDER).max(1);
    Rgb8::from_fn(width, height, |x, y| {
        let from_edge = x.min(y).min(width - 1 - x).min(height - 1 - y);
        if from_edge < border { [r, g, b] } else { image.pixel(x, y) }
    })
}

/// The reference, and every image beside its difference from it, all on one scale, with a frame where the difference stands out.
/// Images that are missing are grey, rejected ones have a frame.
pub fn sheet((name, reference): (&str, &Image), images: &[Shown]) -> Drawing {
    let tone = ToneMap::Srgb { stops: auto_exposure(reference) };
    let shown = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &tone));
    let small = reference.reduced(reduction(reference, THUMBNAIL));
    let (width, height) = (small.width(), small.height());
    // An image that is far off does not hide the differences of all others, nor of the only other
    let compared = || images.iter().filter_map(|shown| shown.thumbnail).filter(|of| !of.difference.is_empty());
    let mut limits: Vec<f64> = compared().map(|thumbnail| robust_limit(&thumbnail.difference)).collect();
    limits.retain(|limit| *limit > 0.0);
    limits.sort_unstable_by(f64::total_cmp);
    let limit = round(limits.get(limits.len().saturating_sub(1) / 2).copied().unwrap_or(1.0));
    let label = "difference by |reference| + 0.01, of the channel that differs most: blue is darker; one scale for all";
    let map = |values: Vec<f64>| Heatmap::new(width, values, Shading::Diverging, label).range(-limit, limit);
    let beside = |left: &Rgb8, right: &Rgb8| {
        let line = 4;
        Rgb8::from_fn(left.width() + line + right.width(), left.height(), |x, y| match x.checked_sub(left.width()) {
            None => left.pixel(x, y),
            Some(x) if x < line => [255; 3],
            Some(x) => right.pixel(x - line, y),
        })
    };
    let nothing = || map(vec![f64::NAN; width * height]).image();
    // An image of another size, in the middle of the place of one that has it
    let placed = |image: &Image| {
        let (image, grey) = (shown(image), nothing());
        let [left, top] = [width - image.width(), height - image.height()].map(|rest| rest / 2);
        Rgb8::from_fn(width, height, |x, y| match (x.checked_sub(left), y.checked_sub(top)) {
            (Some(i), Some(j)) if i < image.width() && j < image.height() => image.pixel(i, j),
            _ => grey.pixel(x, y),
        })
    };
    let place = |shown: &Shown| {
        let difference = &shown.thumbnail?.difference;
        if shown.is_explained || difference.is_empty() { None } else { worst([width, height], difference) }
    };
    let cell = |of: &Shown| {
        let both = match of.thumbnail {
            None => beside(&nothing(), &nothing()),
            Some(Thumbnail { image, difference }) if difference.is_empty() => beside(&placed(image), &nothing()),
            Some(Thumbnail { image, difference }) => {
                let worst: Vec<Region> = place(of).into_iter().collect();
                let pair = [shown(image), map(difference.clone()).image()];
                let [left, right] = pair.map(|image| framed(&image, &worst, 1, theme::DIFFERS));
                beside(&left, &right)
            }
        };
        (of.caption.clone(), if of.is_rejected { bordered(&both) } else { both })
    };
    let first = (format!("reference: {name}"), beside(&shown(&small), &nothing()));
    let cells: Vec<(String, Rgb8)> = std::iter::once(first).chain(images.iter().map(cell)).collect();
    let columns = ((cells.len() as f64 / 2.0).sqrt().ceil() as usize).clamp(1, 6);
    let title = format!("{} against {name}", counted(images.len(), "image"));
    let bar = map(Vec::new()).bar(420.0);
    let frames = [
        images.iter().any(|of| of.is_rejected).then_some("orange frame: rejected"),
        images
            .iter()
            .any(|of| place(of).is_some())
            .then_some("green frame: where the difference is unlike that of most places"),
    ];
    let legend = frames.into_iter().flatten().collect::<Vec<_>>().join("; ");
    let lines = if legend.is_empty() { Vec::new() } else { vec![capitalized(&legend)] };
    Drawing::stacked(vec![contact_sheet("", columns, &cells), bar], 0.5).headed(title, lines)
}

/// What explains a difference, without numbers of what is left: "A is upside down".
pub fn headline(explanation: &Explanation) -> String {
    let mistake = capitalized(&explanation.mistake);
    if explanation.in_part { mistake + " (in part)" } else { mistake }
}

/// What explains a difference, in words.
pub fn explained(explanation: &Explanation) -> String {
    let Explanation { mse_left, leaves_noise, in_part, .. } = explanation;
    let noise = if *leaves_noise && *mse_left > 0.0 { "noise, " } else { "" };
    let more = if *in_part { ", more than noise" } else { "" };
    // A factor multiplies noise, too
    let left = if mse_left.is_nan() || *mse_left > 1.0 {
        if *leaves_noise { "noise".into() } else { "next to nothing".into() }
    } else {
        format!("{noise}{} % of the mean squared error{more}", rounded(100.0 * mse_left, 2))
    };
    format!("{}: undone, this leaves {left}", explanation.told())
}

fn difference_panel(a: &Image, b: &Image, relative: bool) -> Panel {
    let (width, height) = (a.width(), a.height());
    // Large images are averaged over squares of pixels.
    let side = width.max(height).div_ceil(LONGEST_SIDE);
    let grey = |image: &Image, x: usize, y: usize| image.get(x, y).as_dvec3().element_sum() / 3.0;
    let at = |x: usize, y: usize| {
        let (a, b) = (grey(a, x, y), grey(b, x, y));
        (a - b) / if relative { b.abs() + EPSILON } else { 1.0 }
    };
    let square = |x: usize, y: usize| {
        let (columns, rows) = (x..width.min(x + side), y..height.min(y + side));
        let count = (columns.len() * rows.len()) as f64;
        rows.flat_map(|y| columns.clone().map(move |x| at(x, y))).sum::<f64>() / count
    };
    let rows = (0..height).step_by(side);
    let values: Vec<f64> = rows.flat_map(|y| (0..width).step_by(side).map(move |x| square(x, y))).collect();
    let limit = robust_limit(&values);
    let difference = if relative { "(A − B) / (|B| + 0.01)" } else { "A − B" };
    let label = format!("{difference} of (R + G + B)/3; blue: A is darker");
    let map = Heatmap::new(width.div_ceil(side), values, Shading::Diverging, label).range(-limit, limit);
    pixels_panel(width, height).title("A − B").heatmap(map)
}

fn pixels_panel(width: usize, height: usize) -> Panel {
    Panel::new(Axis::linear("column").range(0.0, width as f64), Axis::linear("row").range(height as f64, 0.0))
}

/// A scale that holds 99 % of the values: a single bright pixel does not hide the others.
fn robust_limit(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().filter(|v| v.is_finite()).map(|v| v.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let limit = sizes.get(sizes.len() * 99 / 100).copied().filter(|v| *v > 0.0);
    limit.or(sizes.last().copied()).unwrap_or(0.0)
}

pub fn csv(compared: &Compared) -> Result<Vec<u8>> {
    let tests = compared.families.iter().flat_map(|family| family.tests.iter().map(move |test| (family, test)));
    let tests: Vec<(&FamilyResult, &Tested)> = tests.collect();
    Table::of(&tests)
        .field("family", |(family, _)| family.family.name())
        .field("functional", |(_, test)| test.functional.to_string())
        .field("channel", |(_, test)| compared.channels[test.channel])
        .field("mean_a", |(_, test)| test.means[0])
        .field("mean_b", |(_, test)| test.means[1])
        .field("standard_error", |(_, test)| test.difference.standard_error)
        .field("dof", |(_, test)| test.difference.dof)
        .field("t", |(_, test)| test.difference.t())
        // The normal deviate that is as unlikely as t
        .field("z", |(_, test)| test.difference.z())
        .field("p", |(_, test)| test.difference.p())
        // p times the number of tests of the family and of families
        .field("adjusted_p", |(family, test)| family.adjusted(test))
        .field("dominated", |(_, test)| test.dominated)
        // The difference that would have been found with 90 % probability
        .field("detectable", |(family, test)| test.difference.detectable(family.level(compared.plan)))
        .csv()
}

/// A tile with its channel that differs most.
struct Tile {
    place: [usize; 4],
    worst: Option<Tested>,
}

fn tiles(compared: &Compared) -> Vec<Tile> {
    let tests = compared.families.iter().flat_map(|family| family.tests.chunks(3));
    let tile = |tests: &[Tested]| {
        let Functional::Tile(place) = tests[0].functional else { return None };
        let usable = tests.iter().filter(|test| !test.dominated).copied();
        let worst = usable.min_by(Tested::by_p);
        Some(Tile { place, worst })
    };
    tests.filter_map(tile).collect()
}

/// The map of z by tiles with the worst marked, the p-values of all tests, and the worst tiles enlarged.
pub fn drawing(compared: &Compared) -> Drawing {
    let [width, height] = compared.size;
    let mut tiles = tiles(compared);
    let map = if tiles.is_empty() {
        let [a, b] = &compared.means;
        difference_panel(a, b, false)
    } else {
        z_map(compared, &tiles)
    };
    tiles.retain(|tile| tile.worst.is_some());
    tiles.sort_by(|a, b| a.worst.iter().zip(&b.worst).map(|(a, b)| a.by_p(b)).next().unwrap_or(Ordering::Equal));
    // What chance explains is enlarged only if there is nothing else
    let is_different =
        |tile: &Tile| tile.worst.is_some_and(|worst| compared.families[2].adjusted(&worst) < compared.plan.level);
    tiles.truncate(tiles.iter().filter(|tile| is_different(tile)).count().clamp(1, ENLARGED));
    let map = tiles.iter().enumerate().fold(map, |panel, (i, tile)| {
        let [x, y, w, h] = tile.place.map(|v| v as f64);
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]];
        let frame = Stroke::solid(theme::MARKER_SHADE, 1.4);
        panel.line("", frame, corners).note([x + w, y], format!("{}", i + 1), Colour::BLACK)
    });
    let longer = 400.0 / width.max(height) as f64;
    let frame = [width as f64 * longer, (height as f64 * longer).max(120.0)];
    let plots = Plot::new([map, p_values(compared)]).frame_size(frame[0].max(160.0), frame[1]).draw();
    let rows = std::iter::once(plots).chain((!tiles.is_empty()).then(|| crops(compared, &tiles)));
    let sentence = sentence(compared);
    let (verdict, why) = sentence.split_once([':', ';']).unwrap_or((&sentence, ""));
    let words = [
        ("most at image,", "in the mean of the image,"),
        ("channel R", "red"),
        ("channel G", "green"),
        ("channel B", "blue"),
        (" -", " −"),
    ];
    let in_words = |line: &str| words.iter().fold(finding(line), |line, (name, word)| line.replace(name, word));
    let of_tiles = different_tiles(compared).map(|told| in_words(&told));
    let lines = clauses(why.trim()).iter().take(1).map(|line| in_words(line)).chain(of_tiles).collect();
    Drawing::stacked(rows.collect(), 0.5).headed(capitalized(verdict), lines)
}

fn z_map(compared: &Compared, tiles: &[Tile]) -> Panel {
    let [width, height] = compared.size;
    let columns = width.div_ceil(compared.tile_side);
    let rows = height.div_ceil(compared.tile_side);
    let mut values = vec![f64::NAN; columns * rows];
    for tile in tiles {
        let [x, y, ..] = tile.place.map(|v| v / compared.tile_side);
        values[y * columns + x] = tile.worst.map_or(f64::NAN, |worst| worst.difference.z());
    }
    let largest = values.iter().filter(|z| z.is_finite()).fold(5.0_f64, |m, z| m.max(z.abs())).min(10.0);
    // The last tiles of a row or column may reach beyond the image: of large images every so many pixels are drawn.
    let step = width.max(height).div_ceil(LONGEST_SIDE);
    let places = |length: usize| (0..length).step_by(step).map(|at| at / compared.tile_side);
    let values = places(height).flat_map(|y| places(width).map(move |x| y * columns + x)).map(|tile| values[tile]);
    let (values, across) = (values.collect(), width.div_ceil(step));
    let label = "A − B in standard errors (worst channel; blue: A is darker)";
    let map = Heatmap::new(across, values, Shading::Diverging, label).range(-largest, largest);
    pixels_panel(width, height).title(format!("Tiles of {} pixels", sides_of_tiles(compared))).heatmap(map)
}

fn sides_of_tiles(compared: &Compared) -> String {
    format!("{0}x{0}", compared.tile_side)
}

/// How many tiles differ, around what, and by how much in all: "52 of 169 tiles of 5x5 pixels differ, columns 0 to 24 and rows 0 to 63:
/// A − B is -5.15 % there".
fn different_tiles(compared: &Compared) -> Option<String> {
    let family = compared.families.iter().find(|family| family.family == Family::Tiles)?;
    let all: Vec<&[Tested]> = family.tests.chunks(compared.channels.len()).collect();
    let differs = |test: &Tested| !test.dominated && family.adjusted(test) < compared.plan.level;
    let different: Vec<&[Tested]> = all.iter().copied().filter(|tests| tests.iter().any(differs)).collect();
    if different.len() < 2 {
        return None;
    }
    let (mut ends, mut sums, mut signs) = ([usize::MAX, 0, usize::MAX, 0], [0.0; 2], [false; 2]);
    for tests in &different {
        let Functional::Tile([x, y, w, h]) = tests[0].functional else { return None };
        ends = [ends[0].min(x), ends[1].max(x + w - 1), ends[2].min(y), ends[3].max(y + h - 1)];
        let area = (w * h) as f64;
        tests.iter().for_each(|test| (0..2).for_each(|side| sums[side] += area * test.means[side]));
        tests
            .iter()
            .filter(|test| differs(test))
            .for_each(|test| signs[usize::from(test.means[0] > test.means[1])] = true);
    }
    let [left, right, top, bottom] = ends;
    let bias = match signs {
        [true, true] => ": brighter and darker ones".to_owned(),
        _ if sums[1] > 0.0 => format!(": A − B is {:+.2} % there", 100.0 * (sums[0] / sums[1] - 1.0)),
        _ => String::new(),
    };
    Some(format!(
        "{} of {} tiles of {} pixels differ, columns {left} to {right} and rows {top} to {bottom}{bias}",
        different.len(),
        all.len(),
        sides_of_tiles(compared)
    ))
}

fn p_values(compared: &Compared) -> Panel {
    // Smaller p-values are at the foot of the axis.
    const LEAST: f64 = 1e-12;
    let colours = [theme::CORRECTED, theme::INCONCLUSIVE, theme::OBSERVED];
    let (mut first, mut foot) = (1.0_f64, 1e-3_f64);
    let mut series: Vec<(String, Colour, Vec<Point>)> = Vec::new();
    for (family, colour) in compared.families.iter().zip(colours) {
        let usable = family.tests.iter().filter(|test| !test.dominated);
        let mut p: Vec<f64> = usable.map(|test| test.difference.p().max(LEAST)).collect();
        p.sort_unstable_by(f64::total_cmp);
        let n = p.len() as f64 + 1.0;
        let points: Vec<Point> = p.iter().enumerate().map(|(i, p)| [(i + 1) as f64 / n, *p]).collect();
        if let Some(point) = points.first() {
            let limit = family.level(compared.plan);
            first = first.min(point[0]);
            foot = foot.min(point[1]).min(limit);
            let below = match format!("{limit:.1e}").split_once("e-") {
                Some((digits, exponent)) if limit < 1e-3 => format!("{digits}·10^{{−{exponent}}}"),
                _ => rounded(limit, 2),
            };
            series.push((format!("{}: different below {below}", family.family.name()), colour, points));
        }
    }
    let title = match foot <= LEAST {
        true => "/{p}-values of all tests, not corrected (the lowest: 10^{−12} or less)",
        false => "/{p}-values of all tests, not corrected",
    };
    let foot = 10f64.powf(foot.log10().floor() - 0.5);
    let panel = Panel::new(
        Axis::log("rank / (tests + 1)").range(0.8 * first, 1.0),
        // Points at 1 keep off the frame
        Axis::log("/{p}-value").range(foot, 2.0),
    )
    .title(title)
    .line(
        "expected of equal images",
        Stroke::solid(theme::EXPECTED, theme::THIN),
        [[first * 0.8, first * 0.8], [1.0, 1.0]],
    );
    series.into_iter().fold(panel, |panel, (label, colour, points)| panel.markers(label, colour, Marker::Disc, points))
}

/// The worst tiles with their surroundings: A, B and their difference.
fn crops(compared: &Compared, tiles: &[Tile]) -> Drawing {
    let [a, b] = &compared.means;
    let stops = auto_exposure(b);
    let shown = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops }));
    let mut cells = Vec::new();
    for (i, Tile { place: [x, y, w, h], worst }) in tiles.iter().enumerate() {
        // As much around the tile as it is wide.
        let margin = compared.tile_side;
        let (left, top) = (x.saturating_sub(margin), y.saturating_sub(margin));
        let (right, bottom) = ((x + w + margin).min(a.width()), (y + h + margin).min(a.height()));
        let crop = |image: &Image| Image::from_fn(right - left, bottom - top, |i, j| image.get(left + i, top + j));
        let (a, b) = (crop(a), crop(b));
        let grey = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (a - b).as_dvec3().element_sum() / 3.0);
        let values: Vec<f64> = grey.collect();
        let limit = robust_limit(&values);
        let map = Heatmap::new(a.width(), values, Shading::Diverging, "").range(-limit, limit);
        let Some(worst) = worst else { continue };
        let [mean_a, mean_b] = worst.means.map(|mean| format!("{mean:.4}"));
        let channel = compared.channels[worst.channel];
        let (number, p) = (i + 1, compared.families[2].adjusted(worst));
        cells.push((format!("{number}: image A, channel {channel}: {mean_a}"), shown(&a)));
        cells.push((format!("{number}: image B, channel {channel}: {mean_b}"), shown(&b)));
        cells.push((format!("{number}: A − B, ±{}; corrected {}", rounded(limit, 2), p_value(p)), map.image()));
    }
    image_rows("The tiles that differ most, with their surroundings", 3, &cells)
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A difference as a share of B's image, with its interval; by itself where that is not told from black.
fn bias(compared: &Compared, family: &FamilyResult, test: &Tested) -> String {
    let Some(Bias { value, low, high }) = compared.bias(family, test) else {
        return format!("{:+.2e}, B is not told from black", test.difference.value);
    };
    let percent = |share: f64| format!("{:+.2}", 100.0 * share);
    format!("{} % ({} to {} %)", percent(value), percent(low), percent(high))
}

/// Where and by how much the images differ most, by the tests of a family.
pub fn most(compared: &Compared, family: &FamilyResult) -> Option<String> {
    let worst = family.worst?;
    let ([a, b], channel) = (worst.means.map(|mean| rounded(mean, 5)), compared.channels[worst.channel]);
    let bias = bias(compared, family, &worst);
    let is_mean_of_rgb = family.family == Family::Mean && compared.channels[0] == "R";
    let all = if is_mean_of_rgb { of_all_channels(&family.tests) } else { String::new() };
    Some(format!("most at {}, channel {channel}: A {a}, B {b}, {bias}{all}", worst.functional))
}

/// "; mean of all channels -9.0 %", of the tests of a functional.
fn of_all_channels(tests: &[Tested]) -> String {
    let [a, b] = [0, 1].map(|side| tests.iter().map(|test| test.means[side]).sum::<f64>());
    if b > 0.0 { format!("; mean of all channels {:+.2} %", 100.0 * (a / b - 1.0)) } else { String::new() }
}

/// What is said of pixels that are not compared.
pub fn left_out(pixels: usize) -> String {
    format!("left out: {} with NaN or infinite values", counted(pixels, "pixel"))
}

/// The same in few words: "1 pixel is NaN or infinite".
pub fn not_finite(pixels: usize) -> String {
    format!("{} {} NaN or infinite", counted(pixels, "pixel"), if pixels == 1 { "is" } else { "are" })
}

/// Where the first pixel is that is not finite.
pub fn where_not_finite(NotFinite { image, column, row, pixels, images }: &NotFinite) -> String {
    let all = if *pixels > 1 { format!(", the first of {pixels} such pixels") } else { String::new() };
    let others = match images - 1 {
        0 => String::new(),
        1 => "; 1 other image has such pixels, too".to_owned(),
        others => format!("; {others} other images have such pixels, too"),
    };
    format!("{image} is NaN or infinite in column {column}, row {row} (from 0){all}{others}")
}

pub fn sentence(compared: &Compared) -> String {
    let detect = percent(compared.plan.detect);
    let needed = compared.needed.map_or(String::new(), |needed| format!("; {} would find {detect}", sides(&needed)));
    match (compared.answer, compared.uniform_bias) {
        (Answer::NotIndependent, _) => {
            let of_side = |(related, side): (&Option<Related>, &str)| {
                let Related { images: [k, l], correlation, p } = (*related)?;
                Some(format!(
                    "images {} and {} of {side} (correlation {correlation:+.3}, {})",
                    k + 1,
                    l + 1,
                    p_is(p)
                ))
            };
            let pairs: Vec<String> = compared.related.iter().zip(["A", "B"]).filter_map(of_side).collect();
            format!(
                "not independent: {}; they share random numbers, or the images of that side differ in their expectations (several renderers, an exposure of their own)",
                pairs.join("; ")
            )
        }
        (Answer::NotFinite, bias) => {
            let place = compared.not_finite.as_ref().map_or(String::new(), where_not_finite);
            let others = match bias {
                Some(bias) => format!(
                    "no other difference found, and a uniform bias of {} would have been found with 90 % probability",
                    percent(bias)
                ),
                None => "no other difference found".into(),
            };
            format!("not finite: {place}; {others}")
        }
        (Answer::Different, _) => {
            // The mean of the image, if it differs: that is what a bias is
            let level = compared.plan.level;
            let worst = compared.families.iter().filter_map(|family| Some((family, family.adjusted_p?, family.worst?)));
            let rank = |(family, p, _): &(&FamilyResult, f64, Tested)| (family.family != Family::Mean || *p >= level, *p);
            let worst = worst.min_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(Ordering::Equal));
            worst.map_or("different".into(), |(family, _, test)| {
                let (at, channel) = (test.functional, compared.channels[test.channel]);
                let of = match (compared.bias(family, &test), family.family) {
                    (None, _) => "",
                    (_, Family::Tiles) => " of the tile's mean in B",
                    _ => " of the mean of image B",
                };
                format!("different: most at {at}, channel {channel}: A − B is {}{of}", bias(compared, family, &test))
            })
        }
        _ if compared.noise_hides_difference => {
            "cannot tell: the image that is declared exact seems to have noise, or differs in fine detail; if it has none, the images differ".into()
        }
        (Answer::NoDifferenceFound, Some(bias)) => {
            let bias = percent(bias);
            format!("no difference found; a uniform bias of {bias} would have been found with 90 % probability")
        }
        (_, Some(bias)) => {
            format!(
                "cannot tell: the smallest uniform bias found with 90 % probability is {}, not {detect}{needed}",
                percent(bias)
            )
        }
        (_, None) if compared.families.iter().any(|family| family.dominated > 0) => "cannot tell: a few samples dominate the mean of the image".into(),
        (_, None) => {
            format!(
                "cannot tell: too few replicates to know which bias would have been found, or the image is black{needed}"
            )
        }
    }
}

/// The images or samples that it takes, in words.
fn sides(needed: &Needed) -> String {
    let of_side = |k: usize| match needed.replicates[k] {
        Some(n) => Some(format!("{n} images of {}", ["A", "B"][k])),
        None => needed.noisy[k].then(|| format!("{:.1} times the samples of {}", needed.times, ["A", "B"][k])),
    };
    let sides: Vec<String> = [0, 1].into_iter().filter_map(of_side).collect();
    sides.join(" and ")
}

/// The verdict, a line for each family of tests, and the biases that would have been found.
pub fn text(compared: &Compared) -> String {
    let mut text = wrapped(&sentence(compared), "", LINE);
    let about =
        compared.explanation.as_ref().map(|explanation| format!("between the means: {}", explained(explanation)));
    text += &about.map_or(String::new(), |about| wrapped(&about, "", LINE));
    if let Some(place) = compared.not_finite.as_ref().filter(|_| compared.answer != Answer::NotFinite) {
        text += &wrapped(&format!("not finite, too: {}", where_not_finite(place)), "", LINE);
    }
    if compared.non_finite > 0 {
        text += &format!("{}\n", left_out(compared.non_finite));
    }
    let told = |family: &FamilyResult| match (family.untested, family.adjusted_p.zip(most(compared, family))) {
        (Some(reason), _) => format!("not tested: {reason}"),
        (None, Some((p, most))) => {
            let (p, tests) = (p_is(p), counted(family.tests.len(), "test"));
            format!("{p:<12} of {tests}\n{}", wrapped(&most, "  ", LINE).trim_end())
        }
        (None, None) => "nothing that can be tested".into(),
    };
    text += &Table::of(&compared.families).words("", |family| family.family.name()).words("", told).text_with(
        |family, line| match family.dominated {
            0 => line,
            count => {
                let first = family.tests.iter().find(|test| test.dominated);
                let place = first.map_or(String::new(), |test| format!(", first at {}", test.functional));
                format!("{line}  {count} inconclusive: a few samples dominate{place}\n")
            }
        },
    );
    text += &different_tiles(compared).map_or(String::new(), |told| wrapped(&told, "", LINE));
    let found = |what: &str, bias: f64| {
        wrapped(&format!("{what} {} would have been found with 90 % probability", percent(bias)), "", LINE)
    };
    if let Some(ratio) = compared.noise_of_exact {
        text += &wrapped(
            &format!(
                "the image that is declared exact seems to have noise, or differs in fine detail: {} times the variance of the other \
                 side's mean, which the tests allow for; give replicates, or an image with a layer of standard errors",
                rounded(ratio, 2)
            ),
            "",
            LINE,
        );
    }
    if let (Answer::Different, Some(bias)) = (compared.answer, compared.uniform_bias) {
        text += &found("a uniform bias of", bias);
    }
    if let Some(bias) = compared.own_tile_bias {
        text += &found("in one tile (median of all), a bias of the tile's mean of", bias);
    }
    let level = percent(1.0 - compared.plan.level).replace(".00", "");
    text + &wrapped(
        &format!(
            "p is corrected for the number of tests; A − B is in percent of the mean of image B in that channel, of a tile in percent of its own, \
             with {level} intervals"
        ),
        "",
        LINE,
    )
}
