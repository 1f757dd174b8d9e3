//! The figures of the stability study: how each is made, and the bounds that must hold.

use super::check::Check;
use super::context::Context;
use super::entries::entry;
use super::registry::{Entry, Made};
use super::{output, stability, stability_summary};
use crate::error::Result;

/// The figures, which the study's registry names, and their titles.
const FIGURES: [(&str, &str); 6] = [
    ("stability-fresnel", "Errors of dielectric Fresnel and of refraction"),
    ("stability-conductor", "Errors of conductor Fresnel"),
    ("stability-microfacet", "Errors of microfacet densities and shadowing"),
    ("stability-sampling", "Errors of drawn normals"),
    ("stability-geometry", "Errors of half vectors, spheres, triangles and offsets"),
    (SUMS, "The worst case of everything, sums, tables and long paths included"),
];

const SUMS: &str = "stability-sums";

pub(super) fn all() -> Vec<Entry> {
    let entries = FIGURES.iter().map(|&(id, title)| entry(id, title, "stability study", move |c| figure(c, id)));
    entries.collect()
}

fn figure(context: &Context, id: &'static str) -> Result<Made> {
    let own = context.stability(id)?;
    let drawing = if id == SUMS {
        let all = crate::study::stability::figures()
            .into_iter()
            .map(|id| context.stability(id))
            .collect::<Result<Vec<_>>>()?;
        let rows: Vec<_> = all.iter().flat_map(|s| s.rows.iter().cloned()).collect();
        stability_summary::worst_cases(&rows)
    } else {
        stability::maps(&own.sweeps)?
    };
    let checks = own.bounds.iter().map(|p| Check::at_most(&p.name, p.got, p.limit));
    Ok(Made { drawing, table: output::table(&own.rows)?, picture: None, checks: checks.collect() })
}

#[cfg(test)]
mod tests {
    use super::FIGURES;

    #[test]
    fn every_figure_of_the_study_is_made() {
        assert_eq!(FIGURES.map(|(id, _)| id).to_vec(), crate::study::stability::figures());
    }
}
