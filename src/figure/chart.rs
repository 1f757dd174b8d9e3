//! A panel drawn: marks by plotters, the frame around them, labels and legend where there is room.

use super::axis::Span;
use super::backend::{Canvas, GRID};
use super::clip;
use super::drawing::{Anchor, Colour, Drawing, Level, Paint, Point, Rect, Stroke, Text};
use super::frame::{self, Sides};
use super::legend::Legend;
use super::occupancy::Occupancy;
use super::panel::{Mark, Panel};
use super::text;
use super::theme;
use plotters::coord::{Shift, types::RangedCoordf64};
use plotters::prelude::{Cartesian2d, Circle, DrawingArea, IntoDrawingArea, PathElement, Polygon};
use plotters::style::{RGBAColor, ShapeStyle};

/// Distance that labels keep from curves and from each other.
const CLEAR: f64 = 3.0;
/// Distance of a legend from the frame.
const INSET: f64 = 8.0;

/// A panel drawn with its frame's top left corner at the origin, and the room that it needs outside the frame.
pub(super) struct Chart {
    pub drawing: Drawing,
    pub room: Sides,
    /// The legend, when it found no free place inside the frame.
    pub legend: Option<Legend>,
}

impl Chart {
    /// Draws `panel` in a frame of the given size, with its legend if it is to have its own.
    pub fn new(panel: &Panel, width: f64, height: f64, own_legend: bool) -> Self {
        let mut sketch = Sketch {
            drawing: Drawing::new(width, height, 1.0),
            space: Occupancy::new(Rect::new(0.0, 0.0, width, height)),
            frame: Rect::new(0.0, 0.0, width, height),
            spans: panel.spans(),
        };
        let (x, y) = sketch.spans;
        let (across, up) = frame::ticks(panel, &x, &y, &sketch.frame);
        let mut room = Sides::default();
        match &panel.heatmap {
            Some(map) => room = map.draw(&mut sketch.drawing, &sketch.frame),
            None => frame::grid(&mut sketch.drawing, &sketch.frame, (&x, &y), (&across, &up)),
        }
        for layer in [0, 1, 2, 3] {
            panel.marks.iter().filter(|mark| layer_of(mark) == layer).for_each(|mark| sketch.mark(mark));
        }
        let outside = frame::frame(&mut sketch.drawing, panel, &sketch.frame, (&x, &y), (&across, &up));
        room = room.union(outside);
        panel.marks.iter().for_each(|mark| sketch.label(mark));

        let legend = Legend::new(&panel.marks).filter(|_| own_legend).and_then(|legend| sketch.legend(legend));
        Self { drawing: sketch.drawing, room, legend }
    }
}

/// Areas, then reference lines, curves, dots.
fn layer_of(mark: &Mark) -> usize {
    match mark {
        Mark::Band { .. } | Mark::Bars { .. } => 0,
        Mark::Vertical { .. } | Mark::Horizontal { .. } => 1,
        Mark::Line { .. } => 2,
        Mark::Dots { .. } => 3,
        Mark::Note { .. } => usize::MAX,
    }
}

/// A chart on the way.
struct Sketch {
    drawing: Drawing,
    space: Occupancy,
    frame: Rect,
    spans: (Span, Span),
}

impl Sketch {
    /// Positions along the axes of a point of the data.
    fn position(&self, p: Point) -> Point {
        [self.spans.0.position(p[0]), self.spans.1.position(p[1])]
    }

    /// The place in the frame of positions along the axes.
    fn place(&self, p: Point) -> Point {
        [self.frame.width * p[0], self.frame.height * (1.0 - p[1])]
    }

    /// A plotters drawing area over the frame, which counts from 0 to 1 along both axes.
    fn area<'a>(
        &'a mut self,
        dash: &'static [f64],
    ) -> DrawingArea<Canvas<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>> {
        let (width, height) = ((self.frame.width * GRID) as i32, (self.frame.height * GRID) as i32);
        let area: DrawingArea<Canvas<'a>, Shift> = Canvas::new(&mut self.drawing, dash).into_drawing_area();
        area.apply_coord_spec(Cartesian2d::new(0.0..1.0, 0.0..1.0, (0..width, height..0)))
    }

    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Line { stroke, points, .. } => {
                let positions: Vec<Point> = points.iter().map(|&p| self.position(p)).collect();
                self.curve(&positions, *stroke);
            }
            Mark::Dots { colour, points, .. } => self.dots(*colour, points),
            Mark::Band { colour, points, .. } => self.band(*colour, points),
            Mark::Bars { colour, edges, heights, .. } => self.bars(*colour, edges, heights),
            Mark::Vertical { at, .. } => {
                let x = self.spans.0.position(*at);
                self.curve(&[[x, 0.0], [x, 1.0]], theme::RULE);
            }
            Mark::Horizontal { at, .. } => {
                let y = self.spans.1.position(*at);
                self.curve(&[[0.0, y], [1.0, y]], theme::RULE);
            }
            Mark::Note { .. } => {}
        }
    }

    /// The parts of a line within the frame.
    fn curve(&mut self, positions: &[Point], stroke: Stroke) {
        for part in clip::line(positions) {
            let places: Vec<Point> = part.iter().map(|&p| self.place(p)).collect();
            self.space.add_line(&places, stroke.width + 2.0 * CLEAR);
            let style = shape(stroke.colour, false, stroke.width);
            let path: Vec<(f64, f64)> = part.iter().map(|p| (p[0], p[1])).collect();
            self.area(stroke.dash).draw(&PathElement::new(path, style)).expect(NEVER);
        }
    }

    /// The part of an area within the frame.
    fn fill(&mut self, positions: Vec<Point>, colour: Colour) {
        let path: Vec<(f64, f64)> = clip::polygon(positions).iter().map(|p| (p[0], p[1])).collect();
        if !path.is_empty() {
            self.area(theme::SOLID).draw(&Polygon::new(path, shape(colour, true, 0.0))).expect(NEVER);
        }
    }

    fn dots(&mut self, colour: Colour, points: &[Point]) {
        for &p in points {
            let position = self.position(p);
            // Also false for NaN.
            if position.iter().all(|v| (0.0..=1.0).contains(v)) {
                let [x, y] = self.place(position);
                self.space.add(&Rect::new(x, y, 0.0, 0.0).grown(theme::DOT + CLEAR));
                let radius = (theme::DOT * GRID) as i32;
                let dot = Circle::new((position[0], position[1]), radius, shape(colour, true, 0.0));
                self.area(theme::SOLID).draw(&dot).expect(NEVER);
            }
        }
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
        for run in positions.split(|p| !p.iter().all(|v| v.is_finite())).filter(|run| run.len() > 1) {
            let outline = run.iter().map(|p| [p[0], p[2]]).chain(run.iter().rev().map(|p| [p[0], p[1]])).collect();
            self.fill(outline, colour.faded(0.2));
            for pair in run.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let columns = ((b[0] - a[0]).abs() * self.frame.width).ceil().clamp(1.0, self.frame.width) as usize;
                for i in 0..=columns {
                    let t = i as f64 / columns as f64;
                    let [x, lower, upper] = [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t);
                    self.take([x, lower], [x, upper]);
                }
            }
        }
    }

    fn bars(&mut self, colour: Colour, edges: &[f64], heights: &[f64]) {
        // On a logarithmic scale bars stand on the frame.
        let low = |v: f64| if v.is_nan() { -1.0 } else { v };
        let floor = low(self.spans.1.position(0.0));
        let mut outline: Vec<Point> = Vec::new();
        let mut runs: Vec<Vec<Point>> = Vec::new();
        for (edge, &height) in edges.windows(2).zip(heights) {
            let ([left, top], [right, _]) = (self.position([edge[0], height]), self.position([edge[1], height]));
            if !(height.is_finite() && left.is_finite() && right.is_finite()) {
                runs.push(std::mem::take(&mut outline));
                continue;
            }
            if outline.is_empty() {
                outline.push([left, floor]);
            } else {
                outline.pop();
            }
            outline.extend([[left, low(top)], [right, low(top)], [right, floor]]);
            self.take([left, floor], [right, low(top)]);
        }
        runs.push(outline);
        for run in runs.into_iter().filter(|run| !run.is_empty()) {
            self.fill(run.clone(), colour.faded(0.3));
            self.curve(&run, Stroke::solid(colour, 1.2));
        }
    }

    /// Keeps labels away from the box between two positions.
    fn take(&mut self, a: Point, b: Point) {
        let ([ax, ay], [bx, by]) = (self.place(a), self.place(b));
        self.space.add(&Rect::new(ax.min(bx), ay.min(by), (ax - bx).abs(), (ay - by).abs()).grown(CLEAR));
    }

    /// Writes the label of a reference line or a note where there is room.
    fn label(&mut self, mark: &Mark) {
        let (label, at) = match mark {
            Mark::Vertical { at, label } => (label, [self.spans.0.position(*at), 0.5]),
            Mark::Horizontal { at, label } => (label, [0.5, self.spans.1.position(*at)]),
            Mark::Note { at, text } => (text, self.position(*at)),
            _ => return,
        };
        if label.is_empty() || !at.iter().all(|v| (0.0..=1.0).contains(v)) {
            return;
        }
        let [x, y] = self.place(at);
        let long = text::width(label, theme::NOTE_SIZE, false) + 4.0;
        let high = theme::NOTE_SIZE + 4.0;
        // A gap that is more than what the line itself takes, in whole cells.
        let gap = CLEAR + 3.5;
        let (right, bottom) = (self.frame.width, self.frame.height);
        let found = match mark {
            Mark::Vertical { .. } => {
                let beside = move |w: f64, h: f64| {
                    slots(5.0, bottom - h - 5.0)
                        .flat_map(move |top| [Rect::new(x + gap, top, w, h), Rect::new(x - gap - w, top, w, h)])
                };
                self.space.first_free(beside(long, high).chain(beside(high, long)))
            }
            Mark::Horizontal { .. } => self.space.first_free(slots(5.0, right - long - 5.0).flat_map(|from_right| {
                let left = right - long - from_right;
                [Rect::new(left, y - gap - high, long, high), Rect::new(left, y + gap, long, high)]
            })),
            _ => self.space.nearest_free([x, y], [long, high], gap, 150.0),
        };
        // Where everything is taken, the label stands beside its line on a pale ground.
        let place = found.unwrap_or_else(|| {
            let left = (x + gap).min(right - long - 5.0).max(5.0);
            Rect::new(left, (y - gap - high).clamp(5.0, (bottom - high - 5.0).max(5.0)), long, high)
        });
        self.space.add(&place.grown(CLEAR));
        self.drawing.rect(place, Colour::WHITE.faded(0.85));
        let text = Text::new(place.centre(), theme::NOTE_SIZE, label.clone()).held(Anchor::Middle, Level::Middle);
        let text = text.coloured(theme::INK);
        self.drawing.text(if place.height > place.width && long > high { text.upwards() } else { text });
    }

    /// Draws the legend in a free place along the edges, or returns it when there is none.
    fn legend(&mut self, legend: Legend) -> Option<Legend> {
        for columns in 1..=legend.len().min(3) {
            let [width, height] = legend.size(columns);
            let (left, right) = (INSET, self.frame.width - INSET - width);
            let (top, bottom) = (INSET, self.frame.height - INSET - height);
            let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
            let corners = [[right, top], [left, top], [right, bottom], [left, bottom]];
            let sides = [[middle[0], top], [middle[0], bottom], [right, middle[1]], [left, middle[1]]];
            let places = corners.into_iter().chain(sides).map(|[x, y]| Rect::new(x, y, width, height));
            if let Some(place) = self.space.first_free(places) {
                self.drawing.rect(place, Paint { fill: Some(Colour::WHITE), stroke: Some(theme::GRID) });
                legend.draw(&mut self.drawing, [place.x, place.y], columns);
                return None;
            }
        }
        Some(legend)
    }
}

/// Why plotters' result can be unwrapped.
const NEVER: &str = "drawing into memory cannot fail";

/// Offsets from `from` up to `to` in steps of two cells.
fn slots(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..).map(move |i| from + 4.0 * f64::from(i)).take_while(move |&v| v <= to)
}

fn shape(Colour { r, g, b, alpha }: Colour, filled: bool, width: f64) -> ShapeStyle {
    let color = RGBAColor(r, g, b, f64::from(alpha) / 255.0);
    ShapeStyle { color, filled, stroke_width: (width * GRID).round() as u32 }
}
