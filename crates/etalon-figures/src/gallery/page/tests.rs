//! The page as a document: well-formed, complete, without references to elsewhere.

use super::*;
use crate::figure::{FORMATS, Page};
use crate::gallery::figure::{Claim, Erratum, Place, Printed};
use crate::gallery::registry;
use crate::gallery::tests::record;

/// The page of all figures of the registry, each with an empty drawing.
fn page(change: impl Fn(&str, &mut Record)) -> String {
    let dir = tempfile::tempdir().unwrap();
    let figures = registry();
    let records: Records = figures
        .iter()
        .map(|figure| {
            Page::new(40.0, 30.0, 1.0).write(&dir.path().join(&figure.id), &FORMATS).unwrap();
            let mut record = record();
            change(&figure.id, &mut record);
            (figure.id.clone(), record)
        })
        .collect();
    write(dir.path(), figures, &records).unwrap();
    assert_eq!(read_records(dir.path(), figures).unwrap().len(), figures.len());
    std::fs::read_to_string(dir.path().join(FILE)).unwrap()
}

fn parsed(text: &str) -> roxmltree::Document<'_> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    roxmltree::Document::parse_with_options(text, options).unwrap()
}

#[test]
fn every_figure_is_there_and_nothing_is_loaded_from_elsewhere() {
    let text = page(|_, _| ());
    let tree = parsed(&text);
    let ids: Vec<&str> = tree.descendants().filter_map(|n| n.attribute("id")).collect();
    assert_eq!(ids.len(), ids.iter().collect::<std::collections::BTreeSet<_>>().len(), "an id twice");
    for figure in registry() {
        assert!(ids.contains(&format!("figure-{}", figure.id).as_str()), "{}", figure.id);
    }
    for node in tree.descendants() {
        for attribute in node.attributes().filter(|a| ["href", "src"].contains(&a.name())) {
            let value = attribute.value();
            match value.split_once('#') {
                Some(("", id)) => assert!(ids.contains(&id), "{value}"),
                _ => assert!(value.starts_with("data:") || !value.contains(':'), "{value}"),
            }
        }
        if node.has_tag_name("img") {
            assert!(node.attribute("src").unwrap().starts_with("data:image/"));
            // A thumbnail's text stands beside it, in the same link.
            let link = node.ancestors().find(|n| n.has_tag_name("a")).unwrap();
            let texts: String = link.descendants().filter_map(|n| n.text()).collect();
            assert!(node.attribute("alt").unwrap().len() > 10 || texts.trim().len() > 5);
        }
    }
    assert!(!text.contains("class=\"wide\""), "no report is said to be wrong without evidence");
}

#[test]
fn failures_and_errata_are_shown_as_text() {
    let evil = "</td><script>alert(\"1\")</script>&";
    let text = page(|id, record| {
        record.setup.cpu = evil.into();
        if id == "iron" {
            record.errata = vec![Erratum {
                printed: evil.into(),
                right: "R₀ = 0.04".into(),
                test: "t-test".into(),
                p_value: Some(1e-12),
                picture_error: "3 %".into(),
                place: Some(Place { panel: 'c', share: [0.1, 0.2, 0.3, 0.4] }),
            }];
            record.printed = vec![Printed { quantity: "R₀".into(), report: evil.into(), ours: "0.034".into() }];
        } else {
            record.checks.retain(|c| !c.failed());
        }
        if id == "claims-first" {
            record.claims = vec![Claim {
                report: "second report".into(),
                place: "Fig. 4".into(),
                claim: evil.into(),
                number: String::new(),
                measured: vec!["share: 3 % (≥ 2 %)".into()],
                verdict: "holds".into(),
                evidence: vec!["depth-2".into(), "no-such-figure".into()],
            }];
        }
    });
    let tree = parsed(&text);
    let evil_texts = tree.descendants().filter(|n| n.is_text() && n.text().is_some_and(|t| t.contains(evil))).count();
    assert_eq!(evil_texts, 4, "in the tables of errata, claims and printed numbers, and in the footer");
    assert_eq!(tree.descendants().filter(|n| n.has_tag_name("script")).count(), 1);
    let failed: Vec<_> = tree.descendants().filter(|n| n.attribute("data-failed") == Some("1")).collect();
    let failed = failed.iter().map(|n| n.descendants().find_map(|n| n.attribute("data-id")));
    assert_eq!(failed.collect::<Vec<_>>(), [Some("iron")]);
    assert!(
        text.contains("<a href=\"#figure-depth-2\">depth-2</a>, no-such-figure"),
        "only figures on the page are linked"
    );
    assert!(text.contains("1.0e-12") && text.contains("NaN"));
    assert!(text.contains("<a href=\"#iron-c\">panel c</a>"), "an error leads to its panel");
    let target = tree.descendants().find(|n| n.attribute("id") == Some("iron-c")).unwrap();
    assert_eq!(target.attribute("style"), Some("left:10.00%;top:20.00%;width:30.00%;height:40.00%"));
    assert!(tree.descendants().any(|n| n.attribute("open").is_some() && n.attribute("class") == Some("about")));
}

#[test]
fn figures_of_a_group_share_an_article_with_a_slider() {
    let text = page(|_, _| ());
    let tree = parsed(&text);
    let ids = |node: roxmltree::Node<'_, '_>| {
        node.descendants().filter_map(|n| n.attribute("data-id").map(str::to_owned)).collect::<Vec<_>>()
    };
    assert_eq!(ids(tree.root()), registry().iter().map(|figure| figure.id.clone()).collect::<Vec<_>>());
    let articles: Vec<_> = tree.descendants().filter(|n| n.has_tag_name("article")).collect();
    let tiles: Vec<_> = tree.descendants().find(|n| n.has_tag_name("nav")).unwrap().descendants().collect();
    let links: Vec<_> = tiles.iter().filter_map(|n| n.attribute("href")?.strip_prefix("#figure-")).collect();
    assert_eq!(links.len(), articles.len());
    for (i, (article, link)) in articles.iter().zip(links).enumerate() {
        let number = article.descendants().find(|n| n.has_tag_name("h3")).unwrap().first_element_child().unwrap();
        assert_eq!(number.text(), Some((i + 1).to_string().as_str()));
        let (figures, slider) = (ids(*article), article.descendants().find(|n| n.has_tag_name("input")));
        let first = slider.map_or(0, |slider| slider.attribute("value").unwrap().parse().unwrap());
        assert_eq!(figures[first], link, "the thumbnail is that of the figure which is seen first");
        let last = slider.map_or("0", |slider| slider.attribute("max").unwrap());
        assert_eq!(last, (figures.len() - 1).to_string());
    }
    let depth = articles.iter().find(|n| n.attribute("id") == Some("figure-depth")).unwrap();
    let labels = depth.descendants().find(|n| n.attribute("aria-hidden").is_some()).unwrap();
    let labels: Vec<_> = labels.children().filter_map(|n| n.text()).collect();
    assert_eq!(labels, ["0", "1", "2", "3", "4", "5", "100"]);
    let repeats =
        |pair: &&[Figure]| pair[0].group.is_some() && pair[0].group == pair[1].group && pair[0].shows == pair[1].shows;
    let repeated = registry().windows(2).filter(repeats).count();
    assert_eq!(text.matches("class=\"text repeated\"").count(), repeated, "a list has the texts of a group once");
}

#[test]
fn formulas_break_nowhere() {
    let shown = tables::with_whole_formulas;
    let whole = |formula: &str| format!("<span class=\"formula\">{}</span>", escape(formula));
    assert_eq!(shown("rows of a map"), "rows of a map");
    let pdf = "p(ωᵢ) = D(m) cos θₘ/(4 ωₒ·m)";
    assert_eq!(shown(&format!("second report, error: {pdf}")), format!("second report, error: {}", whole(pdf)));
    let schlick = "F₀ + (1 − F₀)(1 − cos θᵢ)⁵";
    assert_eq!(shown(&format!("{schlick} on both sides")), format!("{} on both sides", whole(schlick)));
    assert_eq!(shown("a < b & c"), format!("{} {} c", whole("a < b"), whole("&")));
    assert_eq!(shown("(open"), whole("(open"));
}
