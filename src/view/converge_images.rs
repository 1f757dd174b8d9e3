//! Images after equal time: of every contender the regions where contenders differ most, enlarged, above their errors.

use super::converge::{curves, duration, label, round, short};
use crate::figure::{Drawing, Heatmap, Rgb8, Shading, contact_sheet, theme};
use crate::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use crate::study::converge::Convergence;
use crate::study::converge::curve::{Curve, Level};

/// Curves above images at equal time.
pub fn sheet(result: &Convergence) -> Drawing {
    Drawing::stacked(vec![curves(result), images(result)], 0.5, 2.0)
}

/// The label of the colour bar of relative errors.
pub const ERROR_LABEL: &str = "relative error (%): blue is too dark, red too bright, grey not compared";
/// Largest side of a region in pixels, and its share of the image's shorter side.
const LARGEST: usize = 128;
const SHARE: f64 = 0.4;
/// Regions of each image.
const REGIONS: usize = 2;
/// Pixels that the row of a cell's regions has at least after enlargement by a whole factor.
const WIDTH: usize = 360;
const COLUMNS: usize = 5;

/// Every contender's image after equal time, with its relative error below.
pub fn images(result: &Convergence) -> Drawing {
    let seconds = result.common_seconds();
    let Some(truth) = &result.truth else { return contact_sheet("Nothing was measured", 1, &[]) };
    let truth = truth.image();
    let mean = result.reference.as_ref().map_or(f64::NAN, |facts| facts.mean);
    // Each contender at the level nearest to the common time
    let shown: Vec<(&Curve, &Level, &Image)> = result
        .curves
        .iter()
        .filter_map(|curve| curve.nearest(seconds).map(|at| (curve, &curve.levels[at], &curve.images[at])))
        .collect();
    // One scale of errors for all: the median RMSE, rounded up
    let mut sizes: Vec<f64> = shown.iter().map(|(_, level, _)| level.rmse() / mean).collect();
    sizes.sort_by(f64::total_cmp);
    let limit = round(sizes.get(sizes.len() / 2).copied().unwrap_or(0.05));
    let tone = ToneMap::Srgb { stops: auto_exposure(&truth) };
    let scale = |width: usize, values: Vec<f64>| {
        Heatmap::new(width, values, Shading::Diverging, ERROR_LABEL).range(-100.0 * limit, 100.0 * limit)
    };
    // Relative to at least 3 % of the mean
    let relative = |image: &Image| -> Vec<f64> {
        let pairs = image.pixels().iter().zip(truth.pixels());
        let error = |(p, q): (&crate::math::Rgb, &crate::math::Rgb)| {
            let (got, expected) = (f64::from(p.element_sum()), f64::from(q.element_sum()));
            100.0 * (got - expected) / expected.max(0.03 * mean)
        };
        pairs.map(error).collect()
    };
    let errors: Vec<Vec<f64>> = shown.iter().map(|(.., image)| relative(image)).collect();
    let regions = regions([truth.width(), truth.height()], &errors);
    let tones = |image: &Image| Rgb8::new(image.width(), image.height(), to_rgb8(image, &tone));
    let mut cells = vec![("reference, and the regions shown".to_owned(), framed(&tones(&truth), &regions))];
    for ((curve, level, image), errors) in shown.iter().zip(errors) {
        let caption = format!(
            "{}: {}\u{a0}spp, {}, RMSE\u{a0}{}",
            label(&curve.strategy),
            level.spp,
            duration(level.cpu_seconds),
            short(level.rmse())
        );
        cells.push((caption, cropped([&tones(image), &scale(image.width(), errors).image()], &regions)));
    }
    let title = format!("After about {} of processor time each: image and relative error", duration(seconds));
    let sheet = contact_sheet(&title, COLUMNS, &cells);
    let bar = scale(1, Vec::new()).bar(420.0);
    Drawing::stacked(vec![sheet, bar], 0.5, 2.0)
}

/// A square region of an image: its left upper corner and its side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Region {
    x: usize,
    y: usize,
    side: usize,
}

impl Region {
    fn overlaps(self, other: Self) -> bool {
        let apart = |a: usize, b: usize| a + self.side <= b || b + other.side <= a;
        !(apart(self.x, other.x) || apart(self.y, other.y))
    }
}

/// The regions, without overlap, in which the mean absolute errors of the contenders vary most.
fn regions([width, height]: [usize; 2], errors: &[Vec<f64>]) -> Vec<Region> {
    let side = ((width.min(height) as f64 * SHARE).ceil() as usize).clamp(1, LARGEST);
    let step = (side / 4).max(1);
    let starts = |length: usize| (0..=length - side).step_by(step);
    let spread = |region: Region| {
        let of = |errors: &Vec<f64>| {
            let rows = (region.y..region.y + side).flat_map(|y| &errors[y * width + region.x..][..side]);
            rows.filter(|e| e.is_finite()).map(|e| e.abs()).sum::<f64>()
        };
        let sums: Vec<f64> = errors.iter().map(of).collect();
        sums.iter().copied().fold(0.0, f64::max) - sums.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let mut all: Vec<(f64, Region)> = starts(height)
        .flat_map(|y| starts(width).map(move |x| Region { x, y, side }))
        .map(|region| (spread(region), region))
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut chosen: Vec<Region> = Vec::new();
    for (_, region) in all {
        if chosen.len() < REGIONS && !chosen.iter().any(|other| other.overlaps(region)) {
            chosen.push(region);
        }
    }
    chosen.sort_by_key(|region| (region.x, region.y));
    chosen
}

/// Regions side by side, of each image in a row of its own, every pixel enlarged to a square.
fn cropped(images: [&Rgb8; 2], regions: &[Region]) -> Rgb8 {
    let Some(Region { side, .. }) = regions.first() else { return images[0].clone() };
    let zoom = WIDTH.div_ceil(side * regions.len());
    let (cell, line) = (side * zoom, 4);
    let size = |count: usize| count * (cell + line) - line;
    Rgb8::from_fn(size(regions.len()), size(images.len()), |x, y| {
        let ([column, x], [row, y]) = [x, y].map(|at| [at / (cell + line), at % (cell + line)]).into();
        if x >= cell || y >= cell {
            return [255; 3];
        }
        let region = regions[column];
        images[row].pixel(region.x + x / zoom, region.y + y / zoom)
    })
}

/// The whole image, enlarged, with frames around the regions.
fn framed(image: &Rgb8, regions: &[Region]) -> Rgb8 {
    let zoom = (WIDTH / image.width()).max(1);
    let frame = [theme::MARKER.r, theme::MARKER.g, theme::MARKER.b];
    Rgb8::from_fn(image.width() * zoom, image.height() * zoom, |x, y| {
        let on_frame = |region: &Region| {
            let [left, top, side] = [region.x, region.y, region.side].map(|at| at * zoom);
            let (dx, dy) = (x.wrapping_sub(left), y.wrapping_sub(top));
            let inside = dx < side && dy < side;
            inside && (dx.min(dy) < 2 || dx.max(dy) + 2 >= side)
        };
        if regions.iter().any(on_frame) { frame } else { image.pixel(x / zoom, y / zoom) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_where_contenders_differ() {
        let (width, height) = (50, 40);
        let noise = |from: usize| -> Vec<f64> {
            (0..width * height).map(|i| if i % width >= from && i % width < from + 8 { 5.0 } else { 1.0 }).collect()
        };
        let found = regions([width, height], &[noise(40), noise(0), vec![1.0; width * height]]);
        assert_eq!(found.len(), 2);
        assert!(found[0].x <= 4 && found[1].x >= 30 && !found[0].overlaps(found[1]), "{found:?}");
        assert_eq!(regions([1, 1], &[vec![f64::NAN]]), [Region { x: 0, y: 0, side: 1 }]);
    }
}
