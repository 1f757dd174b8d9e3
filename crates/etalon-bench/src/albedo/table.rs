//! The table of a furnace test, and the verdict on it.

use etalon_stats::Extremes;
use etalon_stats::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;

/// Rounding of single precision may change an albedo by so much.
pub(super) const ROUNDING: f64 = 1e-5;

/// A directional albedo: the radiance towards `wo` over that of uniform light. Field names are the CSV columns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Row {
    /// The angle of `wo` with the normal.
    pub theta_deg: f64,
    /// The value of the parameters that vary, or 0 if none does.
    pub parameter: f64,
    /// 0 for all channels if they are equal.
    pub channel: usize,
    pub albedo: f64,
    pub error: f64,
    /// What the bound rests on.
    pub basis: &'static str,
    /// The largest mean weight that the BSDF declares, with room for rounding, or the largest that was found if none is declared.
    pub largest_weight: Option<f64>,
    /// Whether the BSDF contradicts what it declares: an albedo above 1, or other than 1 if it conserves energy, a weight above the
    /// largest, or a value that is not finite.
    pub is_violation: bool,
    /// The share that a metal loses because light which facets reflect more than once is not added: 1 minus the albedo
    /// for a Fresnel reflectance of 1.
    pub lost_by_single_scattering: Option<f64>,
    /// The weak furnace test: ∫ G₁(wo) D(m) max(0, wo·m)/cos θₒ dωₘ, which is 1 for any masking function that belongs to its
    /// distribution. Source: Heitz, JCGT 3(2), 2014, section 5.1.
    pub weak_furnace: Option<f64>,
}

/// The albedos of one family.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    pub family: String,
    /// The parameters that vary together.
    pub over: Vec<String>,
    /// Whether their values are in equal factors.
    pub is_logarithmic: bool,
    /// The other parameters.
    pub fixed: Vec<(String, f64)>,
    pub thetas_deg: Vec<f64>,
    /// The values of the parameters that vary.
    pub parameters: Vec<f64>,
    /// By value of the parameters, angle, and channel.
    pub rows: Vec<Row>,
    /// Wall-clock time.
    pub seconds: f64,
}

impl Table {
    /// The rows of the smallest and of the largest albedo.
    #[must_use]
    pub fn extremes(&self) -> Option<[&Row; 2]> {
        let by = |a: &&Row, b: &&Row| a.albedo.total_cmp(&b.albedo);
        Some([self.rows.iter().min_by(by)?, self.rows.iter().max_by(by)?])
    }

    /// The row with the largest error.
    #[must_use]
    pub fn with_largest_error(&self) -> Option<&Row> {
        self.rows.iter().max_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// The largest deviation of the weak furnace test from 1.
    #[must_use]
    pub fn weak_deviation(&self) -> Option<f64> {
        self.rows.iter().filter_map(|row| row.weak_furnace).map(|weak| (weak - 1.0).abs()).max_by(f64::total_cmp)
    }

    /// What the bounds of the errors rest on, with the numbers of albedos.
    #[must_use]
    pub fn bases(&self) -> BTreeMap<&'static str, usize> {
        let mut bases = BTreeMap::new();
        self.rows.iter().for_each(|row| *bases.entry(row.basis).or_default() += 1);
        bases
    }

    /// The number of albedos with a violation.
    #[must_use]
    pub fn violations(&self) -> usize {
        self.rows.iter().filter(|row| row.is_violation).count()
    }

    /// The largest albedo over the channels, by value of the parameters and angle.
    #[must_use]
    pub fn largest_channels(&self) -> Vec<f64> {
        let largest = |rows: &[Row]| rows.iter().map(|row| row.albedo).fold(f64::MIN, f64::at_least);
        self.rows.chunk_by(|_, next| next.channel != 0).map(largest).collect()
    }

    /// The number of albedos above 1 by more than their error, which the BSDF may declare as possible.
    #[must_use]
    pub fn above_one(&self) -> usize {
        self.rows.iter().filter(|row| row.albedo > 1.0 + row.error + ROUNDING).count()
    }

    /// The verdict on a family whose albedos should have errors of at most `error`: rejected if one contradicts what the BSDF
    /// declares or the weak furnace test fails, inconclusive if errors are larger.
    #[must_use]
    pub fn verdict(&self, error: f64) -> Verdict {
        if self.violations() > 0 || self.weak_deviation().is_some_and(is_wrong) {
            Verdict::Reject
        } else if self.with_largest_error().is_some_and(|row| row.error > error) {
            Verdict::Inconclusive
        } else {
            Verdict::Accept
        }
    }
}

/// Whether a deviation of the weak furnace test is an error of the distribution or of its masking; NaN is.
#[must_use]
pub fn is_wrong(deviation: f64) -> bool {
    const TOLERANCE: f64 = 1e-4;
    deviation.is_nan() || deviation > TOLERANCE
}
