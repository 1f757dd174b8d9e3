//! The figures of the stability study: how each is made, and the promises that it must keep.

use super::check::Check;
use super::context::Context;
use super::entries::entry;
use super::registry::{Entry, Made};
use super::{output, stability, stability_summary};
use crate::error::Result;

/// The figures, and the families and experiments that each shows.
pub(super) const FIGURES: [(&str, &str, &[&str]); 6] = [
    ("stability-fresnel", "Errors of dielectric Fresnel and of refraction", &["fresnel", "refraction"]),
    ("stability-conductor", "Errors of conductor Fresnel", &["conductor"]),
    (
        "stability-microfacet",
        "Errors of microfacet densities and shadowing",
        &["beckmann-d", "ggx-d", "beckmann-g", "ggx-g", "beckmann-pdf", "ggx-pdf"],
    ),
    ("stability-sampling", "Errors of drawn normals", &["beckmann-normal", "ggx-normal"]),
    (
        "stability-geometry",
        "Errors of half vectors, spheres, triangles and offsets",
        &["half-vector", "half-cosine", "sphere", "triangle", "offsets"],
    ),
    (
        SUMS,
        "The worst case of everything, sums, tables and long paths included",
        &["tables", "areas", "film", "paths", "cuts"],
    ),
];

const SUMS: &str = "stability-sums";

pub(super) fn all() -> Vec<Entry> {
    let entries = FIGURES.iter().map(|&(id, title, _)| entry(id, title, "stability study", move |c| figure(c, id)));
    entries.collect()
}

fn figure(context: &Context, id: &'static str) -> Result<Made> {
    let own = context.stability(id)?;
    let drawing = if id == SUMS {
        let all = FIGURES.iter().map(|(id, ..)| context.stability(id)).collect::<Result<Vec<_>>>()?;
        let rows: Vec<_> = all.iter().flat_map(|s| s.rows.iter().cloned()).collect();
        stability_summary::worst_cases(&rows)
    } else {
        stability::maps(&own.sweeps)?
    };
    let checks = own.promises.iter().map(|p| Check::at_most(&p.name, p.got, p.limit));
    Ok(Made { drawing, table: output::table(&own.rows)?, picture: None, checks: checks.collect() })
}
