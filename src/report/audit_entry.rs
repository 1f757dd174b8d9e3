//! The figure of the reports' own mistakes, which also feeds the page's list of them.

use super::audit::{checks, drawing, percent, rows};
use super::context::Context;
use super::entries::entry;
use super::erratum::Erratum;
use super::output;
use super::registry::{Entry, Made};
use crate::error::Result;

pub(super) fn all() -> Vec<Entry> {
    let audit = entry("audit", "Where the reports err, and what tells", "both reports: their own formulas", figure);
    let audit = audit
        .shows("What is printed beside what is right, the verdicts on both, and what the mistake does to a picture.");
    vec![audit.errata(errata)]
}

fn figure(context: &Context) -> Result<Made> {
    let errata = context.audit()?;
    Ok(Made {
        drawing: drawing(&errata),
        table: output::table(&rows(&errata))?,
        picture: None,
        checks: checks(&errata),
    })
}

/// The same as rows of the page.
fn errata(context: &Context) -> Result<Vec<Erratum>> {
    let row = |erratum: &crate::study::audit::Erratum| Erratum {
        printed: format!("{}: {}", erratum.report, erratum.printed),
        right: erratum.right.to_owned(),
        test: match &erratum.violation {
            Some(violation) => format!("{}: {violation}", erratum.test),
            None => erratum.test.to_owned(),
        },
        p_value: erratum.p,
        picture_error: format!("{}: {}", erratum.error_of, percent(erratum.error_in_picture)),
    };
    Ok(context.audit()?.iter().map(row).collect())
}
