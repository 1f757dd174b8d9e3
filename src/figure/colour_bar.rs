//! The bar beside a heat map that shows which colour stands for which value.

use super::drawing::Drawing;
use super::frame::{self, Side, Sides};
use super::heatmap::Heatmap;
use super::rgb8::Rgb8;
use super::shapes::{Anchor, Level, Paint, Rect, Stroke, Text};
use super::theme;

/// Width of the bar, and its distance from the frame.
const WIDTH: f64 = 13.0;
const GAP: f64 = 12.0;
const STEPS: usize = 256;

/// Draws the bar of `map` to the right of `frame`; returns the room needed outside the frame.
pub(super) fn draw(drawing: &mut Drawing, map: &Heatmap, frame: &Rect) -> Sides {
    let bar = Rect::new(frame.right() + GAP, frame.y, WIDTH, frame.height);
    let colour = |_, y: usize| map.colour(1.0 - (y as f64 + 0.5) / STEPS as f64);
    drawing.image(bar, Rgb8::from_fn(8, STEPS, colour));
    drawing.rect(bar, Paint::from(Stroke::solid(theme::INK, theme::THIN)));
    let span = map.span();
    let ticks = map.axis().ticks(&span, frame::most_rows(bar.height));
    let mut right = GAP + WIDTH + frame::ticks_along(drawing, &bar, Side::Right, &span, &ticks);
    frame::bar_factor(drawing, &bar, &ticks);
    if !map.label.is_empty() {
        let at = [frame.right() + right + 8.0 + theme::LABEL_SIZE * 0.8, frame.centre()[1]];
        let text = Text::new(at, theme::LABEL_SIZE, map.label.clone()).held(Anchor::Middle, Level::Baseline);
        drawing.text(text.upwards());
        right += 12.0 + theme::LABEL_SIZE;
    }
    Sides { left: 0.0, right, top: frame::factor_height(&ticks), bottom: 0.0 }
}
