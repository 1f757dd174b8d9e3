//! The checks of a run for continuous integration, as JUnit XML and as Markdown: what was rejected or is inconclusive, and why.
//!
//! Sources of the formats: the schema of Jenkins' xUnit plugin, `junit-10.xsd`; GitHub Flavored Markdown, version 0.29.

use super::text::counted;
use crate::figure::escape;
use etalon_bench::table::Table;
use etalon_stats::Verdict;

/// A check, and how it ended.
pub struct Check {
    /// What it belongs to: a family of tests, a figure.
    pub group: String,
    pub name: String,
    /// `None` if it was skipped; the message says why.
    pub verdict: Option<Verdict>,
    /// What was found, in a line: where, and how large.
    pub message: String,
    /// What the terminal says of it, if that is more than the message.
    pub details: String,
    /// Wall-clock time, where it is known of this check alone.
    pub seconds: Option<f64>,
}

pub struct Checks {
    pub title: String,
    pub list: Vec<Check>,
    /// Wall-clock time of the run.
    pub seconds: f64,
}

impl Checks {
    /// Adds what an interrupted run has left out as an inconclusive check.
    pub fn interrupted(&mut self, left_out: &str) {
        self.list.push(Check {
            group: "run".into(),
            name: "completeness".into(),
            verdict: Some(Verdict::Inconclusive),
            message: format!("interrupted: {left_out}"),
            details: String::new(),
            seconds: None,
        });
    }

    fn of(&self, verdict: Option<Verdict>) -> impl Iterator<Item = &Check> + Clone {
        self.list.iter().filter(move |check| check.verdict == verdict)
    }

    /// As JUnit XML: rejected checks are failures, inconclusive ones errors, and those that were skipped are skipped.
    pub fn junit(&self) -> String {
        let mut text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"{}\" tests=\"{}\" \
             failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3}\">\n",
            escape(&self.title),
            self.list.len(),
            self.of(Some(Verdict::Reject)).count(),
            self.of(Some(Verdict::Inconclusive)).count(),
            self.of(None).count(),
            self.seconds
        );
        for Check { group, name, verdict, message, details, seconds } in &self.list {
            let time = seconds.map_or(String::new(), |seconds| format!(" time=\"{seconds:.3}\""));
            let class = escape(&group.replace('/', "."));
            let case = format!("<testcase classname=\"{class}\" name=\"{}\"{time}", escape(name));
            let body = |kind: &str| {
                let details = if details.is_empty() { message } else { details };
                let (message, details) = (escape(message), escape(details));
                format!("{case}>\n<{kind} message=\"{message}\">{details}</{kind}>\n</testcase>\n")
            };
            text += &match verdict {
                Some(Verdict::Accept) if details.is_empty() => format!("{case}/>\n"),
                Some(Verdict::Accept) => {
                    format!("{case}>\n<system-out>{}</system-out>\n</testcase>\n", escape(details))
                }
                Some(Verdict::Reject) => body("failure"),
                Some(Verdict::Inconclusive) => body("error"),
                None => body("skipped"),
            };
        }
        text + "</testsuite>\n</testsuites>\n"
    }

    /// As a section of Markdown: the verdict, the rejected checks, the inconclusive ones, the skipped ones, and all of them folded up.
    pub fn markdown(&self) -> String {
        let verdicts = [Some(Verdict::Accept), Some(Verdict::Reject), Some(Verdict::Inconclusive), None];
        let [accepted, rejected, inconclusive, skipped] = verdicts.map(|verdict| self.of(verdict).count());
        let verdict = match (accepted, rejected, inconclusive) {
            (_, 1.., _) => "rejected",
            (_, _, 1..) | (0, ..) => "inconclusive",
            _ => "accepted",
        };
        let total = counted(self.list.len(), "check");
        let left_out = if skipped > 0 { format!(", {skipped} skipped") } else { String::new() };
        let mut text = format!(
            "## {}: {verdict}\n\n{total}: {rejected} rejected, {inconclusive} inconclusive, {accepted} accepted{left_out}; {:.1} s\n",
            markdown(&self.title),
            self.seconds
        );
        let headings =
            [("Rejected", Some(Verdict::Reject)), ("Inconclusive", Some(Verdict::Inconclusive)), ("Skipped", None)];
        for (heading, verdict) in headings {
            let checks: Vec<&Check> = self.of(verdict).collect();
            if !checks.is_empty() {
                text += &format!(
                    "\n### {heading}\n\n{}",
                    named(&checks).words("found", |check| markdown(&check.message)).markdown()
                );
            }
        }
        let list: Vec<&Check> = self.list.iter().collect();
        let all = named(&list)
            .words("verdict", |check| check.verdict.map_or("skipped".into(), |verdict| verdict.to_string()))
            .words("found", |check| markdown(&check.message))
            .numbers("seconds", |check| check.seconds.map_or(String::new(), |seconds| format!("{seconds:.2}")));
        text + &format!("\n<details>\n<summary>{total}</summary>\n\n{}\n</details>\n", all.markdown())
    }
}

fn named<'a>(checks: &'a [&'a Check]) -> Table<'a, &'a Check> {
    Table::of(checks).words("check", |check| markdown(&format!("{}/{}", check.group, check.name)))
}

/// Text for a cell of a table in Markdown: characters that mean something there or in HTML become references, and what would
/// end the line a space.
fn markdown(text: &str) -> String {
    let one = |c: char| match c {
        c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') => " ".into(),
        '&' | '<' | '>' | '|' | '\\' | '`' | '*' | '_' | '~' | '[' | ']' | '$' | '#' => format!("&#{};", u32::from(c)),
        c => c.to_string(),
    };
    text.chars().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(name: &str, verdict: impl Into<Option<Verdict>>, message: &str) -> Check {
        let (group, details) = ("bsdf/own".into(), String::new());
        Check {
            group,
            name: name.into(),
            verdict: verdict.into(),
            message: message.into(),
            details,
            seconds: Some(0.25),
        }
    }

    fn run(checks: Vec<Check>) -> Checks {
        Checks { title: "etalon validate".into(), list: checks, seconds: 1.5 }
    }

    #[test]
    fn what_failed_stands_first() {
        let run = run(vec![
            check("good", Verdict::Accept, "p = 0.5000"),
            check("open", Verdict::Inconclusive, "too few samples"),
            check("bad", Verdict::Reject, "p < 1e-300"),
        ]);
        let text = run.markdown();
        assert!(text.starts_with(
            "## etalon validate: rejected\n\n3 checks: 1 rejected, 1 inconclusive, 1 accepted; 1.5 s\n\n### Rejected\n"
        ));
        let place = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part} is not in {text}"));
        assert!(place("| bsdf/own/bad | p &#60; 1e-300 |\n") < place("### Inconclusive\n"));
        assert!(place("| bsdf/own/open | too few samples |\n") < place("<details>"));
        assert!(place("<details>") < place("| bsdf/own/good | accept | p = 0.5000 | 0.25 |\n"));
        let xml = run.junit();
        assert!(xml.contains("tests=\"3\" failures=\"1\" errors=\"1\" skipped=\"0\" time=\"1.500\""), "{xml}");
        assert!(xml.contains("classname=\"bsdf.own\" name=\"good\" time=\"0.250\"/>"), "{xml}");
    }

    #[test]
    fn skipped_checks_are_told_of_and_change_no_verdict() {
        let run = run(vec![check("good", Verdict::Accept, ""), check("other", None, "the map is nave")]);
        let text = run.markdown();
        assert!(
            text.starts_with(
                "## etalon validate: accepted\n\n2 checks: 0 rejected, 0 inconclusive, 1 accepted, 1 skipped; 1.5 s\n"
            ),
            "{text}"
        );
        assert!(text.contains("### Skipped\n\n| check | found |\n|---|---|\n| bsdf/own/other | the map is nave |\n"));
        assert!(text.contains("| bsdf/own/other | skipped | the map is nave | 0.25 |\n"));
        let xml = run.junit();
        assert!(xml.contains("tests=\"2\" failures=\"0\" errors=\"0\" skipped=\"1\""), "{xml}");
        assert!(xml.contains("<skipped message=\"the map is nave\">the map is nave</skipped>"), "{xml}");
    }

    #[test]
    fn the_verdict_is_the_worst_one_and_nothing_is_not_accepted() {
        let verdict = |verdicts: &[Verdict]| {
            let text = run(verdicts.iter().map(|verdict| check("a", *verdict, "")).collect()).markdown();
            text.lines().next().and_then(|line| line.split(": ").nth(1)).unwrap().to_owned()
        };
        use Verdict::{Accept, Inconclusive, Reject};
        assert_eq!([&[Accept][..], &[Accept, Inconclusive]].map(verdict), ["accepted", "inconclusive"]);
        assert_eq!([&[Inconclusive, Reject, Accept][..], &[]].map(verdict), ["rejected", "inconclusive"]);
        let mut cut = run(vec![check("a", Accept, "")]);
        cut.interrupted("the other figures were not made");
        assert!(cut.markdown().contains("inconclusive\n") && cut.junit().contains("errors=\"1\""));
    }

    #[test]
    fn hostile_names_are_only_text() {
        let name = "a|b\\|c\r\n## d <img src=x> [x](y) `|` *e* _f_ $g$ &amp; </details>\u{2028}\"'";
        let run = run(vec![check(name, Verdict::Reject, name)]);
        let text = run.markdown();
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| bsdf/own/a")).collect();
        assert_eq!(rows.len(), 2, "{text}");
        assert_eq!(rows.iter().map(|row| row.matches('|').count()).collect::<Vec<_>>(), [3, 5], "{text}");
        assert!(rows.iter().all(|row| !row.contains(['<', '>', '\\', '`', '*', '[', '$'])), "{text}");
        assert!(text.matches("## ").count() == 2 && text.matches("</details>").count() == 1, "{text}");
        let xml = run.junit();
        let document = roxmltree::Document::parse(&xml).unwrap();
        let case = document.descendants().find(|node| node.has_tag_name("testcase")).unwrap();
        assert_eq!(case.attribute("name").unwrap(), name.replace(['\r', '\n'], " "));
        assert!(document.descendants().any(|node| node.has_tag_name("failure")));
    }
}
