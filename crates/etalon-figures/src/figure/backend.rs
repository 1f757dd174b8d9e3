//! The plotters back end: converts what plotters draws on a fine integer grid to items of a drawing.
//!
//! plotters has integer coordinates. [`GRID`] of them make a drawing unit, so that curves are smooth and lines have any
//! width; lengths given to plotters (stroke widths, radii) are multiplied alike. It draws lines, dots and areas; text and
//! frames are drawn without it.

use super::drawing::Drawing;
use super::shapes::{Colour, Paint, Point, Rect, Stroke};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingBackend, DrawingErrorKind};
use std::convert::Infallible;

/// plotters' pixels per drawing unit: as fine as the two decimals that are written.
pub const GRID: f64 = 64.0;

/// A drawing that plotters can draw on; lines get the given dash pattern, which plotters does not have.
pub struct Canvas<'a> {
    pub drawing: &'a mut Drawing,
    pub dash: &'static [f64],
}

type Outcome = Result<(), DrawingErrorKind<Infallible>>;

impl Canvas<'_> {
    fn stroke(&self, style: &impl BackendStyle) -> Stroke {
        Stroke { colour: colour(style.color()), width: f64::from(style.stroke_width()) / GRID, dash: self.dash }
    }
}

fn colour(BackendColor { alpha, rgb: (r, g, b) }: BackendColor) -> Colour {
    Colour::rgb(r, g, b).faded(alpha)
}

fn point((x, y): BackendCoord) -> Point {
    [f64::from(x) / GRID, f64::from(y) / GRID]
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        ((self.drawing.width * GRID).ceil() as u32, (self.drawing.height * GRID).ceil() as u32)
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, of: BackendColor) -> Outcome {
        let [x, y] = point(at);
        self.drawing.rect(Rect::new(x, y, 1.0 / GRID, 1.0 / GRID), colour(of));
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        let stroke = self.stroke(style);
        self.drawing.line(path.into_iter().map(point).collect::<Vec<_>>(), stroke);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, at: BackendCoord, radius: u32, style: &S, fill: bool) -> Outcome {
        let paint: Paint = if fill { colour(style.color()).into() } else { self.stroke(style).into() };
        self.drawing.circle(point(at), f64::from(radius) / GRID, paint);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        self.drawing.polygon(path.into_iter().map(point).collect::<Vec<_>>(), colour(style.color()));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::*;
    use plotters::prelude::{Circle, IntoDrawingArea, PathElement, RGBColor, ShapeStyle};

    #[test]
    fn what_plotters_draws_arrives_in_drawing_units() {
        let mut drawing = Drawing::new(100.0, 50.0, 1.0);
        let area = Canvas { drawing: &mut drawing, dash: &[4.0, 2.0] }.into_drawing_area();
        assert_eq!(area.dim_in_pixel(), (6400, 3200));
        let style = ShapeStyle { color: RGBColor(1, 2, 3).into(), filled: false, stroke_width: 96 };
        area.draw(&PathElement::new([(64, 128), (640, 1280)], style)).unwrap();
        let style = ShapeStyle { color: RGBColor(9, 9, 9).into(), filled: true, stroke_width: 0 };
        area.draw(&Circle::new((32, 64), 128, style)).unwrap();
        drop(area);
        let stroke = Stroke { colour: Colour::rgb(1, 2, 3), width: 1.5, dash: &[4.0, 2.0] };
        let line = Item::Path { points: vec![[1.0, 2.0], [10.0, 20.0]], closed: false, paint: stroke.into() };
        let dot = Item::Circle { centre: [0.5, 1.0], radius: 2.0, paint: Colour::rgb(9, 9, 9).into() };
        assert_eq!(drawing.items, [line, dot]);
    }
}
