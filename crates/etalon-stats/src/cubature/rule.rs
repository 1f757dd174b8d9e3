//! The tensor product of the Gauss–Kronrod rule (7, 15). Source: Piessens et al., QUADPACK, 1983.

use crate::extremes::Extremes;
use crate::grid::Cell;

/// Nodes of the Kronrod rule.
pub(super) const KRONROD: usize = 15;
/// Its nodes on \[−1, 1\] with their weights, and those of the Gauss rule that shares every second node.
pub(super) const RULE: [(f64, f64, f64); KRONROD] = {
    const HALF: [(f64, f64, f64); 8] = [
        (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
        (0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7),
        (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
        (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
        (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
        (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
        (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
        (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
    ];
    let mut rule = [(0.0, 0.0, 0.0); KRONROD];
    let mut i = 0;
    while i < 8 {
        let (x, k, g) = HALF[i];
        rule[i] = (-x, k, g);
        rule[KRONROD - 1 - i] = (x, k, g);
        i += 1;
    }
    rule
};

/// The nodes in a rectangle, row by row; on a line those with y = ½.
#[inline]
pub(super) fn nodes(at: &Cell, plane: bool) -> impl Iterator<Item = [f64; 2]> {
    let at = *at;
    let columns = if plane { &RULE[..] } else { &RULE[KRONROD / 2..=KRONROD / 2] };
    RULE.iter().flat_map(move |(u, ..)| columns.iter().map(move |(v, ..)| at.place([*u, *v])))
}

/// Sums over \[−1, 1\]²: Kronrod's rule along both axes; Gauss's along x; Gauss's along y.
#[inline]
pub(super) fn rules(values: &[f64]) -> [f64; 3] {
    if values.len() == KRONROD {
        let sum = |weight: fn(&(f64, f64, f64)) -> f64| {
            2.0 * RULE.iter().zip(values).map(|(node, value)| weight(node) * value).sum::<f64>()
        };
        let (k, g) = (sum(|node| node.1), sum(|node| node.2));
        return [k, g, k];
    }
    let mut sums = [0.0; 3];
    for ((_, kx, gx), row) in RULE.iter().zip(values.chunks(KRONROD)) {
        let (mut k, mut g) = (0.0, 0.0);
        for ((_, ky, gy), value) in RULE.iter().zip(row) {
            (k, g) = (k + ky * value, g + gy * value);
        }
        sums = [sums[0] + kx * k, sums[1] + gx * k, sums[2] + kx * g];
    }
    sums
}

/// Weights of the Kronrod rule's nodes in barycentric interpolation: 1 / ∏ (xᵢ − xⱼ), scaled.
///
/// Source: Berrut & Trefethen, "Barycentric Lagrange Interpolation", SIAM Review 46(3), 2004.
const BARYCENTRIC: [f64; KRONROD] = {
    let mut weights = [1.0; KRONROD];
    let mut i = 0;
    while i < KRONROD {
        let mut j = 0;
        while j < KRONROD {
            if i != j {
                // The factor 2 keeps the products, of the order of 2⁻¹⁴, near 1.
                weights[i] /= 2.0 * (RULE[i].0 - RULE[j].0);
            }
            j += 1;
        }
        i += 1;
    }
    weights
};

/// Σ aᵢ bᵢ.
///
/// This, [`add_times`] and [`lagrange`] count by hand: users of this crate test without optimization, where iterators cost several times as
/// much as the sums.
#[inline]
pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let (mut sum, mut i) = (0.0, 0);
    while i < N {
        sum += a[i] * b[i];
        i += 1;
    }
    sum
}

/// Adds `factor` times a row to the sums.
#[inline]
pub(super) fn add_times<const N: usize>(sums: &mut [f64; N], factor: f64, row: &[f64; N]) {
    let mut i = 0;
    while i < N {
        sums[i] += factor * row[i];
        i += 1;
    }
}

/// Values at `x` in \[−1, 1\] of the 15 polynomials that are 1 at one node and 0 at the others.
#[inline]
fn lagrange(x: f64) -> [f64; KRONROD] {
    let (mut basis, mut sum) = ([0.0; KRONROD], 0.0);
    let mut i = 0;
    while i < KRONROD {
        basis[i] = BARYCENTRIC[i] / (x - RULE[i].0);
        sum += basis[i];
        i += 1;
    }
    if !sum.is_finite() {
        // At a node.
        return RULE.map(|node| f64::from(u8::from(node.0 == x)));
    }
    basis.map(|value| value / sum)
}

/// The polynomial through `values` at the [`nodes`] of `at`, whose integral is what Kronrod's rule returns.
#[inline]
pub(super) fn interpolate(values: &[f64], at: &Cell, [x, y]: [f64; 2]) -> f64 {
    let local = |v: f64, [from, to]: [f64; 2]| ((2.0 * v - from - to) / (to - from)).within(-1.0, 1.0);
    let along_x = lagrange(local(x, at.x));
    let (rows, _) = values.as_chunks::<KRONROD>();
    if let [line] = rows {
        return dot(&along_x, line);
    }
    // Sum over rows first: the 15 columns are independent of each other.
    let mut columns = [0.0; KRONROD];
    for (weight, row) in along_x.iter().zip(rows) {
        add_times(&mut columns, *weight, row);
    }
    dot(&lagrange(local(y, at.y)), &columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_14_come_back() {
        let f = |[x, y]: [f64; 2]| (2.0 * x - 0.3).powi(14) - 3.0 * x * (y - 0.2).powi(11) + y.powi(14);
        let at = Cell { x: [0.25, 0.5], y: [-1.0, 1.0] };
        let values: Vec<f64> = nodes(&at, true).map(f).collect();
        let corners = [[0.25, -1.0], [0.5, 1.0]];
        for place in [[0.3, 0.1], [0.44, -0.9]].into_iter().chain(corners).chain(nodes(&at, true).take(20)) {
            let value = interpolate(&values, &at, place);
            assert!((value - f(place)).abs() < 1e-11 * f(place).abs().max(1.0), "{place:?}: {value} {}", f(place));
        }
        let line: Vec<f64> = nodes(&at, false).map(|[x, _]| f([x, 0.5])).collect();
        assert!((interpolate(&line, &at, [0.4, 0.5]) - f([0.4, 0.5])).abs() < 1e-12);
    }
}
