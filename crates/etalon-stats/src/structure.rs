//! What the parts and the order of the counted samples say, beside the counts of the cells.

use crate::counting::Tally;
use crate::cubature::Shares;
use crate::diagnosis::p_value;
use crate::domain::Domain;
use crate::extremes::Extremes;
use crate::grid::Subdivision;
use crate::multiple::weighted;
use crate::outcome::Finer;
use crate::power::{ChiSquare, chi_square_below};
use crate::scales::{Scale, Scales};
use crate::serial::Labels;

/// The share of a test's level that the counts of the cells have; scales, ends and order share the rest equally.
pub const CELLS: f64 = 0.5;
/// Samples are called stratified where the counts of independent ones would be as uniform with this probability at most.
const STRATIFIED: f64 = 1e-6;
/// Scales in words.
const NAMED: usize = 2;

/// The counted samples of a test, and what they are compared with.
pub struct Counted<'a> {
    pub subdivision: &'a Subdivision<'a>,
    pub domain: &'a dyn Domain,
    pub labels: Labels,
    pub tally: &'a Tally,
    /// The expected shares of the parts, and the share of samples that these are known to miss.
    pub shares: &'a Option<(Shares, Vec<f64>)>,
    pub samples: u64,
    /// The level of the test.
    pub level: f64,
    /// Whether all samples have been drawn.
    pub is_last: bool,
    /// Whether scales say what they detect, which takes a while.
    pub states_power: bool,
}

/// The findings.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    /// Scales of the axes, the cells, the ends, and the order.
    pub scales: Vec<Scale>,
    /// The p-value of all, that of the cells included.
    pub p: f64,
    /// Scales whose counts chance hardly explains, the worst first.
    pub words: Vec<String>,
    /// What users should know though it does not decide.
    pub remarks: Vec<String>,
    /// Counts of parts where these are worst.
    pub finer: Option<Finer>,
}

impl Counted<'_> {
    /// Tests the scales, the ends and the order of the samples beside the `cells`, whose test is known; chance is thought
    /// not to explain what is less likely than `suspect`.
    pub fn structure(&self, cells: ChiSquare, suspect: f64) -> Structure {
        let Self { subdivision, labels, tally, samples, .. } = *self;
        let known = self.shares.as_ref();
        let scales = known.map_or_else(Scales::default, |(shares, found)| {
            Scales::new(subdivision, self.domain, &tally.parts, shares, found, samples)
        });
        // Recognize stratified samples first: they depend on each other on purpose.
        let uniform = [chi_square_below(cells.dof as f64, cells.statistic)].into_iter();
        let of_scales = scales.tests.iter().map(|test| test.below());
        let uniform: Vec<f64> = uniform.chain(of_scales).chain(tally.serial.stratification()).collect();
        let least = uniform.iter().copied().fold(1.0, f64::at_most) * uniform.len() as f64;
        let is_stratified = least < STRATIFIED;

        let dependence = tally.serial.dependence(&labels);
        let (ends, order) = (scales.ends(), dependence.map(dependent));
        let count = scales.tests.len() + usize::from(ends.is_some()) + usize::from(order.is_some());
        let own = (1.0 - CELLS) / count.max(1) as f64;
        let level = self.states_power.then_some(own * self.level);
        let tests = scales.tests.iter().map(|test| test.at_level(level, samples));
        let scales: Vec<Scale> = tests.chain(ends).chain(order.clone()).collect();
        // The order of stratified samples does not count; what is left has the whole level. Nor does it before the last look while
        // batches are too few to recognize samples that are stratified in each.
        let order_counts = !is_stratified && (self.is_last || tally.serial.stratification().is_some());
        let is_order = |scale: &&Scale| Some(*scale) == order.as_ref();
        let decide: Vec<&Scale> = scales.iter().filter(|scale| order_counts || !is_order(scale)).collect();
        // Scales and ends say more than the cells only where these do not reject.
        let by_cells = cells.p < suspect * self.level;
        let cells = (cells.p, 1.0 - own * decide.len() as f64);
        let p = weighted(&decide.iter().map(|scale| (scale.p, own)).chain([cells]).collect::<Vec<_>>());
        let told = scales.iter().filter(|scale| if is_order(scale) { !is_stratified } else { !by_cells });
        let mut worst: Vec<&Scale> = told.filter(|scale| scale.p < own * suspect).collect();
        worst.sort_by(|a, b| a.p.total_cmp(&b.p));
        let words = worst.iter().take(NAMED).map(|scale| scale.words.clone()).collect();
        let finer = worst.first().and_then(|scale| scale.finer.clone());
        let mut remarks = Vec::new();
        if is_stratified {
            let order = order.filter(|order| order.p < own * self.level).map_or("", |_| " and depend on each other");
            remarks.push(format!(
                "counts agree with the pdf better than those of independent samples would ({}): samples are stratified, \
                 antithetic or from a low-discrepancy sequence{order}; the tests assume independent samples",
                p_value(least)
            ));
        }
        Structure { scales, p, words, remarks, finer }
    }
}

/// The test of dependence as a scale.
fn dependent([statistic, dof, p]: [f64; 3]) -> Scale {
    let words = "samples depend on those before them".to_owned();
    Scale { of: "order of the samples".to_owned(), parts: 0, statistic, dof, p, detectable: None, words, finer: None }
}
