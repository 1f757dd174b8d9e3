//! Environment maps with markers of samples and of regions.

use crate::figure::{Colour, Drawing, Page, Picture, Rect, Rgb8, Stroke, theme};
use etalon_bench::{map_samples, median_cut};
use etalon_core::envmap::EnvMap;
use etalon_core::math::Rgb;
use etalon_core::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use std::collections::BTreeMap;

/// How radiance becomes colour.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Look {
    /// Exposure in stops; chosen from the map when not given.
    pub exposure: Option<f32>,
    /// Pure power law instead of the sRGB curve.
    pub gamma: Option<f32>,
}

impl Look {
    /// The tone mapping, with the exposure of `automatic` if none was chosen.
    fn tone(&self, automatic: impl FnOnce() -> f32) -> ToneMap {
        let stops = self.exposure.unwrap_or_else(automatic);
        self.gamma.map_or(ToneMap::Srgb { stops }, |gamma| ToneMap::Gamma { gamma, stops })
    }
}

/// A tone-mapped map on which markers are put.
pub struct Display {
    base: Rgb8,
    look: Look,
    /// Texels of the map.
    width: usize,
    height: usize,
    /// Drawing units per texel.
    scale: f64,
}

/// Smallest and largest width of a map on the page; smaller maps are enlarged, larger ones reduced, by integer factors.
const PAGE: [usize; 2] = [512, 2048];
/// The map's height over the sides of the inset and of the part that it shows.
const INSET_SIDE: usize = 4;
const INSET_PART: usize = 24;
/// The side of the marker of a light of average flux, in those of a sample; no marker is smaller than half of one. Few lights have larger
/// ones, up to this part of the map's height.
const AVERAGE: f64 = 1.4;
const LARGEST_PART: f64 = 24.0;
/// Most of the map that the markers of its samples cover; but no marker has a smaller side than the least.
const COVERED: f64 = 0.012;
const LEAST: usize = 3;
/// The rim of a marker over its side.
const RIM: f64 = 0.2;
/// Times that a marker on black has the side of one on the map, where it would cover what it marks.
const ALONE: usize = 2;
/// The diameter of a dot of the inset, in drawing units.
const DOT: f64 = 10.0;

impl Display {
    pub fn new(map: &EnvMap, look: Look) -> Self {
        // Darker than usual, so that bright lights keep their colours and markers stand out.
        let tone = look.tone(|| auto_exposure(map.image()) - 1.5);
        let (width, height) = (map.image().width(), map.image().height());
        // Scale by an integer factor to a width within the limits of the page
        let (enlarge, reduce) =
            (PAGE[0].div_ceil(width).min(PAGE[0] / height.min(PAGE[0])).max(1), width.div_ceil(PAGE[1]));
        // One of the two factors is 1.
        let image = if reduce > 1 { map.image().reduced(reduce) } else { map.image().enlarged(enlarge) };
        let base = Rgb8::new(image.width(), image.height(), to_rgb8(&image, &tone));
        Self { base, look, width, height, scale: enlarge as f64 / reduce as f64 }
    }

    fn black(&self) -> Page {
        let (width, height) = (self.base.width(), self.base.height());
        Page::over(Rgb8::new(width, height, vec![0; 3 * width * height]))
    }

    /// A square marker around texel (x, y), `side` texels wide and `rim` drawing units wider on all sides: wrapped at the
    /// seam, clipped at the poles.
    fn marker(&self, drawing: &mut Page, (x, y): (f64, f64), side: usize, rim: f64, colour: Colour) {
        // Rows are clipped at the poles, columns wrap around the seam in two parts
        let half = (side / 2) as i64;
        let (x, y) = (x as i64, (y as i64).min(self.height as i64 - 1));
        let s = self.scale;
        let (width, height) = (self.width as f64 * s, self.height as f64 * s);
        let top = ((y - half) as f64 * s - rim).max(0.0);
        let bottom = ((y - half + side as i64) as f64 * s + rim).min(height);
        let span = (side as f64 * s + 2.0 * rim).min(width);
        let left = ((x - half) as f64 * s - rim).rem_euclid(width);
        let first = span.min(width - left);
        for (from, length) in [(left, first), (0.0, span - first)] {
            if length > 0.0 && bottom > top {
                drawing.rect(Rect::new(from, top, length, bottom - top), colour);
            }
        }
    }

    /// Markers with rims, which stand out from every background; rims lie below all markers.
    fn markers(&self, drawing: &mut Page, markers: &[((f64, f64), usize, Colour)], rims: &[(f64, Colour)]) {
        for &(rim, colour) in rims {
            markers.iter().for_each(|&(at, side, _)| self.marker(drawing, at, side, rim, colour));
        }
        markers.iter().for_each(|&(at, side, colour)| self.marker(drawing, at, side, 0.0, colour));
    }

    /// The map with a blue marker at each sample; samples that one marker would cover have one of as many times its area. An
    /// inset enlarges the place with most samples.
    pub fn samples(&self, rows: &[map_samples::SampleRow], side: usize) -> Drawing {
        let mut drawing = Page::over(self.base.clone());
        let side = self.side(rows.len(), side);
        let groups = grouped(rows, side);
        let marker = |group: &Group| {
            let wide = (side as f64 * (group.count as f64).sqrt()).round() as usize;
            (group.at, wide, theme::MARKER)
        };
        let markers: Vec<_> = groups.iter().map(marker).collect();
        let rim = RIM * side as f64;
        self.markers(&mut drawing, &markers, &[(2.0 * rim, theme::MARKER_SHADE), (rim, theme::BORDER)]);
        let densest = groups.iter().max_by_key(|group| group.count).filter(|group| group.count > 1);
        // An inset that does not part the dots shows nothing
        let is_parted = |group: &&Group| group.count > 2 && group.extent * self.scale * self.zoom()[1] as f64 > DOT;
        let zoom = densest.filter(is_parted).map(|densest| self.inset(&mut drawing, rows, densest.at));
        Drawing::Picture(Picture { page: drawing, key: self.key(side, densest.map(|group| group.count), zoom) })
    }

    /// The side of a marker, less where many would cover what they mark.
    fn side(&self, samples: usize, side: usize) -> usize {
        let fitting = (COVERED * (self.width * self.height) as f64 / samples.max(1) as f64).sqrt().ceil() as usize;
        side.min(fitting.max(LEAST))
    }

    /// What the markers mean.
    fn key(&self, side: usize, most: Option<usize>, zoom: Option<usize>) -> Vec<(f64, Colour, String)> {
        let inset =
            zoom.map(|zoom| (0, format!("inset: the square in orange, {zoom} times as large, a dot for each sample")));
        let most = most.map(|most| (most, format!("{most} samples, the most under one marker")));
        let markers = [(1, "1 sample".to_owned())].into_iter().chain(most);
        let side = |count: usize| side as f64 * (count as f64).sqrt() * self.scale;
        markers.chain(inset).map(|(count, name)| (side(count), theme::MARKER, name)).collect()
    }

    /// The pixels of the page that the inset shows along each side, and how much larger.
    fn zoom(&self) -> [usize; 2] {
        let part = (self.base.height() / INSET_PART).max(1);
        [part, (self.base.height() / INSET_SIDE / part).max(2)]
    }

    /// An enlarged part of the map around a texel, with a marker at each sample, in the corner with the fewest samples;
    /// by how much it is enlarged.
    fn inset(&self, drawing: &mut Page, rows: &[map_samples::SampleRow], (x, y): (f64, f64)) -> usize {
        let (width, height) = (self.base.width(), self.base.height());
        let [part, zoom] = self.zoom();
        let corner =
            |at: f64, size: usize| ((at * self.scale) as usize).saturating_sub(part / 2).min(size - part.min(size));
        let (left, top) = (corner(x, width), corner(y, height));
        let image = Rgb8::from_fn(part * zoom, part * zoom, |i, j| {
            self.base.pixel((left + i / zoom).min(width - 1), (top + j / zoom).min(height - 1))
        });
        let side = (part * zoom) as f64;
        let gap = 0.02 * height as f64;
        let (far_right, low) = (width as f64 - gap - side, height as f64 - gap - side);
        let corners = [[far_right, low], [gap, low], [far_right, gap], [gap, gap]];
        let covered = |&[x, y]: &[f64; 2]| {
            let place = Rect::new(x, y, side, side);
            rows.iter().filter(|r| place.contains([r.x * self.scale, r.y * self.scale])).count()
        };
        let [x, y] = corners.into_iter().min_by_key(covered).unwrap_or([gap; 2]);
        let place = Rect::new(x, y, side, side);
        let source = Rect::new(left as f64, top as f64, part as f64, part as f64);
        for (frame, width, colour) in [
            (source, 5.0, theme::MARKER_SHADE),
            (source, 2.6, theme::INSET),
            (place, 5.0, theme::MARKER_SHADE),
            (place, 3.0, theme::INSET),
        ] {
            drawing.rect(frame, Stroke::solid(colour, width));
        }
        drawing.image(place, image);
        let times = zoom as f64;
        let inside =
            rows.iter().map(|r| [(r.x * self.scale - left as f64) * times, (r.y * self.scale - top as f64) * times]);
        let inside: Vec<_> = inside.filter(|p| p.iter().all(|v| (0.0..side).contains(v))).collect();
        // Samples of one texel show as a darker marker
        for [x, y] in inside {
            let centre = [place.x + x, place.y + y];
            drawing.circle(centre, 0.5 * DOT, theme::BORDER.faded(0.6));
            drawing.circle(centre, 3.6, theme::MARKER.faded(0.6));
        }
        zoom
    }

    /// Black except for a marker at each sample, in the hue of its radiance.
    pub fn samples_only(&self, rows: &[map_samples::SampleRow], side: usize) -> Drawing {
        let mut drawing = self.black();
        if rows.is_empty() {
            return drawing.into();
        }
        // The cube root of the brightness, unless an exposure is given: bright windows keep their colours, and walls are seen
        let power = if self.look.exposure.is_none() { 1.0 / 3.0 } else { 1.0 };
        let of = |r: &map_samples::SampleRow| {
            let (colour, brightest) = (Rgb::new(r.r, r.g, r.b), r.r.max(r.g).max(r.b));
            if brightest > 0.0 { colour / brightest * brightest.powf(power) } else { colour }
        };
        let strip = Image::from_pixels(rows.len(), 1, rows.iter().map(of).collect());
        let bytes = to_rgb8(
            &strip,
            &self.look.tone(|| -strip.pixels().iter().map(|c| c.max_element()).fold(0.0, f32::max).log2()),
        );
        let colour = |rgb: &[u8]| Colour::rgb(rgb[0], rgb[1], rgb[2]);
        let markers: Vec<_> =
            rows.iter().zip(bytes.chunks_exact(3)).map(|(r, rgb)| ((r.x, r.y), ALONE * side, colour(rgb))).collect();
        self.markers(&mut drawing, &markers, &[(1.5, theme::MARKER_RIM)]);
        said(
            drawing,
            match self.look.exposure {
                None => "a square for each sample, in the hue of its radiance, as bright as the cube root of it",
                Some(_) => "a square for each sample, in the colour of its radiance",
            },
        )
    }

    /// The map with white lines between the regions and a blue dot at each centroid.
    pub fn partition(&self, rows: &[median_cut::RegionRow]) -> Drawing {
        let s = self.scale;
        let mut drawing = Page::over(self.base.clone());
        // White lines on dark ones are seen on windows as on walls
        for line in [Stroke::solid(theme::MARKER_SHADE, 3.4), Stroke::solid(theme::BORDER, 1.4)] {
            for r in rows {
                // Each region draws its left and upper border; the map's own edge needs none.
                let (x0, y0, x1, y1) = (r.x0 as f64 * s, r.y0 as f64 * s, r.x1 as f64 * s, r.y1 as f64 * s);
                if r.x0 > 0 {
                    drawing.line([[x0, y0], [x0, y1]], line);
                }
                if r.y0 > 0 {
                    drawing.line([[x0, y0], [x1, y0]], line);
                }
            }
        }
        for r in rows {
            let centre = [r.centroid_x * s, r.centroid_y * s];
            for (radius, colour) in [(6.5, theme::MARKER_SHADE), (5.5, theme::BORDER), (4.0, theme::MARKER)] {
                drawing.circle(centre, radius, colour);
            }
        }
        said(drawing, "lines: borders of regions of equal energy; dots: their centroids of energy")
    }

    /// The map, dimmed, with a marker at each centroid, in the colour of the region's total flux and of an area in proportion to it.
    /// The brightest light is shown at full scale, the others in proportion before the power law of 1/2.2.
    pub fn lights(&self, rows: &[median_cut::RegionRow], side: usize) -> Drawing {
        // Part of the map's brightness on the page
        const DIMMED: f64 = 0.4;
        let covering = (COVERED * (self.width * self.height) as f64 / rows.len().max(1) as f64).sqrt();
        let side = side.max(covering.min(self.height as f64 / LARGEST_PART / AVERAGE) as usize);
        let flux = |r: &median_cut::RegionRow| r.flux_r + r.flux_g + r.flux_b;
        let mean = rows.iter().map(flux).sum::<f64>() / rows.len().max(1) as f64;
        let wide = |r: &median_cut::RegionRow| match (flux(r) / mean).sqrt() {
            size if size.is_finite() => (AVERAGE * side as f64 * size).round().max((side as f64 / 2.0).ceil()) as usize,
            _ => side,
        };
        let brightest = rows.iter().map(|r| r.flux_r.max(r.flux_g).max(r.flux_b)).fold(0.0, f64::max);
        let byte = |v: f64| if brightest > 0.0 { (255.0 * (v / brightest).powf(1.0 / 2.2)).round() as u8 } else { 0 };
        let dim = |v: u8| (DIMMED * f64::from(v)) as u8;
        let base = Rgb8::from_fn(self.base.width(), self.base.height(), |x, y| self.base.pixel(x, y).map(dim));
        let mut page = Page::over(base);
        let colour = |r: &median_cut::RegionRow| Colour::rgb(byte(r.flux_r), byte(r.flux_g), byte(r.flux_b));
        let markers: Vec<_> = rows.iter().map(|r| ((r.centroid_x, r.centroid_y), wide(r), colour(r))).collect();
        self.markers(&mut page, &markers, &[(1.5, theme::MARKER_RIM)]);
        said(
            page,
            "a square at the centroid of each region: its area is in proportion to the flux (nearly equal for all), its colour that of the flux",
        )
    }
}

/// A picture with a sentence below it.
fn said(page: Page, text: &str) -> Drawing {
    Drawing::Picture(Picture { page, key: vec![(0.0, theme::INK, text.to_owned())] })
}

/// Samples that one marker covers.
struct Group {
    /// Their mean position in texels.
    at: (f64, f64),
    /// The larger side of the smallest rectangle around them, in texels.
    extent: f64,
    count: usize,
}

/// The samples in cells of `side` texels a side, in the order of the cells.
fn grouped(rows: &[map_samples::SampleRow], side: usize) -> Vec<Group> {
    let mut cells: BTreeMap<[usize; 2], Vec<[f64; 2]>> = BTreeMap::new();
    for r in rows {
        cells.entry([r.y, r.x].map(|v| v as usize / side.max(1))).or_default().push([r.x, r.y]);
    }
    let group = |places: Vec<[f64; 2]>| {
        let mean = |axis: usize| places.iter().map(|at| at[axis]).sum::<f64>() / places.len() as f64;
        let end = |axis: usize, of: fn(f64, f64) -> f64| places.iter().map(|at| at[axis]).fold(f64::NAN, of);
        let extent = |axis| end(axis, f64::max) - end(axis, f64::min);
        Group { at: (mean(0), mean(1)), extent: extent(0).max(extent(1)), count: places.len() }
    };
    cells.into_values().map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Item;

    fn rects(drawing: &Page) -> Vec<Rect> {
        let rect = |item: &Item| if let Item::Rect { rect, .. } = item { Some(*rect) } else { None };
        drawing.items.iter().filter_map(rect).collect()
    }

    #[test]
    fn markers_wrap_at_the_seam_and_stop_at_the_poles() {
        let map = EnvMap::new(Image::from_fn(1024, 512, |_, _| Rgb::ONE));
        let display = Display::new(&map, Look::default());
        let at = |x: f64, y: f64, side: usize| {
            let mut drawing = display.black();
            display.marker(&mut drawing, (x, y), side, 0.0, theme::MARKER);
            rects(&drawing)
        };
        assert_eq!(at(100.5, 50.5, 5), [Rect::new(98.0, 48.0, 5.0, 5.0)]);
        assert_eq!(at(0.5, 50.5, 5), [Rect::new(1022.0, 48.0, 2.0, 5.0), Rect::new(0.0, 48.0, 3.0, 5.0)]);
        assert_eq!(at(1023.5, 0.5, 5), [Rect::new(1021.0, 0.0, 3.0, 3.0), Rect::new(0.0, 0.0, 2.0, 3.0)]);
        assert_eq!(at(10.5, 511.9, 5), [Rect::new(8.0, 509.0, 5.0, 3.0)]);
        let mut drawing = display.black();
        display.marker(&mut drawing, (0.5, 50.5), 5, 1.0, theme::BORDER);
        assert_eq!(rects(&drawing), [Rect::new(1021.0, 47.0, 3.0, 7.0), Rect::new(0.0, 47.0, 4.0, 7.0)]);
        assert_eq!(at(10.5, 10.5, 5000), [Rect::new(582.0, 0.0, 442.0, 512.0), Rect::new(0.0, 0.0, 582.0, 512.0)]);
    }

    #[test]
    fn samples_under_one_marker_share_a_larger_one() {
        let at = |x: f64, y: f64| map_samples::SampleRow { x, y, ..map_samples::SampleRow::default() };
        let rows = [at(100.5, 50.5), at(101.5, 50.5), at(102.5, 50.5), at(103.5, 50.5), at(500.5, 50.5)];
        let counts: Vec<usize> = grouped(&rows, 5).iter().map(|group| group.count).collect();
        assert_eq!(counts, [4, 1]);
        let map = EnvMap::new(Image::from_fn(1024, 512, |_, _| Rgb::ONE));
        let Drawing::Picture(drawing) = Display::new(&map, Look::default()).samples(&rows, 5) else {
            panic!("a picture")
        };
        let sides: Vec<f64> = rects(&drawing.page).iter().map(|rect| rect.width).collect();
        // Two rims below the markers, then the frames of the inset and of what it shows
        assert_eq!(sides[..6], [14.0, 9.0, 12.0, 7.0, 10.0, 5.0]);
        assert_eq!(sides[6..10], [21.0, 21.0, 126.0, 126.0]);
        assert_eq!(drawing.key.iter().map(|(side, ..)| *side).collect::<Vec<_>>(), [5.0, 10.0, 0.0]);
        // Four samples at one place are not parted by an inset
        let alike = Display::new(&map, Look::default()).samples(&[at(100.5, 50.5); 4], 5);
        let Drawing::Picture(drawing) = alike else { panic!("a picture") };
        assert_eq!(drawing.key.iter().map(|(side, ..)| *side).collect::<Vec<_>>(), [5.0, 10.0]);
    }

    #[test]
    fn maps_of_any_size_fit_the_page() {
        for (w, h) in [(1, 1), (2, 1), (3, 2), (64, 32), (1024, 512), (5000, 100)] {
            let display = Display::new(&EnvMap::new(Image::from_fn(w, h, |_, _| Rgb::ONE)), Look::default());
            let drawing = display.samples(&[], 5).natural();
            assert!(drawing.width >= 256.0 && drawing.width <= 2048.0, "{w}x{h}: {}", drawing.width);
        }
    }
}
