//! Sums over the rectangles between declared lines, on each of which a density is constant: exact integrals.

use super::shares::{Shares, met};
use super::{Integrals, InvalidPdf, first_invalid};
use crate::domain::Domain;
use crate::error::{Cancelled, Result, poll};
use crate::extremes::Extremes;
use crate::grid::{Parts, Subdivision, subdivided};
use crate::parallel::each;
use crate::sampler::Density;

/// Values asked for at a time: enough for a density in another process.
const POINTS: usize = 1 << 12;
/// Values summed at a time: many more than there are parts, and in few enough batches to fit into memory.
const VALUES: usize = 1 << 17;
const BATCHES: usize = 64;

/// Part numbers, and how much of each interval between lines they hold.
type Overlaps = Vec<Vec<(usize, f64)>>;

/// How the intervals between `lines` share out to those between `ends`.
fn overlaps(lines: &[f64], ends: &[f64]) -> Overlaps {
    let of = |line: &[f64]| -> Vec<(usize, f64)> {
        let part = |part: usize| (part, line[1].at_most(ends[part + 1]) - line[0].at_least(ends[part]));
        met(ends, [line[0], line[1]]).map(part).filter(|(_, length)| *length > 0.0).collect()
    };
    lines.windows(2).map(of).collect()
}

/// The integrals over the cells and over the parts of `subdivision`.
pub(super) fn sums(
    domain: &dyn Domain,
    density: &dyn Density,
    subdivision: &Subdivision,
    steps: &[Vec<f64>; 2],
    cancelled: Cancelled,
) -> Result<(Integrals, Shares)> {
    let [xs, ys] = [0, 1].map(|axis| [&[0.0], &steps[axis][..], &[1.0]].concat());
    let (rows, columns) = (xs.len() - 1, ys.len() - 1);

    // For each interval along x, the parts of the axis and the rows of parts of cells; of each along y, the parts of the
    // axis and, for each row of the grid, the columns of parts of cells.
    let side = 1 << subdivision.depth;
    let (row_ends, column_ends) = subdivision.grid.ends();
    let mut in_rows = overlaps(&xs, &subdivided(row_ends, side));
    let in_columns: Vec<Overlaps> = column_ends.iter().map(|ends| overlaps(&ys, &subdivided(ends, side))).collect();
    let mut along: Vec<Overlaps> =
        subdivision.axes.iter().zip([&xs, &ys]).map(|(axis, lines)| overlaps(lines, &axis.ends())).collect();
    if let Some(outcomes) = domain.outcomes() {
        // An outcome belongs to one part as a whole: to that which its samples are found in.
        let at = |outcome: usize| domain.to_chart(domain.point_at([(outcome as f64 + 0.5) / outcomes as f64, 0.5]));
        let whole = |find: &dyn Fn([f64; 2]) -> usize| -> Overlaps {
            (0..rows).map(|row| at(row).map(|at| (find(at), xs[row + 1] - xs[row])).into_iter().collect()).collect()
        };
        in_rows = whole(&|at| subdivision.grid.find(at));
        along = subdivision.axes.iter().map(|axis| whole(&|at| axis.find(at[0]))).collect();
    }

    let of_rows = |first: usize, last: usize| {
        let mut shares = Parts::new(subdivision);
        let (mut invalid, mut points, mut values, mut of_row) = (None, Vec::new(), Vec::new(), Vec::new());
        let mut margin = vec![0.0; columns];
        let per_call = POINTS.div_ceil(columns);
        for row in first..last {
            // Ask for the values of several rows at once.
            let asked = (row - first) % per_call;
            if asked == 0 {
                poll(cancelled)?;
                points.clear();
                values.clear();
                let middle = |x: &[f64], y: &[f64]| domain.point_at([0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])]);
                let rows = xs[row..=last.min(row + per_call)].windows(2);
                points.extend(rows.flat_map(|x| ys.windows(2).map(move |y| middle(x, y))));
                density.pdf(&points, &mut values)?;
                invalid = invalid.or_else(|| first_invalid(&points, &values));
            }
            let values = &values[asked * columns..(asked + 1) * columns];
            // The margins along both axes.
            let total: f64 = values.iter().zip(ys.windows(2)).map(|(value, y)| value * (y[1] - y[0])).sum();
            if let Some(parts) = along.first() {
                parts[row].iter().for_each(|(part, length)| shares.axes[0][*part] += length * total);
            }
            margin.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * (xs[row + 1] - xs[row]));
            // The parts of cells: sums over the columns of each row of the grid, shared out to its rows of parts.
            for same_row in in_rows[row].chunk_by(|a, b| a.0 / side == b.0 / side) {
                let grid_row = same_row[0].0 / side;
                of_row.clear();
                of_row.resize((column_ends[grid_row].len() - 1) * side, 0.0);
                for (value, parts) in values.iter().zip(&in_columns[grid_row]) {
                    parts.iter().for_each(|(column, length)| of_row[*column] += length * value);
                }
                for (fine_row, length) in same_row {
                    for (column, value) in of_row.iter().enumerate() {
                        let cell = subdivision.grid.number(grid_row, column / side);
                        shares.cells[subdivision.part(cell, [fine_row % side, column % side])] += length * value;
                    }
                }
            }
        }
        if let Some(parts) = along.get(1) {
            for (sum, parts) in margin.iter().zip(parts) {
                parts.iter().for_each(|(part, length)| shares.axes[1][*part] += length * sum);
            }
        }
        Ok((shares, invalid))
    };
    let batch = VALUES.div_ceil(columns).max(rows.div_ceil(BATCHES));
    let of_batch = |i: u64| of_rows(i as usize * batch, rows.min((i as usize + 1) * batch));
    let batches = each(rows.div_ceil(batch) as u64, of_batch)?;

    // Add up in order, for sums that do not depend on the threads.
    let mut invalid: Option<InvalidPdf> = None;
    let mut shares = Shares::new(subdivision);
    for (more, found) in batches {
        shares.values.add(&more);
        invalid = invalid.or(found);
    }
    let Parts { axes, cells } = &mut shares.values;
    axes.iter_mut().flatten().chain(cells).for_each(|value| *value *= domain.measure());
    let values = shares.values.cells.chunks(side * side).map(|parts| parts.iter().sum()).collect::<Vec<f64>>();
    Ok((Integrals { errors: vec![0.0; values.len()], values, invalid }, shares))
}
