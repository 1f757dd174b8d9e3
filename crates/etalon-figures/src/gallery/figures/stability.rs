//! Numerical errors of the code that renders: `stability-fresnel`, `-conductor`, `-microfacet`, `-sampling`, `-geometry`,
//! `-special`, `-worst`. The registry of the study says which figure shows which family.

use crate::gallery::prelude::*;
use crate::view::stability as view;
use etalon_bench::stability::{self, Stability, Workload};

/// The figure of what has no grids.
const SPECIAL: &str = "stability-special";
/// The figure of all; those of sums, tables and paths have no other.
const WORST: &str = "stability-worst";

/// The families and experiments of the figure of that id.
fn families(inputs: &Inputs, studies: &mut Studies, id: &str) -> Result<Rc<Stability>> {
    let workload = inputs.effort.of(Workload::FIGURES, Workload::QUICK);
    studies.get(id, || stability::run(&stability::of_figure(id), &workload, inputs.seed, &mut |_| {}))
}

pub fn figures() -> Vec<Maker> {
    let figure = |id: &'static str| maker(id, move |inputs, studies| content(inputs, studies, id));
    stability::figures().into_iter().map(figure).collect()
}

fn content(inputs: &Inputs, studies: &mut Studies, id: &'static str) -> Result<Content> {
    let own = families(inputs, studies, id)?;
    let drawing = if id == SPECIAL {
        view::worst_cases(&own.rows)
    } else if id == WORST {
        let mut rows = Vec::new();
        for figure in stability::figures().into_iter().filter(|figure| *figure != SPECIAL) {
            rows.extend_from_slice(&families(inputs, studies, figure)?.rows);
        }
        view::worst_cases(&rows)
    } else {
        view::errors(&own.sweeps)
    };
    let checks = own.bounds.iter().map(|bound| Check::at_most(&bound.name, bound.got, bound.limit));
    Content::new(drawing, &own.rows, checks.collect())
}
