//! Weights of multiple importance sampling.

/// The weight of a sample from a technique of density `own` when two other techniques find the same path with the densities
/// `others`: the power heuristic own² / (own² + Σ others²). A density counts the samples of its technique.
///
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 4.
#[inline(always)]
pub fn power_heuristic(own: f32, others: [f32; 2]) -> f32 {
    let [a, b] = [others[0] / own, others[1] / own];
    1.0 / (1.0 + a * a + b * b)
}
