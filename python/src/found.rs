//! What a test found, as Python sees it.

use crate::exception;
use etalon::study::albedo::Table;
use etalon::study::compare::{Answer, Compared};
use etalon::study::validation::{Tested, Validation};
use etalon::summary::{Medium, Style, Summary, Theme};
use etalon_stats::Verdict;
use etalon_stats::multiple::any_of;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A result; see `etalon_bench.Result`.
#[pyclass(frozen, module = "etalon_bench._native")]
pub struct Found {
    #[pyo3(get)]
    name: String,
    /// "accept", "reject" or "inconclusive".
    #[pyo3(get)]
    verdict: String,
    #[pyo3(get)]
    p: Option<f64>,
    #[pyo3(get)]
    statistic: Option<f64>,
    #[pyo3(get)]
    dof: Option<usize>,
    #[pyo3(get)]
    detectable: Option<f64>,
    #[pyo3(get)]
    integral: Option<f64>,
    #[pyo3(get)]
    samples: u64,
    #[pyo3(get)]
    seconds: f64,
    #[pyo3(get)]
    reason: Option<String>,
    /// Where it fails, a place each.
    #[pyo3(get)]
    places: Vec<String>,
    #[pyo3(get)]
    text: String,
    /// The single tests of a run.
    #[pyo3(get)]
    checks: Vec<Py<Found>>,
    summary: Box<dyn Summary + Send + Sync>,
}

#[pymethods]
impl Found {
    /// The figure as an SVG document.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| self.summary.drawing().svg())
    }

    /// Writes the figure in a style, in the format that the extension of `path` names.
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        style: &str,
        theme: &str,
        title: String,
        width: Option<f64>,
    ) -> PyResult<Vec<PathBuf>> {
        let medium = named("style", style, Medium::ALL)?;
        let mut style = Style::new(medium, width).map_err(exception)?;
        (style.title, style.theme) = (title, named("theme", theme, Theme::ALL)?);
        py.detach(|| self.summary.drawing().save(&path, &style)).map_err(exception)
    }

    /// The table as a CSV document, if there is one.
    fn csv(&self) -> PyResult<Option<String>> {
        let csv = self.summary.csv().map_err(exception)?;
        Ok(csv.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
    }
}

/// The value of that name.
fn named<T, const N: usize>(argument: &str, name: &str, all: [(&str, &str, T); N]) -> PyResult<T> {
    let names = all.each_ref().map(|(known, ..)| *known).join(", ");
    let found = all.into_iter().find(|(known, ..)| *known == name).map(|(.., value)| value);
    found.ok_or_else(|| PyValueError::new_err(format!("{argument}: {name:?}; wanted one of {names}")))
}

impl Found {
    fn new(name: &str, verdict: Verdict, text: String, summary: impl Summary + Send + Sync + 'static) -> Self {
        Self {
            name: name.to_owned(),
            verdict: verdict.to_string(),
            p: None,
            statistic: None,
            dof: None,
            detectable: None,
            integral: None,
            samples: 0,
            seconds: 0.0,
            reason: None,
            places: Vec::new(),
            text,
            checks: Vec::new(),
            summary: Box::new(summary),
        }
    }

    /// The same, rejected for this reason, if there is one.
    pub fn because(self, reason: Option<String>) -> Self {
        let Some(reason) = reason else { return self };
        let (verdict, text) = (Verdict::Reject.to_string(), format!("{reason}\n{}", self.text));
        Self { verdict, text, reason: Some(reason), ..self }
    }

    /// One test, with `text` in place of its summary's, if given.
    pub fn of_test(tested: Tested, text: Option<String>) -> Self {
        let outcome = tested.outcome.clone();
        let text = text.unwrap_or_else(|| tested.text());
        let places = outcome.places().map(str::to_owned).collect();
        Self {
            p: outcome.p,
            statistic: Some(outcome.statistic).filter(|_| outcome.dof > 0),
            dof: Some(outcome.dof).filter(|dof| *dof > 0),
            detectable: outcome.detectable,
            integral: outcome.mass.map(|mass| mass.value),
            samples: outcome.samples,
            seconds: outcome.seconds,
            reason: outcome.reason(),
            places,
            ..Self::new(&tested.name.clone(), outcome.verdict, text, tested)
        }
    }

    /// A run of tests that share a level.
    pub fn of_run(py: Python<'_>, name: &str, run: Validation) -> PyResult<Self> {
        let outcomes = || run.tests.iter().map(|test| &test.outcome);
        let verdict = match &run {
            Validation { rejected: 1.., .. } => Verdict::Reject,
            Validation { inconclusive: 1.., .. } => Verdict::Inconclusive,
            _ => Verdict::Accept,
        };
        let least = outcomes().filter_map(|outcome| outcome.p).min_by(f64::total_cmp);
        let places = run.causes();
        let checks = run.tests.iter().map(|test| Py::new(py, Self::of_test(test.clone(), None)));
        Ok(Self {
            // Below the level if and only if the step-down rejects at least one
            p: least.map(|p| any_of(p, run.tests.len())),
            // Exact checks state what they tolerate, which is no power
            detectable: outcomes()
                .filter(|outcome| outcome.p.is_some())
                .filter_map(|outcome| outcome.detectable)
                .max_by(f64::total_cmp),
            samples: outcomes().map(|outcome| outcome.samples).sum(),
            seconds: run.seconds,
            reason: places.first().cloned(),
            places,
            checks: checks.collect::<PyResult<_>>()?,
            ..Self::new(name, verdict, run.text(), run)
        })
    }

    /// Two renderers.
    pub fn of_comparison(name: &str, compared: Compared, seconds: f64) -> Self {
        let verdict = match compared.answer {
            Answer::Different | Answer::NotFinite => Verdict::Reject,
            Answer::NoDifferenceFound => Verdict::Accept,
            Answer::CannotTell | Answer::NotIndependent => Verdict::Inconclusive,
        };
        let (text, level) = (compared.text(), compared.plan.level);
        let worst = compared.families.iter().filter(|family| family.adjusted_p.is_some_and(|p| p < level));
        let place = |worst: &etalon::study::compare::Tested| {
            let [a, b] = worst.means;
            format!("{}, channel {}: {a:.6} and {b:.6}", worst.functional, compared.channels[worst.channel])
        };
        let places = worst.filter_map(|family| family.worst.as_ref()).map(place).collect();
        Self {
            p: compared.families.iter().filter_map(|family| family.adjusted_p).min_by(f64::total_cmp),
            detectable: compared.uniform_bias,
            samples: compared.images.iter().map(|count| *count as u64).sum(),
            seconds,
            reason: (verdict != Verdict::Accept).then(|| text.lines().next().unwrap_or_default().to_owned()),
            places,
            ..Self::new(name, verdict, text, compared)
        }
    }

    /// A furnace test whose albedos should have errors of at most `error`.
    pub fn of_albedos(table: Table, error: f64) -> Self {
        let at = |row: &etalon::study::albedo::Row| {
            format!(
                "at {:.2}°, parameter {}: albedo {:.5} ± {:.1e}",
                row.theta_deg, row.parameter, row.albedo, row.error
            )
        };
        let places: Vec<String> = table.rows.iter().filter(|row| row.is_violation).map(at).collect();
        let verdict = table.verdict();
        let reason = match verdict {
            Verdict::Accept => None,
            Verdict::Reject => Some(places.first().map_or("the weak furnace test fails", String::as_str).to_owned()),
            Verdict::Inconclusive => Some(format!("errors of albedos are larger than {error}")),
        };
        Self {
            detectable: table.with_largest_error().map(|row| row.error),
            seconds: table.seconds,
            reason,
            places,
            ..Self::new(&table.family.clone(), verdict, table.text(), table)
        }
    }
}
