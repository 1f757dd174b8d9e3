//! The marks of a panel, clipped to the frame and drawn by plotters; the cells that they cover are marked as occupied.

use super::backend::{NEVER, pixels, style};
use super::chart::{CLEAR, Sketch};
use super::clip;
use super::panel::Mark;
use super::shapes::{Colour, Marker, Point, Rect, Stroke};
use super::theme;
use plotters::prelude::{Circle, EmptyElement, PathElement, Polygon};

const OUTLINE: f64 = 1.2;

/// What is drawn at once, from the lowest to the topmost.
#[derive(Clone, Copy)]
enum Layer {
    Areas,
    Rules,
    Curves,
    Dots,
    Above,
}

impl Sketch<'_> {
    /// Draws areas, then reference lines, then curves and the outlines of bars, then dots, then lines above all.
    pub fn marks(&mut self, marks: &[Mark]) {
        for layer in [Layer::Areas, Layer::Rules, Layer::Curves, Layer::Dots, Layer::Above] {
            for mark in marks {
                match (layer, mark) {
                    (Layer::Areas, Mark::Band { colour, points, .. }) => self.band(*colour, points),
                    (Layer::Areas, Mark::Shade { from, to, colour }) => {
                        let [left, right] = [*from, *to].map(|x| self.axes.x.position(x));
                        self.fill(vec![[left, 0.0], [right, 0.0], [right, 1.0], [left, 1.0]], colour.faded(0.12));
                    }
                    (Layer::Areas, Mark::Bars { colour, edges, heights, .. }) => {
                        let outlines = self.outlines(edges, heights);
                        outlines.into_iter().for_each(|outline| self.fill(outline, colour.faded(0.3)));
                    }
                    (Layer::Rules, Mark::Vertical { at, above: None, .. }) => self.vertical(*at, theme::RULE),
                    (Layer::Above, Mark::Vertical { at, above: Some(stroke), .. }) => self.vertical(*at, *stroke),
                    (Layer::Rules, Mark::Horizontal { at, .. }) => {
                        let y = self.axes.y.position(*at);
                        self.curve(&[[0.0, y], [1.0, y]], theme::RULE);
                    }
                    (Layer::Curves, Mark::Line { stroke, points, .. }) => {
                        let positions: Vec<Point> = points.iter().map(|&p| self.position(p)).collect();
                        self.curve(&positions, *stroke);
                    }
                    (Layer::Curves, Mark::Bars { colour, edges, heights, .. }) => {
                        let outlines = self.outlines(edges, heights);
                        outlines.iter().for_each(|outline| self.curve(outline, Stroke::solid(*colour, OUTLINE)));
                    }
                    (Layer::Dots, Mark::Dots { colour, marker, points, .. }) => self.dots(*colour, *marker, points),
                    _ => {}
                }
            }
        }
    }

    fn vertical(&mut self, at: f64, stroke: Stroke) {
        let x = self.axes.x.position(at);
        self.curve(&[[x, 0.0], [x, 1.0]], stroke);
    }

    /// The parts of a line within the frame.
    fn curve(&mut self, positions: &[Point], stroke: Stroke) {
        for part in clip::line(positions) {
            let places: Vec<Point> = part.iter().map(|&p| self.place(p)).collect();
            self.space.add_line(&places, stroke.width + 2.0 * CLEAR);
            let path: Vec<(f64, f64)> = part.into_iter().map(Into::into).collect();
            let path = PathElement::new(path, style(stroke.colour, false, stroke.width));
            self.axes.chart(&mut self.drawing, stroke.dash).draw_series([path]).expect(NEVER);
        }
    }

    /// The part of an area within the frame.
    fn fill(&mut self, positions: Vec<Point>, colour: Colour) {
        let path: Vec<(f64, f64)> = clip::polygon(positions).into_iter().map(Into::into).collect();
        if !path.is_empty() {
            let area = Polygon::new(path, style(colour, true, 0.0));
            self.axes.chart(&mut self.drawing, theme::SOLID).draw_series([area]).expect(NEVER);
        }
    }

    /// Markers whose centre lies within the frame.
    fn dots(&mut self, colour: Colour, marker: Marker, points: &[Point]) {
        let mut positions: Vec<Point> = points.iter().map(|&p| self.position(p)).collect();
        // Also drops NaN.
        positions.retain(|p| p.iter().all(|v| (0.0..=1.0).contains(v)));
        for &position in &positions {
            let [x, y] = self.place(position);
            self.space.add(&Rect::new(x, y, 0.0, 0.0).grown(theme::DOT + CLEAR));
        }
        let style = style(colour, marker != Marker::Open, OUTLINE);
        let corners: Vec<(i32, i32)> = marker.corners(theme::DOT).iter().map(|c| c.map(pixels).into()).collect();
        let mut chart = self.axes.chart(&mut self.drawing, theme::SOLID);
        let centres = positions.into_iter().map(|p| EmptyElement::at(<(f64, f64)>::from(p)));
        let drawn = if corners.is_empty() {
            chart.draw_series(centres.map(|at| at + Circle::new((0, 0), pixels(theme::DOT), style)))
        } else {
            chart.draw_series(centres.map(|at| at + Polygon::new(corners.clone(), style)))
        };
        drawn.expect(NEVER);
    }

    fn band(&mut self, colour: Colour, points: &[[f64; 3]]) {
        // A bound that is off a logarithmic scale lies below the frame.
        let low = |v: f64| if v.is_nan() { -1.0 } else { v };
        let positions: Vec<[f64; 3]> = points
            .iter()
            .map(|&[x, lower, upper]| {
                let ([x, lower_at], [_, upper_at]) = (self.position([x, lower]), self.position([x, upper]));
                if lower.is_finite() { [x, low(lower_at), upper_at] } else { [x, f64::NAN, upper_at] }
            })
            .collect();
        // Fill each run of finite points between upper and lower bound; mark its cells as occupied, column by column
        for run in positions.split(|p| !p.iter().all(|v| v.is_finite())).filter(|run| run.len() > 1) {
            let outline = run.iter().map(|p| [p[0], p[2]]).chain(run.iter().rev().map(|p| [p[0], p[1]])).collect();
            self.fill(outline, colour.faded(0.2));
            for pair in run.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let columns =
                    ((b[0] - a[0]).abs() * self.axes.frame.width).ceil().clamp(1.0, self.axes.frame.width) as usize;
                for i in 0..=columns {
                    let t = i as f64 / columns as f64;
                    let [x, lower, upper] = [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t);
                    self.take([x, lower], [x, upper]);
                }
            }
        }
    }

    /// The outlines of bars that stand side by side, from the foot of the first to that of the last.
    fn outlines(&mut self, edges: &[f64], heights: &[f64]) -> Vec<Vec<Point>> {
        // On a logarithmic scale bars stand on the frame. Positions far outside are clamped.
        let low = |v: f64| if v.is_nan() { -1.0 } else { v.clamp(-1e6, 1e6) };
        let floor = low(self.axes.y.position(0.0));
        let mut outlines: Vec<Vec<Point>> = Vec::new();
        let mut outline: Vec<Point> = Vec::new();
        for (edge, &height) in edges.windows(2).zip(heights) {
            let ([left, top], [right, _]) = (self.position([edge[0], height]), self.position([edge[1], height]));
            if !(height.is_finite() && left.is_finite() && right.is_finite()) {
                outlines.push(std::mem::take(&mut outline));
                continue;
            }
            // The next bar goes on from the top of the one before.
            if outline.pop().is_none() {
                outline.push([left, floor]);
            }
            outline.extend([[left, low(top)], [right, low(top)], [right, floor]]);
            self.take([left, floor], [right, low(top)]);
        }
        outlines.push(outline);
        outlines
    }

    /// Keeps labels away from the box between two positions.
    fn take(&mut self, a: Point, b: Point) {
        let ([ax, ay], [bx, by]) = (self.place(a), self.place(b));
        self.space.add(&Rect::new(ax.min(bx), ay.min(by), (ax - bx).abs(), (ay - by).abs()).grown(CLEAR));
    }
}
