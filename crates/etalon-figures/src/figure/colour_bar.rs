//! The bar that shows which colour stands for which value: beside one heat map, or below several of the same scale.

use super::drawing::Drawing;
use super::frame::{self, Sides};
use super::heatmap::Heatmap;
use super::rgb8::Rgb8;
use super::shapes::{Anchor, Level, Rect};
use super::text;
use super::theme;
use super::ticks::Ticks;

/// Width of the bar, and its distance from the frame.
const WIDTH: f64 = 13.0;
const GAP: f64 = 12.0;
const STEPS: usize = 256;

/// Draws the bar of `map` to the right of `frame`; returns the room needed outside the frame.
pub(super) fn beside(drawing: &mut Drawing, map: &Heatmap, frame: &Rect) -> Sides {
    let bar = Rect::new(frame.right() + GAP, frame.y, WIDTH, frame.height);
    let colour = |_, y: usize| map.colour(1.0 - (y as f64 + 0.5) / STEPS as f64);
    drawing.image(bar, Rgb8::from_fn(8, STEPS, colour));
    let ticks = map.axis().ticks(&map.span(), frame::most_rows(bar.height));
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

impl Heatmap {
    /// The colour bar alone, lying, `length` long (at least 60), with its ticks and its label below.
    pub fn bar(&self, length: f64) -> Drawing {
        let length = length.max(60.0);
        let label = text::width(&self.label, theme::LABEL_SIZE, false);
        let width = (length + 2.0 * FACTOR).max(label + 2.0 * EDGE).ceil();
        let bar = Rect::new(0.5 * (width - length), EDGE, length, WIDTH);
        let mut drawing = Drawing::new(width, 0.0, 2.0);
        let colour = |x: usize, _| self.colour((x as f64 + 0.5) / STEPS as f64);
        drawing.image(bar, Rgb8::from_fn(STEPS, 8, colour));
        let ticks = self.axis().ticks(&self.span(), (length / 50.0) as usize);
        let bottom = frame::below_ticks(&ticks) + frame::title_height(&self.label);
        let room = Sides { bottom, ..Sides::default() };
        frame::draw_axes(&mut drawing, bar, room, [&ticks, &Ticks::default()], [&self.label, ""]);
        let after = [bar.right() + 6.0, bar.centre()[1]];
        frame::draw_factor(&mut drawing, &ticks, after, (Anchor::Start, Level::Middle));
        drawing.height = (bar.bottom() + bottom + EDGE).ceil();
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::super::heatmap::Shading;
    use super::*;

    #[test]
    fn a_lying_bar_runs_from_the_least_value_to_the_largest() {
        let map = Heatmap::new(1, vec![-1.0, 4.0], Shading::Diverging, "relative error");
        let bar = map.bar(300.0);
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
}
