//! The lines of figures: id, verdict, seconds and files when a figure is done, and its checks below.

use etalon_figures::gallery::{Check, Reproduced, skipped};
use etalon_figures::output::braced;
use etalon_figures::view::text::{counted, wrapped};
use std::path::{Path, PathBuf};

/// Most columns of a line.
const WIDTH: usize = 100;

/// How figures are told of.
pub struct Lines {
    /// Columns of the longest id.
    pub id: usize,
    /// Whether all checks are told, not only failed ones.
    pub verbose: bool,
}

impl Lines {
    /// What is told of a figure that is done.
    pub fn of(&self, figure: &Reproduced) -> String {
        let Reproduced { id, files, seconds, checks, .. } = figure;
        let verdict = match checks.iter().filter(|check| check.failed()).count() {
            0 if checks.iter().all(|check| check.pass.is_none()) => "skipped".into(),
            0 => format!("ok, {}", counted(checks.len(), "check")),
            failed => format!("FAILED {failed} of {}", checks.len()),
        };
        // The summary names the folder
        let names: Vec<PathBuf> = files.iter().filter_map(|file| file.file_name()).map(PathBuf::from).collect();
        let mut text =
            format!("{id:<width$}  {verdict:<14}  {seconds:>6.1} s  {}\n", braced(&names).join(" "), width = self.id);
        for check in checks.iter().filter(|check| self.verbose || check.failed()) {
            let verdict = match check.pass {
                Some(true) => "ok",
                Some(false) => "FAILED",
                None => "skipped",
            };
            text += &wrapped(&format!("{verdict}: {}: {}", check.name, found(check)), "    ", WIDTH);
        }
        for (count, why) in skipped(checks.iter()) {
            text += &wrapped(&format!("{} skipped: {why}", counted(count, "check")), "    ", WIDTH);
        }
        text
    }
}

/// The number of a check beside what it must be, or why there is none.
pub fn found(check: &Check) -> String {
    let why = if check.pass.is_none() { format!(" ({})", check.skipped) } else { String::new() };
    format!("{}, must be {}{why}", check.measured(), check.demand())
}

/// The last lines: what a run left out, and its sum.
pub fn summary(figures: &[Reproduced], interrupted: bool, page: &Path, seconds: f64) -> String {
    let checks = || figures.iter().flat_map(|figure| &figure.checks);
    let failed = checks().filter(|check| check.failed()).count();
    let reasons = skipped(checks());
    let left_out = if reasons.is_empty() {
        String::new()
    } else {
        let count: usize = reasons.iter().map(|(count, _)| count).sum();
        let reasons: Vec<String> = reasons.iter().map(|(count, why)| format!("{count}: {why}")).collect();
        format!(", {count} skipped ({})", reasons.join("; "))
    };
    let interruption = if interrupted { "interrupted: the other figures were not made\n" } else { "" };
    format!(
        "{interruption}{} in {}: {}, {failed} failed{left_out}; {seconds:.1} s\n",
        counted(figures.len(), "figure"),
        page.display(),
        counted(checks().count(), "check")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_figures::gallery::registry;

    fn figure(id: &'static str, extensions: &[&str], checks: Vec<Check>) -> Reproduced {
        let files = extensions.iter().map(|extension| PathBuf::from(format!("a/b/{id}.{extension}"))).collect();
        let (errata, claims, printed) = Default::default();
        Reproduced { id, files, seconds: 1234.56, checks, errata, claims, printed }
    }

    fn checks() -> Vec<Check> {
        vec![Check::at_most("error of a name that is long ".repeat(5), f64::NAN, 1.0), Check::is_true("fine", true)]
    }

    #[test]
    fn failed_checks_stand_below_their_figure_and_all_if_asked_for() {
        let lines = |verbose| Lines { id: 6, verbose }.of(&figure("iron", &["csv", "svg", "png", "pdf"], checks()));
        let text = lines(false);
        assert!(
            text.starts_with("iron    FAILED 1 of 2   1234.6 s  iron.{csv,svg,png,pdf}\n    FAILED: error of"),
            "{text}"
        );
        assert!(text.contains("NaN, must be ≤ 1\n") && !text.contains("fine"), "{text}");
        assert_eq!(lines(true), text + "    ok: fine: true, must be true\n");
        let text = Lines { id: 4, verbose: false }.of(&figure("iron", &["csv"], vec![Check::is_true("fine", true)]));
        assert_eq!(text, "iron  ok, 1 check     1234.6 s  iron.csv\n");
        let other = Check::at_most("error", 2.0, 1.0).unless(Some("the map is nave"));
        let text = |verbose| Lines { id: 4, verbose }.of(&figure("iron", &["csv"], vec![other.clone()]));
        assert_eq!(text(false), "iron  skipped         1234.6 s  iron.csv\n    1 check skipped: the map is nave\n");
        assert!(text(true).contains("    skipped: error: not measured, must be ≤ 1 (the map is nave)\n"));
    }

    #[test]
    fn lines_of_all_figures_are_at_most_100_columns_wide() {
        let all = registry();
        let id = all.iter().map(|figure| figure.id.len()).max().unwrap();
        for entry in all {
            let text = Lines { id, verbose: true }.of(&figure(&entry.id, &["csv", "svg", "png", "pdf"], checks()));
            assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        }
    }

    #[test]
    fn the_summary_counts_what_failed() {
        let other = Check::at_most("error", 2.0, 1.0).unless(Some("the map is nave"));
        let skipped = summary(&[figure("iron", &[], vec![other])], false, Path::new("f"), 2.0);
        assert_eq!(skipped, "1 figure in f: 1 check, 0 failed, 1 skipped (1: the map is nave); 2.0 s\n");
        let made = [figure("iron", &[], checks()), figure("audit", &[], checks())];
        let text = |interrupted| summary(&made, interrupted, Path::new("f/index.html"), 2.0);
        assert_eq!(text(false), "2 figures in f/index.html: 4 checks, 2 failed; 2.0 s\n");
        assert!(text(true).starts_with("interrupted: "));
    }
}
