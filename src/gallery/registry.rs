//! The list of all figures: one line for each file of figures.

use super::figure::Figure;
use super::figures;

/// All figures, in the order in which they are made and shown.
#[must_use]
pub fn registry() -> Vec<Figure> {
    [
        figures::fresnel::figures(),
        figures::envmap_samples::figures(),
        figures::proposal::figures(),
        figures::median_cut::figures(),
        figures::sphere::figures(),
        figures::sphere_error::figures(),
        figures::depth::figures(),
        figures::depth_differences::figures(),
        figures::roughness::figures(),
        figures::sampling::figures(),
        figures::iron::figures(),
        figures::metals_table::figures(),
        figures::validation::figures(),
        figures::audit::figures(),
        figures::error_time::figures(),
        figures::error_time_roughness::figures(),
        figures::error_depth::figures(),
        figures::median_cut_error::figures(),
        figures::stability::figures(),
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
