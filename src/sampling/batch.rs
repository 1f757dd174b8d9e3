//! Samples of several cells at once, component by component.

/// Samples per batch: enough to overlap their memory accesses, few enough for the nearest cache.
pub const BATCH: usize = 64;

/// Samples of up to [`BATCH`] cells of a grid.
#[derive(Debug, Clone)]
pub struct Batch {
    /// Number of the cell, counted row by row.
    pub cell: [usize; BATCH],
    /// Its column.
    pub x: [u32; BATCH],
    /// Its row.
    pub y: [u32; BATCH],
    /// Position inside the cell along x, in (0, 1).
    pub fx: [f64; BATCH],
    /// Position inside the cell along y, in (0, 1).
    pub fy: [f64; BATCH],
    /// Probability of the cell.
    pub probability: [f64; BATCH],
    /// Between two steps: the first and the last cell of the row that the sample may be in.
    pub(super) bracket: [[u16; 2]; BATCH],
    /// Between two steps: the probability of the column in its row.
    pub(super) column: [f64; BATCH],
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            cell: [0; BATCH],
            x: [0; BATCH],
            y: [0; BATCH],
            fx: [0.0; BATCH],
            fy: [0.0; BATCH],
            probability: [0.0; BATCH],
            bracket: [[0; 2]; BATCH],
            column: [0.0; BATCH],
        }
    }
}
