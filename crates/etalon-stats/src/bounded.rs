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
}
