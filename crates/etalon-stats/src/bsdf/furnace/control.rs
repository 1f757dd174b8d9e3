//! A function on the unit square as polynomials on rectangles: a control variate for its integral.

use crate::error::Result;
use crate::extremes::Extremes;
use crate::grid::Cell;

/// Nodes of Gauss's rule along each axis, on \[−1, 1\], and their weights, which sum to 1.
const NODE: f64 = 0.774_596_669_241_483_4;
const NODES: [f64; 3] = [-NODE, 0.0, NODE];
const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
/// The lines of the first rectangles along each axis: dense where samplers have their poles and horizons.
pub const LINES: [f64; 7] = [0.0, 1.0 / 64.0, 1.0 / 8.0, 0.5, 7.0 / 8.0, 63.0 / 64.0, 1.0];
/// The same for functions without a bound: as dense as single precision.
pub const LINES_TO_POLES: [f64; 11] = {
    let [a, b, c, d] = [1.0 / (1u32 << 23) as f64, 1.0 / (1u32 << 13) as f64, 1.0 / 64.0, 1.0 / 8.0];
    [0.0, a, b, c, d, 0.5, 1.0 - d, 1.0 - c, 1.0 - b, 1.0 - a, 1.0]
};
/// Values of the function after which no rectangle is cut any more.
const VALUES: usize = 1 << 15;

/// A polynomial of degree 2 in either coordinate, the one through the function's values at nine nodes of a rectangle.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Its rectangle.
    pub at: Cell,
    /// Coefficients of xⁱ yʲ, x and y from −1 to 1.
    coefficients: [[f64; 3]; 3],
    /// The integral over the rectangle.
    pub integral: f64,
    /// An estimate of the root mean square of the difference between the function and the polynomial.
    pub distance: f64,
    /// The largest value that was met in it, or in the rectangle that it was cut from.
    pub most: f64,
}

impl Piece {
    /// The places of the nodes.
    fn nodes(at: &Cell) -> impl Iterator<Item = [f64; 2]> {
        NODES.into_iter().flat_map(|x| NODES.map(|y| at.place([x, y])))
    }

    /// From the values at the nodes.
    fn new(at: Cell, values: &[f64], distance: f64, most: f64) -> Self {
        // From values at −a, 0, a to coefficients.
        let fit = |[low, middle, high]: [f64; 3]| {
            [middle, 0.5 * (high - low) / NODE, 0.5 * (high + low - 2.0 * middle) / (NODE * NODE)]
        };
        let along_y: [[f64; 3]; 3] =
            std::array::from_fn(|i| fit([values[3 * i], values[3 * i + 1], values[3 * i + 2]]));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|j| fit([along_y[0][j], along_y[1][j], along_y[2][j]]));
        let coefficients = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        let mean: f64 = (0..9).map(|k| WEIGHTS[k / 3] * WEIGHTS[k % 3] * values[k]).sum();
        let most = values.iter().copied().fold(most, f64::at_least);
        Self { at, coefficients, integral: at.area() * mean, distance, most }
    }

    /// The polynomial at coordinates from −1 to 1.
    #[inline]
    pub fn value(&self, [x, y]: [f64; 2]) -> f64 {
        let [a, b, c] = self.coefficients.map(|[a, b, c]| a + y * (b + y * c));
        a + x * (b + x * c)
    }

    /// Its smallest and its largest value, or bounds beyond them.
    pub fn range(&self) -> [f64; 2] {
        let middle = self.coefficients[0][0];
        let rest: f64 = self.coefficients.as_flattened()[1..].iter().map(|c| c.abs()).sum();
        [middle - rest, middle + rest]
    }

    /// Its quarters.
    fn quarters(&self) -> [Cell; 4] {
        let [mx, my] = self.at.place([0.0; 2]);
        let Cell { x: [x0, x1], y: [y0, y1] } = self.at;
        [[[x0, mx], [y0, my]], [[x0, mx], [my, y1]], [[mx, x1], [y0, my]], [[mx, x1], [my, y1]]]
            .map(|[x, y]| Cell { x, y })
    }
}

/// Rectangles that fill the unit square, first between `lines`, cut until the estimated difference between `function` and the polynomials
/// is `allowed` in the mean, by `most` values or so.
pub fn pieces(
    lines: &[f64],
    allowed: f64,
    most: f64,
    mut function: impl FnMut(&[[f64; 2]]) -> Result<Vec<f64>>,
) -> Result<Vec<Piece>> {
    let lines = lines.windows(2).map(|ends| [ends[0], ends[1]]);
    let cells: Vec<Cell> = lines.clone().flat_map(|x| lines.clone().map(move |y| Cell { x, y })).collect();
    let mut values = function(&cells.iter().flat_map(Piece::nodes).collect::<Vec<_>>())?;
    let first =
        cells.into_iter().zip(values.chunks_exact(9)).map(|(at, values)| Piece::new(at, values, f64::INFINITY, 0.0));
    let (mut pieces, mut count) = (first.collect::<Vec<_>>(), values.len());
    loop {
        let sum: f64 = pieces.iter().map(|piece| piece.at.area() * piece.distance).sum();
        if sum <= allowed || count >= VALUES || count as f64 >= most {
            return Ok(pieces);
        }
        // Cut what has more than its part of what is allowed.
        let most = allowed / pieces.len() as f64;
        let (large, small): (Vec<Piece>, Vec<Piece>) =
            pieces.into_iter().partition(|piece| piece.at.area() * piece.distance > most);
        pieces = small;
        if large.is_empty() {
            // What remains is NaN.
            return Ok(pieces);
        }
        let quarters: Vec<Cell> = large.iter().flat_map(Piece::quarters).collect();
        values = function(&quarters.iter().flat_map(Piece::nodes).collect::<Vec<_>>())?;
        count += values.len();
        for (number, (at, values)) in quarters.into_iter().zip(values.chunks_exact(9)).enumerate() {
            // What the polynomial of the whole missed at the nodes; a kink makes the error of a quarter half as large.
            let whole = &large[number / 4];
            let [dx, dy] = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]][number % 4];
            let squares = (0..9).map(|k| {
                let within = [dx + 0.5 * NODES[k / 3], dy + 0.5 * NODES[k % 3]];
                WEIGHTS[k / 3] * WEIGHTS[k % 3] * (values[k] - whole.value(within)).powi(2)
            });
            let distance = 0.5 * squares.sum::<f64>().sqrt();
            pieces.push(Piece::new(at, values, distance, whole.most));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(allowed: f64, function: impl Fn([f64; 2]) -> f64) -> (Vec<Piece>, usize) {
        let mut count = 0;
        let mut values = |points: &[[f64; 2]]| {
            count += points.len();
            Ok(points.iter().map(|&at| function(at)).collect())
        };
        (pieces(&LINES, allowed, f64::INFINITY, &mut values).unwrap(), count)
    }

    #[test]
    fn polynomials_of_degree_2_come_back() {
        let function = |[x, y]: [f64; 2]| 1.0 + 2.0 * x - 3.0 * y + x * x * y * y - 0.5 * x * y * y;
        let (pieces, _) = of(1e-9, function);
        let integral: f64 = pieces.iter().map(|piece| piece.integral).sum();
        assert!((integral - (1.0 + 1.0 - 1.5 + 1.0 / 9.0 - 1.0 / 12.0)).abs() < 1e-12, "{integral}");
        for piece in &pieces {
            for local in [[-1.0, 1.0], [0.3, -0.2], [1.0, 1.0]] {
                let value = piece.value(local);
                assert!((value - function(piece.at.place(local))).abs() < 1e-12);
                let [low, high] = piece.range();
                assert!(low <= value + 1e-12 && value <= high + 1e-12);
            }
        }
    }

    #[test]
    fn edges_are_followed_as_far_as_asked() {
        let disc = |[x, y]: [f64; 2]| f64::from(u8::from((x - 0.4).hypot(y - 0.6) < 0.3));
        let exact = 0.09 * std::f64::consts::PI;
        for allowed in [0.03, 0.003] {
            let (pieces, count) = of(allowed, disc);
            let integral: f64 = pieces.iter().map(|piece| piece.integral).sum();
            assert!((integral - exact).abs() < allowed && count < VALUES, "{allowed} {integral} {exact} {count}");
            let area: f64 = pieces.iter().map(|piece| piece.at.area()).sum();
            assert!((area - 1.0).abs() < 1e-12);
        }
        // What cannot be followed ends with the budget.
        assert!(of(1e-9, disc).1 < 3 * VALUES);
    }

    #[test]
    fn what_is_no_number_ends() {
        let (pieces, _) = of(1e-3, |[x, _]| if x < 0.5 { f64::NAN } else { x });
        assert!(pieces.iter().any(|piece| piece.integral.is_nan()));
    }
}
