//! Summed-area tables: blocks of 8 × 8 texels behind one bright texel, against sums in integers.

use super::experiment::{Bound, ErrorRow, Experiment, Precision, STABLE, TEXTBOOK, Tally, Workload};
use crate::envmap::latlong::Block;
use crate::envmap::sat::SummedArea;
use crate::error::Result;

/// The entry of the registry.
pub const EXPERIMENT: Experiment = Experiment {
    name: "areas",
    about: "summed-area tables with one texel of 2^20 among 1 (areas), of 2^40 among 2^-40 (areas-extreme)",
    figure: "stability-sums",
    bounds: &[Bound {
        name: "error of sums of few digits",
        limit: 0.0,
        reason: "all partial sums are whole multiples of 2^−12 below 2^41",
        error: |row| (row.family == "areas").then_some(row.max_relative),
    }],
    run,
};

/// Texels along the sides of a block.
const BLOCK: usize = 8;

fn run(workload: &Workload, _seed: u64) -> Result<Vec<ErrorRow>> {
    let [width, height] = workload.map.map(|side| side / 8);
    let rows = [("areas", 2f64.powi(20), 1.0 + 2f64.powi(-12)), ("areas-extreme", 2f64.powi(40), 2f64.powi(-40))];
    let rows = rows.into_iter().flat_map(|(name, hot, cold)| {
        let at = (width / 8, height / 8);
        let value = |x: usize, y: usize| if (x, y) == at { hot } else { cold };
        let table = SummedArea::new(width, height, value);
        let single = single_sums(width, height, value);
        let mut stable = Tally::new(name, STABLE, Precision::Double);
        let mut textbook = Tally::new(name, TEXTBOOK, Precision::Single);
        for (x0, y0) in (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (x * BLOCK, y * BLOCK))) {
            let block = Block { x0, y0, x1: x0 + BLOCK, y1: y0 + BLOCK };
            let inside = |r: Block| (r.x0..r.x1).contains(&at.0) && (r.y0..r.y1).contains(&at.1);
            // Both values have few digits, so that this is exact.
            let exact = |r: Block| {
                let cells = ((r.x1 - r.x0) * (r.y1 - r.y0)) as f64;
                if inside(r) { hot + (cells - 1.0) * cold } else { cells * cold }
            };
            let sum = exact(block);
            // Condition of the difference of four sums.
            let condition = 4.0 * exact(Block { x0: 0, y0: 0, ..block }) / sum;
            let what = || format!("block from ({x0}, {y0}) of {width}x{height}");
            stable.compare(table.sum(block), sum, condition, what);
            // The same difference of four sums in f32.
            let corner = |x: usize, y: usize| single[y * (width + 1) + x];
            let four = corner(block.x1, block.y1) - corner(x0, block.y1) - corner(block.x1, y0) + corner(x0, y0);
            textbook.compare(f64::from(four), sum, condition, what);
        }
        [stable.row(), textbook.row()]
    });
    Ok(rows.collect())
}

/// The table in f32, row by row.
fn single_sums(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Vec<f32> {
    let stride = width + 1;
    let mut sums = vec![0.0; stride * (height + 1)];
    for y in 0..height {
        let mut row = 0.0;
        for x in 0..width {
            row += value(x, y) as f32;
            sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
        }
    }
    sums
}
