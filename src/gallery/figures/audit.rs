//! The errors of the two reports: `audit`.

use crate::gallery::figure;
use crate::gallery::prelude::*;
use crate::study::audit::{self, Erratum};
use crate::view::audit as view;
use etalon_stats::Verdict;

/// One figure, which also feeds the page's list of errors.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "audit",
        title: "Where the reports err, and which test detects it",
        report: Report::Both,
        reproduces: "all formulas that they print and that are wrong, approximate or misprinted",
        shows: "Each formula as printed beside the corrected one, the verdicts on both, and the error that it causes in an \
                image. An error of print stands in the text alone: what follows is what it would do if taken at its word.",
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let errata = audit::audit(&inputs.protocol())?;
    let checks = errata.iter().flat_map(|erratum| {
        let Erratum { title, verdict, right_verdict, .. } = erratum;
        [
            Check::is_true(format!("rejected as printed: {title}"), *verdict == Verdict::Reject),
            Check::is_true(format!("accepted as corrected: {title}"), *right_verdict == Verdict::Accept),
        ]
    });
    let content = Content::new(view::drawing(&errata), &errata, checks.collect())?;
    Ok(Content { errata: errata.iter().map(row).collect(), ..content })
}

fn row(erratum: &Erratum) -> figure::Erratum {
    figure::Erratum {
        printed: format!("{}, {}: {}", erratum.report, erratum.nature.name(), erratum.printed),
        right: erratum.right.to_owned(),
        test: match &erratum.violation {
            Some(violation) => format!("{}: {violation}", erratum.test),
            None => erratum.test.to_owned(),
        },
        p_value: erratum.p,
        picture_error: view::consequence(erratum),
    }
}
