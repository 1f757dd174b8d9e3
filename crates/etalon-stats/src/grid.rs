//! Cells: rectangles of a domain's chart, in rows, each row with columns of its own.

/// A rectangle of the chart.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Cell {
    /// Its ends along the first axis.
    pub x: [f64; 2],
    /// Its ends along the second axis.
    pub y: [f64; 2],
}

impl Cell {
    /// The whole chart.
    pub const WHOLE: Self = Self { x: [0.0, 1.0], y: [0.0, 1.0] };

    /// The place in it at coordinates from −1 to 1.
    #[inline]
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let along = |[from, to]: [f64; 2], v: f64| 0.5 * (from + to) + 0.5 * (to - from) * v;
        [along(self.x, x), along(self.y, y)]
    }

    /// Its area in the chart: the share of the domain's measure.
    #[must_use]
    pub fn area(&self) -> f64 {
        (self.x[1] - self.x[0]) * (self.y[1] - self.y[0])
    }
}

/// A partition of a rectangle of the chart: rows along x, and each row's columns along y.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Grid {
    rows: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Number of the first cell of each row.
    first: Vec<usize>,
}

impl Grid {
    /// Edges of rows, and of every row's columns: ascending, at least two each.
    fn new(rows: Vec<f64>, columns: Vec<Vec<f64>>) -> Self {
        let first = columns
            .iter()
            .scan(0, |next, edges| {
                let first = *next;
                *next += edges.len() - 1;
                Some(first)
            })
            .collect();
        Self { rows, columns, first }
    }

    /// Cells of equal area over the whole chart.
    #[must_use]
    pub fn equal([rows, columns]: [usize; 2], snap: Option<usize>) -> Self {
        let edges = |n: usize, snap| tidy((1..n).map(|i| i as f64 / n as f64), [0.0, 1.0], snap);
        let rows = edges(rows, snap);
        let columns = vec![edges(columns, None); rows.len() - 1];
        Self::new(rows, columns)
    }

    /// Cells of `within` that hold about equally many of the chart coordinates `places`: narrow where these are dense.
    ///
    /// `snap` = n lets rows end at multiples of 1/n only, where there are no points between them.
    #[must_use]
    pub fn adapted(places: &[[f64; 2]], [rows, columns]: [usize; 2], within: Cell, snap: Option<usize>) -> Self {
        let mut places = places.to_vec();
        places.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let xs: Vec<f64> = places.iter().map(|p| p[0]).collect();
        let edges = tidy(quantiles(&xs, rows), within.x, snap);
        let columns = edges
            .windows(2)
            .map(|row| {
                let of_row = xs.partition_point(|&x| x < row[0])..xs.partition_point(|&x| x < row[1]);
                let mut ys: Vec<f64> = places[of_row].iter().map(|p| p[1]).collect();
                ys.sort_by(f64::total_cmp);
                tidy(quantiles(&ys, columns), within.y, None)
            })
            .collect();
        Self::new(edges, columns)
    }

    /// The rows of this grid, then those of `next`, which starts where this one ends.
    #[must_use]
    pub(crate) fn followed_by(self, next: Self) -> Self {
        Self::new([&self.rows[..], &next.rows[1..]].concat(), [self.columns, next.columns].concat())
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.iter().map(|edges| edges.len() - 1).sum()
    }

    /// Always false: a grid has at least one cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The ends of the rows, and of each row's columns.
    pub(crate) fn ends(&self) -> (&[f64], &[Vec<f64>]) {
        (&self.rows, &self.columns)
    }

    /// The number of the cell in that column of a row.
    pub(crate) fn number(&self, row: usize, column: usize) -> usize {
        self.first[row] + column
    }

    /// The cells, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.rows.windows(2).zip(&self.columns).flat_map(|(row, columns)| {
            columns.windows(2).map(|column| Cell { x: [row[0], row[1]], y: [column[0], column[1]] })
        })
    }

    /// The grid's rows and, where all rows have the same columns, its columns; each with the numbers of its cells.
    pub(crate) fn strips(&self) -> Vec<(Cell, Vec<usize>)> {
        let (n, ends) = (self.rows.len() - 1, |edges: &[f64]| [edges[0], edges[edges.len() - 1]]);
        let of_row = |row: usize| {
            let columns = &self.columns[row];
            let cell = Cell { x: [self.rows[row], self.rows[row + 1]], y: ends(columns) };
            (cell, (self.first[row]..self.first[row] + columns.len() - 1).collect())
        };
        let of_column = |column: usize| {
            let cell = Cell { x: ends(&self.rows), y: [self.columns[0][column], self.columns[0][column + 1]] };
            (cell, self.first.iter().map(|first| first + column).collect())
        };
        let aligned = self.columns.iter().all(|columns| *columns == self.columns[0]);
        let columns = if aligned { self.columns[0].len() - 1 } else { 0 };
        (0..n).map(of_row).chain((0..columns).map(of_column)).collect()
    }

    /// The number of the cell at chart coordinates.
    #[inline]
    #[must_use]
    pub fn find(&self, [x, y]: [f64; 2]) -> usize {
        let row = interval(&self.rows, x);
        self.first[row] + interval(&self.columns[row], y)
    }

    /// The same cells, cut where they are far wider than a neighbour: see [`graded`].
    #[must_use]
    pub(crate) fn graded(&self) -> Self {
        let (mut rows, mut columns) = (vec![self.rows[0]], Vec::new());
        for (xs, ys) in graded(&self.rows).iter().zip(&self.columns) {
            let mut edges = vec![ys[0]];
            graded(ys).iter().for_each(|inner| edges.extend(&inner[1..]));
            rows.extend(&xs[1..]);
            columns.extend(std::iter::repeat_n(edges, xs.len() - 1));
        }
        Self::new(rows, columns)
    }
}

/// The number of the interval between ascending `edges` that `at` is in; the first or last if it is in none.
#[inline]
fn interval(edges: &[f64], at: f64) -> usize {
    let last = edges.len() - 2;
    // Intervals of equal length need no search.
    let guess = (at - edges[0]) * (last + 1) as f64 / (edges[last + 1] - edges[0]);
    let guess = (guess as usize).min(last);
    if edges[guess] <= at && at < edges[guess + 1] {
        guess
    } else {
        edges[1..=last].partition_point(|&edge| edge <= at)
    }
}

/// Ascending edges from `from` to `to` through those of `inner` that lie strictly between, without repetition.
fn tidy(inner: impl Iterator<Item = f64>, [from, to]: [f64; 2], snap: Option<usize>) -> Vec<f64> {
    let mut edges = vec![from];
    for edge in inner {
        let edge = snap.map_or(edge, |n| (edge * n as f64).round() / n as f64);
        if edge > edges[edges.len() - 1] && edge < to {
            edges.push(edge);
        }
    }
    edges.push(to);
    edges
}

/// What parts sorted values into `parts` groups of equal size: midpoints between neighbours.
fn quantiles(sorted: &[f64], parts: usize) -> impl Iterator<Item = f64> + '_ {
    (1..parts).filter_map(move |i| {
        let next = i * sorted.len() / parts;
        let (before, after) = (sorted.get(next.checked_sub(1)?)?, sorted.get(next)?);
        Some(0.5 * (before + after))
    })
}

/// Splits each interval that is far wider than a neighbour at geometrically growing distances from it.
///
/// The density that made the neighbour narrow extends beyond the edge at the neighbour's scale, which the nodes of a wide
/// interval would miss.
fn graded(edges: &[f64]) -> Vec<Vec<f64>> {
    const RATIO: f64 = 4.0;
    let widths: Vec<f64> = edges.windows(2).map(|e| e[1] - e[0]).collect();
    (0..widths.len())
        .map(|i| {
            let (from, to, half) = (edges[i], edges[i + 1], 0.5 * widths[i]);
            let steps = |neighbour: Option<&f64>| {
                let first = neighbour.map_or(f64::INFINITY, |w| w * RATIO);
                std::iter::successors(Some(first), |d| Some(d * RATIO)).take_while(|d| *d < half).collect::<Vec<_>>()
            };
            let left = steps(i.checked_sub(1).map(|i| &widths[i]));
            let right = steps(widths.get(i + 1));
            tidy(left.iter().map(|d| from + d).chain(right.iter().rev().map(|d| to - d)), [from, to], None)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_in_the_cell_that_is_found() {
        let places: Vec<[f64; 2]> = (0..1000u32)
            .map(|i| [f64::from(i) / 1000.0, f64::from(i * 618 % 1000) / 1000.0])
            .map(|[x, y]| [x.powi(20), 0.5 + 1e-6 * y])
            .collect();
        for grid in [Grid::equal([7, 5], None), Grid::adapted(&places, [7, 5], Cell::WHOLE, None)] {
            let cells: Vec<Cell> = grid.cells().collect();
            assert_eq!((cells.len(), grid.len()), (35, 35));
            assert!((cells.iter().map(Cell::area).sum::<f64>() - 1.0).abs() < 1e-12);
            for [x, y] in places.iter().copied().chain([[0.0, 0.0], [1f64.next_down(); 2]]) {
                let Cell { x: [x0, x1], y: [y0, y1] } = cells[grid.find([x, y])];
                assert!(x0 <= x && x < x1 && y0 <= y && y < y1);
            }
        }
        let grid = Grid::adapted(&places, [7, 5], Cell::WHOLE, None);
        let mut counts = [0; 35];
        places.iter().for_each(|&p| counts[grid.find(p)] += 1);
        assert!(counts.iter().all(|n| (25..=32).contains(n)), "{counts:?}");
    }

    #[test]
    fn edges_of_a_finite_set_fall_between_its_points() {
        let grid = Grid::equal([4, 1], Some(6));
        let edges: Vec<f64> = grid.cells().map(|c| c.x[1] * 6.0).collect();
        assert_eq!(edges, [2.0, 3.0, 5.0, 6.0]);
        // Half of the points are one outcome: its quantiles are the same edge.
        let places = [[0.25, 0.5], [0.25, 0.5], [0.25, 0.5], [0.75, 0.5]];
        assert_eq!(Grid::adapted(&places, [4, 1], Cell::WHOLE, Some(2)).len(), 2);
    }

    #[test]
    fn wide_cells_grow_away_from_narrow_ones() {
        let grid = Grid::adapted(&[[1e-6, 0.5], [3e-6, 0.5]], [2, 1], Cell::WHOLE, None).graded();
        let cells: Vec<Cell> = grid.cells().collect();
        assert!(cells.len() > 6 && (cells.iter().map(Cell::area).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(cells.windows(2).all(|p| p[1].area() < 20.0 * p[0].area()));
        assert!(cells.iter().enumerate().all(|(i, at)| grid.find([0.5 * (at.x[0] + at.x[1]), 0.5]) == i));
    }
}
