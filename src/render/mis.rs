//! Weights of multiple importance sampling.

/// The weight of a sample of pdf `p` when another strategy finds the same light with pdf `q`: p² / (p² + q²).
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 4.
#[inline(always)]
pub fn power_heuristic(p: f32, q: f32) -> f32 {
    let ratio = q / p;
    1.0 / (1.0 + ratio * ratio)
}

/// The weight of a sample over its pdf `p` when another strategy, of pdf `q` there, takes as many samples:
/// (p / (p + q)) / p. Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 3.
#[inline]
pub fn balance_weight_over_pdf(p: f64, q: f64) -> f64 {
    1.0 / (p + q)
}
