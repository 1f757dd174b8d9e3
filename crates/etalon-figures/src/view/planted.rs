//! The table of planted faults.

use etalon_bench::validation::planted::{By, Finding, Findings};
use serde::Serialize;

/// One fault. Field names are the CSV columns.
#[derive(Debug, Default, Serialize)]
pub struct Row<'a> {
    name: &'a str,
    mistake: &'a str,
    verdict: String,
    by: &'a str,
    violation: &'a str,
    diagnosis: &'a str,
    statistic: f64,
    dof: usize,
    p: Option<f64>,
    samples: u64,
    detectable: Option<f64>,
    error: Option<f64>,
    verdict_without: String,
    p_without: Option<f64>,
    remark_without: &'a str,
}

pub fn rows<'a>(findings: &'a Findings) -> Vec<Row<'a>> {
    let row = |test: &'a Finding| {
        let Finding { name, mistake, outcome, by, error, sound, sound_p, sound_remark } = test;
        Row {
            name,
            mistake,
            verdict: outcome.verdict.to_string(),
            by: by.map_or("", By::name),
            violation: outcome.violation.as_deref().unwrap_or(""),
            diagnosis: outcome.diagnosis.as_deref().unwrap_or(""),
            statistic: outcome.statistic,
            dof: outcome.dof,
            p: outcome.p,
            samples: outcome.samples,
            detectable: outcome.detectable,
            error: *error,
            verdict_without: sound.to_string(),
            p_without: *sound_p,
            remark_without: sound_remark.as_deref().unwrap_or(""),
        }
    };
    findings.tests.iter().map(row).collect()
}
