//! A plot: panels in rows and columns, their frames aligned, with legends that cover no data.

use super::chart::{Chart, Parts};
use super::drawing::{Drawing, Keep};
use super::frame::Sides;
use super::heatmap::Heatmap;
use super::legend::Legend;
use super::page::{PIXELS, Page};
use super::panel::Panel;
use super::shapes::Text;
use super::style::Room;
use super::{text, theme};

/// Panels that make up one figure.
///
/// Curves have their names where they run, or a legend, never some of them this and others that. A legend goes into a corner of its panel
/// that is free of data, or else below the panel. Panels with the same legend share one below all of them, or below their row, and so do heat
/// maps of one scale with their colour bar; neighbours share the title of the y axis.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Plot {
    rows: Vec<Row>,
    frame: [f64; 2],
}

/// Panels side by side, under a heading (or none, when empty).
#[derive(Debug, Clone, PartialEq)]
struct Row {
    heading: String,
    panels: Vec<Panel>,
}

/// Space at the page's edge, and between panels.
const EDGE: f64 = 10.0;
const BETWEEN: f64 = 18.0;
/// From what stands below a frame to a legend below it.
const LEGEND_GAP: f64 = 6.0;
const HEADING: f64 = 24.0;
/// Longest colour bar of several heat maps.
const BAR: f64 = 420.0;
/// Smallest frame on a page of limited size.
const SMALLEST: [f64; 2] = [90.0, 70.0];
/// Largest height over width of a chart's frame on a page of limited width, where panels stand above each other.
const FLAT: f64 = 0.55;
/// Height of a place with a name.
const NAME: f64 = 18.0;
/// The least difference of what stands left of frames for which these are not in line.
const LONG_NAMES: f64 = 60.0;
/// The part of its own width that a frame keeps beside others.
const NARROWEST: f64 = 0.6;

impl Plot {
    /// Panels side by side.
    pub fn new(panels: impl Into<Vec<Panel>>) -> Self {
        let panels = panels.into();
        let frame = if panels.len() > 1 { [350.0, 265.0] } else { [460.0, 310.0] };
        Self { rows: vec![Row { heading: String::new(), panels }], frame }
    }

    /// Rows of panels, each row under a heading (or none, when empty).
    pub fn grid(rows: impl IntoIterator<Item = (String, Vec<Panel>)>) -> Self {
        let rows = rows.into_iter().map(|(heading, panels)| Row { heading, panels }).collect();
        Self { rows, frame: [350.0, 240.0] }
    }

    /// Sets the size of each panel's frame in drawing units; at least 60 and at most 4000 a side.
    pub fn frame_size(self, width: f64, height: f64) -> Self {
        Self { frame: [width, height].map(|v| if v.is_nan() { 60.0 } else { v.clamp(60.0, 4000.0) }), ..self }
    }

    pub fn draw(self) -> Drawing {
        Drawing::Plot(self)
    }

    pub(super) fn is_single(&self) -> bool {
        self.panels().count() == 1
    }

    /// The plot with another title of each panel.
    pub(super) fn titled(mut self, title: &str) -> Self {
        self.rows.iter_mut().flat_map(|row| &mut row.panels).for_each(|panel| panel.title = title.into());
        self
    }

    /// The panels whose title `keep` wants; the title of the y axis stands for that of a panel without one.
    pub(super) fn select(&self, groups: &[&str], keep: &mut Keep) -> Option<Self> {
        let name =
            |panel: &Panel| if panel.title.is_empty() { panel.y.label.clone() } else { panel.title.replace('\n', " ") };
        let rows = self.rows.iter().map(|row| {
            let mut is_kept = |panel: &&Panel| keep(&[groups, &[row.heading.as_str(), name(panel).as_str()]].concat());
            let panels = row.panels.iter().filter(&mut is_kept).cloned().collect();
            Row { panels, ..row.clone() }
        });
        let rows: Vec<Row> = rows.filter(|row| !row.panels.is_empty()).collect();
        (!rows.is_empty()).then_some(Self { rows, ..self.clone() })
    }

    /// The page for a room: as it was made, or in limited room with as many panels in a row as keep their frames large.
    pub(super) fn laid(&self, room: Room) -> Page {
        if room.width.is_infinite() {
            return self.page(&self.rows, self.frame, f64::INFINITY, true);
        }
        let most = if self.has_headings() { self.columns() } else { self.panels().count() };
        // As many as fit with frames large enough; on a page of fixed height, with the largest frames
        let score = |columns: usize, page: &Page, [width, height]: [f64; 2]| match () {
            () if page.width > room.width + 1.0 || page.height > room.height + 1.0 => -1.0,
            () if room.height.is_finite() => width.min(1.6 * height),
            () if width >= NARROWEST * self.frame[0] => columns as f64,
            () => 1.0 / columns as f64,
        };
        let candidate = |columns: usize| {
            let (page, frame, limit) = self.fitted(columns, room);
            (score(columns, &page, frame), columns, frame, limit)
        };
        let best = (1..=most.max(1)).map(candidate).max_by(|(a, ..), (b, ..)| a.total_cmp(b));
        let whole = |(_, columns, frame, limit)| self.page(&self.arranged(columns), frame, limit, true);
        best.map_or_else(|| Page::new(0.0, 0.0, PIXELS), whole)
    }

    /// The page with at most this many panels in a row, in frames as wide as the room allows and no higher, without lines to names of curves,
    /// which take long to find and may only make its legends smaller; the size of the frames, and the limit of titles.
    fn fitted(&self, columns: usize, room: Room) -> (Page, [f64; 2], f64) {
        let rows = self.arranged(columns);
        let columns = rows.iter().map(|row| row.panels.len()).max().unwrap_or(1).max(1) as f64;
        let cell = (room.width - 2.0 * EDGE - BETWEEN * (columns - 1.0)) / columns;
        let share = room.height / rows.len() as f64;
        let smallest = self.smallest(room);
        let mut frame = [cell, self.height_of(cell, share)];
        let limit = cell.max(SMALLEST[0]);
        let mut page = self.page(&rows, frame, limit, false);
        // What stands around the frames hardly depends on their size
        for _ in 0..8 {
            let [wide, high] = [page.width - room.width, page.height - room.height];
            if (wide <= 0.0 && high <= 0.0) || frame == smallest {
                break;
            }
            let width = (frame[0] - (wide / columns).max(0.0)).floor().max(smallest[0]);
            let height = self.height_of(width, frame[1] - (high / rows.len() as f64).max(0.0)).floor();
            // Images keep their shape
            let width = if self.is_map() { width.min(height * self.frame[0] / self.frame[1]) } else { width };
            frame = [width.max(smallest[0]), height.max(smallest[1])];
            page = self.page(&rows, frame, limit, false);
        }
        (page, frame, limit)
    }

    /// The smallest frame: of several on a slide, of which some may go to another one, not much smaller than it was made.
    fn smallest(&self, room: Room) -> [f64; 2] {
        let [width, height] = self.frame;
        match room.height.is_finite() && !self.is_single() {
            true => [SMALLEST[0].max(0.4 * width), SMALLEST[1].max(0.4 * height)],
            false => SMALLEST,
        }
    }

    /// The height of a frame of this width: in proportion, as high as the room where that is limited, and as the names beside it need.
    fn height_of(&self, width: f64, room: f64) -> f64 {
        let [natural, height] = self.frame;
        let places = self.panels().map(|panel| panel.y.places()).max().unwrap_or(0);
        let wanted = match () {
            () if self.is_map() => height * width / natural,
            () if room.is_finite() => room,
            () => (height * width / natural).min(FLAT * width).max(NAME * places as f64),
        };
        wanted.min(room)
    }

    fn is_map(&self) -> bool {
        self.panels().any(|panel| panel.heatmap.is_some())
    }

    /// Each row with its heading; a row that is alone in halves.
    pub(super) fn rows_apart(&self) -> Vec<Self> {
        let rows =
            if self.rows.len() > 1 { self.rows.clone() } else { self.arranged(self.columns().div_ceil(2).max(1)) };
        rows.into_iter().map(|row| Self { rows: vec![row], ..self.clone() }).collect()
    }

    pub(super) fn has_headings(&self) -> bool {
        self.rows.iter().any(|row| !row.heading.is_empty())
    }

    /// Panels in the longest row.
    fn columns(&self) -> usize {
        self.rows.iter().map(|row| row.panels.len()).max().unwrap_or(0)
    }

    /// The panels in rows of at most `columns`. Rows without headings are one sequence.
    fn arranged(&self, columns: usize) -> Vec<Row> {
        let all = |panels: Vec<Panel>| vec![Row { heading: String::new(), panels }];
        let rows = if self.has_headings() { self.rows.clone() } else { all(self.panels().cloned().collect()) };
        let parts = |row: Row| -> Vec<Row> {
            let part = |(i, panels): (usize, &[Panel])| {
                let heading = if i == 0 { row.heading.clone() } else { String::new() };
                Row { heading, panels: panels.to_vec() }
            };
            row.panels.chunks(columns).enumerate().map(part).collect()
        };
        rows.into_iter().flat_map(parts).collect()
    }

    /// A page of rows with frames of one size; titles and legends are broken within the width `limit`.
    fn page(&self, rows: &[Row], [width, height]: [f64; 2], limit: f64, leads: bool) -> Page {
        let bar = self.shared_bar();
        let is_named = |panel: &Panel| {
            let parts = Parts { legend: false, bar: false, names: true, leads };
            panel.names_curves && Chart::new(panel, [width, height], parts, limit).is_named
        };
        // Names and legends are not mixed in a row
        let of_row = |row: &Row| {
            let are_named = row.panels.iter().filter(|panel| panel.names_curves).all(is_named);
            row.panels.iter().map(|panel| panel.names_curves && are_named).collect()
        };
        let named: Vec<Vec<bool>> = rows.iter().map(of_row).collect();
        // Panels with the same legend share it, unless all of them name their curves
        let shared = |panels: Vec<&Panel>, are_named: bool| {
            let legends: Vec<Option<Legend>> = panels.iter().map(|panel| Legend::new(&panel.marks)).collect();
            let is_one = legends.len() > 1 && legends.windows(2).all(|pair| pair[0] == pair[1]);
            if is_one && !are_named { legends[0].clone() } else { None }
        };
        let are_all = |named: &[bool]| named.iter().all(|is_named| *is_named);
        let legend = shared(rows.iter().flat_map(|row| &row.panels).collect(), named.iter().all(|row| are_all(row)));
        let of_rows: Vec<Option<Legend>> = rows
            .iter()
            .zip(&named)
            .map(|(row, named)| match legend {
                Some(_) => None,
                None => shared(row.panels.iter().collect(), are_all(named)),
            })
            .collect();
        let draw_row = |(number, row): (usize, &Row), width: f64| -> Vec<Chart> {
            let shares = legend.is_some() || of_rows[number].is_some();
            let draw = |(column, panel): (usize, &Panel)| {
                let next = row.panels.get(column + 1);
                let is_shared = |map: &Heatmap| {
                    next.and_then(|panel| panel.heatmap.as_ref()).is_some_and(|next| next.has_scale_of(map))
                };
                let has_own = Parts {
                    legend: !shares,
                    bar: bar.is_none() && !panel.heatmap.as_ref().is_some_and(is_shared),
                    names: !shares && named[number][column],
                    leads,
                };
                // Names of places and titles of axes stand once in a row
                let mut panel = panel.clone();
                if let Some(before) = column.checked_sub(1).map(|before| &row.panels[before]) {
                    panel.y = panel.y.without_names_of(&before.y);
                    // Maps are larger without the same numbers between them
                    if panel.heatmap.is_some() && before.heatmap.is_some() {
                        panel.y = panel.y.without_numbers_of(&before.y);
                    }
                }
                let is_narrow = limit.is_finite() && row.panels.len() > 1;
                let mut chart = chart(&panel, [width, height], has_own, limit, is_narrow);
                chart.legend_below([width, height], limit);
                chart
            };
            row.panels.iter().enumerate().map(draw).collect()
        };
        let charts: Vec<Vec<Chart>> = rows.iter().enumerate().map(|row| draw_row(row, width)).collect();
        // Frames line up: those of a column share what is left and right of them, those of a row what is above and below
        let count = charts.iter().map(Vec::len).max().unwrap_or(0);
        let around = |charts: &mut dyn Iterator<Item = &Chart>| {
            charts.fold(Sides::default(), |sides, chart| sides.union(chart.room))
        };
        let columns: Vec<Sides> =
            (0..count).map(|column| around(&mut charts.iter().filter_map(|row| row.get(column)))).collect();
        // Below each other on a page of limited size, frames take the room of long names that stand beside others only
        let names = columns.first().map_or(0.0, |column| column.left);
        let lefts = charts.iter().filter_map(|row| Some(row.first()?.room.left));
        let usual = lefts.filter(|left| *left < names - LONG_NAMES).fold(0.0, f64::max);
        let is_usual = |chart: &Chart| count == 1 && limit.is_finite() && chart.room.left <= usual;
        let widened = |(row, charts): ((usize, &Row), Vec<Chart>)| match charts.first() {
            Some(first) if is_usual(first) => draw_row(row, width + names - usual),
            _ => charts,
        };
        let charts: Vec<Vec<Chart>> = rows.iter().enumerate().zip(charts).map(widened).collect();
        let mut page = Page::new(0.0, 0.0, PIXELS);
        let mut y = EDGE;
        let whole = columns.iter().map(|column| (column.left + width + column.right + BETWEEN).ceil()).sum::<f64>()
            - BETWEEN
            + 2.0 * EDGE;
        for ((charts, Row { heading, .. }), of_row) in charts.into_iter().zip(rows).zip(&of_rows) {
            if !heading.is_empty() {
                for line in text::wrapped(heading, theme::TITLE_SIZE, true, limit * count as f64) {
                    let text = Text::new([EDGE, y + theme::TITLE_SIZE], theme::TITLE_SIZE, line).bold();
                    page.width = page.width.max(text.width() + 2.0 * EDGE);
                    page.text(text);
                    y += HEADING;
                }
            }
            let room = around(&mut charts.iter());
            let mut x = EDGE;
            for (chart, column) in charts.into_iter().zip(&columns) {
                let (left, width) = (if is_usual(&chart) { usual } else { column.left }, chart.drawing.width);
                page.append(chart.drawing, (x + left).round(), (y + room.top).round());
                x += (left + width + column.right + BETWEEN).ceil();
            }
            page.width = page.width.max(x - BETWEEN + EDGE);
            y += (room.top + height + room.bottom + BETWEEN).ceil();
            if let Some(legend) = of_row {
                let legend = legend.clone().within(whole - 2.0 * EDGE);
                let columns = legend.columns_within(whole - 2.0 * EDGE);
                let [w, h] = legend.size(columns);
                legend.draw(&mut page, [((whole - w) / 2.0).max(EDGE), y - BETWEEN + LEGEND_GAP], columns);
                page.width = page.width.max(w + 2.0 * EDGE);
                y += (LEGEND_GAP + h).ceil();
            }
        }
        page.width = page.width.max(2.0 * EDGE).ceil();
        page.height = (y - BETWEEN + EDGE).max(2.0 * EDGE).ceil();

        // What all panels share goes below them
        if let Some(legend) = legend {
            let legend = legend.within(page.width - 2.0 * EDGE);
            let columns = legend.columns_within(page.width - 2.0 * EDGE);
            let [w, h] = legend.size(columns);
            let at = [(page.width - w) / 2.0, page.height - EDGE + LEGEND_GAP];
            legend.draw(&mut page, at, columns);
            page.height = (page.height + LEGEND_GAP + h).ceil();
        }
        match bar {
            Some(map) => {
                let bar = map.lying_bar(BAR.min(page.width - 2.0 * EDGE), limit * count as f64);
                Page::stacked(vec![page, bar], 0.5)
            }
            None => page,
        }
    }

    fn panels(&self) -> impl Iterator<Item = &Panel> {
        self.rows.iter().flat_map(|row| &row.panels)
    }

    /// A heat map whose colour bar serves all panels, if there are several and all have the same scale.
    fn shared_bar(&self) -> Option<&Heatmap> {
        let mut maps = self.panels().map(|panel| panel.heatmap.as_ref());
        let first = maps.next()??;
        let same = maps.all(|map| map.is_some_and(|map| map.has_scale_of(first)));
        (self.panels().count() > 1 && same).then_some(first)
    }
}

/// A panel drawn. On a page of limited size a colour bar whose label is longer than the frame is high goes below it, and so do those of maps
/// beside others, which are larger then.
fn chart(panel: &Panel, [width, height]: [f64; 2], has_own: Parts, limit: f64, is_narrow: bool) -> Chart {
    let is_long = |map: &&Heatmap| limit.is_finite() && text::width(&map.label, theme::LABEL_SIZE, false) > height;
    let lying = panel.heatmap.as_ref().filter(|map| has_own.bar && (is_narrow || is_long(map)));
    let has_own = Parts { bar: has_own.bar && lying.is_none(), ..has_own };
    let mut chart = Chart::new(panel, [width, height], has_own, limit);
    if let Some(map) = lying {
        let bar = map.lying_bar(width, limit);
        chart.below(bar, [width, height], limit);
    }
    chart
}

impl Chart {
    /// Puts a legend that found no free place inside the frame below it.
    fn legend_below(&mut self, frame: [f64; 2], limit: f64) {
        let Some(legend) = self.legend.take() else { return };
        let columns = legend.columns_within(frame[0] + 0.5 * self.room.left);
        let [w, h] = legend.size(columns);
        let mut page = Page::new(w, h, PIXELS);
        legend.draw(&mut page, [0.0, 0.0], columns);
        self.below(page, frame, limit);
    }

    /// Adds something below the frame: in its middle, or further to the left where a room that is limited leaves none to the right.
    fn below(&mut self, page: Page, [width, height]: [f64; 2], limit: f64) {
        let right =
            if limit.is_finite() { limit - self.room.left.max(0.5 * (page.width - width)) - width } else { 0.0 };
        let x = (0.5 * (width - page.width)).min(width + self.room.right.max(right) - page.width);
        let y = height + self.room.bottom + LEGEND_GAP;
        let bottom = self.room.bottom + LEGEND_GAP + page.height;
        let sides = Sides { left: -x, right: x + page.width - width, bottom, top: 0.0 };
        self.room = self.room.union(sides);
        self.drawing.append(page, x, y);
    }
}

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::super::heatmap::{Heatmap, Shading};
    use super::super::page::Item;
    use super::super::shapes::{Point, Rect, Text};
    use super::*;

    /// The box around a text's capitals and descenders.
    fn bounds(t: &Text) -> Rect {
        let along = t.start();
        let (top, height) = (t.drop() - t.size * text::CAP_HEIGHT, t.size * (text::CAP_HEIGHT + text::DESCENT));
        let [x, y] = t.at;
        if t.upwards {
            Rect::new(x + top, y - along - t.width(), height, t.width())
        } else {
            Rect::new(x + along, y + top, t.width(), height)
        }
    }

    fn texts(page: &Page) -> Vec<&Text> {
        page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None }).collect()
    }

    /// Nothing is cut off, and no text lies on another or on the data.
    fn assert_sound(page: &Page) {
        let sheet = Rect::new(0.0, 0.0, page.width, page.height);
        let boxes: Vec<(Rect, &str)> = texts(page).into_iter().map(|t| (bounds(t), t.markup.as_str())).collect();
        let overlap = |a: &Rect, b: &Rect| a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
        for (i, (a, what)) in boxes.iter().enumerate() {
            let inside = a.x >= 0.0 && a.y >= 0.0 && a.right() <= sheet.right() && a.bottom() <= sheet.bottom();
            assert!(inside, "{what:?} at {a:?} leaves the page {sheet:?}");
            for (b, other) in &boxes[..i] {
                assert!(!overlap(a, b), "{what:?} lies on {other:?}");
            }
        }
        for item in &page.items {
            let Item::Path { points, paint, .. } = item else { continue };
            if paint.stroke.is_some_and(|stroke| stroke.width == theme::LINE) {
                for pair in points.windows(2) {
                    for i in 0..=20 {
                        let at = [0, 1].map(|k| pair[0][k] + (pair[1][k] - pair[0][k]) * f64::from(i) / 20.0);
                        let dot = Rect::new(at[0], at[1], 1e-9, 1e-9);
                        assert!(boxes.iter().all(|(b, _)| !overlap(b, &dot)), "a curve crosses a text at {at:?}");
                    }
                }
            }
        }
    }

    fn wave(k: usize) -> Vec<Point> {
        let height = |x: f64| 0.5 + 0.48 * (x * (1.0 + 0.3 * k as f64) + k as f64).sin();
        (0..300).map(|i| f64::from(i) / 30.0).map(|x| [x, height(x)]).collect()
    }

    #[test]
    fn nothing_collides_however_crowded() {
        for curves in 1..=8 {
            let axes = (Axis::linear("time (s)"), Axis::linear("/{E}_{0} (10^{−3} W)").range(0.0, 1.0));
            let mut panel = Panel::new(axes.0, axes.1).title("A title that is wider than the narrow frame below it");
            for k in 0..curves {
                panel = panel.line(format!("series {k}"), theme::series(k), wave(k));
            }
            panel = panel.vertical(3.3, "first rule").vertical(3.5, "second").vertical(9.9, "/{θ}_{B} = 55.41°");
            panel = panel.horizontal(0.5, "half").horizontal(0.52, "a little more").note(
                [5.0, 0.5],
                "slope −1/2",
                theme::INK,
            );
            let other = Panel::new(Axis::log("/{n}"), Axis::linear("").range(-3e-7, 2e6));
            let other = other.dots("dots", theme::GREEN, [[1e-9, 1.0]]);
            let both = [panel.clone(), other];
            for plot in [
                Plot::new([panel]),
                Plot::new(both.clone()),
                Plot::grid(both.map(|panel| (String::new(), vec![panel]))),
            ] {
                assert_sound(&plot.laid(Room::UNLIMITED));
                assert_sound(&plot.frame_size(150.0, 120.0).laid(Room::UNLIMITED));
            }
        }
    }

    #[test]
    fn long_labels_fit_on_the_page() {
        let x = Axis::linear("an axis label far wider than its frame").range(0.0, 1e7);
        let y = Axis::linear("another one, higher than its frame").range(0.0, 3e-9);
        let panel = Panel::new(x, y).line("", theme::series(0), [[0.0, 0.0], [1e7, 3e-9]]);
        let panel = panel.vertical(5e6, "1").horizontal(1e-9, "h");
        assert_sound(&Plot::new([panel.clone()]).frame_size(130.0, 100.0).laid(Room::UNLIMITED));
        assert_sound(&Plot::new([panel]).frame_size(700.0, 500.0).laid(Room::UNLIMITED));
        // A label too long for any place is not lost.
        let endless = "long ".repeat(300);
        let panel = Panel::new(Axis::linear("").range(0.0, 1.0), Axis::linear("").range(0.0, 1.0));
        let panel = panel.vertical(0.5, endless.clone()).horizontal(0.5, endless.clone());
        let page = Plot::new([panel]).laid(Room::UNLIMITED);
        assert_eq!(texts(&page).iter().filter(|t| t.markup == endless).count(), 2);
    }

    #[test]
    fn odd_data_are_drawn_somehow() {
        let odd = [f64::NAN, f64::INFINITY, -1e300, -1.0, 0.0, 5e-324, 1e-300, 1.0, 1e300, f64::MAX];
        for x in odd {
            for y in odd {
                for axis in [Axis::linear, Axis::log] {
                    let panel = Panel::new(axis("x"), axis("y"))
                        .line("a", theme::series(0), [[x, y], [y, x], [1.0, 2.0]])
                        .dots("b", theme::BLUE, [[x, y]])
                        .band("c", theme::BLUE, [[x, y, 1.0], [1.0, x, y], [2.0, 1.0, y]])
                        .bars("d", theme::BLUE, vec![x, y, 1.0], vec![y, x, 3.0])
                        .vertical(x, "v")
                        .horizontal(y, "h")
                        .note([x, y], "n", theme::INK);
                    let page = Plot::new([panel]).frame_size(100.0, 80.0).laid(Room::UNLIMITED);
                    assert!(page.width < 2000.0 && page.height < 2000.0, "{x} {y}");
                }
            }
        }
        assert!(Plot::new([]).laid(Room::UNLIMITED).png().is_ok());
    }

    #[test]
    fn panels_with_the_same_legend_share_it() {
        let panel = || Panel::new(Axis::linear("x"), Axis::linear("y")).line("only once", theme::series(0), wave(0));
        let count = |plot: Plot| texts(&plot.laid(Room::UNLIMITED)).iter().filter(|t| t.markup == "only once").count();
        assert_eq!(count(Plot::new([panel(), panel()])), 1);
        assert_eq!(count(Plot::new([panel(), panel().line("more", theme::series(1), wave(1))])), 2);
    }

    #[test]
    fn all_curves_of_a_panel_have_names_where_they_run_or_none() {
        let panel = |heights: [f64; 3]| {
            let axes = (Axis::linear("x").range(0.0, 1.0), Axis::linear("y").range(0.0, 1.0));
            let panel = Panel::new(axes.0, axes.1).with_names_on_curves();
            heights
                .into_iter()
                .enumerate()
                .fold(panel, |panel, (i, y)| panel.line(format!("curve {i}"), theme::series(i), [[0.0, y], [1.0, y]]))
        };
        let parts = Parts { legend: true, bar: true, names: true, leads: true };
        let is_named = |heights| Chart::new(&panel(heights), [300.0, 200.0], parts, f64::INFINITY).is_named;
        assert!(is_named([0.2, 0.5, 0.8]));
        // Two curves that coincide: nobody could tell which of them a name is of
        assert!(!is_named([0.2, 0.8, 0.8]));
        let names = |plot: Plot| {
            let page = plot.laid(Room::UNLIMITED);
            texts(&page).iter().filter(|t| t.markup.starts_with("curve")).map(|t| t.at).collect::<Vec<_>>()
        };
        let legend = names(Plot::new([panel([0.2, 0.8, 0.8])]));
        assert_eq!(legend.len(), 3, "all are in the legend");
        assert_eq!(names(Plot::new([panel([0.2, 0.5, 0.8]), panel([0.2, 0.8, 0.8])])).len(), 3, "a row shares it");
    }

    #[test]
    fn heat_maps_stand_with_their_colour_bars() {
        let map = Heatmap::new(2, vec![1e-8, 2e-8, f64::NAN, 5e-8], Shading::Linear, "density (1/sr)");
        let panel = Panel::new(Axis::linear("/{φ} (°)").range(0.0, 360.0), Axis::linear("/{θ} (°)").range(180.0, 0.0));
        let panel = panel.title("Observed").heatmap(map);
        let page = Plot::new([panel.clone(), panel.clone()]).frame_size(200.0, 100.0).laid(Room::UNLIMITED);
        assert_sound(&page);
        let images = |page: &Page| page.items.iter().filter(|item| matches!(item, Item::Image { .. })).count();
        assert_eq!(images(&page), 3, "two maps of one scale share a colour bar");
        let other = Heatmap::new(2, vec![0.0, 1.0], Shading::Linear, "density (1/sr)");
        let other = Panel::new(Axis::linear("x"), Axis::linear("y")).heatmap(other);
        let page = Plot::new([panel, other]).frame_size(200.0, 100.0).laid(Room::UNLIMITED);
        assert_sound(&page);
        assert_eq!(images(&page), 4);
    }

    #[test]
    fn frames_of_a_grid_line_up() {
        let panel = |label: &str| Panel::new(Axis::linear("x").range(0.0, 1.0), Axis::linear(label).range(0.0, 1.0));
        let rows = [("First", vec![panel("a label"), panel("")]), ("", vec![panel(""), panel("y")])];
        let page = Plot::grid(rows.map(|(heading, panels)| (heading.to_owned(), panels))).laid(Room::UNLIMITED);
        assert_sound(&page);
        let frame = |item: &Item| if let Item::Rect { rect, .. } = item { Some(*rect) } else { None };
        let frames: Vec<Rect> = page.items.iter().filter_map(frame).collect();
        assert_eq!(frames.len(), 4);
        assert_eq!((frames[0].x, frames[1].x), (frames[2].x, frames[3].x));
        assert_eq!((frames[0].y, frames[2].y), (frames[1].y, frames[3].y));
    }

    #[test]
    fn named_places_and_every_marker_are_drawn() {
        let axis = Axis::named("", ["light", "bsdf"].map(str::to_owned));
        let panel = Panel::new(Axis::log("x"), axis).dots("", theme::BLUE, [[1.0, 0.5], [20.0, 1.5]]);
        let panel = (0..5).fold(panel, |panel, i| {
            let points = [[f64::from(i) + 1.0, 1.0], [f64::from(i) + 2.0, 1.2]];
            panel.dotted_line(format!("{i}"), theme::series(i as usize), points)
        });
        let page = Plot::new([panel]).laid(Room::UNLIMITED);
        assert_sound(&page);
        let light = texts(&page).into_iter().find(|t| t.markup == "light").unwrap().at[1];
        let bsdf = texts(&page).into_iter().find(|t| t.markup == "bsdf").unwrap().at[1];
        assert!(light < bsdf, "the first name stands at the top");
    }
}
