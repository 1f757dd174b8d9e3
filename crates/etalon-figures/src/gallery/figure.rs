//! What a figure is: an entry of the registry, and its content.

use super::check::Check;
use super::inputs::Shown;
use crate::figure::Drawing;
use crate::output;
use etalon_bench::table::Table;
use etalon_core::error::Result;
use etalon_core::raster::{Image, ToneMap};
use serde::{Deserialize, Serialize};

/// Formats of figures' files, in the order of the links to them.
pub const FORMATS: [&str; 7] = ["csv", "svg", "pdf", "png", "exr", "pfm", "ppm"];

/// Where a figure's counterpart was published.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Report {
    /// The report of 2020, about Fresnel reflectance and environment maps.
    First,
    /// The report of 2022, about path tracing and microfacets.
    Second,
    Both,
    #[default]
    Neither,
}

impl Report {
    pub fn name(self) -> &'static str {
        match self {
            Self::First => "first report",
            Self::Second => "second report",
            Self::Both => "both reports",
            Self::Neither => "beyond the reports",
        }
    }

    /// What it is, in full.
    pub fn citations(self) -> &'static [&'static str] {
        const CITATIONS: [&str; 2] = [
            "First report: Advanced Computer Graphics coursework report, Imperial College London, Department of Computing, \
             February 2020.",
            "Second report: CS 184 HW3.2 report, University of California, Berkeley, spring 2022 (the course calls it \
             project 3-2).",
        ];
        match self {
            Self::First => &CITATIONS[..1],
            Self::Second => &CITATIONS[1..],
            Self::Both => &CITATIONS,
            Self::Neither => &[],
        }
    }

    /// What it is, in brief.
    fn source(self) -> &'static str {
        match self {
            Self::First => "Imperial College London, 2020",
            Self::Second => "CS 184, UC Berkeley, 2022",
            Self::Both => "Imperial College London, 2020; CS 184, UC Berkeley, 2022",
            Self::Neither => "",
        }
    }
}

/// A figure: its texts, as `figures.json` has them.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The name of its files, and of `--only`.
    pub id: String,
    pub title: String,
    #[serde(default)]
    pub report: Report,
    /// The counterpart in that report, with the number of the figure where it has one.
    pub reproduces: String,
    /// The part of the gallery that it belongs to.
    pub section: String,
    /// The input that it shows, which its caption names.
    #[serde(default)]
    pub input: Shown,
    /// The caption: what is seen.
    pub shows: String,
    /// Why that matters, in a sentence.
    pub matters: String,
    /// Papers and books for its formulas.
    pub papers: Vec<String>,
    /// The figure to compare it with.
    pub beside: Option<String>,
    /// The figures with which it shares one place on the page, and its position among them: a label of their slider.
    pub group: Option<Group>,
    #[serde(default)]
    pub at: String,
    /// The subcommand that makes this figure alone, if there is one; `{map}` stands for the environment map.
    pub command: Option<String>,
}

/// Figures that differ by one quantity.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    pub id: String,
    pub title: String,
    /// The quantity by which they differ.
    pub varies: String,
}

impl Figure {
    /// "first report (Imperial College London, 2020): Figure 3, …".
    pub fn counterpart(&self) -> String {
        match self.report {
            Report::Neither => self.reproduces.clone(),
            report => format!("{} ({}): {}", report.name(), report.source(), self.reproduces),
        }
    }
}

pub struct Content {
    /// None of what is a table of text on the page.
    pub drawing: Option<Drawing>,
    /// The numbers of the drawing as CSV text.
    pub table: Vec<u8>,
    /// A render, written as EXR, PFM and PPM beside the drawing, and how the PPM shows it.
    pub image: Option<(Image, ToneMap)>,
    pub checks: Vec<Check>,
    /// Errors of the reports that it demonstrates.
    pub errata: Vec<Erratum>,
    /// Claims of the reports that it answers.
    pub claims: Vec<Claim>,
    pub printed: Vec<Printed>,
    /// Numbers that the page shows beside the drawing.
    pub numbers: Numbers,
}

impl Content {
    /// A drawing, the rows of its table, and its checks.
    pub fn new<T: Serialize + Default>(drawing: Drawing, rows: &[T], checks: Vec<Check>) -> Result<Self> {
        Ok(Self::of_csv(drawing, output::csv(rows)?, checks))
    }

    /// The rows of a table that the page shows as text, and its checks.
    pub fn of_text<T: Serialize + Default>(rows: &[T], checks: Vec<Check>) -> Result<Self> {
        Ok(Self::of_csv(None, output::csv(rows)?, checks))
    }

    /// A drawing, if there is one, its table as CSV text, and its checks.
    pub fn of_csv(drawing: impl Into<Option<Drawing>>, table: Vec<u8>, checks: Vec<Check>) -> Self {
        Self {
            drawing: drawing.into(),
            table,
            image: None,
            checks,
            errata: Vec::new(),
            claims: Vec::new(),
            printed: Vec::new(),
            numbers: Numbers::default(),
        }
    }

    /// Adds numbers that a report prints.
    pub fn with_printed(self, printed: Vec<Printed>) -> Self {
        Self { printed, ..self }
    }

    /// Adds the render that the drawing shows, with the tone mapping of its PPM file.
    pub fn with_image(self, image: &Image, tone: ToneMap) -> Self {
        Self { image: Some((image.clone(), tone)), ..self }
    }
}

/// A table for the page: headings, and rows of cells.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Numbers {
    pub fn of<T>(table: &Table<'_, T>) -> Self {
        let columns = &table.columns;
        let rows = columns.first().map_or(0, |column| column.cells.len());
        let row = |i: usize| columns.iter().map(|column| column.cells[i].clone()).collect();
        let headings = columns.iter().map(|column| column.heading.clone()).collect();
        Self { headings, rows: (0..rows).map(row).collect() }
    }
}

/// A number that a report prints beside the one that is computed here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Printed {
    pub quantity: String,
    pub report: String,
    /// To the digits of the report.
    pub ours: String,
}

/// An error of a report with the evidence for it: a row of "errors in the reports".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Erratum {
    pub printed: String,
    pub right: String,
    /// The test that detects the error.
    pub test: String,
    /// The p-value of that test for what is printed; `None` where an exact check rejects it.
    pub p_value: Option<f64>,
    /// The error of an image, and its measure.
    pub picture_error: String,
    /// Where the figure shows it; unknown in records of earlier versions.
    #[serde(default)]
    pub place: Option<Place>,
}

/// A panel of a figure: its letter, and its left, top, width and height as shares of the figure's size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Place {
    pub panel: char,
    pub share: [f64; 4],
}

/// A claim of a report with the answer: a row of "what the reports claim".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    pub report: String,
    /// The figure or table of the report, or its text.
    pub place: String,
    pub claim: String,
    /// The number that the report prints, if it prints one.
    pub number: String,
    /// The numbers that are measured, each with what the claim demands of it.
    pub measured: Vec<String>,
    pub verdict: String,
    /// Figures that show it.
    pub evidence: Vec<String>,
}
