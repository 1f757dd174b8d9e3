//! Which cells of a panel are occupied: labels and legends go only where nothing is drawn.

use super::shapes::{Point, Rect};

/// Side of a cell in drawing units.
const CELL: f64 = 2.0;

/// A panel's frame divided into small cells, each taken or free. A cell that anything touches is taken, so what is
/// reported free is free.
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
        let mut candidates: Vec<(f64, Rect)> = Vec::new();
        for y in steps(height) {
            for x in steps(width) {
                let (dx, dy) = (x.max(-x - width).max(0.0), y.max(-y - height).max(0.0));
                let distance = dx.hypot(dy);
                // At equal distance the box that is centred beside or above the point looks best.
                let offset = (x + width / 2.0).abs().min((y + height / 2.0).abs());
                if (gap..=reach).contains(&distance) {
                    candidates.push((distance + 0.05 * offset, Rect::new(point[0] + x, point[1] + y, width, height)));
                }
            }
        }
        // Try the nearest first
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.first_free(candidates.into_iter().map(|(_, rect)| rect))
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
