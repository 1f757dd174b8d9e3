//! The plotters back end: converts what plotters draws on a fine integer grid to items of a drawing.
//!
//! plotters has integer coordinates. [`GRID`] of them make a drawing unit, so that curves are smooth and lines have any
//! width; lengths given to plotters (stroke widths, radii, font sizes) are multiplied alike.

use super::drawing::Drawing;
use super::shapes::{Anchor, Colour, Level, Paint, Point, Rect, Stroke, Text};
use super::text;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    FontTransform,
};
use std::convert::Infallible;

/// plotters' pixels per drawing unit: as fine as the two decimals that are written.
pub const GRID: f64 = 64.0;

/// A drawing that plotters can draw on; lines get the given dash pattern, which plotters does not have.
pub struct Canvas<'a> {
    drawing: &'a mut Drawing,
    dash: &'static [f64],
}

type Outcome = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Canvas<'a> {
    /// A back end that draws on `drawing` with dashes of this pattern.
    #[must_use]
    pub fn new(drawing: &'a mut Drawing, dash: &'static [f64]) -> Self {
        Self { drawing, dash }
    }

    fn stroke(&self, style: &impl BackendStyle) -> Stroke {
        Stroke { colour: colour(style.color()), width: f64::from(style.stroke_width()) / GRID, dash: self.dash }
    }

    fn paint(&self, style: &impl BackendStyle, fill: bool) -> Paint {
        if fill { colour(style.color()).into() } else { self.stroke(style).into() }
    }
}

fn colour(BackendColor { alpha, rgb: (r, g, b) }: BackendColor) -> Colour {
    Colour::rgb(r, g, b).faded(alpha)
}

fn point((x, y): BackendCoord) -> Point {
    [f64::from(x) / GRID, f64::from(y) / GRID]
}

fn rect(a: BackendCoord, b: BackendCoord) -> Rect {
    let ([ax, ay], [bx, by]) = (point(a), point(b));
    Rect::new(ax.min(bx), ay.min(by), (ax - bx).abs(), (ay - by).abs())
}

/// Font size in drawing units, and whether the style asks for bold.
fn font(style: &impl BackendTextStyle) -> (f64, bool) {
    (style.size() / GRID, matches!(style.style(), FontStyle::Bold))
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        ((self.drawing.width() * GRID).ceil() as u32, (self.drawing.height() * GRID).ceil() as u32)
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, of: BackendColor) -> Outcome {
        self.drawing.rect(rect(at, (at.0 + 1, at.1 + 1)), colour(of));
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Outcome {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S, fill: bool) -> Outcome {
        let paint = self.paint(style, fill);
        self.drawing.rect(rect(a, b), paint);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        let stroke = self.stroke(style);
        self.drawing.line(path.into_iter().map(point).collect::<Vec<_>>(), stroke);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, at: BackendCoord, radius: u32, style: &S, fill: bool) -> Outcome {
        let paint = self.paint(style, fill);
        self.drawing.circle(point(at), f64::from(radius) / GRID, paint);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        self.drawing.polygon(path.into_iter().map(point).collect::<Vec<_>>(), colour(style.color()));
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, markup: &str, style: &S, at: BackendCoord) -> Outcome {
        let anchor = match style.anchor().h_pos {
            HPos::Left => Anchor::Start,
            HPos::Center => Anchor::Middle,
            HPos::Right => Anchor::End,
        };
        let level = match style.anchor().v_pos {
            VPos::Top => Level::Top,
            VPos::Center => Level::Middle,
            VPos::Bottom => Level::Baseline,
        };
        let (size, bold) = font(style);
        // A drawing has upright text and text that runs upwards; plotters uses no other.
        let upwards = !matches!(style.transform(), FontTransform::None);
        let text = Text::new(point(at), size, markup).held(anchor, level).coloured(colour(style.color()));
        self.drawing.text(Text { bold, upwards, ..text });
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        markup: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let (size, bold) = font(style);
        let height = size * (text::CAP_HEIGHT + text::DESCENT);
        Ok(((text::width(markup, size, bold) * GRID).ceil() as u32, (height * GRID).ceil() as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::*;
    use plotters::prelude::{Circle, IntoDrawingArea, IntoFont, PathElement, RGBColor, ShapeStyle, TextStyle};

    #[test]
    fn what_plotters_draws_arrives_in_drawing_units() {
        let mut drawing = Drawing::new(100.0, 50.0, 1.0);
        {
            let area = Canvas::new(&mut drawing, &[4.0, 2.0]).into_drawing_area();
            assert_eq!(area.dim_in_pixel(), (6400, 3200));
            let style = ShapeStyle { color: RGBColor(1, 2, 3).into(), filled: false, stroke_width: 96 };
            area.draw(&PathElement::new([(64, 128), (640, 1280)], style)).unwrap();
            let style = ShapeStyle { color: RGBColor(9, 9, 9).into(), filled: true, stroke_width: 0 };
            area.draw(&Circle::new((32, 64), 128, style)).unwrap();
            let font = TextStyle::from(("sans-serif", 640.0).into_font());
            area.draw(&plotters::element::Text::new("θ_{B}", (640, 640), font)).unwrap();
        }
        let stroke = Stroke { colour: Colour::rgb(1, 2, 3), width: 1.5, dash: &[4.0, 2.0] };
        let line = Item::Path { points: vec![[1.0, 2.0], [10.0, 20.0]], closed: false, paint: stroke.into() };
        assert_eq!(drawing.items()[0], line);
        let dot = Item::Circle { centre: [0.5, 1.0], radius: 2.0, paint: Colour::rgb(9, 9, 9).into() };
        assert_eq!(drawing.items()[1], dot);
        let text = Text::new([10.0, 10.0], 10.0, "θ_{B}").held(Anchor::Start, Level::Top);
        assert_eq!(drawing.items()[2], Item::Text(text));
    }
}
