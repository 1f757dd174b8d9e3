//! The registry of figures: one file for each, or for those that differ by a parameter, with study, view and checks. Their texts
//! are in `figures.json`.
//!
//! A new figure is an entry there, a file with a function `figures`, and its two lines here.

mod anisotropy;
mod audit;
mod claims;
mod depth;
mod envmap;
mod error_depth;
mod error_time;
mod error_time_roughness;
mod fresnel;
mod metals_table;
mod mistakes;
mod rough_glass;
mod roughness;
mod sampling;
mod sphere;
mod stability;
mod validation;

use super::figure::{Content, Figure};
use super::inputs::{Inputs, Studies};
use etalon_core::error::Result;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Makes a figure's content from the inputs and from studies that other figures may share.
type Make = dyn Fn(&Inputs, &mut Studies) -> Result<Content>;

/// What makes a figure.
pub struct Maker {
    id: String,
    make: Box<Make>,
}

pub fn maker(id: impl Into<String>, make: impl Fn(&Inputs, &mut Studies) -> Result<Content> + 'static) -> Maker {
    Maker { id: id.into(), make: Box::new(make) }
}

fn makers() -> Vec<Maker> {
    let files = [
        anisotropy::figures(),
        audit::figures(),
        claims::figures(),
        depth::figures(),
        envmap::figures(),
        error_depth::figures(),
        error_time::figures(),
        error_time_roughness::figures(),
        fresnel::figures(),
        metals_table::figures(),
        mistakes::figures(),
        rough_glass::figures(),
        roughness::figures(),
        sampling::figures(),
        sphere::figures(),
        stability::figures(),
        validation::figures(),
    ];
    files.into_iter().flatten().collect()
}

/// Makes the content of a figure.
///
/// # Errors
/// Those of its studies.
pub fn make(figure: &Figure, inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let maker = makers().into_iter().find(|maker| maker.id == figure.id);
    (maker.expect("a test finds a maker of each figure").make)(inputs, studies)
}

/// All figures, in the order in which they are made, numbered and shown: by section, from what a reader has to know first.
pub fn registry() -> &'static [Figure] {
    static ALL: LazyLock<Vec<Figure>> =
        LazyLock::new(|| read(include_str!("../figures.json")).expect("a test reads the figures' texts"));
    &ALL
}

/// The figures of `figures.json`. Those of a series share the fields beside it.
fn read(text: &str) -> serde_json::Result<Vec<Figure>> {
    #[derive(Deserialize)]
    struct Texts {
        sections: Vec<Section>,
        papers: BTreeMap<String, String>,
    }
    #[derive(Deserialize)]
    struct Section {
        section: Value,
        figures: Vec<Map<String, Value>>,
    }
    let Texts { sections, papers } = serde_json::from_str(text)?;
    let mut all = Vec::new();
    for Section { section, figures } in sections {
        for mut shared in figures {
            shared.insert("section".into(), section.clone());
            let series = shared.remove("series").unwrap_or_else(|| Value::Array(vec![Value::Object(Map::new())]));
            for own in serde_json::from_value::<Vec<Map<String, Value>>>(series)? {
                let fields = shared.clone().into_iter().chain(own).collect();
                let mut figure: Figure = serde_json::from_value(Value::Object(fields))?;
                for paper in &mut figure.papers {
                    let unknown =
                        || <serde_json::Error as serde::de::Error>::custom(format!("{}: no paper {paper}", figure.id));
                    *paper = papers.get(paper).ok_or_else(unknown)?.clone();
                }
                all.push(figure);
            }
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_entry_is_complete() {
        let all = registry();
        let ids: BTreeSet<&str> = all.iter().map(|figure| figure.id.as_str()).collect();
        assert_eq!(ids.len(), all.len(), "an id twice");
        let mut made: Vec<String> = makers().into_iter().map(|maker| maker.id).collect();
        made.sort();
        assert_eq!(made, ids.iter().copied().collect::<Vec<_>>(), "each figure has one maker");
        let titles: BTreeSet<&str> = all.iter().map(|figure| figure.title.as_str()).collect();
        assert_eq!(titles.len(), all.len(), "a title twice");
        let sections: Vec<&str> =
            all.chunk_by(|a, b| a.section == b.section).map(|group| group[0].section.as_str()).collect();
        assert_eq!(sections.len(), sections.iter().collect::<BTreeSet<_>>().len(), "a section in two places");
        let groups: Vec<&[Figure]> =
            all.chunk_by(|a, b| a.group == b.group).filter(|figures| figures[0].group.is_some()).collect();
        let names: BTreeSet<&str> =
            groups.iter().map(|figures| figures[0].group.as_ref().unwrap().id.as_str()).collect();
        assert_eq!(groups.len(), names.len(), "a group in two places");
        assert!(names.is_disjoint(&ids), "a group and a figure of one id");
        for figures in groups {
            let positions: BTreeSet<&str> = figures.iter().map(|figure| figure.at.as_str()).collect();
            assert!(
                figures.len() > 1 && positions.len() == figures.len() && !positions.contains(""),
                "{:?}",
                figures[0].group
            );
        }
        for figure in all {
            assert_eq!(figure.group.is_none(), figure.at.is_empty(), "{}", figure.id);
            let id = figure.id.as_str();
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
            assert!(id.chars().all(plain), "{id} is the name of files");
            assert!(!figure.title.is_empty() && !figure.reproduces.is_empty(), "{id}");
            assert!(
                figure.title.starts_with(|c: char| c.is_uppercase() || c.is_ascii_digit()),
                "{id}: {}",
                figure.title
            );
            for text in [&figure.shows, &figure.matters] {
                assert!(text.len() > 20 && text.ends_with('.'), "{id} says what is seen and why it matters: {text:?}");
            }
            let beside = figure.beside.as_deref().is_none_or(|other| other != id && ids.contains(other));
            assert!(beside, "{id} beside {:?}", figure.beside);
        }
    }
}
