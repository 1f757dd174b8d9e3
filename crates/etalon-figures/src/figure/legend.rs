//! Legends, a sample of each mark beside its label, and which cells of a panel are occupied: labels and legends go only where
//! nothing is drawn.

use super::page::Page;
use super::panel::Mark;
use super::shapes::{Anchor, Colour, Level, Marker, Paint, Point, Rect, Stroke, Text};
use super::{text, theme};

const SAMPLE: f64 = 30.0;
const ROW: f64 = 17.5;
/// Height of a further line of a label.
const LINE: f64 = 14.5;
const PAD: f64 = 7.0;
const SAMPLE_GAP: f64 = 7.0;
const COLUMN_GAP: f64 = 20.0;

/// How a mark looks in the legend.
#[derive(Debug, Clone, PartialEq)]
enum Sample {
    Line(Stroke),
    Dot(Colour, Marker),
    Area { colour: Colour, outlined: bool },
}

/// The labels of a panel with their samples; marks under the same label share an entry.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Legend {
    entries: Vec<(String, Vec<Sample>)>,
    /// Width of the page, within which labels are broken.
    page: f64,
}

impl Legend {
    /// The legend of these marks, or none when none of them has a label.
    pub fn new(marks: &[Mark]) -> Option<Self> {
        let mut entries: Vec<(String, Vec<Sample>)> = Vec::new();
        for mark in marks.iter().filter(|mark| !mark.label().is_empty()) {
            let sample = match mark {
                Mark::Line { stroke, .. } => Sample::Line(*stroke),
                Mark::Dots { colour, marker, .. } => Sample::Dot(*colour, *marker),
                Mark::Band { colour, .. } => Sample::Area { colour: *colour, outlined: false },
                Mark::Bars { colour, .. } => Sample::Area { colour: *colour, outlined: true },
                Mark::Vertical { .. } | Mark::Horizontal { .. } | Mark::Shade { .. } | Mark::Note { .. } => continue,
            };
            match entries.iter_mut().find(|(label, _)| label == mark.label()) {
                Some((_, samples)) if samples.contains(&sample) => {}
                Some((_, samples)) => samples.push(sample),
                None => entries.push((mark.label().to_owned(), vec![sample])),
            }
        }
        (!entries.is_empty()).then_some(Self { entries, page: f64::INFINITY })
    }

    /// The legend without some of its labels, or none if no others are left.
    pub fn without(mut self, labels: &[String]) -> Option<Self> {
        self.entries.retain(|(label, _)| !labels.contains(label));
        (!self.entries.is_empty()).then_some(self)
    }

    /// The legend with labels broken so that an entry is no wider than this.
    pub fn within(self, page: f64) -> Self {
        Self { page, ..self }
    }

    fn lines(&self, label: &str) -> Vec<String> {
        text::wrapped(label, theme::NOTE_SIZE, false, self.page - SAMPLE - SAMPLE_GAP - 2.0 * PAD)
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// The columns for a legend as low as a width allows, and no more than its rows need; at least one.
    pub fn columns_within(&self, width: f64) -> usize {
        let most = (1..=self.len()).rev().find(|&columns| self.size(columns)[0] <= width).unwrap_or(1);
        self.len().div_ceil(self.len().div_ceil(most))
    }

    /// Width and height with entries in this many columns, filled row by row.
    pub fn size(&self, columns: usize) -> [f64; 2] {
        let widths = self.widths(columns);
        let width = widths.iter().sum::<f64>() + COLUMN_GAP * (widths.len() - 1) as f64 + 2.0 * PAD;
        [width, self.heights(columns).iter().sum::<f64>() + 2.0 * PAD - 3.0]
    }

    fn widths(&self, columns: usize) -> Vec<f64> {
        let mut widths = vec![0.0f64; columns];
        for (i, (label, _)) in self.entries.iter().enumerate() {
            for line in self.lines(label) {
                let width = SAMPLE + SAMPLE_GAP + text::width(&line, theme::NOTE_SIZE, false);
                widths[i % columns] = widths[i % columns].max(width);
            }
        }
        widths
    }

    fn heights(&self, columns: usize) -> Vec<f64> {
        let lines = |row: &[(String, Vec<Sample>)]| row.iter().map(|(label, _)| self.lines(label).len()).max();
        let height = |row| ROW + LINE * (lines(row).unwrap_or(1).max(1) - 1) as f64;
        self.entries.chunks(columns).map(height).collect()
    }

    /// Draws the entries with the legend's top left corner at `at`.
    pub fn draw(&self, drawing: &mut Page, at: Point, columns: usize) {
        let (widths, heights) = (self.widths(columns), self.heights(columns));
        for (i, (label, samples)) in self.entries.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let x = at[0] + PAD + widths[..column].iter().map(|w| w + COLUMN_GAP).sum::<f64>();
            let y = at[1] + PAD - 1.5 + heights[..row].iter().sum::<f64>() + 0.5 * ROW;
            for sample in samples {
                draw_sample(drawing, sample, [x, y]);
            }
            for (line, label) in self.lines(label).into_iter().enumerate() {
                let at = [x + SAMPLE + SAMPLE_GAP, y + LINE * line as f64];
                drawing.text(Text::new(at, theme::NOTE_SIZE, label).held(Anchor::Start, Level::Middle));
            }
        }
    }
}

fn draw_sample(drawing: &mut Page, sample: &Sample, [x, y]: Point) {
    match *sample {
        Sample::Line(stroke) => drawing.line([[x, y], [x + SAMPLE, y]], stroke),
        Sample::Dot(colour, marker) => drawing.marker([x + SAMPLE / 2.0, y], theme::DOT, marker, colour),
        Sample::Area { colour, outlined } => {
            let fill = Some(colour.faded(if outlined { 0.3 } else { 0.2 }));
            let stroke = outlined.then(|| Stroke::solid(colour, 1.2));
            drawing.rect(Rect::new(x, y - 5.0, SAMPLE, 10.0), Paint { fill, stroke });
        }
    }
}

/// Side of a cell in drawing units.
const CELL: f64 = 2.0;

/// A panel's frame divided into small cells, each taken or free. A cell that anything touches is taken, so what is
/// reported free is free.
#[derive(Clone)]
pub(super) struct Occupancy {
    frame: Rect,
    columns: usize,
    rows: usize,
    taken: Vec<bool>,
    /// Taken cells above and left of each corner, (rows + 1) x (columns + 1); made at the first query.
    sums: Option<Vec<u32>>,
}

impl Occupancy {
    pub fn new(frame: Rect) -> Self {
        let (columns, rows) = ((frame.width / CELL).ceil() as usize, (frame.height / CELL).ceil() as usize);
        Self { frame, columns, rows, taken: vec![false; columns * rows], sums: None }
    }

    /// Takes the cells under a line of the given width.
    pub fn add_line(&mut self, points: &[Point], width: f64) {
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let steps = ((b[0] - a[0]).hypot(b[1] - a[1]) / (CELL / 2.0)).ceil().clamp(1.0, 1e5) as usize;
            for i in 0..=steps {
                let t = i as f64 / steps as f64;
                let at = Rect::new(a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, 0.0, 0.0);
                self.add(&at.grown(width / 2.0));
            }
        }
    }

    pub fn add(&mut self, rect: &Rect) {
        self.sums = None;
        let [left, right, top, bottom] = self.cells(rect);
        if left >= right {
            // Outside, or nowhere at all.
            return;
        }
        for row in top..bottom {
            self.taken[row * self.columns + left..row * self.columns + right].fill(true);
        }
    }

    /// Whether `rect` lies within the frame and on no taken cell.
    pub fn is_free(&mut self, rect: &Rect) -> bool {
        let frame = self.frame;
        let inside =
            rect.x >= frame.x && rect.y >= frame.y && rect.right() <= frame.right() && rect.bottom() <= frame.bottom();
        if !inside {
            return false;
        }
        // Count the occupied cells under the rectangle in a summed-area table (Crow 1984)
        let [left, right, top, bottom] = self.cells(rect);
        let (columns, rows, taken) = (self.columns, self.rows, &self.taken);
        let sums = self.sums.get_or_insert_with(|| sums(columns, rows, taken));
        let at = |row: usize, column: usize| sums[row * (columns + 1) + column];
        at(bottom, right) + at(top, left) == at(bottom, left) + at(top, right)
    }

    pub fn first_free(&mut self, candidates: impl IntoIterator<Item = Rect>) -> Option<Rect> {
        candidates.into_iter().find(|rect| self.is_free(rect))
    }

    /// The free place for a box of this size that is nearest to `point`, at least `gap` and at most `reach` from it.
    pub fn nearest_free(&mut self, point: Point, [width, height]: [f64; 2], gap: f64, reach: f64) -> Option<Rect> {
        let steps =
            |extent: f64| (-((reach + extent) / CELL) as i32..=(reach / CELL) as i32).map(|i| f64::from(i) * CELL);
        let mut best: Option<(f64, Rect)> = None;
        for y in steps(height) {
            for x in steps(width) {
                let (dx, dy) = (x.max(-x - width).max(0.0), y.max(-y - height).max(0.0));
                let distance = dx.hypot(dy);
                // At equal distance the box that is centred beside or above the point looks best.
                let offset = (x + width / 2.0).abs().min((y + height / 2.0).abs());
                let (far, rect) = (distance + 0.05 * offset, Rect::new(point[0] + x, point[1] + y, width, height));
                let is_nearer = best.as_ref().is_none_or(|(least, _)| far < *least);
                if is_nearer && (gap..=reach).contains(&distance) && self.is_free(&rect) {
                    best = Some((far, rect));
                }
            }
        }
        best.map(|(_, rect)| rect)
    }

    /// First and last (exclusive) column and row that `rect` touches, cut to the frame.
    fn cells(&self, rect: &Rect) -> [usize; 4] {
        let index = |v: f64, count: usize| v.clamp(0.0, count as f64) as usize;
        [
            index(((rect.x - self.frame.x) / CELL).floor(), self.columns),
            index(((rect.right() - self.frame.x) / CELL).floor() + 1.0, self.columns),
            index(((rect.y - self.frame.y) / CELL).floor(), self.rows),
            index(((rect.bottom() - self.frame.y) / CELL).floor() + 1.0, self.rows),
        ]
    }
}

fn sums(columns: usize, rows: usize, taken: &[bool]) -> Vec<u32> {
    let mut sums = vec![0; (columns + 1) * (rows + 1)];
    for row in 0..rows {
        let mut line = 0;
        for column in 0..columns {
            line += u32::from(taken[row * columns + column]);
            sums[(row + 1) * (columns + 1) + column + 1] = sums[row * (columns + 1) + column + 1] + line;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(label: impl Into<String>) -> Mark {
        Mark::Line { label: label.into(), stroke: theme::series(0), points: Vec::new() }
    }

    #[test]
    fn marks_of_one_label_share_an_entry() {
        let dots = Mark::Dots { label: "a".into(), colour: theme::BLUE, marker: Marker::Disc, points: Vec::new() };
        let legend = Legend::new(&[line("a"), line("b"), line(""), dots, line("a")]).unwrap();
        assert_eq!((legend.len(), legend.entries[0].1.len()), (2, 2));
        assert_eq!(Legend::new(&[line("")]), None);
    }

    #[test]
    fn columns_fit_the_width() {
        let marks: Vec<Mark> = (0..6).map(|i| line(format!("series number {i}"))).collect();
        let legend = Legend::new(&marks).unwrap();
        for width in [10.0, 200.0, 400.0, 2000.0] {
            let columns = legend.columns_within(width);
            assert!(columns == 1 || legend.size(columns)[0] <= width);
        }
        assert_eq!(legend.columns_within(2000.0), 6);
        assert_eq!(legend.columns_within(legend.size(5)[0]), 3, "two even rows, not five and one");
    }

    #[test]
    fn a_diagonal_leaves_two_corners() {
        let mut space = Occupancy::new(Rect::new(100.0, 50.0, 200.0, 100.0));
        space.add_line(&[[100.0, 50.0], [300.0, 150.0]], 1.6);
        assert!(space.is_free(&Rect::new(200.0, 52.0, 98.0, 40.0)));
        assert!(space.is_free(&Rect::new(102.0, 105.0, 90.0, 40.0)));
        assert!(!space.is_free(&Rect::new(102.0, 52.0, 30.0, 30.0)));
        assert!(!space.is_free(&Rect::new(170.0, 60.0, 60.0, 60.0)), "the line crosses the middle of the box");
        assert!(!space.is_free(&Rect::new(250.0, 40.0, 40.0, 40.0)), "outside the frame");
    }

    #[test]
    fn the_nearest_place_is_beside_the_point() {
        let mut space = Occupancy::new(Rect::new(0.0, 0.0, 200.0, 100.0));
        space.add_line(&[[0.0, 50.0], [200.0, 50.0]], 1.0);
        let place = space.nearest_free([100.0, 50.0], [60.0, 12.0], 3.0, 60.0).unwrap();
        assert!((place.bottom() - 47.0).abs() <= 3.0 || (place.y - 53.0).abs() <= 3.0, "{place:?}");
        assert!((place.centre()[0] - 100.0).abs() <= 2.0, "{place:?}");
        space.add(&Rect::new(0.0, 0.0, 200.0, 100.0));
        assert_eq!(space.nearest_free([100.0, 50.0], [60.0, 12.0], 3.0, 60.0), None);
    }
}
