//! Weights of multiple importance sampling.

/// The weight of a sample from a technique of density `own` when two other techniques find the same path with the densities
/// `others`: the balance heuristic own / (own + Σ others). A density counts the samples of its technique.
///
/// Light samples of a map in proportion to what exceeds its mean complement BSDF samples under this heuristic.
///
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 3.3; Karlík et al., "MIS Compensation", 2019.
#[inline(always)]
pub fn balance_heuristic(own: f32, others: [f32; 2]) -> f32 {
    1.0 / (1.0 + (others[0] + others[1]) / own)
}
