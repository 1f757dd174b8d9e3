//! The marks of a panel, drawn by plotters, and cut to the frame exactly: a curve that leaves the frame ends at its edge and in
//! its own direction. The cells that they cover are marked as occupied.

use super::backend::{NEVER, pixels, style};
use super::chart::{CLEAR, Sketch};
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
        for part in clipped_line(positions) {
            let places: Vec<Point> = part.iter().map(|&p| self.place(p)).collect();
            self.space.add_line(&places, stroke.width + 2.0 * CLEAR);
            let path: Vec<(f64, f64)> = part.into_iter().map(Into::into).collect();
            let path = PathElement::new(path, style(stroke.colour, false, stroke.width));
            self.axes.chart(&mut self.drawing, stroke.dash).draw_series([path]).expect(NEVER);
        }
    }

    /// The part of an area within the frame.
    fn fill(&mut self, positions: Vec<Point>, colour: Colour) {
        let path: Vec<(f64, f64)> = clipped_polygon(positions).into_iter().map(Into::into).collect();
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

/// The parts of a line that lie inside the unit square. A point that is not finite breaks the line.
fn clipped_line(points: &[Point]) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((a, b)) = segment(pair[0], pair[1]) else {
            open = false;
            continue;
        };
        match parts.last_mut() {
            Some(part) if open => part.push(b),
            _ => parts.push(vec![a, b]),
        }
        open = b == pair[1];
    }
    parts
}

/// The part of a segment inside the unit square (Liang and Barsky, 1984).
fn segment(a: Point, b: Point) -> Option<(Point, Point)> {
    if !a.iter().chain(&b).all(|v| v.is_finite()) {
        return None;
    }
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let step = b[axis] - a[axis];
        if step == 0.0 {
            if !(0.0..=1.0).contains(&a[axis]) {
                return None;
            }
            continue;
        }
        let (t0, t1) = (-a[axis] / step, (1.0 - a[axis]) / step);
        start = start.max(t0.min(t1));
        end = end.min(t0.max(t1));
    }
    // Ends inside stay as they are, bit for bit
    let at = |t: f64| [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t].map(|v: f64| v.clamp(0.0, 1.0));
    let inside = |p: Point| p.iter().all(|v| (0.0..=1.0).contains(v));
    (start <= end).then(|| (if inside(a) { a } else { at(start) }, if inside(b) { b } else { at(end) }))
}

/// The part of a polygon inside the unit square (Sutherland and Hodgman, 1974); empty when there is none.
fn clipped_polygon(points: Vec<Point>) -> Vec<Point> {
    let mut points = points;
    for (axis, limit, sign) in [(0, 0.0, 1.0), (0, 1.0, -1.0), (1, 0.0, 1.0), (1, 1.0, -1.0)] {
        let depth = |p: &Point| sign * (p[axis] - limit);
        let mut kept = Vec::with_capacity(points.len() + 4);
        for (i, b) in points.iter().enumerate() {
            let a = &points[(i + points.len() - 1) % points.len()];
            let (da, db) = (depth(a), depth(b));
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                let mut crossing = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
                crossing[axis] = limit;
                kept.push(crossing);
            }
            if db >= 0.0 {
                kept.push(*b);
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_edge_and_broken_at_gaps() {
        let parts = clipped_line(&[[-0.5, 0.5], [0.5, 0.5], [0.5, 2.5], [0.8, 2.5], [0.8, -1.0]]);
        assert_eq!(parts, [vec![[0.0, 0.5], [0.5, 0.5], [0.5, 1.0]], vec![[0.8, 1.0], [0.8, 0.0]]]);
        let parts = clipped_line(&[[0.1, 0.1], [0.2, 0.2], [0.3, f64::NAN], [0.4, 0.4], [0.5, 0.5]]);
        assert_eq!(parts, [vec![[0.1, 0.1], [0.2, 0.2]], vec![[0.4, 0.4], [0.5, 0.5]]]);
        for nothing in [&[[0.5, f64::INFINITY], [0.5, 0.5]][..], &[[0.5, 0.5]], &[]] {
            assert!(clipped_line(nothing).is_empty(), "{nothing:?}");
        }
    }

    #[test]
    fn polygons_are_cut_at_the_edge() {
        let mut cut = clipped_polygon(vec![[-1.0, 0.25], [2.0, 0.25], [2.0, 0.75], [-1.0, 0.75]]);
        cut.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(cut, [[0.0, 0.25], [0.0, 0.75], [1.0, 0.25], [1.0, 0.75]]);
        assert!(
            clipped_polygon(vec![[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]]).is_empty()
                && clipped_polygon(Vec::new()).is_empty()
        );
    }
}
