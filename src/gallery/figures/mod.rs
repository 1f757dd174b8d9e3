//! The registry of figures: one file for each, or for those that differ by a parameter, with study, view, checks and texts.
//!
//! A new figure is a file with a function `figures`, and its two lines here.

pub mod audit;
pub mod depth;
pub mod depth_differences;
pub mod envmap_samples;
pub mod error_depth;
pub mod error_time;
pub mod error_time_roughness;
pub mod fresnel;
pub mod iron;
pub mod median_cut;
pub mod median_cut_error;
pub mod metals_table;
pub mod proposal;
pub mod roughness;
pub mod sampling;
pub mod sphere;
pub mod sphere_error;
pub mod stability;
pub mod validation;

use super::figure::Figure;

/// All figures, in the order in which they are made and shown.
pub fn registry() -> Vec<Figure> {
    [
        fresnel::figures(),
        envmap_samples::figures(),
        proposal::figures(),
        median_cut::figures(),
        sphere::figures(),
        sphere_error::figures(),
        depth::figures(),
        depth_differences::figures(),
        roughness::figures(),
        sampling::figures(),
        iron::figures(),
        metals_table::figures(),
        validation::figures(),
        audit::figures(),
        error_time::figures(),
        error_time_roughness::figures(),
        error_depth::figures(),
        median_cut_error::figures(),
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
