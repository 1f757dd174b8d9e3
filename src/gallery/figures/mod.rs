//! The registry of figures: one file for each, or for those that differ by a parameter, with study, view, checks and texts.
//!
//! A new figure is a file with a function `figures`, and its two lines here.

mod anisotropy;
mod audit;
mod bsdf_fault;
mod claims;
mod depth;
mod envmap_samples;
mod error_depth;
mod error_time;
mod error_time_roughness;
mod fresnel;
mod median_cut;
mod median_cut_error;
mod metals_table;
mod multiple_scattering;
mod proposal;
mod rough_glass;
mod roughness;
mod sampling;
mod scaling;
mod sphere;
mod stability;
mod validation;

use super::figure::Figure;

/// All figures, in the order in which they are made and shown.
pub fn registry() -> Vec<Figure> {
    [
        fresnel::figures(),
        envmap_samples::figures(),
        proposal::figures(),
        median_cut::figures(),
        sphere::figures(),
        depth::figures(),
        roughness::figures(),
        sampling::figures(),
        roughness::iron(),
        metals_table::figures(),
        rough_glass::figures(),
        anisotropy::figures(),
        multiple_scattering::figures(),
        validation::figures(),
        bsdf_fault::figures(),
        audit::figures(),
        claims::figures(),
        error_time::figures(),
        error_time_roughness::figures(),
        error_depth::figures(),
        median_cut_error::figures(),
        scaling::figures(),
        stability::figures(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_entry_is_complete() {
        let all = registry();
        let ids: BTreeSet<&str> = all.iter().map(|figure| figure.id).collect();
        assert_eq!(ids.len(), all.len(), "an id twice");
        for figure in &all {
            let id = figure.id;
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
            assert!(id.chars().all(plain), "{id} is the name of files");
            assert!(!figure.title.is_empty() && !figure.reproduces.is_empty(), "{id}");
            assert!(figure.shows.len() > 20 && figure.shows.ends_with('.'), "{id}: {}", figure.shows);
            let beside = figure.beside.is_none_or(|other| other != id && ids.contains(other));
            assert!(beside, "{id} beside {:?}", figure.beside);
        }
    }
}
