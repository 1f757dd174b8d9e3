//! The difference between a density and what the rules integrate, measured at random points.

use super::pieces::{LARGE, Piece};
use super::{InvalidPdf, Probe, Refinement, first_invalid};
use crate::counting::{BATCH, FOUND, Share, add};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::parallel::sum;
use crate::stream::CounterRng;
use rand::RngExt;

/// The density at random points against the polynomials that the rules integrate.
///
/// The points are distributed in proportion to the density that each piece is expected to reach. There the density, cut off at
/// this height, and the rule's polynomial are compared: their mean difference, times `reach`, is the error of the integral
/// of the density as far as it is within reach. (Samples find what is above: see
/// [`Refinement::share_within`].)
#[derive(Debug, Clone)]
pub(crate) struct Check {
    /// The integral of the largest density that the pieces are expected to reach.
    pub reach: f64,
    /// The number of points. Each has a difference from −1 to 1.
    pub count: u64,
    /// For each cell: sums of the positive differences, of the negative ones without their sign, and of the squares.
    pub sums: Vec<[Share; 3]>,
    /// Some of the points where the difference is large.
    pub found: Vec<Probe>,
    pub invalid: Option<InvalidPdf>,
}

impl Check {
    fn plus(mut self, other: Self) -> Self {
        add(self.sums.as_flattened_mut(), other.sums.as_flattened());
        self.found.extend(other.found);
        self.found.truncate(FOUND);
        self.invalid = self.invalid.or(other.invalid);
        self
    }

    /// The integral over a cell of what is within reach, minus that of the polynomials, and the standard error of this.
    #[must_use]
    pub fn difference(&self, cell: usize) -> [f64; 2] {
        let scale = self.reach / self.count.max(1) as f64;
        let [above, below, squares] = self.sums[cell].map(Share::sum);
        [scale * (above - below), scale * squares.sqrt()]
    }

    /// The sum over all cells of the positive (0) or the negative (1) differences.
    #[must_use]
    pub fn total(&self, sign: usize) -> f64 {
        Share::total(self.sums.iter().map(|sums| sums[sign]))
    }
}

impl Refinement<'_> {
    /// Compares the density with the polynomials at `count` random points.
    pub fn check(&self, count: u64, seed: u64, stream: u64) -> Result<Check> {
        let plane = self.domain.is_plane();
        let running_sum = |sum: &mut f64, piece: &Piece| {
            *sum += piece.reach();
            Some(*sum)
        };
        let ends: Vec<f64> = self.pieces.iter().scan(0.0, running_sum).collect();
        let reach = ends.last().copied().unwrap_or(0.0);
        let count = if reach > 0.0 { count } else { 0 };
        let none = || {
            let sums = vec![[Share::default(); 3]; self.grid.len()];
            Check { reach, count, sums, found: Vec::new(), invalid: None }
        };
        let of_batch = |batch: u64| {
            let mut rng = CounterRng::new(seed, batch << 8 | stream);
            let (mut chosen, mut charts) = (Vec::new(), Vec::new());
            // Sample points by the largest density that the pieces are expected to reach.
            for i in batch * BATCH..count.min((batch + 1) * BATCH) {
                // One point in each of `count` equal parts of `reach`.
                let at = (i as f64 + rng.random::<f64>()) / count as f64 * reach;
                let piece = &self.pieces[ends.partition_point(|&end| end <= at).min(ends.len() - 1)];
                let along = |[from, to]: [f64; 2], u: f64| (from + (to - from) * u).at_most(to.next_down());
                let [u, v] = rng.random::<[f64; 2]>();
                let chart = [along(piece.part.at.x, u), if plane { along(piece.part.at.y, v) } else { 0.5 }];
                chosen.push(piece);
                charts.push(chart);
            }
            let (points, values, _) = self.values_at(&charts)?;
            let mut check = none();
            check.invalid = first_invalid(&points, &values);
            // Add up the differences between density and polynomial.
            for ((piece, at), density) in chosen.into_iter().zip(charts).zip(values) {
                let probe = Probe { at, density };
                let difference = piece.difference(&probe);
                let sums = &mut check.sums[piece.part.cell];
                sums[usize::from(difference <= 0.0)].add(Share::new(difference.abs()));
                sums[2].add(Share::new(difference * difference));
                if check.found.len() < FOUND && (difference.abs() > LARGE || piece.share_within(density) < 1.0) {
                    check.found.push(probe);
                }
            }
            Ok(check)
        };
        sum(0..count.div_ceil(BATCH), none, |all, batch| Ok(all.plus(of_batch(batch)?)), Check::plus)
    }
}
