//! The frame of a panel: grid, ticks with their labels and axis titles, drawn by plotters; the panel's title.

use super::axis::{Span, Tick, Ticks};
use super::backend::{Canvas, NEVER, PlottersChart, pixels, style};
use super::page::Page;
use super::panel::Panel;
use super::shapes::{Anchor, Level, Paint, Point, Rect, Stroke, Text};
use super::{text, theme};
use plotters::chart::LabelAreaPosition;
use plotters::prelude::{EmptyElement, IntoFont, PathElement};
use plotters::style::{TRANSPARENT, TextStyle};

/// Length of a labelled tick and of one between.
const TICK: f64 = 5.0;
const MINOR: f64 = 2.8;
/// From the end of a tick to its label.
const PAD: f64 = 4.0;
/// From tick labels to the axis title.
const TITLE_GAP: f64 = 8.0;
/// Height of an axis title with that gap.
const TITLE: f64 = TITLE_GAP + theme::LABEL_SIZE * (text::CAP_HEIGHT + text::DESCENT);
/// Height of a further line of a title.
const LINE: f64 = 16.0;
/// From the frame up to the factor that all tick labels share.
pub(super) const FACTOR_GAP: f64 = 8.0;

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

/// How many ticks may stand above each other on `height`.
pub(super) fn most_rows(height: f64) -> usize {
    (height / 34.0) as usize
}

/// The axes of a panel in its frame.
pub(super) struct Axes<'a> {
    pub panel: &'a Panel,
    pub frame: Rect,
    /// Titles above and below the frame are broken within this width, and within little more than that of the frame.
    pub limit: f64,
    pub x: Span,
    pub y: Span,
    across: Ticks,
    pub up: Ticks,
}

impl<'a> Axes<'a> {
    /// Axes with ticks so few that their labels do not touch.
    pub fn new(panel: &'a Panel, frame: Rect, limit: f64) -> Self {
        let (x, y) = panel.spans();
        let fits = |ticks: &Ticks| {
            let mut ends = ends(ticks, &frame);
            ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
            ends.windows(2).all(|pair| pair[0][1] + 9.0 <= pair[1][0])
        };
        let most = (frame.width / 42.0) as usize;
        let fewer =
            [2.0, 3.0, 4.0, 6.0].into_iter().filter_map(|n| panel.x.coarser(n)).map(|axis| axis.ticks(&x, most));
        let across = (2..=most.max(2)).rev().map(|most| panel.x.ticks(&x, most)).chain(fewer).find(fits);
        let across = across.unwrap_or_else(|| {
            // Not even the fewest labels fit: the ends must do.
            let mut ticks = panel.x.ticks(&x, 2);
            ticks.major.truncate(1);
            ticks
        });
        let up = panel.y.ticks(&y, most_rows(frame.height));
        Self { panel, frame, limit, x, y, across, up }
    }

    /// plotters' chart of the panel, without labels.
    pub fn chart<'b>(&'b self, drawing: &'b mut Page, dash: &'static [f64]) -> PlottersChart<'b> {
        Canvas { drawing, frame: self.frame, room: Sides::default(), dash }.chart(&self.across, &self.up)
    }

    /// The length of a line above or below the frame: little more than its width.
    fn widest(&self) -> f64 {
        self.limit.min(1.2 * self.frame.width)
    }

    /// The length of a line beside the frame, where titles are broken at all.
    fn tallest(&self) -> f64 {
        if self.limit.is_finite() { self.frame.height } else { f64::INFINITY }
    }

    pub fn grid(&self, drawing: &mut Page) {
        let lines = style(theme::GRID.colour, false, theme::GRID.width);
        let mut chart = self.chart(drawing, theme::SOLID);
        chart.configure_mesh().disable_axes().bold_line_style(lines).draw().expect(NEVER);
    }

    /// Draws the frame with ticks, labels and titles, clear of the `labels` that stand outside already; returns the room of
    /// all.
    pub fn draw(&self, drawing: &mut Page, labels: Sides) -> Sides {
        let Self { panel, frame, across, up, .. } = self;
        let mut room = labels.union(Sides { left: 8.0, right: 8.0, top: 6.0, bottom: 8.0 });
        // Labels at the ends of the x axis, and its title, may overhang the frame
        let label = text::wrapped(&panel.x.label, theme::LABEL_SIZE, false, self.widest());
        let longest =
            |lines: &[String]| lines.iter().map(|line| text::width(line, theme::LABEL_SIZE, false)).fold(0.0, f64::max);
        let half = longest(&label) / 2.0;
        let title = [frame.centre()[0] - half, frame.centre()[0] + half];
        for [left, right] in ends(across, frame).into_iter().chain([title]) {
            let (left, right) = (frame.x - left + 4.0, right - frame.right() + 4.0);
            room = room.union(Sides { left, right, ..Sides::default() });
        }
        // The factor of the x axis, on its title's line where both fit, else on one of its own before it
        let mut bottom = below_ticks(across);
        let at = [frame.right(), frame.bottom() + bottom + TITLE_GAP];
        let width = draw_factor(drawing, across, at, (Anchor::End, Level::Top));
        if width > 0.0 && (half == 0.0 || half + width + 12.0 > frame.width / 2.0) {
            bottom += TITLE;
        }
        bottom += title_height(&panel.x.label);
        let first = label.first().map_or("", String::as_str);
        // The factor of the y axis, above the frame
        draw_factor(drawing, up, [frame.x, frame.y - FACTOR_GAP], (Anchor::Start, Level::Baseline));
        let beside = text::wrapped(&panel.y.label, theme::LABEL_SIZE, false, self.tallest());
        let further = LINE * beside.len().saturating_sub(1) as f64;
        let left = beside_ticks(up) + title_height(&panel.y.label) + further;
        let labelled = Sides { left, bottom, ..Sides::default() };
        draw_axes(drawing, *frame, labelled, [across, up], [first, beside.first().map_or("", String::as_str)]);
        for (i, line) in beside.iter().enumerate().skip(1) {
            let at = [frame.x - left + LINE * i as f64, frame.centre()[1]];
            let text = Text::new(at, theme::LABEL_SIZE, line.clone()).held(Anchor::Middle, Level::Top);
            drawing.text(text.upwards());
        }
        let bottom = bottom + further_lines(drawing, &label, [frame.centre()[0], frame.bottom() + bottom]);
        let labelled = Sides { bottom, ..labelled };
        let overhang = longest(&beside) - frame.height + 4.0;
        let above = factor_height(up).max(labels.top);
        room = room.union(Sides { top: above.max(overhang), ..labelled });
        // Title above everything
        if !panel.title.is_empty() {
            // What follows the first line of a title stands below it in plain type
            let (title, plain) = panel.title.split_once('\n').unwrap_or((&panel.title, ""));
            let wrapped = |text: &str, size: f64, bold: bool| {
                let lines = text::wrapped(text, size, bold, self.widest()).into_iter();
                lines.filter(|line| !line.is_empty()).map(move |line| (line, size, bold))
            };
            let lines: Vec<_> =
                wrapped(title, theme::TITLE_SIZE, true).chain(wrapped(plain, theme::NOTE_SIZE, false)).collect();
            let foot = above + 9.0;
            let top = foot + theme::TITLE_SIZE + LINE * (lines.len() - 1) as f64;
            for (i, (line, size, bold)) in lines.into_iter().rev().enumerate() {
                let at = [frame.centre()[0], frame.y - foot - LINE * i as f64];
                let title = Text::new(at, size, line);
                let title = if bold { title.bold() } else { title };
                let overhang = (title.width() - frame.width) / 2.0;
                drawing.text(title.held(Anchor::Middle, Level::Baseline));
                room = room.union(Sides { left: overhang, right: overhang, top, bottom: 0.0 });
            }
        }
        room
    }
}

/// Writes the lines of an axis title after its first, which ends at `at`; returns their height.
pub(super) fn further_lines(drawing: &mut Page, lines: &[String], [x, y]: Point) -> f64 {
    for (i, line) in lines.iter().enumerate().skip(1) {
        let text = Text::new([x, y + LINE * i as f64], theme::LABEL_SIZE, line.clone());
        drawing.text(text.held(Anchor::Middle, Level::Bottom));
    }
    LINE * lines.len().saturating_sub(1) as f64
}

/// Draws a frame with the ticks of both axes, their labels and titles, on those sides that have `room` for labels.
pub(super) fn draw_axes(
    drawing: &mut Page,
    frame: Rect,
    room: Sides,
    [x, y]: [&Ticks; 2],
    [x_title, y_title]: [&str; 2],
) {
    drawing.rect(frame, Paint::from(Stroke::solid(theme::INK, theme::THIN)));
    let mut chart = Canvas { drawing, frame, room, dash: theme::SOLID }.chart(x, y);
    // Labels are twice as far from the frame as plotters' ticks, which all have one length and are not shown
    let ink = style(theme::INK, false, theme::THIN);
    let font = |size: f64| TextStyle::from(("", pixels(size)).into_font()).color(&ink.color);
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(TRANSPARENT)
        .set_all_tick_mark_size(pixels((TICK + PAD) / 2.0))
        .set_tick_mark_size(LabelAreaPosition::Bottom, pixels((TICK + PAD + exponent_lift(x)) / 2.0))
        .label_style(font(theme::TICK_SIZE))
        .axis_desc_style(font(theme::LABEL_SIZE))
        .x_desc(x_title)
        .y_desc(y_title)
        .draw()
        .expect(NEVER);
    // Ticks stand on the side that has labels
    let tick = |at, [x, y]: Point| EmptyElement::at(at) + PathElement::new([(0, 0), (pixels(x), pixels(y))], ink);
    let (side, out) = if room.right > 0.0 { (1.0, 1.0) } else { (0.0, -1.0) };
    let across = lengths(x).map(|(at, length)| tick((at, 0.0), [0.0, length]));
    let up = lengths(y).map(|(at, length)| tick((side, at), [out * length, 0.0]));
    chart.draw_series(across.chain(up)).expect(NEVER);
}

/// The position and the length of each tick.
fn lengths(ticks: &Ticks) -> impl Iterator<Item = (f64, f64)> {
    let minor = ticks.minor.iter().map(|&at| (at, MINOR));
    minor.chain(ticks.major.iter().map(|tick| (tick.at, TICK)))
}

/// Writes the factor that all labels share, if there is one, and returns its width.
pub(super) fn draw_factor(drawing: &mut Page, ticks: &Ticks, at: Point, held: (Anchor, Level)) -> f64 {
    if ticks.exponent == 0 {
        return 0.0;
    }
    let markup = format!("×10^{{{}}}", super::axis::number(f64::from(ticks.exponent), 0));
    let text = Text::new(at, theme::TICK_SIZE, markup).held(held.0, held.1);
    let width = text.width();
    drawing.text(text);
    width
}

/// Height of ticks and their labels below a frame.
pub(super) fn below_ticks(ticks: &Ticks) -> f64 {
    TICK + PAD + exponent_lift(ticks) + theme::TICK_SIZE * (text::CAP_HEIGHT + text::DESCENT)
}

/// Width of ticks and their labels beside a frame.
pub(super) fn beside_ticks(ticks: &Ticks) -> f64 {
    let widths = ticks.major.iter().map(|tick| text::width(&tick.label, theme::TICK_SIZE, false));
    TICK + PAD + widths.fold(0.0, f64::max)
}

/// Height of the title of an axis with its distance from the ticks' labels.
pub(super) fn title_height(title: &str) -> f64 {
    if title.is_empty() { 0.0 } else { TITLE }
}

/// Height above the frame of the factor that all labels share.
pub(super) fn factor_height(ticks: &Ticks) -> f64 {
    if ticks.exponent == 0 { 0.0 } else { FACTOR_GAP + theme::TICK_SIZE * 1.1 }
}

/// Where each label of an x axis begins and ends.
fn ends(ticks: &Ticks, frame: &Rect) -> Vec<[f64; 2]> {
    let of = |tick: &Tick| {
        let centre = frame.x + frame.width * tick.at;
        let half = text::width(&tick.label, theme::TICK_SIZE, false) / 2.0;
        [centre - half, centre + half]
    };
    ticks.major.iter().map(of).collect()
}

/// Exponents rise above the capitals, so labels with them stand lower.
fn exponent_lift(ticks: &Ticks) -> f64 {
    if ticks.major.iter().any(|t| t.label.contains("^{")) { 0.18 * theme::TICK_SIZE } else { 0.0 }
}
