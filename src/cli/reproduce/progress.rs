//! What `reproduce` shows as it runs: which figure runs, and how much time is left if a former run tells how long figures take;
//! the lines of figures: id, verdict, seconds and files when a figure is done, and its checks below.

use crate::cli::console::{Console, bar_style};
use etalon_figures::gallery::{Check, Reproduced, skipped};
use etalon_figures::output::braced;
use etalon_figures::view::text::{counted, wrapped};
use indicatif::{ProgressBar, ProgressState};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest time of a figure in ms that is believed, eleven days, so that no sum overflows.
const LONGEST: f64 = 1e9;

/// The figures of a run in their order.
struct Plan {
    ids: Vec<&'static str>,
    /// How long each takes, in ms (at least 1); empty where that is not known of all.
    times: Vec<u64>,
}

impl Plan {
    fn new(ids: Vec<&'static str>, seconds: &dyn Fn(&str) -> Option<f64>) -> Self {
        let time =
            |id: &&'static str| seconds(id).filter(|s| s.is_finite()).map(|s| (1e3 * s).clamp(1.0, LONGEST) as u64);
        let times = ids.iter().map(time).collect::<Option<Vec<u64>>>().unwrap_or_default();
        Self { ids, times }
    }

    /// Steps of the bar before the `i`-th figure, in milliseconds if they are known; after the last one, of all.
    fn steps(&self, i: usize) -> u64 {
        if self.times.is_empty() { i as u64 } else { self.times[..i].iter().sum() }
    }

    /// "figure 7 of 55: audit".
    fn message(&self, i: usize) -> String {
        format!("figure {} of {}: {}", i + 1, self.ids.len(), self.ids[i])
    }

    /// The share of the time before the `i`-th figure, rounded down: never 100 % while one runs.
    fn percent(&self, i: usize) -> u64 {
        100 * self.steps(i) / self.steps(self.ids.len()).max(1)
    }

    /// What is left while the `i`-th figure runs, which was begun after `before` and has run for `since`; figures take as much
    /// longer than in the former run as those before did.
    fn left(&self, i: usize, before: Duration, since: Duration) -> String {
        let done = self.steps(i) as f64;
        let pace = if done > 0.0 { 1e3 * before.as_secs_f64() / done } else { 1.0 };
        let time = |from: usize, to: usize| 1e-3 * (self.steps(to) - self.steps(from)) as f64 * pace;
        let (this, others) = (time(i, i + 1) - since.as_secs_f64(), time(i + 1, self.ids.len()));
        let about = if this >= 0.0 { "about" } else { "more than" };
        let seconds = this.max(0.0) + others;
        format!("{about} {:.0}:{:02.0} left", (seconds / 60.0).floor(), (seconds % 60.0).floor())
    }
}

/// The bar on the terminal.
pub struct Progress {
    plan: Arc<Plan>,
    bar: ProgressBar,
    start: Instant,
}

impl Progress {
    /// The progress of the figures of `ids`; `seconds` is the time of one in a former run.
    pub fn new(console: &Console, ids: Vec<&'static str>, seconds: &dyn Fn(&str) -> Option<f64>) -> Self {
        let plan = Plan::new(ids, seconds);
        let bar = console.bar(plan.steps(plan.ids.len()));
        Self { plan: plan.into(), bar, start: Instant::now() }
    }

    /// Names the figure that begins now.
    pub fn begin(&self, id: &str) {
        let i = self.plan.ids.iter().position(|known| *known == id).unwrap_or(0);
        let (plan, begin, before) = (self.plan.clone(), Instant::now(), self.start.elapsed());
        let end = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
            // Writing into memory cannot fail.
            let _ = write!(out, "{:>3} %  {}", plan.percent(i), plan.left(i, before, begin.elapsed()));
        };
        let is_timed = !self.plan.times.is_empty();
        let style = bar_style(if is_timed { "{msg}  [{bar:30}] {end}" } else { "{msg}  {elapsed}" });
        self.bar.set_style(if is_timed { style.with_key("end", end) } else { style });
        self.bar.set_message(self.plan.message(i));
        self.bar.set_position(self.plan.steps(i));
        // The times move on while the figure runs
        self.bar.enable_steady_tick(Duration::from_millis(200));
    }

    /// Prints by `tell` while the bar is away.
    pub fn suspend(&self, tell: impl FnOnce()) {
        self.bar.suspend(tell);
    }

    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

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

    fn plan(seconds: &[Option<f64>]) -> Plan {
        let ids = ["0", "1", "2"];
        Plan::new(ids[..seconds.len()].to_vec(), &|id: &str| seconds[id.parse::<usize>().unwrap()])
    }

    #[test]
    fn figures_weigh_what_they_take_and_the_last_one_is_not_done() {
        let plan = plan(&[Some(1.0), Some(999.0), Some(0.0)]);
        assert_eq!([0, 1, 2].map(|i| plan.percent(i)), [0, 0, 99]);
        assert_eq!(plan.message(1), "figure 2 of 3: 1");
    }

    #[test]
    fn what_is_left_follows_the_pace_and_is_not_told_to_be_less_than_known() {
        let plan = plan(&[Some(10.0), Some(20.0), Some(60.0)]);
        let left = |i, before, since| plan.left(i, Duration::from_secs(before), Duration::from_secs(since));
        assert_eq!([left(0, 0, 0), left(0, 0, 4)], ["about 1:30 left", "about 1:26 left"]);
        // Twice as slow as before
        assert_eq!([left(1, 20, 0), left(1, 20, 41)], ["about 2:40 left", "more than 2:00 left"]);
        assert_eq!(left(2, 30, 61), "more than 0:00 left");
    }

    #[test]
    fn an_unknown_time_makes_no_estimate() {
        assert_eq!(plan(&[Some(1e300), Some(-1.0)]).percent(1), 99);
        for unknown in [None, Some(f64::NAN)] {
            let plan = plan(&[Some(5.0), unknown]);
            assert!(plan.times.is_empty() && plan.steps(2) == 2);
        }
    }

    fn figure(id: &'static str, extensions: &[&str], checks: Vec<Check>) -> Reproduced {
        let files = extensions.iter().map(|extension| PathBuf::from(format!("a/b/{id}.{extension}"))).collect();
        let (errata, claims, printed, numbers) = Default::default();
        Reproduced { id, files, seconds: 1234.56, checks, errata, claims, printed, numbers }
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
