//! The registry of figures: one file for each, or for those that differ by a parameter, with study, view, checks and texts.
//!
//! A new figure is a file with a function `figures`, and its two lines here.

mod anisotropy;
mod audit;
mod choice;
mod claims;
mod depth;
mod envmap_samples;
mod error_depth;
mod error_time;
mod error_time_roughness;
mod fresnel;
mod fresnel_media;
mod median_cut;
mod median_cut_error;
mod metals_table;
mod multiple_scattering;
mod planted_fault;
mod proposal;
mod rough_glass;
mod roughness;
mod sampling;
mod scaling;
mod special_angles;
mod sphere;
mod stability;
mod validation;

use super::figure::Figure;
use super::inputs::Shown;

/// All figures, in the order in which they are made, numbered and shown: by section, from what a reader has to know first.
pub fn registry() -> Vec<Figure> {
    use Shown::{Copper, Map, Nothing, Spheres, Statue};
    let sections = [
        (
            "Reflectance of an interface",
            vec![
                (Nothing, fresnel::figures()),
                (Nothing, special_angles::figures()),
                (Nothing, fresnel_media::figures()),
            ],
        ),
        ("Samples of an environment map", vec![(Map, envmap_samples::figures()), (Map, proposal::figures())]),
        ("Sphere under the map", vec![(Map, sphere::figures()), (Map, error_time::sphere())]),
        ("Lights in place of the map", vec![(Map, median_cut::figures()), (Map, median_cut_error::figures())]),
        (
            "Paths up to a depth",
            vec![(Spheres, depth::figures()), (Spheres, error_depth::figures()), (Spheres, error_time::cornell())],
        ),
        (
            "Metals and their roughness",
            vec![
                (Nothing, metals_table::figures()),
                (Statue, roughness::figures()),
                (Statue, roughness::iron()),
                (Copper, sampling::figures()),
                (Statue, error_time_roughness::figures()),
            ],
        ),
        (
            "More materials",
            vec![
                (Nothing, multiple_scattering::figures()),
                (Nothing, anisotropy::figures()),
                (Spheres, rough_glass::figures()),
            ],
        ),
        ("Tests of samplers", vec![(Nothing, planted_fault::figures()), (Nothing, validation::figures())]),
        (
            "What the reports print and claim",
            vec![
                (Nothing, audit::figures()),
                (Map, claims::first()),
                (Nothing, claims::second()),
                (Spheres, claims::places()),
            ],
        ),
        (
            "Numerical errors and cost",
            vec![(Nothing, stability::figures()), (Map, choice::figures()), (Nothing, scaling::figures())],
        ),
    ];
    let titled = |(section, groups): (&'static str, Vec<(Shown, Vec<Figure>)>)| {
        let of_input = move |(input, figures): (Shown, Vec<Figure>)| {
            figures.into_iter().map(move |figure| Figure { section, input, ..figure })
        };
        groups.into_iter().flat_map(of_input)
    };
    sections.into_iter().flat_map(titled).collect()
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
        let titles: BTreeSet<&str> = all.iter().map(|figure| figure.title).collect();
        assert_eq!(titles.len(), all.len(), "a title twice");
        let sections: Vec<&str> = all.chunk_by(|a, b| a.section == b.section).map(|group| group[0].section).collect();
        assert_eq!(sections.len(), sections.iter().collect::<BTreeSet<_>>().len(), "a section in two places");
        for figure in &all {
            let id = figure.id;
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
            assert!(id.chars().all(plain), "{id} is the name of files");
            assert!(!figure.title.is_empty() && !figure.reproduces.is_empty(), "{id}");
            assert!(
                figure.title.starts_with(|c: char| c.is_uppercase() || c.is_ascii_digit()),
                "{id}: {}",
                figure.title
            );
            for text in [figure.shows, figure.matters] {
                assert!(text.len() > 20 && text.ends_with('.'), "{id} says what is seen and why it matters: {text:?}");
            }
            let beside = figure.beside.is_none_or(|other| other != id && ids.contains(other));
            assert!(beside, "{id} beside {:?}", figure.beside);
        }
    }
}
