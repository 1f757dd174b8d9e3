//! Environment maps with markers of samples and of regions.

use crate::envmap::EnvMap;
use crate::figure::{Colour, Drawing, Rect, Rgb8, Stroke, theme};
use crate::math::Rgb;
use crate::raster::{Image, ToneMap, auto_exposure, to_rgb8};
use crate::study::{map_samples, median_cut};

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

    fn black(&self) -> Drawing {
        Drawing::over(Rgb8::from_fn(self.base.width(), self.base.height(), |_, _| [0; 3]))
    }

    /// A square marker of `side` texels around texel (x, y): wrapped at the seam, clipped at the poles.
    fn marker(&self, drawing: &mut Drawing, (x, y): (f64, f64), side: usize, colour: Colour) {
        // Rows are clipped at the poles, columns wrap around the seam in two parts
        let half = (side / 2) as i64;
        let (x, y) = (x as i64, (y as i64).min(self.height as i64 - 1));
        let y0 = (y - half).max(0);
        let y1 = (y - half + side as i64).min(self.height as i64);
        let width = self.width as i64;
        let span = (side as i64).min(width);
        let x0 = (x - half).rem_euclid(width);
        let first = span.min(width - x0);
        for (from, length) in [(x0, first), (0, span - first)] {
            if length > 0 && y1 > y0 {
                let s = self.scale;
                let rect = Rect::new(from as f64 * s, y0 as f64 * s, length as f64 * s, (y1 - y0) as f64 * s);
                drawing.rect(rect, colour);
            }
        }
    }

    /// The map with a blue marker at each sample.
    pub fn samples(&self, rows: &[map_samples::SampleRow], side: usize) -> Drawing {
        let mut drawing = Drawing::over(self.base.clone());
        for r in rows {
            self.marker(&mut drawing, (r.x, r.y), side, theme::MARKER);
        }
        drawing
    }

    /// Black but for a marker at each sample, in the colour of its radiance; exposed for the samples, which are far brighter
    /// than the average of the map.
    pub fn samples_only(&self, rows: &[map_samples::SampleRow], side: usize) -> Drawing {
        let mut drawing = self.black();
        if rows.is_empty() {
            return drawing;
        }
        let colours = rows.iter().map(|r| Rgb::new(r.r, r.g, r.b)).collect();
        let strip = Image::from_pixels(rows.len(), 1, colours);
        // The brightest lights may clip; the colours of the other markers matter more.
        let bytes = to_rgb8(&strip, &self.look.tone(|| auto_exposure(&strip) + 2.5));
        for (r, rgb) in rows.iter().zip(bytes.chunks_exact(3)) {
            self.marker(&mut drawing, (r.x, r.y), side, Colour::rgb(rgb[0], rgb[1], rgb[2]));
        }
        drawing
    }

    /// The map with white lines between the regions and a blue dot at each centroid.
    pub fn partition(&self, rows: &[median_cut::RegionRow]) -> Drawing {
        let s = self.scale;
        let mut drawing = Drawing::over(self.base.clone());
        let line = Stroke::solid(theme::BORDER, 1.0);
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
        for r in rows {
            let centre = [r.centroid_x * s, r.centroid_y * s];
            drawing.circle(centre, 4.5, theme::BORDER);
            drawing.circle(centre, 3.5, theme::MARKER);
        }
        drawing
    }

    /// Black but for a marker at each centroid, in the colour of the region's total flux. The brightest light is
    /// shown at full scale, the others in proportion before the power law of 1/2.2.
    pub fn lights(&self, rows: &[median_cut::RegionRow], side: usize) -> Drawing {
        let brightest = rows.iter().map(|r| r.flux_r.max(r.flux_g).max(r.flux_b)).fold(0.0, f64::max);
        let byte = |v: f64| if brightest > 0.0 { (255.0 * (v / brightest).powf(1.0 / 2.2)).round() as u8 } else { 0 };
        let mut drawing = self.black();
        for r in rows {
            let colour = Colour::rgb(byte(r.flux_r), byte(r.flux_g), byte(r.flux_b));
            self.marker(&mut drawing, (r.centroid_x, r.centroid_y), side, colour);
        }
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Item;

    fn rects(drawing: &Drawing) -> Vec<Rect> {
        let rect = |item: &Item| if let Item::Rect { rect, .. } = item { Some(*rect) } else { None };
        drawing.items.iter().filter_map(rect).collect()
    }

    #[test]
    fn markers_wrap_at_the_seam_and_stop_at_the_poles() {
        let map = EnvMap::new(Image::from_fn(1024, 512, |_, _| Rgb::ONE));
        let display = Display::new(&map, Look::default());
        let at = |x: f64, y: f64, side: usize| {
            let mut drawing = display.black();
            display.marker(&mut drawing, (x, y), side, theme::MARKER);
            rects(&drawing)
        };
        assert_eq!(at(100.5, 50.5, 5), [Rect::new(98.0, 48.0, 5.0, 5.0)]);
        assert_eq!(at(0.5, 50.5, 5), [Rect::new(1022.0, 48.0, 2.0, 5.0), Rect::new(0.0, 48.0, 3.0, 5.0)]);
        assert_eq!(at(1023.5, 0.5, 5), [Rect::new(1021.0, 0.0, 3.0, 3.0), Rect::new(0.0, 0.0, 2.0, 3.0)]);
        assert_eq!(at(10.5, 511.9, 5), [Rect::new(8.0, 509.0, 5.0, 3.0)]);
        assert_eq!(at(10.5, 10.5, 5000), [Rect::new(582.0, 0.0, 442.0, 512.0), Rect::new(0.0, 0.0, 582.0, 512.0)]);
    }

    #[test]
    fn maps_of_any_size_fit_the_page() {
        for (w, h) in [(1, 1), (2, 1), (3, 2), (64, 32), (1024, 512), (5000, 100)] {
            let display = Display::new(&EnvMap::new(Image::from_fn(w, h, |_, _| Rgb::ONE)), Look::default());
            let drawing = display.samples(&[], 5);
            assert!(drawing.width >= 256.0 && drawing.width <= 2048.0, "{w}x{h}: {}", drawing.width);
        }
    }
}
