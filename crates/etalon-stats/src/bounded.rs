//! Bounds of the mean of independent numbers between 0 and 1, valid for any number of them and any distribution.

/// The interval that holds the expected value of a mean of `n` independent numbers in \[0, 1\], of which `mean` was
/// observed; it fails to hold it with probability `risk` at most.
///
/// These are the values whose Kullback–Leibler divergence n·KL(mean ‖ value) stays below ln(2/risk). With a mean of 0 the
/// upper end is about ln(2/risk)/n. Source: Hoeffding, "Probability Inequalities for Sums of Bounded Random Variables",
/// JASA 58, 1963, theorem 1.
#[must_use]
pub fn mean_interval(mean: f64, n: u64, risk: f64) -> [f64; 2] {
    let allowed = (2.0 / risk).ln() / n as f64;
    let divergence = |value: f64| part(mean, value) + part(1.0 - mean, 1.0 - value);
    // The divergence grows away from the mean, on both sides.
    let end = |mut inside: f64, mut outside: f64| {
        if divergence(outside) <= allowed {
            return outside;
        }
        for _ in 0..80 {
            let middle = 0.5 * (inside + outside);
            if divergence(middle) <= allowed { inside = middle } else { outside = middle }
        }
        outside
    };
    [end(mean, 0.0), end(mean, 1.0)]
}

/// a ln(a/b), which is 0 for a = 0.
fn part(a: f64, b: f64) -> f64 {
    if a > 0.0 { a * (a / b).ln() } else { 0.0 }
}

/// A confidence interval of a mean that is narrow where the squares of the numbers are small, in rounds. Given the rounds before,
/// the numbers of a round are independent, their mean has the same expected value as that of every round, and none is below −`largest` or above
/// `largest`; like the rate, `n` and `largest` are chosen before the numbers are known.
///
/// For ξ ≥ −1 and a rate λ in \[0, 1), exp(λξ − ψ(λ)ξ²) ≤ 1 + λξ with ψ(λ) = −ln(1 − λ) − λ. So E exp(Σ λ(ξ − Eξ) − ψ(λ)ξ²) ≤ 1, and
/// by Ville's inequality the exponent exceeds ln(1/risk) at any time with probability `risk` at most. The same holds for −ξ. So
/// the interval may be asked for after each round. Source of the inequality: Fan, Grama &
/// Liu, "Exponential Inequalities for Martingales with Applications", EJP 20, 2015; of confidence sequences by it: Waudby-Smith & Ramdas,
/// "Estimating Means of Bounded Random Variables by Betting", JRSS B 86(1), 2024, theorem 2.
#[derive(Debug, Clone, Copy, Default)]
pub struct EmpiricalBernstein {
    /// Σ λ n/largest.
    weight: f64,
    /// Σ λ x/largest.
    weighted: f64,
    /// Σ ψ(λ) x²/largest².
    penalty: f64,
}

/// ψ(λ).
fn psi(rate: f64) -> f64 {
    -(-rate).ln_1p() - rate
}

impl EmpiricalBernstein {
    /// Adds `n` numbers with this `sum` and sum of `squares`, at a `rate` that was chosen before they were known.
    pub fn add(&mut self, rate: f64, largest: f64, n: f64, [sum, squares]: [f64; 2]) {
        self.weight += rate * n / largest;
        self.weighted += rate * sum / largest;
        self.penalty += psi(rate) * squares / (largest * largest);
    }

    /// The mean, and its largest distance from the expected value, which is exceeded with probability `risk` at most.
    #[must_use]
    pub fn interval(&self, risk: f64) -> [f64; 2] {
        match self.weight > 0.0 {
            true => [self.weighted / self.weight, (self.penalty + (2.0 / risk).ln()) / self.weight],
            false => [0.0, f64::INFINITY],
        }
    }

    /// The rate that makes the interval narrowest after `n` more numbers with this mean `square`, and its half width.
    #[must_use]
    pub fn expect(&self, n: f64, largest: f64, square: f64, risk: f64) -> [f64; 2] {
        /// If all numbers are 0, the interval is 1 % wider than at the rate 1.
        const LARGEST_RATE: f64 = 0.99;
        let square = square / (largest * largest);
        let width = |rate: f64| {
            let weight = self.weight + rate * n / largest;
            (self.penalty + (2.0 / risk).ln() + n * psi(rate) * square) / weight
        };
        // The width falls with the rate, then rises: narrow the range by golden sections.
        const SECTION: f64 = 0.381_966_011_250_105;
        let (mut low, mut high) = (0.0, LARGEST_RATE);
        for _ in 0..24 {
            let [a, b] = [low + SECTION * (high - low), high - SECTION * (high - low)];
            if width(a) < width(b) { high = b } else { low = a }
        }
        let rate = 0.5 * (low + high);
        [rate, width(rate)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Independent, Stream};

    #[test]
    fn intervals_are_those_computed_by_hand() {
        // Nothing observed in n: (1 - h)^n = risk/2.
        let [low, high] = mean_interval(0.0, 1000, 0.02);
        assert!(low == 0.0 && ((1.0 - high).powi(1000) - 0.01).abs() < 1e-12, "{high}");
        let [low, high] = mean_interval(0.5, 10_000, 0.02);
        // Near ½ it is Hoeffding's ±√(ln(2/risk)/2n).
        let half = (100f64.ln() / 20_000.0).sqrt();
        assert!((high - 0.5 - half).abs() < 1e-3 * half && (0.5 - low - half).abs() < 1e-3 * half);
        assert_eq!(mean_interval(0.0, 0, 0.01), [0.0, 1.0], "nothing is known without numbers");
        assert_eq!(mean_interval(1.0, 10, 0.01)[1], 1.0);
    }

    #[test]
    fn intervals_hold_the_mean_as_often_as_they_say() {
        // Rare large numbers: where intervals from the standard error fail.
        let (rate, runs) = (2e-3, 2000);
        let missed = (0..runs).filter(|&run| {
            let n = 1000;
            let seen = (0..n).filter(|&i| Independent::new(9, run, i).pair(0)[0] < rate).count();
            let [low, high] = mean_interval(seen as f64 / f64::from(n), u64::from(n), 0.05);
            !(low..=high).contains(&rate)
        });
        assert!(missed.count() <= 100, "at most 5 % of 2000");
    }

    #[test]
    fn intervals_by_squares_are_those_computed_by_hand() {
        // For n zeros: ln(2/risk)/(λ n) times the largest number.
        let mut zeros = EmpiricalBernstein::default();
        assert_eq!(zeros.interval(0.02)[1], f64::INFINITY);
        zeros.add(0.5, 3.0, 1000.0, [0.0; 2]);
        let [mean, half] = zeros.interval(0.02);
        assert!(mean == 0.0 && (half - 3.0 * 100f64.ln() / 500.0).abs() < 1e-12);
        // For many numbers of variance σ² and small rates: σ √(2 ln(2/risk)/n), as of the normal distribution's tails.
        let (n, variance) = (1e8, 1e-2);
        let [rate, half] = EmpiricalBernstein::default().expect(n, 1.0, variance, 0.02);
        assert!((half / (2.0 * variance * 100f64.ln() / n).sqrt() - 1.0).abs() < 0.01, "{rate} {half}");
        let mut sum = EmpiricalBernstein::default();
        sum.add(rate, 1.0, n, [0.0, n * variance]);
        assert!((sum.interval(0.02)[1] / half - 1.0).abs() < 1e-9);
    }

    #[test]
    fn intervals_by_squares_hold_the_mean_at_all_times() {
        // Rare large numbers among small ones of the other sign, the rate from what was seen, and a look after each round.
        let (rate, small, runs) = (2e-3, -1e-3, 2000);
        let exact = rate + (1.0 - rate) * small;
        let missed = (0..runs).filter(|&run| {
            let (mut interval, mut square) = (EmpiricalBernstein::default(), 1e-3);
            (0..10).any(|round| {
                let numbers = (0..200).map(|i| {
                    let u = Independent::new(11, run, 200 * round + i).pair(0)[0];
                    if u < rate { 1.0 } else { small }
                });
                let (sum, squares) = numbers.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
                let [chosen, _] = interval.expect(200.0, 1.0, square, 0.05);
                interval.add(chosen, 1.0, 200.0, [sum, squares]);
                square = 0.5 * (square + squares / 200.0);
                let [mean, half] = interval.interval(0.05);
                (mean - exact).abs() > half
            })
        });
        assert!(missed.count() <= 100, "at most 5 % of 2000");
    }
}
