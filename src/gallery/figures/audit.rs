//! The errors of the two reports: `audit`.

use crate::gallery::figure::{self, Place};
use crate::gallery::prelude::*;
use crate::study::audit::{self, Erratum};
use crate::view::audit as view;
use etalon_stats::Verdict;

/// One figure, which also feeds the page's list of errors.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "audit",
        title: "Errors in the reports, and the tests that reveal them",
        report: Report::Both,
        reproduces: "all formulas that they print and that are wrong, approximate or misprinted",
        shows: "Each formula as printed beside the corrected one, the verdicts on both, and the error that it causes in an \
                image. A misprint stands in the text alone: what follows is what it would do if taken at its word.",
        matters: "A formula that looks right in print may change an image by a few percent, which hardly anyone sees and a test does.",
        papers: &[papers::WALTER, papers::HEITZ, papers::SCHLICK],
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
    let (drawing, places) = view::drawing(&errata);
    let content = Content::new(drawing, &errata, checks.collect())?;
    let rows = errata.iter().zip(places).enumerate().map(|(i, (erratum, place))| {
        let [width, height] = [content.drawing.width, content.drawing.height];
        let share = [place.x / width, place.y / height, place.width / width, place.height / height];
        row(erratum, Place { panel: view::letter(i), share })
    });
    Ok(Content { errata: rows.collect(), ..content })
}

fn row(erratum: &Erratum, place: Place) -> figure::Erratum {
    figure::Erratum {
        printed: format!("{}, {}: {}", erratum.report, erratum.nature.name(), erratum.printed),
        right: erratum.right.to_owned(),
        test: match &erratum.violation {
            Some(violation) => format!("{}: {violation}", erratum.test),
            None => erratum.test.to_owned(),
        },
        // What an exact check rejects needs no p-value.
        p_value: erratum.p.filter(|_| erratum.violation.is_none()),
        picture_error: view::consequence(erratum),
        place: Some(place),
    }
}
