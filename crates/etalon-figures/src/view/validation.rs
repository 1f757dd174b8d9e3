//! A run of tests as a table and as a drawing of its p-values.

use super::{text::p_value, validation_cells};
use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use etalon_bench::validation::{Tested, Validation};
use etalon_stats::{Bound, Verdict};
use serde::Serialize;

/// A line of the table. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Row<'a> {
    name: &'a str,
    verdict: String,
    statistic: f64,
    dof: usize,
    p: Option<f64>,
    samples: u64,
    /// Relative error of the pdf (root mean square) that is detected with 90 % probability.
    detectable: Option<f64>,
    mass: Option<f64>,
    mass_error: Option<f64>,
    mass_bound: Option<Bound>,
    cells: usize,
    /// Cells put together for lack of expected samples.
    pooled: usize,
    /// Samples without a direction.
    none: u64,
    repeated: bool,
    seconds: f64,
    /// A violation, or why the test is inconclusive.
    remark: &'a str,
    /// Where samples and pdf differ most, of a rejected test.
    diagnosis: &'a str,
    /// What users should know though it does not decide.
    remarks: String,
    /// What is detected between the cells.
    finer: String,
}

pub fn rows(validation: &Validation) -> Vec<Row<'_>> {
    let tests = validation.tests.iter();
    tests
        .map(|Tested { name, outcome }| Row {
            name,
            verdict: outcome.verdict.to_string(),
            statistic: outcome.statistic,
            dof: outcome.dof,
            p: outcome.p,
            samples: outcome.samples,
            detectable: outcome.detectable,
            mass: outcome.mass.map(|mass| mass.value),
            mass_error: outcome.mass.map(|mass| mass.error),
            mass_bound: outcome.mass.map(|mass| mass.bound),
            cells: outcome.cells,
            pooled: outcome.pooled,
            none: outcome.none,
            repeated: outcome.repeated,
            seconds: outcome.seconds,
            remark: outcome.remark().unwrap_or_default(),
            diagnosis: outcome.diagnosis.as_deref().unwrap_or_default(),
            remarks: outcome.remarks.join("; "),
            finer: outcome.finer().unwrap_or_default(),
        })
        .collect()
}

/// A single test, or the p-values of several and why those that are not accepted are not.
pub fn drawing(validation: &Validation) -> Drawing {
    match validation.tests.as_slice() {
        [test] => validation_cells::drawing(test),
        tests => {
            let rows = std::iter::once(p_values(validation)).chain(validation_cells::reasons(tests));
            Drawing::stacked(rows.collect(), 0.5, 2.0)
        }
    }
}

/// The run's p-values in ascending order against those of true claims, on linear and logarithmic axes.
fn p_values(validation: &Validation) -> Drawing {
    let tests = validation.ranked();
    let (n, total) = (tests.len(), validation.tests.len());
    // p-values of 0 and below what a double can hold are at the lower end of the logarithmic axis.
    const LEAST: f64 = 1e-20;
    let dots = |verdict: Verdict, least: f64| -> Vec<Point> {
        tests.iter().filter(|test| test.verdict == verdict).map(|test| [test.expected, test.p.max(least)]).collect()
    };
    let band: Vec<[f64; 3]> = tests.iter().map(|t| [t.expected, t.interval[0], t.interval[1]]).collect();
    let line: Vec<Point> = tests.iter().map(|t| [t.expected, t.expected]).collect();
    let holm: Vec<Point> = tests.iter().map(|t| [t.expected, t.threshold]).collect();
    let panel = |x: Axis, y: Axis, least: f64| {
        let panel = Panel::new(x, y)
            .band("99 % of true claims at each rank", theme::INTERVAL, band.clone())
            .line("expected", Stroke::solid(theme::EXPECTED, theme::THIN), line.clone())
            .line(
                "rejected below",
                Stroke { dash: theme::DASHED, ..Stroke::solid(theme::REJECTED, theme::THIN) },
                holm.clone(),
            )
            .dots("accepted", theme::ACCEPTED.faded(0.5), dots(Verdict::Accept, least));
        [("rejected", theme::REJECTED, Verdict::Reject), ("inconclusive", theme::INCONCLUSIVE, Verdict::Inconclusive)]
            .into_iter()
            .filter(|(.., verdict)| tests.iter().any(|test| test.verdict == *verdict))
            .fold(panel, |panel, (name, colour, verdict)| panel.dots(name, colour, dots(verdict, least)))
    };
    // The logarithmic panel starts a decade below the smallest p-value and threshold
    let smallest = tests.first().map_or(LEAST, |test| test.p.clamp(LEAST, 1.0));
    let foot = 10f64.powf(smallest.min(holm.first().map_or(1.0, |p| p[1])).log10().floor() - 1.0);
    let first = tests.first().map_or(1.0, |test| test.expected);
    let uniformity = validation.uniformity;
    Plot::new([
        panel(Axis::linear("rank / (tests + 1)").range(0.0, 1.0), Axis::linear("/{p}-value").range(0.0, 1.0), 0.0)
            .title(format!("{n} /{{p}}-values of {total} tests: uniformity {}", p_value(uniformity.p))),
        panel(Axis::log("rank / (tests + 1)").range(0.8 * first, 1.0), Axis::log("/{p}-value").range(foot, 1.0), foot)
            .title(format!(
                "{} accepted, {} rejected, {} inconclusive",
                validation.accepted, validation.rejected, validation.inconclusive
            )),
    ])
    .draw()
}
