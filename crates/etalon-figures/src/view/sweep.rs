//! The results of a sweep in words.

use super::checks::Check;
use super::text::{LINE, counted, p_is, plain_p_value, wrapped};
use etalon_bench::sweep::{Conclusion, Description, Failure, Group};
use etalon_bench::table::Table;
use etalon_stats::Verdict;
use etalon_stats::sweep::CONFIRM_LEVEL;

/// The verdict, the table of families and checks, what fails, with the command that runs it again, and a summary. `replay_by` is the command but
/// for its last argument. Checks that accept are told if `all` are.
pub fn text(found: &Conclusion, sweep: &Description, replay_by: &str, all: bool) -> String {
    // In percent of the configurations; shown for checks with p-values
    let powered = |group: &Group| 100.0 * group.powered as f64 / group.configurations.max(1) as f64;
    let mut text = format!("rejected: {}; inconclusive: {}\n", found.rejected, found.inconclusive);
    let is_told = |group: &&Group| all || group.rejected + group.inconclusive > 0;
    let groups: Vec<&Group> = found.groups.iter().filter(is_told).collect();
    let table = Table::of(&groups)
        .words("family", |group| &group.family)
        .words("check", |group| &group.check)
        .numbers("runs", |group| group.configurations)
        .numbers("rejected", |group| group.rejected)
        .numbers("undecided", |group| group.inconclusive)
        .numbers("survive", |group| group.min_p.map_or("-".into(), |_| group.survivors.to_string()))
        .numbers("min p", |group| group.min_p.map_or("-".into(), plain_p_value))
        .numbers(format!("finds {} %", 100.0 * sweep.detect()), |group| {
            group.min_p.map_or("-".into(), |_| format!("in {:.1} %", powered(group)))
        });
    text += &if groups.is_empty() { String::new() } else { table.text() };
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
        "\n{} of {} by {}, seed {}: {} checks at level {} together\n",
        counted(found.configurations as usize, "configuration"),
        if found.families == 1 { "1 family".into() } else { format!("{} families", found.families) },
        sweep.strategy(),
        sweep.seed(),
        found.checks,
        sweep.level(),
    );
    text += &wrapped(&format!("{survived}{smallest}"), "", LINE);
    if found.left_out > 0 {
        text += &format!("{} more survived and were not run again\n", counted(found.left_out as usize, "test"));
    }
    text
}

pub fn checks(found: &Conclusion) -> Vec<Check> {
    let one = |group: &Group| {
        let failures = found.failures.iter().filter(|of| (&of.family, &of.check) == (&group.family, &group.check));
        let details: Vec<String> = failures.map(|of| format!("{}\n{}\n", of.replay, of.message)).collect();
        Check {
            group: format!("sweep/{}", group.family),
            name: group.check.clone(),
            verdict: Some(match (group.rejected, group.inconclusive) {
                (1.., _) => Verdict::Reject,
                (0, 1..) => Verdict::Inconclusive,
                (0, 0) => Verdict::Accept,
            }),
            message: format!(
                "{} rejected, {} inconclusive of {}",
                group.rejected,
                group.inconclusive,
                counted(group.configurations as usize, "configuration")
            ),
            details: details.concat(),
            seconds: None,
        }
    };
    let left_out = (found.left_out > 0).then(|| Check {
        group: "sweep".into(),
        name: "survivors".into(),
        verdict: Some(Verdict::Inconclusive),
        message: format!("{} survived and were not run again", counted(found.left_out as usize, "test")),
        details: String::new(),
        seconds: None,
    });
    found.groups.iter().map(one).chain(left_out).collect()
}
