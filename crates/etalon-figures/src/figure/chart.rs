//! A panel drawn: marks by plotters, the frame around them, labels and legend where there is room.

use super::frame::{self, Axes, Sides};
use super::legend::{Legend, Occupancy};
use super::page::Page;
use super::panel::{Mark, Panel};
use super::shapes::{Anchor, Colour, Level, Paint, Point, Rect, Stroke, Text};
use super::{heatmap, text, theme};

/// Distance of labels from curves and from each other.
pub(super) const CLEAR: f64 = 3.0;
/// Largest distance from the frame of a label without a free place inside.
const OUTSIDE: f64 = 300.0;
/// Width kept for the factor of the y axis, above the frame's left end.
const FACTOR: f64 = 45.0;
/// Length of the sample before the name of a curve, and their distance.
const NAME_SAMPLE: f64 = 18.0;
const NAME_GAP: f64 = 4.0;
/// Where along a curve its name may stand, the best place first.
const ALONG: [f64; 11] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9, 0.05, 0.95];
/// Distance of places along a curve, and how far the curve must be from the others where a line to its name ends.
const STEP: f64 = 3.0;
const APART: f64 = 3.0;
/// How far it should be from them, and half as far as from the ends of other lines to names.
const PLAIN: f64 = 9.0;
/// Places along a curve where a line to its name may end.
const ENDS: usize = 24;
/// Largest distance of a name from its curve: of one beside it, and of one with a line to it.
const BESIDE: f64 = 16.0;
const LED: f64 = 100.0;
/// Where around a curve a name with a line to it is sought, in that distance.
const SIDES: [Point; 9] =
    [[0.0, 0.0], [0.0, -0.4], [0.0, 0.4], [-0.6, 0.0], [0.6, 0.0], [-0.5, -0.3], [0.5, -0.3], [-0.5, 0.3], [0.5, 0.3]];
/// The line to a name, and the dot at its end.
const LEADER: f64 = 0.8;
const LEADER_END: f64 = 2.2;
/// Distance of a legend from the frame.
const INSET: f64 = 8.0;

/// A panel drawn with its frame's top left corner at the origin, and the room that it needs outside the frame.
pub(super) struct Chart {
    pub drawing: Page,
    /// Space that ticks, labels and title take around the frame.
    pub room: Sides,
    /// The legend, when it found no free place inside the frame.
    pub legend: Option<Legend>,
    /// Whether every curve has its name where it runs.
    pub is_named: bool,
}

impl Chart {
    /// `has_own` says whether the panel shows a legend and a colour bar of its own, or shares them with others; titles are broken
    /// within the width `limit`.
    pub fn new(panel: &Panel, [width, height]: [f64; 2], has_own: Parts, limit: f64) -> Self {
        let axes = Axes::new(panel, Rect::new(0.0, 0.0, width, height), limit);
        let mut sketch = Sketch {
            drawing: Page::new(width, height, 1.0),
            space: Occupancy::new(axes.frame),
            above: Occupancy::new(Rect::new(-OUTSIDE, -OUTSIDE, width + 2.0 * OUTSIDE, OUTSIDE)),
            beside: Occupancy::new(Rect::new(width, 0.0, OUTSIDE, height)),
            outside: Sides::default(),
            labels: Vec::new(),
            ends: Vec::new(),
            axes,
        };
        // Grid or heat map below, marks above it
        let mut room = Sides::default();
        match &panel.heatmap {
            Some(map) => {
                sketch.drawing.image(sketch.axes.frame, map.image());
                if has_own.bar {
                    room = heatmap::bar_beside(&mut sketch.drawing, map, &sketch.axes.frame);
                }
            }
            None => sketch.axes.grid(&mut sketch.drawing),
        }
        sketch.marks(&panel.marks);
        // Labels of reference lines and notes, clear of the marks and of the y axis' factor
        let factor = frame::factor_height(&sketch.axes.up);
        sketch.above.add(&Rect::new(0.0, -factor, FACTOR, factor));
        let is_map = panel.heatmap.is_some();
        panel.marks.iter().for_each(|mark| sketch.label(mark, is_map));
        room = room.union(sketch.axes.draw(&mut sketch.drawing, sketch.outside));
        // The legend of what is not named where it runs, where it covers nothing
        let named = if has_own.names { sketch.name_curves(&panel.marks, has_own.leads) } else { None };
        let legend = Legend::new(&panel.marks).and_then(|legend| legend.without(named.as_deref().unwrap_or_default()));
        let legend = legend.filter(|_| has_own.legend).map(|legend| legend.within(limit));
        let legend = legend.and_then(|legend| sketch.legend(legend));
        Self { drawing: sketch.drawing, room, legend, is_named: named.is_some() }
    }
}

/// What panels may share.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub legend: bool,
    pub bar: bool,
    /// Whether curves have their names where they run, if there is room for all of them; and whether lines lead to those that have none
    /// beside their curves.
    pub names: bool,
    pub leads: bool,
}

pub(super) struct Sketch<'a> {
    pub drawing: Page,
    /// With the frame at the origin.
    pub axes: Axes<'a>,
    /// Occupied cells within the frame; `above` and `beside` are those above it and to its right.
    pub space: Occupancy,
    above: Occupancy,
    beside: Occupancy,
    /// Room taken by labels outside the frame, and the places of those within.
    outside: Sides,
    labels: Vec<Rect>,
    /// Where lines to names end.
    ends: Vec<Point>,
}

struct Curve {
    label: String,
    stroke: Stroke,
    /// Places along it, and those that tell where it runs.
    places: Vec<Point>,
    few: Vec<Point>,
}

impl Sketch<'_> {
    /// Positions along the axes of a point of the data.
    pub fn position(&self, p: Point) -> Point {
        [self.axes.x.position(p[0]), self.axes.y.position(p[1])]
    }

    /// The place in the frame of positions along the axes.
    pub fn place(&self, p: Point) -> Point {
        [self.axes.frame.width * p[0], self.axes.frame.height * (1.0 - p[1])]
    }

    /// Writes the label of a reference line or a note where there is room.
    fn label(&mut self, mark: &Mark, is_on_map: bool) {
        let (label, at, colour) = match mark {
            Mark::Vertical { at, label, .. } => (label, [self.axes.x.position(*at), 0.5], theme::INK),
            Mark::Horizontal { at, label } => (label, [0.5, self.axes.y.position(*at)], theme::INK),
            Mark::Note { at, text, colour } => (text, self.position(*at), *colour),
            _ => return,
        };
        if label.is_empty() || !at.iter().all(|v| (0.0..=1.0).contains(v)) {
            return;
        }
        let [x, y] = self.place(at);
        let high = theme::NOTE_SIZE + 4.0;
        // Never taller than wide, unless it runs upwards.
        let long = (text::width(label, theme::NOTE_SIZE, false) + 4.0).max(high);
        // A gap that is more than what the line itself takes, in whole cells.
        let gap = CLEAR + 3.5;
        let (right, bottom) = (self.axes.frame.width, self.axes.frame.height);
        // Candidates: along a vertical line from the top, along a horizontal line from the right, around a point
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
        // No free place inside: the nearest one beside the frame or above it, else next to it
        let place = match (found, mark) {
            (Some(place), _) => {
                self.take_label(&place);
                // Lines of the grid run on behind notes, which may be many; on the colours of a map they have paper
                if is_on_map || !matches!(mark, Mark::Note { .. }) {
                    self.drawing.rect(place, Colour::WHITE.faded(0.85));
                }
                place
            }
            (None, Mark::Horizontal { .. }) => {
                let at = |y: f64| Rect::new(right + CLEAR, y - high / 2.0, long, high);
                let up_and_down = slots(0.0, bottom).flat_map(|d| [at(y - d), at(y + d)]);
                let place = self.beside.first_free(up_and_down).unwrap_or(at(y));
                self.beside.add(&place);
                self.outside.right = self.outside.right.max(place.right() - right + CLEAR);
                place
            }
            (None, _) => {
                let at = |up: f64| Rect::new(x - long / 2.0, -up - high, long, high);
                let place = self.above.first_free(slots(CLEAR, OUTSIDE).map(at)).unwrap_or(at(CLEAR));
                self.above.add(&place.grown(CLEAR));
                let overhang = (place.right() - right).max(-place.x) + CLEAR;
                let room = Sides { top: CLEAR - place.y, left: overhang, right: overhang, bottom: 0.0 };
                self.outside = self.outside.union(room);
                place
            }
        };
        let text = Text::new(place.centre(), theme::NOTE_SIZE, label.clone())
            .held(Anchor::Middle, Level::Middle)
            .coloured(colour);
        self.drawing.text(if place.height > place.width { text.upwards() } else { text });
    }

    fn take_label(&mut self, place: &Rect) {
        self.space.add(&place.grown(CLEAR));
        self.labels.push(*place);
    }

    /// Writes the names of curves, each with a sample of its line, beside them wherever its own curve is the nearest one, else further off
    /// with a line to the curve, which crosses no other; returns the names. Where one of them has no
    /// place nothing is written: names at some of the curves and a legend of the others would be read as two lists.
    fn name_curves(&mut self, marks: &[Mark], leads: bool) -> Option<Vec<String>> {
        let curve = |mark: &Mark| match mark {
            Mark::Line { label, stroke, points } if !label.is_empty() => {
                let places = points.windows(2).flat_map(|ends| self.between(ends));
                let places: Vec<Point> = places.collect();
                // The points of a long curve that tell where it runs
                let mut few: Vec<Point> = Vec::new();
                for place in &places {
                    if few.last().is_none_or(|last| apart(*last, *place) >= 0.5 * STEP) {
                        few.push(*place);
                    }
                }
                Some(Curve { label: label.clone(), stroke: *stroke, places, few })
            }
            _ => None,
        };
        let curves: Vec<Curve> = marks.iter().filter_map(curve).collect();
        let (space, labels, ends) = (self.space.clone(), self.labels.clone(), self.ends.clone());
        // Long names first, which have the fewest places
        let mut order: Vec<usize> = (0..curves.len()).collect();
        let long = |i: &usize| text::width(&curves[*i].label, theme::NOTE_SIZE, false);
        order.sort_by(|a, b| long(b).total_cmp(&long(a)));
        let found: Option<Vec<(usize, Rect, Option<Point>)>> = order
            .into_iter()
            .map(|i| {
                let (place, end) = self.place_of_name(&curves, i, leads)?;
                self.take_label(&place);
                if let Some(end) = end {
                    self.space.add_line(&leader(&place, end), CLEAR);
                    self.ends.push(end);
                }
                Some((i, place, end))
            })
            .collect();
        let Some(found) = found.filter(|found| !found.is_empty()) else {
            (self.space, self.labels, self.ends) = (space, labels, ends);
            return None;
        };
        for (i, place, end) in found {
            let Curve { label, stroke, .. } = &curves[i];
            if let Some(end) = end {
                self.drawing.line(leader(&place, end), Stroke::solid(stroke.colour, LEADER));
                self.drawing.circle(end, LEADER_END, stroke.colour);
            }
            let [x, y] = [place.x + 2.0, place.centre()[1]];
            // A marker in the frame would be read as a datum
            self.drawing.line([[x, y], [x + NAME_SAMPLE, y]], *stroke);
            let text = Text::new([x + NAME_SAMPLE + NAME_GAP, y], theme::NOTE_SIZE, label.clone());
            self.drawing.text(text.held(Anchor::Start, Level::Middle));
        }
        Some(curves.into_iter().map(|curve| curve.label).collect())
    }

    /// A free place for the name of a curve, and where on the curve a line to it ends, if it has one.
    fn place_of_name(&mut self, curves: &[Curve], i: usize, leads: bool) -> Option<(Rect, Option<Point>)> {
        let Curve { label, places, few, .. } = &curves[i];
        // Indices stand lower than letters
        let high = theme::NOTE_SIZE + 8.0;
        let long = NAME_SAMPLE + NAME_GAP + text::width(label, theme::NOTE_SIZE, false) + 4.0;
        let others = || curves.iter().enumerate().filter(|(other, _)| *other != i).map(|(_, curve)| &*curve.few);
        let is_own = |place: &Rect| {
            let distance = |places: &[Point]| places.iter().map(|p| place.distance(*p)).fold(f64::INFINITY, f64::min);
            others().all(|other| distance(other) > 1.5 * distance(few))
        };
        let at = |share: f64| places.get((share * places.len() as f64) as usize).copied();
        let mut near = |reach: f64, at: Point| self.space.nearest_free(at, [long, high], CLEAR + 3.5, reach);
        let beside: Vec<_> = ALONG.into_iter().filter_map(at).filter_map(|end| near(BESIDE, end)).collect();
        let beside = beside.into_iter().find(is_own).map(|place| (place, None));
        if beside.is_some() || !leads {
            return beside;
        }
        let is_clear = |end: &Point| others().flatten().all(|other| apart(*other, *end) > APART);
        let ends = (1..ENDS).filter_map(|i| at(i as f64 / ENDS as f64));
        let around = |end: Point| SIDES.map(|[x, y]| ([end[0] + LED * x, end[1] + LED * y], end));
        let far: Vec<_> = ends
            .filter(is_clear)
            .flat_map(around)
            .filter_map(|(at, end)| near(LED, at).map(|place| (place, end)))
            .collect();
        let crossed = |line: &[Point]| {
            let meets = |other: &&[Point]| other.iter().any(|p| line.iter().any(|q| apart(*p, *q) < STEP));
            others().any(|other| meets(&other))
        };
        let over = |line: &[Point]| self.labels.iter().any(|label| line.iter().any(|q| label.contains(*q)));
        let lines = far.into_iter().map(|(place, end)| (leader(&place, end), place, end));
        // Rather where no other line ends, and where it is plain which curve this one ends at
        let near = |end: Point, reach: f64| move |other: &Point| apart(*other, end) < reach;
        let doubts =
            |end: Point| [self.ends.iter().any(near(end, 2.0 * PLAIN)), others().flatten().any(near(end, PLAIN))];
        let ranked = lines.filter(|(line, ..)| !over(line) && !crossed(line)).map(|(_, place, end)| {
            let length = place.distance(end);
            (doubts(end), length, place, end)
        });
        let best = ranked.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.map(|(.., place, end)| (place, Some(end)))
    }

    /// Places along a part of a curve, those within the frame.
    fn between(&self, ends: &[Point]) -> Vec<Point> {
        let [from, to] = [ends[0], ends[1]].map(|end| self.place(self.position(end)));
        let count = (apart(from, to) / STEP).ceil();
        let count = if count.is_finite() { count.clamp(1.0, 1e3) as usize } else { 0 };
        let at = |i: usize| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * i as f64 / count as f64);
        (0..count).map(at).filter(|&place| self.axes.frame.contains(place)).collect()
    }

    /// Draws the legend in a free corner, or returns it when there is none.
    fn legend(&mut self, legend: Legend) -> Option<Legend> {
        for columns in 1..=legend.len().min(3) {
            let [width, height] = legend.size(columns);
            let (left, right) = (INSET, self.axes.frame.width - INSET - width);
            let (top, bottom) = (INSET, self.axes.frame.height - INSET - height);
            let corners = [[right, top], [left, top], [right, bottom], [left, bottom]];
            let places = corners.map(|[x, y]| Rect::new(x, y, width, height));
            if let Some(place) = self.space.first_free(places) {
                self.drawing.rect(place, Paint { fill: Some(Colour::WHITE), stroke: Some(theme::GRID) });
                legend.draw(&mut self.drawing, [place.x, place.y], columns);
                return None;
            }
        }
        Some(legend)
    }
}

fn apart(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Places along the line from the edge of a name to a curve.
fn leader(place: &Rect, end: Point) -> Vec<Point> {
    let from = [end[0].clamp(place.x, place.right()), end[1].clamp(place.y, place.bottom())];
    let count = (apart(from, end) / STEP).ceil().max(1.0) as usize;
    (0..=count).map(|i| [0, 1].map(|axis| from[axis] + (end[axis] - from[axis]) * i as f64 / count as f64)).collect()
}

/// Offsets from `from` up to `to` in steps of two cells.
fn slots(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..).map(move |i| from + 4.0 * f64::from(i)).take_while(move |&v| v <= to)
}
