//! Heat maps: a grid of values as colours; their scales of equal steps to the eye, one from dark to light, one with a neutral
//! middle; the bar that shows which colour stands for which value, beside one map, or below several of the same scale.

use super::axis::{Axis, Span, Tick, Ticks};
use super::drawing::Drawing;
use super::frame::{self, Sides};
use super::page::{PIXELS, Page};
use super::rgb8::Rgb8;
use super::shapes::{Anchor, Colour, Level, Rect};
use super::{text, theme};

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shading {
    /// From dark to light, in equal steps of the value.
    Linear,
    /// From dark to light, in equal factors; values that are not positive have no colour.
    Log10,
    /// From blue through white at zero to red, equally far to both sides.
    Diverging,
}

/// A grid of values, row 0 at the top. What is not finite is shown in [`theme::NO_VALUE`], or as paper.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Heatmap {
    columns: usize,
    values: Vec<f64>,
    shading: Shading,
    pub(super) label: String,
    range: Option<(f64, f64)>,
    is_on_paper: bool,
}

impl Heatmap {
    /// A map of `values`, row by row from the top; `label` stands beside the colour bar. Cells that have no value, as in a last
    /// row that is not full, are not finite.
    pub fn new(columns: usize, values: Vec<f64>, shading: Shading, label: impl Into<String>) -> Self {
        Self { columns: columns.max(1), values, shading, label: label.into(), range: None, is_on_paper: false }
    }

    /// Spreads the colours over this range instead of that of the values; values outside take the colour of the nearest end.
    pub fn range(self, lo: f64, hi: f64) -> Self {
        Self { range: Some((lo, hi)), ..self }
    }

    /// Leaves blank what has no value.
    pub fn on_paper(self) -> Self {
        Self { is_on_paper: true, ..self }
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    pub fn rows(&self) -> usize {
        self.values.len().div_ceil(self.columns).max(1)
    }

    pub(super) fn axis(&self) -> Axis {
        let axis = if self.shading == Shading::Log10 { Axis::log("") } else { Axis::linear("") };
        match (self.range, self.shading) {
            (Some((lo, hi)), _) => axis.range(lo, hi),
            (None, Shading::Diverging) => {
                let largest = self.values.iter().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
                axis.range(-largest, largest)
            }
            (None, _) => axis,
        }
    }

    pub(super) fn span(&self) -> Span {
        self.axis().span(self.values.iter().copied(), 0.0)
    }

    /// Whether both maps show the same colours for the same values, so that one colour bar serves both.
    pub(super) fn has_scale_of(&self, other: &Self) -> bool {
        self.shading == other.shading && self.label == other.label && self.span() == other.span()
    }

    /// The colour at a position along the colour bar, from 0 to 1.
    pub(super) fn colour(&self, position: f64) -> [u8; 3] {
        let Colour { r, g, b, .. } = match self.shading {
            _ if position.is_nan() && self.is_on_paper => Colour::WHITE,
            _ if position.is_nan() => theme::NO_VALUE,
            Shading::Diverging => diverging(2.0 * position - 1.0),
            Shading::Linear | Shading::Log10 => sequential(position),
        };
        [r, g, b]
    }

    /// The map as an image, one pixel for each value.
    pub fn image(&self) -> Rgb8 {
        let span = self.span();
        let image = Rgb8::from_fn(self.columns, self.rows(), |x, y| {
            let value = self.values.get(y * self.columns + x).filter(|value| value.is_finite());
            self.colour(value.map_or(f64::NAN, |&value| span.position(value)))
        });
        if self.is_on_paper { image.on_paper() } else { image }
    }

    /// The colour bar alone, lying, `length` long where there is room (at least 60), with its ticks and its label below.
    pub fn bar(&self, length: f64) -> Drawing {
        Drawing::Bar(self.clone(), length)
    }

    /// The ticks of its colour bar: about as many as there is room for, and at least three numbers where round ones can be found.
    fn ticks(&self, room: usize, fits: impl Fn(&Ticks) -> bool) -> Ticks {
        /// More would be too many for the shortest bar.
        const MOST: usize = 6;
        let of = |most| self.axis().ticks(&self.span(), most);
        let enough = (room.max(3)..=MOST).map(of).find(|ticks| ticks.major.len() >= 3 && fits(ticks));
        enough.unwrap_or_else(|| of(room.max(2)))
    }

    pub(super) fn lying_bar(&self, length: f64, room: f64) -> Page {
        // Numbers do not touch
        let fits = |ticks: &Ticks, length: f64| {
            let width = |tick: &Tick| text::width(&tick.label, theme::TICK_SIZE, false);
            let gap = |pair: &[Tick]| (pair[1].at - pair[0].at) * length - 0.5 * (width(&pair[0]) + width(&pair[1]));
            ticks.major.windows(2).all(|pair| gap(pair) >= 4.0)
        };
        let ticks_of = |length: f64| self.ticks((length / 50.0) as usize, |ticks| fits(ticks, length));
        let ticks = ticks_of(length);
        // Numbers at the ends reach beyond the bar
        let reach = ticks.major.iter().map(|tick| 0.5 * text::width(&tick.label, theme::TICK_SIZE, false) + 4.0);
        let beside = reach.fold(if ticks.exponent == 0 { EDGE } else { FACTOR }, f64::max);
        let length = length.min(room - 2.0 * beside).max(60.0);
        let ticks = ticks_of(length);
        let label = text::wrapped(&self.label, theme::LABEL_SIZE, false, room - 2.0 * EDGE);
        let widest = label.iter().map(|line| text::width(line, theme::LABEL_SIZE, false)).fold(0.0, f64::max);
        let width = (length + 2.0 * beside).max(widest + 2.0 * EDGE).ceil();
        let bar = Rect::new(0.5 * (width - length), EDGE, length, WIDTH);
        let mut drawing = Page::new(width, 0.0, PIXELS);
        let colour = |x: usize, _| self.colour((x as f64 + 0.5) / STEPS as f64);
        drawing.image(bar, Rgb8::from_fn(STEPS, 8, colour));
        let bottom = frame::below_ticks(&ticks) + frame::title_height(&self.label);
        let room = Sides { bottom, ..Sides::default() };
        let first = label.first().map_or("", String::as_str);
        frame::draw_axes(&mut drawing, bar, room, [&ticks, &Ticks::default()], [first, ""]);
        let bottom = bottom + frame::further_lines(&mut drawing, &label, [bar.centre()[0], bar.bottom() + bottom]);
        let after = [bar.right() + 6.0, bar.centre()[1]];
        frame::draw_factor(&mut drawing, &ticks, after, (Anchor::Start, Level::Middle));
        drawing.height = (bar.bottom() + bottom + EDGE).ceil();
        drawing
    }
}

/// Sequential scale: `t` from 0 (dark purple) over teal to 1 (light yellow). Outside values take the nearest end, NaN
/// takes the dark one.
///
/// Both scales are straight lines of lightness in Oklab (Björn Ottosson, 2020), with hue and chroma as plain functions of the position,
/// chosen to stay inside sRGB.
pub fn sequential(t: f64) -> Colour {
    let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    let chroma = 0.085 + 0.04 * (1.0 - t).powi(3) + 0.09 * t.powi(4);
    oklch(0.25 + 0.67 * t, chroma, 310.0 - 205.0 * t)
}

/// Diverging scale: `t` from −1 (blue) over 0 (nearly white) to 1 (red), equally dark at both ends. Outside values take
/// the nearest end, NaN takes the middle.
pub fn diverging(t: f64) -> Colour {
    let t = if t.is_nan() { 0.0 } else { t.clamp(-1.0, 1.0) };
    oklch(0.96 - 0.5 * t.abs(), 0.15 * t.abs(), if t < 0.0 { 255.0 } else { 30.0 })
}

/// Oklab in polar form to sRGB; hue in degrees.
fn oklch(lightness: f64, chroma: f64, hue: f64) -> Colour {
    let byte = |v: f64| (encode(v) * 255.0).round() as u8;
    let [r, g, b] = linear_rgb(lightness, chroma, hue);
    Colour::rgb(byte(r), byte(g), byte(b))
}

fn linear_rgb(lightness: f64, chroma: f64, hue: f64) -> [f64; 3] {
    let (sin, cos) = hue.to_radians().sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    // Oklab to cone responses, their cubes to linear sRGB
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The sRGB transfer curve.
fn encode(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Width of the bar, and its distance from the frame.
const WIDTH: f64 = 13.0;
const GAP: f64 = 12.0;
const STEPS: usize = 256;

/// Draws the bar of `map` to the right of `frame`; returns the room needed outside the frame.
pub(super) fn bar_beside(drawing: &mut Page, map: &Heatmap, frame: &Rect) -> Sides {
    let bar = Rect::new(frame.right() + GAP, frame.y, WIDTH, frame.height);
    let colour = |_, y: usize| map.colour(1.0 - (y as f64 + 0.5) / STEPS as f64);
    drawing.image(bar, Rgb8::from_fn(8, STEPS, colour));
    let ticks = map.ticks(frame::most_rows(bar.height), |_| true);
    let right = frame::beside_ticks(&ticks) + frame::title_height(&map.label);
    let room = Sides { right, ..Sides::default() };
    frame::draw_axes(drawing, bar, room, [&Ticks::default(), &ticks], ["", &map.label]);
    let above = [bar.centre()[0], bar.y - frame::FACTOR_GAP];
    frame::draw_factor(drawing, &ticks, above, (Anchor::Middle, Level::Baseline));
    Sides { left: 0.0, right: GAP + WIDTH + right, top: frame::factor_height(&ticks), bottom: 0.0 }
}

/// Space around a bar that lies.
const EDGE: f64 = 10.0;
/// Width kept right of the bar for the factor that all its labels share.
const FACTOR: f64 = 50.0;

#[cfg(test)]
mod tests {
    use super::super::page::Item;
    use super::*;

    #[test]
    fn values_and_gaps_have_their_colours() {
        let map = Heatmap::new(2, vec![0.0, 1.0, f64::NAN, 0.5], Shading::Linear, "p");
        let image = map.image();
        let colours = [sequential(0.0), sequential(1.0), theme::NO_VALUE, sequential(0.5)];
        let bytes: Vec<u8> = colours.iter().flat_map(|c| [c.r, c.g, c.b]).collect();
        assert_eq!((image.width(), image.height(), image.pixels().as_raw()), (2, 2, &bytes));
    }

    #[test]
    fn a_diverging_map_is_neutral_at_zero() {
        let map = Heatmap::new(3, vec![-1.0, 0.0, 4.0], Shading::Diverging, "");
        let Colour { r, g, b, .. } = diverging(0.0);
        assert_eq!(map.colour(map.span().position(0.0)), [r, g, b]);
        assert_eq!((map.span().lo(), map.span().hi()), (-4.0, 4.0));
    }

    #[test]
    fn odd_grids_and_values_are_drawn_somehow() {
        for shading in [Shading::Linear, Shading::Log10, Shading::Diverging] {
            for values in [&[][..], &[0.0], &[-1.0], &[f64::NAN], &[f64::INFINITY, 1.0, 2.0], &[f64::MAX]] {
                let map = |columns| Heatmap::new(columns, values.into(), shading, "").image();
                assert_eq!(map(0), map(1));
                assert_eq!((map(2).width(), map(2).height()), (2, values.len().div_ceil(2).max(1)));
            }
        }
    }

    /// CIE lightness, 0 to 100.
    fn lightness(c: Colour) -> f64 {
        let linear = |v: u8| {
            let v = f64::from(v) / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        let y = 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
        116.0 * y.cbrt() - 16.0
    }

    #[test]
    fn lightness_follows_the_scale() {
        let steps: Vec<f64> = (0..=10).map(|i| f64::from(i) / 10.0).collect();
        for pair in steps.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|t| lightness(sequential(t)));
            assert!((5.0..11.0).contains(&(to - from)), "{pair:?}: {from} to {to}");
        }
        for t in steps {
            assert!((lightness(diverging(t)) - lightness(diverging(-t))).abs() < 5.0, "{t}");
        }
        assert!(lightness(diverging(0.0)) > 94.0);
    }

    #[test]
    fn both_scales_stay_inside_srgb() {
        for t in (0..=200).map(|i| f64::from(i) / 200.0) {
            let chroma = 0.085 + 0.04 * (1.0 - t).powi(3) + 0.09 * t.powi(4);
            let [dark, light] = [(0.25 + 0.67 * t, chroma, 310.0 - 205.0 * t), (0.96 - 0.5 * t, 0.15 * t, 255.0)];
            for (lightness, chroma, hue) in [dark, light, (light.0, light.1, 30.0)] {
                let colour = linear_rgb(lightness, chroma, hue);
                assert!(colour.iter().all(|v| (-1e-3..=1.001).contains(v)), "{t}: {colour:?}");
            }
        }
    }

    #[test]
    fn values_that_are_off_the_scale_take_an_end() {
        assert_eq!([-3.0, f64::NAN].map(sequential), [sequential(0.0); 2]);
        assert_eq!(sequential(f64::INFINITY), sequential(1.0));
        assert_eq!(diverging(f64::NEG_INFINITY), diverging(-1.0));
    }

    #[test]
    fn a_lying_bar_runs_from_the_least_value_to_the_largest() {
        let map = Heatmap::new(1, vec![-1.0, 4.0], Shading::Diverging, "relative error");
        let bar = map.lying_bar(300.0, f64::INFINITY);
        let image =
            bar.items.iter().find_map(|item| if let Item::Image { image, .. } = item { Some(image) } else { None });
        let image = image.unwrap();
        assert_eq!(image.pixel(0, 0), map.colour(0.5 / STEPS as f64));
        assert_eq!(image.pixel(STEPS - 1, 0), map.colour(1.0 - 0.5 / STEPS as f64));
        let labels: Vec<&str> = bar
            .items
            .iter()
            .filter_map(|i| if let Item::Text(t) = i { Some(t.markup.as_str()) } else { None })
            .collect();
        assert_eq!(labels, ["relative error", "−4", "−2", "0", "2", "4"]);
    }

    #[test]
    fn the_shortest_bar_has_three_numbers() {
        for (range, shading) in [
            ((-6.0, 6.0), Shading::Diverging),
            ((0.0, 2800.0), Shading::Linear),
            ((0.23, 1.0), Shading::Linear),
            ((0.013, 13.0), Shading::Log10),
        ] {
            let map = Heatmap::new(1, vec![1.0], shading, "").range(range.0, range.1);
            assert!(map.ticks(1, |_| true).major.len() >= 3, "{range:?}");
        }
    }
}
