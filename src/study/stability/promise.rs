//! What the suite promises of the code that renders, and whether it was kept.

use super::family::{Precision, STABLE};
use super::row::Row;
use super::sweep::{Case, Sweep};
use serde::Serialize;

/// A bound on an error.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Promise {
    pub name: String,
    pub got: f64,
    pub limit: f64,
    pub kept: bool,
    /// The input of the largest error, as `--replay` takes it.
    pub worst: String,
}

impl Promise {
    /// got ≤ limit, written so that NaN breaks it.
    fn new(name: impl Into<String>, got: f64, limit: f64, worst: String) -> Self {
        Self { name: name.into(), got, limit, kept: got <= limit, worst }
    }

    /// The largest of `error` over the renderer's form of some families, from the cases that it judges.
    fn largest(name: &str, limit: f64, sweeps: &[&Sweep], error: impl Fn(&Case) -> Option<f64>) -> Self {
        let (mut got, mut worst) = (0.0, String::new());
        for (family, case) in sweeps.iter().flat_map(|s| s.cases.iter().map(|case| (s.family, case))) {
            match error(case) {
                Some(e) if e > got || e.is_nan() => (got, worst) = (e, case.text(family)),
                _ => {}
            }
        }
        Self::new(name, got, limit, worst)
    }
}

/// The promises about what was run.
#[must_use]
pub fn promises(sweeps: &[Sweep], rows: &[Row]) -> Vec<Promise> {
    let swept = |names: &[&str]| sweeps.iter().filter(|s| names.contains(&s.family.name)).collect::<Vec<_>>();
    let ran = |name: &str| rows.iter().filter(|r| r.family == name && r.form.starts_with(STABLE)).collect::<Vec<_>>();
    let mut list = Vec::new();
    let lost = rows.iter().filter(|r| r.form.starts_with(STABLE) && r.non_finite > 0);
    let (mut count, mut worst) = (0, String::new());
    lost.for_each(|row| (count, worst) = (count + row.non_finite, row.worst.clone()));
    list.push(Promise::new("results that are not finite", count as f64, 0.0, worst));
    let fresnel = swept(&["fresnel"]);
    if !fresnel.is_empty() {
        list.push(Promise::largest("Fresnel in f32 away from the critical angle, relative", 1e-6, &fresnel, |case| {
            let [eta, cos] = [case.inputs[0], case.inputs[1]];
            let judged = case.precision == Precision::Single && (1e-3..=1e3).contains(&eta) && away(eta, cos);
            judged.then(|| case.off[0].map(|off| off.relative)).flatten()
        }));
        list.push(Promise::largest("Fresnel anywhere, last places over condition number", 8.0, &fresnel, |case| {
            case.off[0].map(|off| off.ulp / case.condition.max(1.0))
        }));
    }
    let densities = swept(&["beckmann-d", "ggx-d", "beckmann-pdf", "ggx-pdf"]);
    if !densities.is_empty() {
        list.push(Promise::largest("D and pdf in f32 from alpha = 1e-4 on, relative", 4e-6, &densities, |case| {
            let judged = case.precision == Precision::Single && case.inputs[0] >= 1e-4;
            judged.then(|| case.off[0].map(|off| off.relative)).flatten()
        }));
    }
    for (name, family) in [("energy drift in a furnace", "paths"), ("energy drift of walks over materials", "walks")] {
        let rows = ran(family);
        list.extend(rows.iter().map(|r| Promise::new(name, r.max_relative, 1e-4, r.worst.clone())));
    }
    let unreached = ran("tables");
    if !unreached.is_empty() {
        let count: u64 = unreached.iter().map(|r| r.out_of_range).sum();
        list.push(Promise::new("bins of positive weight out of reach", count as f64, 0.0, String::new()));
    }
    list
}

/// Whether a direction is a degree or more from the critical angle.
fn away(eta: f64, cos: f64) -> bool {
    eta >= 1.0 || (cos.acos() - eta.asin()).abs() >= 1f64.to_radians()
}
