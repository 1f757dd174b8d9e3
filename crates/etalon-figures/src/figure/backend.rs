//! The plotters back end: converts what plotters draws on a fine integer grid to items of a drawing.
//!
//! plotters has integer coordinates. [`GRID`] of them make a drawing unit, so that curves are smooth and lines have any
//! width; lengths given to plotters (stroke widths, radii, font sizes) are multiplied alike. Text may carry the markup of
//! [`super::text`].

use super::axis::Ticks;
use super::frame::Sides;
use super::page::Page;
use super::shapes::{Anchor, Colour, Level, Paint, Point, Rect, Stroke, Text};
use super::text;
use plotters::coord::ranged1d::{KeyPointHint, KeyPointWeight, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::{Cartesian2d, ChartBuilder, ChartContext, IntoDrawingArea};
use plotters::style::{RGBAColor, ShapeStyle};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontTransform,
};
use std::convert::Infallible;
use std::ops::Range;

/// plotters' pixels per drawing unit: as fine as the two decimals that are written.
pub const GRID: f64 = 64.0;

/// Why plotters' result can be unwrapped.
pub const NEVER: &str = "drawing into memory cannot fail";

/// A frame in a drawing on which plotters draws a chart, with room for labels beside it. Lines get the given dash pattern,
/// which plotters does not have.
pub struct Canvas<'a> {
    pub drawing: &'a mut Page,
    pub frame: Rect,
    pub room: Sides,
    pub dash: &'static [f64],
}

/// A chart of plotters, whose coordinates are positions along its axes.
pub type PlottersChart<'a> = ChartContext<'a, Canvas<'a>, Cartesian2d<&'a Ticks, &'a Ticks>>;

type Outcome<T = ()> = Result<T, DrawingErrorKind<Infallible>>;

impl<'a> Canvas<'a> {
    /// A chart with its plotting area in the frame, and areas for labels where there is room.
    pub fn chart(self, x: &'a Ticks, y: &'a Ticks) -> PlottersChart<'a> {
        let [left, right, bottom] = [self.room.left, self.room.right, self.room.bottom].map(pixels);
        let area = self.into_drawing_area();
        let mut builder = ChartBuilder::on(&area);
        builder.y_label_area_size(left).right_y_label_area_size(right).x_label_area_size(bottom);
        builder.build_cartesian_2d(x, y).expect(NEVER)
    }

    fn stroke(&self, style: &impl BackendStyle) -> Stroke {
        Stroke { colour: colour(style.color()), width: f64::from(style.stroke_width()) / GRID, dash: self.dash }
    }

    fn point(&self, (x, y): BackendCoord) -> Point {
        [self.frame.x + f64::from(x - pixels(self.room.left)) / GRID, self.frame.y + f64::from(y) / GRID]
    }
}

/// A length in plotters' pixels.
pub fn pixels(length: f64) -> i32 {
    (length * GRID).round() as i32
}

/// How plotters draws a shape; `width` is that of its outline, in drawing units.
pub fn style(Colour { r, g, b, alpha }: Colour, filled: bool, width: f64) -> ShapeStyle {
    let color = RGBAColor(r, g, b, f64::from(alpha) / 255.0);
    ShapeStyle { color, filled, stroke_width: pixels(width).unsigned_abs() }
}

fn colour(BackendColor { alpha, rgb: (r, g, b) }: BackendColor) -> Colour {
    Colour::rgb(r, g, b).faded(alpha)
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        // One more pixel, which plotters leaves out: axes end where the frame ends
        let sum = |lengths: [f64; 3]| lengths.map(pixels).iter().sum::<i32>().unsigned_abs() + 1;
        let Self { frame, room, .. } = self;
        (sum([room.left, frame.width, room.right]), sum([0.0, frame.height, room.bottom]))
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, of: BackendColor) -> Outcome {
        let [x, y] = self.point(at);
        self.drawing.rect(Rect::new(x, y, 1.0 / GRID, 1.0 / GRID), colour(of));
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        if style.color().alpha > 0.0 {
            let points: Vec<Point> = path.into_iter().map(|p| self.point(p)).collect();
            self.drawing.line(points, self.stroke(style));
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Outcome {
        self.draw_path([from, to], style)
    }

    fn draw_circle<S: BackendStyle>(&mut self, at: BackendCoord, radius: u32, style: &S, fill: bool) -> Outcome {
        let paint: Paint = if fill { colour(style.color()).into() } else { self.stroke(style).into() };
        self.drawing.circle(self.point(at), f64::from(radius) / GRID, paint);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        let points: Vec<Point> = path.into_iter().map(|p| self.point(p)).collect();
        self.drawing.polygon(points, colour(style.color()));
        Ok(())
    }

    /// Titles of y axes run upwards on both sides, and start at the frame's foot where they are longer than it.
    fn draw_text<S: BackendTextStyle>(&mut self, markup: &str, style: &S, at: BackendCoord) -> Outcome {
        let (Pos { h_pos, v_pos }, turn) = (style.anchor(), style.transform());
        let anchor = match h_pos {
            HPos::Left => Anchor::Start,
            HPos::Center => Anchor::Middle,
            HPos::Right => Anchor::End,
        };
        let level = match (v_pos, &turn) {
            (VPos::Center, _) => Level::Middle,
            (VPos::Bottom, _) | (_, FontTransform::Rotate90) => Level::Bottom,
            (VPos::Top, _) => Level::Top,
        };
        let text = Text::new(self.point(at), style.size() / GRID, markup).held(anchor, level);
        let mut text = text.coloured(colour(style.color()));
        if !matches!(turn, FontTransform::None) {
            text.at[1] = text.at[1].min(self.frame.bottom() - text.width() / 2.0);
            text = text.upwards();
        }
        if !markup.is_empty() {
            self.drawing.text(text);
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(&self, markup: &str, style: &S) -> Outcome<(u32, u32)> {
        Ok((text::width(markup, style.size(), false) as u32, style.size() as u32))
    }
}

/// Positions along an axis, from 0 at its start to 1 at its end: lines are clipped there, before plotters has them.
impl Ranged for &Ticks {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, position: &f64, (from, to): (i32, i32)) -> i32 {
        from + (f64::from(to - from) * position).round() as i32
    }

    /// Only labelled ticks have lines of the grid.
    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        match hint.weight() {
            KeyPointWeight::Bold => self.major.iter().map(|tick| tick.at).collect(),
            KeyPointWeight::Any => Vec::new(),
        }
    }

    fn range(&self) -> Range<f64> {
        0.0..1.0
    }
}

impl ValueFormatter<f64> for &Ticks {
    fn format_ext(&self, position: &f64) -> String {
        self.major.iter().find(|tick| tick.at == *position).map_or_else(String::new, |tick| tick.label.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::super::axis::Tick;
    use super::super::page::Item;
    use super::*;
    use plotters::prelude::{Circle, IntoFont, PathElement};

    #[test]
    fn what_plotters_draws_arrives_in_drawing_units() {
        let ticks = Ticks { major: vec![Tick { at: 0.25, label: "10^{−3}".into() }], ..Ticks::default() };
        let mut drawing = Page::new(0.0, 0.0, 1.0);
        let frame = Rect::new(10.0, 20.0, 100.0, 50.0);
        let room = Sides { left: 30.0, bottom: 15.0, ..Sides::default() };
        let mut chart = Canvas { drawing: &mut drawing, frame, room, dash: &[4.0, 2.0] }.chart(&ticks, &ticks);
        let ink = style(Colour::rgb(1, 2, 3), true, 1.5);
        chart.draw_series([PathElement::new([(0.0, 0.0), (1.0, 0.5)], ink)]).unwrap();
        chart.draw_series([Circle::new((0.5, 1.0), pixels(2.0), ink)]).unwrap();
        let mut mesh = chart.configure_mesh();
        mesh.bold_line_style(ink).axis_style(plotters::style::TRANSPARENT).set_all_tick_mark_size(pixels(4.0));
        mesh.label_style(("", pixels(10.0)).into_font()).x_desc("/{θ}").y_desc("longer than the frame").draw().unwrap();
        drop(chart);

        let path = |points: [Point; 2]| {
            let stroke = Stroke { colour: Colour::rgb(1, 2, 3), width: 1.5, dash: &[4.0, 2.0] };
            Item::Path { points: points.into(), closed: false, paint: stroke.into() }
        };
        // Areas for labels begin a pixel beside the frame
        let (pixel, half) = (1.0 / GRID, text::width("longer than the frame", 10.0, false) / 2.0);
        let text = |x: f64, y: f64, markup: &str, anchor, level| {
            Text::new([x, y], 10.0, markup).held(anchor, level).coloured(Colour::BLACK)
        };
        let expected = [
            path([[10.0, 70.0], [110.0, 45.0]]),
            Item::Circle { centre: [60.0, 20.0], radius: 2.0, paint: Colour::rgb(1, 2, 3).into() },
            Item::Text(text(-20.0, 70.0 - half, "longer than the frame", Anchor::Middle, Level::Top).upwards()),
            Item::Text(text(60.0, 85.0 + pixel, "/{θ}", Anchor::Middle, Level::Bottom)),
            path([[35.0, 70.0], [35.0, 20.0]]),
            path([[10.0, 57.5], [110.0, 57.5]]),
            Item::Text(text(2.0, 57.5, "10^{−3}", Anchor::End, Level::Middle)),
            Item::Text(text(35.0, 78.0 + pixel, "10^{−3}", Anchor::Middle, Level::Top)),
        ];
        assert_eq!(drawing.items, expected);
    }
}
