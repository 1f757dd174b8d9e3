//! The frame of a panel: grid, ticks with their labels, axis labels, title.

use super::axis::Span;
use super::drawing::Drawing;
use super::panel::Panel;
use super::shapes::{Anchor, Level, Paint, Rect, Stroke, Text};
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
    /// To the left of it.
    pub left: f64,
    /// To the right.
    pub right: f64,
    /// Above.
    pub top: f64,
    /// Below.
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

/// How many ticks may stand above each other on `height`.
pub(super) fn most_rows(height: f64) -> usize {
    (height / 34.0) as usize
}

/// The ticks of both axes, few enough that their labels do not touch.
pub(super) fn ticks(panel: &Panel, x: &Span, y: &Span, frame: &Rect) -> (Ticks, Ticks) {
    let fits = |ticks: &Ticks| {
        let ends = ticks.major.iter().map(|tick| {
            let (centre, half) =
                (frame.width * x.position(tick.at), text::width(&tick.label, theme::TICK_SIZE, false) / 2.0);
            (centre - half, centre + half)
        });
        let mut ends: Vec<(f64, f64)> = ends.collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.windows(2).all(|pair| pair[0].1 + 9.0 <= pair[1].0)
    };
    let most = (frame.width / 42.0) as usize;
    let across = (2..=most.max(2)).rev().map(|most| panel.x.ticks(x, most)).find(fits);
    let across = across.unwrap_or_else(|| {
        // Not even the fewest labels fit: the ends must do.
        let mut ticks = panel.x.ticks(x, 2);
        ticks.major.truncate(1);
        ticks
    });
    (across, panel.y.ticks(y, most_rows(frame.height)))
}

/// Grid lines at the labelled ticks.
pub(super) fn grid(drawing: &mut Drawing, frame: &Rect, (x, y): (&Span, &Span), (across, up): (&Ticks, &Ticks)) {
    for tick in &across.major {
        let at = frame.x + frame.width * x.position(tick.at);
        drawing.line([[at, frame.y], [at, frame.bottom()]], theme::GRID);
    }
    for tick in &up.major {
        let at = frame.bottom() - frame.height * y.position(tick.at);
        drawing.line([[frame.x, at], [frame.right(), at]], theme::GRID);
    }
}

/// The frame with ticks, labels and title, clear of the `labels` that stand outside already; returns the room of all.
pub(super) fn frame(
    drawing: &mut Drawing,
    panel: &Panel,
    frame: &Rect,
    (x, y): (&Span, &Span),
    (across, up): (&Ticks, &Ticks),
    labels: Sides,
) -> Sides {
    let thin = Stroke::solid(theme::INK, theme::THIN);
    drawing.rect(*frame, Paint::from(thin));
    let mut room = labels.union(Sides { left: 8.0, right: 8.0, top: 6.0, bottom: 8.0 });

    // Ticks of the x axis; labels at its ends may overhang the frame
    for &value in &across.minor {
        let at = frame.x + frame.width * x.position(value);
        drawing.line([[at, frame.bottom()], [at, frame.bottom() + MINOR]], thin);
    }
    for tick in &across.major {
        let at = frame.x + frame.width * x.position(tick.at);
        drawing.line([[at, frame.bottom()], [at, frame.bottom() + TICK]], thin);
        let label = tick_text([at, frame.bottom() + TICK + PAD + exponent_lift(across)], &tick.label);
        let half = label.width() / 2.0;
        room.right = room.right.max(at + half - frame.right() + 4.0);
        room.left = room.left.max(frame.x - (at - half) + 4.0);
        drawing.text(label.held(Anchor::Middle, Level::Top));
    }
    let mut below = TICK + PAD + exponent_lift(across) + theme::TICK_SIZE * (text::CAP_HEIGHT + text::DESCENT);

    // Ticks of the y axis
    for &value in &up.minor {
        let at = frame.bottom() - frame.height * y.position(value);
        drawing.line([[frame.x, at], [frame.x - MINOR, at]], thin);
    }
    let mut widest: f64 = 0.0;
    for tick in &up.major {
        let at = frame.bottom() - frame.height * y.position(tick.at);
        drawing.line([[frame.x, at], [frame.x - TICK, at]], thin);
        let label = tick_text([frame.x - TICK - PAD, at], &tick.label);
        widest = widest.max(label.width());
        drawing.text(label.held(Anchor::End, Level::Middle));
    }
    let mut left = TICK + PAD + widest;

    // Label of the x axis and the factor of its ticks
    let line = LABEL_GAP + theme::LABEL_SIZE * (text::CAP_HEIGHT + text::DESCENT);
    let label = label_text([frame.centre()[0], frame.bottom() + below + LABEL_GAP], &panel.x.label);
    let overhang = (label.width() - frame.width) / 2.0 + 4.0;
    room = room.union(Sides { left: overhang, right: overhang, ..Sides::default() });
    if across.exponent != 0 {
        let factor = tick_text([frame.right(), label.at[1]], &factor(across)).held(Anchor::End, Level::Top);
        // On the label's line where both fit, else on one of its own before it.
        let shares = label.width() / 2.0 + factor.width() + 12.0 <= frame.width / 2.0 || panel.x.label.is_empty();
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
        let label = label_text([frame.x - left, 0.0], &panel.y.label).held(Anchor::Middle, Level::Baseline).upwards();
        // Longer than the frame, it starts at the frame's foot, above the label of the x axis.
        let middle = frame.centre()[1].min(frame.bottom() - label.width() / 2.0);
        let label = Text { at: [label.at[0], middle], ..label };
        room = room.union(Sides { top: label.width() - frame.height + 4.0, ..Sides::default() });
        drawing.text(label);
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
        let title = Text::new(at, theme::TITLE_SIZE, panel.title.clone()).bold().coloured(theme::INK);
        let overhang = (title.width() - frame.width) / 2.0;
        drawing.text(title.held(Anchor::Middle, Level::Baseline));
        let top = above + 9.0 + theme::TITLE_SIZE;
        room = room.union(Sides { left: overhang, right: overhang, top, bottom: 0.0 });
    }
    room
}

/// Ticks and labels to the right of a colour bar; returns the room that they need.
pub(super) fn right_ticks(drawing: &mut Drawing, bar: &Rect, span: &Span, ticks: &Ticks) -> f64 {
    let thin = Stroke::solid(theme::INK, theme::THIN);
    let height = |value: f64| bar.bottom() - bar.height * span.position(value);
    for &value in &ticks.minor {
        drawing.line([[bar.right(), height(value)], [bar.right() + MINOR, height(value)]], thin);
    }
    let mut widest: f64 = 0.0;
    for tick in &ticks.major {
        let at = height(tick.at);
        drawing.line([[bar.right(), at], [bar.right() + TICK, at]], thin);
        let label = tick_text([bar.right() + TICK + PAD, at], &tick.label).held(Anchor::Start, Level::Middle);
        widest = widest.max(label.width());
        drawing.text(label);
    }
    if ticks.exponent != 0 {
        let text = tick_text([bar.centre()[0], bar.y - FACTOR_GAP], &factor(ticks));
        drawing.text(text.held(Anchor::Middle, Level::Baseline));
    }
    TICK + PAD + widest
}

/// Height above the frame of the factor that all labels share.
pub(super) fn factor_height(ticks: &Ticks) -> f64 {
    if ticks.exponent == 0 { 0.0 } else { FACTOR_GAP + theme::TICK_SIZE * 1.1 }
}

fn factor(ticks: &Ticks) -> String {
    format!("×10^{{{}}}", super::ticks::number(f64::from(ticks.exponent), 0))
}

/// Exponents rise above the capitals, so labels with them stand lower.
fn exponent_lift(ticks: &Ticks) -> f64 {
    if ticks.major.iter().any(|t| t.label.contains("^{")) { 0.18 * theme::TICK_SIZE } else { 0.0 }
}

fn tick_text(at: [f64; 2], label: &str) -> Text {
    Text::new(at, theme::TICK_SIZE, label).coloured(theme::INK)
}

fn label_text(at: [f64; 2], label: &str) -> Text {
    Text::new(at, theme::LABEL_SIZE, label).coloured(theme::INK)
}
