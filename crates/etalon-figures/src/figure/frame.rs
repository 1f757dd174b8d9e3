//! The frame of a panel: grid, ticks with their labels, axis labels, title.

use super::axis::Span;
use super::drawing::Drawing;
use super::panel::Panel;
use super::shapes::{Anchor, Level, Paint, Point, Rect, Stroke, Text};
use super::text;
use super::theme;
use super::ticks::Ticks;

/// Length of a labelled tick and of one between.
const TICK: f64 = 5.0;
const MINOR: f64 = 2.8;
/// From the end of a tick to its label.
const PAD: f64 = 4.0;
/// From tick labels to the axis label.
const LABEL_GAP: f64 = 8.0;
/// From the frame up to the factor that all tick labels share.
const FACTOR_GAP: f64 = 8.0;

/// Space outside a frame, in drawing units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sides {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Sides {
    /// Room for both, one covering the other.
    pub fn union(self, other: Sides) -> Sides {
        Sides {
            left: self.left.max(other.left),
            right: self.right.max(other.right),
            top: self.top.max(other.top),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// The side of a frame along which ticks stand.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Bottom,
    Left,
    Right,
}

/// How many ticks may stand above each other on `height`.
pub(super) fn most_rows(height: f64) -> usize {
    (height / 34.0) as usize
}

/// The axes of a panel in its frame.
pub(super) struct Axes<'a> {
    pub panel: &'a Panel,
    pub frame: Rect,
    pub x: Span,
    pub y: Span,
    across: Ticks,
    up: Ticks,
}

impl<'a> Axes<'a> {
    /// Axes with ticks so few that their labels do not touch.
    pub fn new(panel: &'a Panel, frame: Rect) -> Self {
        let (x, y) = panel.spans();
        let fits = |ticks: &Ticks| {
            let mut ends = ends(ticks, &x, &frame);
            ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
            ends.windows(2).all(|pair| pair[0][1] + 9.0 <= pair[1][0])
        };
        let most = (frame.width / 42.0) as usize;
        let across = (2..=most.max(2)).rev().map(|most| panel.x.ticks(&x, most)).find(fits);
        let across = across.unwrap_or_else(|| {
            // Not even the fewest labels fit: the ends must do.
            let mut ticks = panel.x.ticks(&x, 2);
            ticks.major.truncate(1);
            ticks
        });
        let up = panel.y.ticks(&y, most_rows(frame.height));
        Self { panel, frame, x, y, across, up }
    }

    pub fn grid(&self, drawing: &mut Drawing) {
        let frame = &self.frame;
        for tick in &self.across.major {
            let at = frame.x + frame.width * self.x.position(tick.at);
            drawing.line([[at, frame.y], [at, frame.bottom()]], theme::GRID);
        }
        for tick in &self.up.major {
            let at = frame.bottom() - frame.height * self.y.position(tick.at);
            drawing.line([[frame.x, at], [frame.right(), at]], theme::GRID);
        }
    }

    pub fn factor_height(&self) -> f64 {
        factor_height(&self.up)
    }

    /// Draws the frame with ticks, labels and title, clear of the `labels` that stand outside already; returns the room of
    /// all.
    pub fn draw(&self, drawing: &mut Drawing, labels: Sides) -> Sides {
        let Self { panel, frame, across, up, .. } = self;
        drawing.rect(*frame, Paint::from(Stroke::solid(theme::INK, theme::THIN)));
        let mut room = labels.union(Sides { left: 8.0, right: 8.0, top: 6.0, bottom: 8.0 });
        // Ticks; labels at the ends of the x axis may overhang the frame
        ticks_along(drawing, frame, Side::Bottom, &self.x, across);
        for [left, right] in ends(across, &self.x, frame) {
            let (left, right) = (frame.x - left + 4.0, right - frame.right() + 4.0);
            room = room.union(Sides { left, right, ..Sides::default() });
        }
        let mut below = below_ticks(across);
        let mut left = ticks_along(drawing, frame, Side::Left, &self.y, up);

        // Label of the x axis and the factor of its ticks
        let line = LABEL_GAP + theme::LABEL_SIZE * (text::CAP_HEIGHT + text::DESCENT);
        let label = label_text([frame.centre()[0], frame.bottom() + below + LABEL_GAP], &panel.x.label);
        let overhang = (label.width() - frame.width) / 2.0 + 4.0;
        room = room.union(Sides { left: overhang, right: overhang, ..Sides::default() });
        if across.exponent != 0 {
            let factor = tick_text([frame.right(), label.at[1]], &factor(across)).held(Anchor::End, Level::Top);
            // On the label's line where both fit, else on one of its own before it.
            let shares = label.width() / 2.0 + factor.width() + 12.0 <= frame.width / 2.0;
            drawing.text(factor);
            below += if shares && !panel.x.label.is_empty() { 0.0 } else { line };
        }
        if !panel.x.label.is_empty() {
            let at = [label.at[0], frame.bottom() + below + LABEL_GAP];
            drawing.text(Text { at, ..label }.held(Anchor::Middle, Level::Top));
            below += line;
        }
        // Label of the y axis, upwards, and the factor of its ticks above the frame
        if !panel.y.label.is_empty() {
            left += LABEL_GAP + theme::LABEL_SIZE * text::DESCENT;
            let label = label_text([frame.x - left, 0.0], &panel.y.label).held(Anchor::Middle, Level::Baseline);
            // Longer than the frame, it starts at the frame's foot, above the label of the x axis.
            let middle = frame.centre()[1].min(frame.bottom() - label.width() / 2.0);
            room = room.union(Sides { top: label.width() - frame.height + 4.0, ..Sides::default() });
            drawing.text(Text { at: [label.at[0], middle], ..label }.upwards());
            left += theme::LABEL_SIZE * 0.85;
        }
        if up.exponent != 0 {
            drawing.text(tick_text([frame.x, frame.y - FACTOR_GAP], &factor(up)));
        }
        let above = factor_height(up).max(labels.top);
        room = room.union(Sides { left, bottom: below, top: above, right: 0.0 });
        // Title above everything
        if !panel.title.is_empty() {
            let at = [frame.centre()[0], frame.y - above - 9.0];
            let title = Text::new(at, theme::TITLE_SIZE, panel.title.clone()).bold();
            let overhang = (title.width() - frame.width) / 2.0;
            drawing.text(title.held(Anchor::Middle, Level::Baseline));
            let top = above + 9.0 + theme::TITLE_SIZE;
            room = room.union(Sides { left: overhang, right: overhang, top, bottom: 0.0 });
        }
        room
    }
}

/// Draws ticks and their labels along one side of `frame`; returns the room that they need beside it.
pub(super) fn ticks_along(drawing: &mut Drawing, frame: &Rect, side: Side, span: &Span, ticks: &Ticks) -> f64 {
    let thin = Stroke::solid(theme::INK, theme::THIN);
    // The point so far outside the frame at a value
    let at = |value: f64, out: f64| -> Point {
        let position = span.position(value);
        match side {
            Side::Bottom => [frame.x + frame.width * position, frame.bottom() + out],
            Side::Left => [frame.x - out, frame.bottom() - frame.height * position],
            Side::Right => [frame.right() + out, frame.bottom() - frame.height * position],
        }
    };
    let (anchor, level, lift) = match side {
        Side::Bottom => (Anchor::Middle, Level::Top, exponent_lift(ticks)),
        Side::Left => (Anchor::End, Level::Middle, 0.0),
        Side::Right => (Anchor::Start, Level::Middle, 0.0),
    };
    for &value in &ticks.minor {
        drawing.line([at(value, 0.0), at(value, MINOR)], thin);
    }
    let mut widest: f64 = 0.0;
    for tick in &ticks.major {
        drawing.line([at(tick.at, 0.0), at(tick.at, TICK)], thin);
        let label = tick_text(at(tick.at, TICK + PAD + lift), &tick.label).held(anchor, level);
        widest = widest.max(label.width());
        drawing.text(label);
    }
    TICK + PAD + widest
}

/// Draws the factor that all labels of a colour bar share, above it.
pub(super) fn bar_factor(drawing: &mut Drawing, bar: &Rect, ticks: &Ticks) {
    if ticks.exponent != 0 {
        let text = tick_text([bar.centre()[0], bar.y - FACTOR_GAP], &factor(ticks));
        drawing.text(text.held(Anchor::Middle, Level::Baseline));
    }
}

/// Height of ticks and their labels below a frame.
pub(super) fn below_ticks(ticks: &Ticks) -> f64 {
    TICK + PAD + exponent_lift(ticks) + theme::TICK_SIZE * (text::CAP_HEIGHT + text::DESCENT)
}

/// Height above the frame of the factor that all labels share.
pub(super) fn factor_height(ticks: &Ticks) -> f64 {
    if ticks.exponent == 0 { 0.0 } else { FACTOR_GAP + theme::TICK_SIZE * 1.1 }
}

pub(super) fn factor(ticks: &Ticks) -> String {
    format!("×10^{{{}}}", super::ticks::number(f64::from(ticks.exponent), 0))
}

/// Where each label of an x axis begins and ends.
fn ends(ticks: &Ticks, span: &Span, frame: &Rect) -> Vec<[f64; 2]> {
    let of = |tick: &super::ticks::Tick| {
        let (centre, width) =
            (frame.x + frame.width * span.position(tick.at), tick_text([0.0; 2], &tick.label).width());
        [centre - width / 2.0, centre + width / 2.0]
    };
    ticks.major.iter().map(of).collect()
}

/// Exponents rise above the capitals, so labels with them stand lower.
fn exponent_lift(ticks: &Ticks) -> f64 {
    if ticks.major.iter().any(|t| t.label.contains("^{")) { 0.18 * theme::TICK_SIZE } else { 0.0 }
}

fn tick_text(at: Point, label: &str) -> Text {
    Text::new(at, theme::TICK_SIZE, label)
}

fn label_text(at: Point, label: &str) -> Text {
    Text::new(at, theme::LABEL_SIZE, label)
}
