//! A run of tests as JUnit XML, which continuous integration shows: rejected tests are failures, inconclusive ones errors.
//!
//! Source of the format: the schema of Jenkins' xUnit plugin, `junit-10.xsd`.

use crate::figure::escape;
use crate::study::validation::{Tested, Validation};
use etalon_stats::Verdict;

/// A test, and how it ended.
pub struct Case {
    pub class: String,
    pub name: String,
    pub seconds: f64,
    pub verdict: Verdict,
    pub message: String,
    /// All that is known of it.
    pub text: String,
    /// What does not decide; of accepted tests.
    pub remarks: String,
}

/// A run of the tests of a command.
pub fn suite(name: &str, cases: &[Case], seconds: f64) -> String {
    let count = |verdict| cases.iter().filter(|case| case.verdict == verdict).count();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"{}\" tests=\"{}\" \
         failures=\"{}\" errors=\"{}\" time=\"{seconds:.3}\">\n",
        escape(name),
        cases.len(),
        count(Verdict::Reject),
        count(Verdict::Inconclusive)
    );
    for Case { class, name, seconds, verdict, message, text: all, remarks } in cases {
        let case = format!("<testcase classname=\"{}\" name=\"{}\" time=\"{seconds:.3}\"", escape(class), escape(name));
        let body = |kind: &str| {
            let (message, all) = (escape(message), escape(all));
            format!("{case}>\n<{kind} message=\"{message}\">{all}</{kind}>\n</testcase>\n")
        };
        text += &match verdict {
            Verdict::Accept if remarks.is_empty() => format!("{case}/>\n"),
            Verdict::Accept => format!("{case}>\n<system-out>{}</system-out>\n</testcase>\n", escape(remarks)),
            Verdict::Reject => body("failure"),
            Verdict::Inconclusive => body("error"),
        };
    }
    text + "</testsuite>\n</testsuites>\n"
}

/// The tests of `etalon validate`.
pub fn document(validation: &Validation) -> String {
    let case = |Tested { name, outcome }: &Tested| {
        let (family, own) = name.rsplit_once('/').unwrap_or(("etalon", name));
        Case {
            class: family.replace('/', "."),
            name: own.into(),
            seconds: outcome.seconds,
            verdict: outcome.verdict,
            message: outcome.remark().map_or_else(|| outcome.verdict.to_string(), str::to_owned),
            text: outcome.to_string(),
            remarks: outcome.remarks.join("\n"),
        }
    };
    let cases: Vec<Case> = validation.tests.iter().map(case).collect();
    suite("etalon validate", &cases, validation.seconds)
}
