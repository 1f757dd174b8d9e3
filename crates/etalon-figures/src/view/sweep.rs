//! The results of a sweep in words.

use super::text::{counted, p_is, plain_p_value};
use etalon_bench::sweep::{Conclusion, Description, Failure, Group};
use etalon_stats::sweep::CONFIRM_LEVEL;

/// The table of families and checks, what fails, with the command that runs it again, and a summary. `replay_by` is the command but
/// for its last argument.
pub fn text(found: &Conclusion, sweep: &Description, replay_by: &str) -> String {
    let width = found.groups.iter().map(|group| group.family.len()).max().unwrap_or(0).max("family".len());
    let mut text = format!(
        "{:<width$}  check        configurations accepted rejected inconclusive survivors    min p  detects {} %\n",
        "family",
        100.0 * sweep.detect()
    );
    for group in &found.groups {
        let Group { family, check, configurations, accepted, rejected, inconclusive, survivors, min_p, powered } =
            group;
        let [survivors, p, power] = match min_p {
            Some(p) => {
                let share = 100.0 * *powered as f64 / (*configurations).max(1) as f64;
                [survivors.to_string(), plain_p_value(*p), format!("in {share:.1} %")]
            }
            None => ["-"; 3].map(str::to_owned),
        };
        let mark = if *rejected > 0 { "  <- rejected" } else { "" };
        text += &format!(
            "{family:<width$}  {check:<12} {configurations:>14} {accepted:>8} {rejected:>8} {inconclusive:>12} \
             {survivors:>9} {p:>8} {power:>11}{mark}\n"
        );
    }
    for failure in &found.failures {
        let Failure { family, check, configurations, example, shrunk, replay, message, p } = failure;
        let p = p.map_or(String::new(), |p| format!(", {}", p_is(p)));
        let many = counted(*configurations as usize, "configuration");
        let which = match shrunk {
            true => "the simplest found".to_owned(),
            false => format!("not shrunk, which takes p < {CONFIRM_LEVEL:.0e}"),
        };
        text += &format!("\n{family}: {check} rejects in {many}, such as\n  {example}\n{which}{p}:\n");
        text += &format!("  {replay_by} '{replay}'\n");
        text += &if message.is_empty() { String::new() } else { format!("  {message}\n") };
    }
    let survived = format!(
        "{} survived the screen (p < 0.001; at most {:.1} expected of right BSDFs) and {} run again",
        counted(found.survivors, "test"),
        found.expected_survivors,
        if found.survivors == 1 { "was" } else { "were" }
    );
    let smallest = found.min_fresh_p.map_or(String::new(), |p| format!(", smallest fresh {}", p_is(p)));
    text += &format!(
        "\n{} of {} by {}, seed {}: {} checks at level {} together\n{survived}{smallest}\n",
        counted(found.configurations as usize, "configuration"),
        if found.families == 1 { "1 family".into() } else { format!("{} families", found.families) },
        sweep.strategy(),
        sweep.seed(),
        found.checks,
        sweep.level(),
    );
    if found.left_out > 0 {
        text += &format!("{} more survived and were not run again\n", counted(found.left_out as usize, "test"));
    }
    text += &format!("rejected: {}; inconclusive: {}\n", found.rejected, found.inconclusive);
    text
}
