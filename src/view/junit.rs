//! A run of tests as JUnit XML, which continuous integration shows: rejected tests are failures, inconclusive ones errors.
//!
//! Source of the format: the schema of Jenkins' xUnit plugin, `junit-10.xsd`.

use crate::figure::escape;
use crate::study::validation::{Tested, Validation};
use etalon_stats::Verdict;

pub fn document(validation: &Validation) -> String {
    let Validation { tests, rejected, inconclusive, seconds, .. } = validation;
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"etalon validate\" tests=\"{}\" \
         failures=\"{rejected}\" errors=\"{inconclusive}\" time=\"{seconds:.3}\">\n",
        tests.len()
    );
    for Tested { name, outcome } in tests {
        let (family, own) = name.rsplit_once('/').unwrap_or(("etalon", name));
        let case = format!(
            "<testcase classname=\"{}\" name=\"{}\" time=\"{:.3}\"",
            escape(&family.replace('/', ".")),
            escape(own),
            outcome.seconds
        );
        let body = |kind: &str| {
            let message = outcome.remark().map_or_else(|| outcome.verdict.to_string(), str::to_owned);
            let (message, all) = (escape(&message), escape(&outcome.to_string()));
            format!("{case}>\n<{kind} message=\"{message}\">{all}</{kind}>\n</testcase>\n")
        };
        text += &match outcome.verdict {
            Verdict::Accept if outcome.remarks.is_empty() => format!("{case}/>\n"),
            Verdict::Accept => {
                format!("{case}>\n<system-out>{}</system-out>\n</testcase>\n", escape(&outcome.remarks.join("\n")))
            }
            Verdict::Reject => body("failure"),
            Verdict::Inconclusive => body("error"),
        };
    }
    text + "</testsuite>\n</testsuites>\n"
}
