//! Numerical errors of the code that renders: `stability-fresnel`, `-conductor`, `-microfacet`, `-sampling`, `-geometry`,
//! `-sums`.

use crate::error::Result;
use crate::gallery::check::Check;
use crate::gallery::figure::{Content, Figure, Report};
use crate::gallery::inputs::Inputs;
use crate::gallery::studies::{Studies, Study};
use crate::study::stability::{self, Effort, Row, Stability};
use crate::view::{stability as maps, stability_summary as summary};
use std::rc::Rc;

/// Texts of a figure; the study's registry says which families and experiments it covers.
struct Part {
    id: &'static str,
    title: &'static str,
    shows: &'static str,
}

const PARTS: [Part; 6] = [
    Part { id: "stability-fresnel", title: "Errors of dielectric Fresnel and of refraction", shows: MAPS },
    Part { id: "stability-conductor", title: "Errors of conductor Fresnel", shows: MAPS },
    Part { id: "stability-microfacet", title: "Errors of microfacet distributions, pdfs and shadowing", shows: MAPS },
    Part { id: "stability-sampling", title: "Errors of sampled normals", shows: MAPS },
    Part { id: "stability-geometry", title: "Errors of half vectors, spheres, triangles and offsets", shows: MAPS },
    Part {
        id: SUMS,
        title: "The worst case of every family, sums, tables and long paths included",
        shows: "The largest relative error of each family: of the code that renders, of textbook formulas and of the reports', in \
                f32 (filled) and f64 (open).",
    },
];

const SUMS: &str = "stability-sums";
const MAPS: &str = "Relative errors in f32 over the inputs: of the code that renders, of textbook formulas and of the reports', \
                    beside what rounding of the inputs alone causes.";

/// The families of the figure with this id.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct FamiliesOf(&'static str);

impl Study for FamiliesOf {
    type Output = Stability;

    fn run(self, inputs: &Inputs) -> Result<Stability> {
        let effort = inputs.effort.of(Effort::FIGURES, Effort::QUICK);
        stability::run(&stability::of_figure(self.0), &effort, inputs.seed, &mut |_| {})
    }
}

/// A figure for each part.
pub fn figures() -> Vec<Figure> {
    let figure = |part: &'static Part| Figure {
        id: part.id,
        title: part.title,
        report: Report::Neither,
        answers: "stability study",
        shows: part.shows,
        beside: None,
        command: None,
        make: Box::new(|inputs, studies| content(inputs, studies, part)),
    };
    PARTS.iter().map(figure).collect()
}

fn content(inputs: &Inputs, studies: &mut Studies, part: &Part) -> Result<Content> {
    let own = studies.get(FamiliesOf(part.id), inputs)?;
    let drawing = if part.id == SUMS {
        let all: Vec<Rc<Stability>> =
            PARTS.iter().map(|part| studies.get(FamiliesOf(part.id), inputs)).collect::<Result<_>>()?;
        let rows: Vec<Row> = all.iter().flat_map(|found| found.rows.iter().cloned()).collect();
        summary::worst_cases(&rows)
    } else {
        maps::maps(&own.sweeps)?
    };
    let checks = own.bounds.iter().map(|bound| Check::at_most(&bound.name, bound.got, bound.limit));
    Content::new(drawing, &own.rows, checks.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_of_the_study_has_its_texts() {
        assert_eq!(PARTS.map(|part| part.id).to_vec(), stability::figures());
    }
}
