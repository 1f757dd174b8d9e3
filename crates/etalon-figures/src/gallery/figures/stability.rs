//! Numerical errors of the code that renders: `stability-fresnel`, `-conductor`, `-microfacet`, `-sampling`, `-geometry`,
//! `-special`, `-worst`. The registry of the study says which figure shows which family.

use crate::gallery::prelude::*;
use crate::view::stability as view;
use etalon_bench::stability::{self, BoundCheck, ErrorRow, Stability};

/// Places along each side of the grids: finer than a page shows; and for a quick look.
const SIDES: [usize; 2] = [25, 9];

/// The families of those names; `id` is that of their figure.
fn run(inputs: &Inputs, studies: &mut Studies, id: &'static str, names: &[&str]) -> Result<Rc<Stability>> {
    let side = inputs.effort.of(SIDES[0], SIDES[1]);
    studies.get(id, || stability::run(names, side, &mut |_| {}))
}

pub fn figures() -> Vec<Maker> {
    let families = |id: &'static str| maker(id, move |inputs, studies| families(inputs, studies, id));
    let all = [maker("stability-special", special), maker("stability-worst", worst)];
    stability::figures().into_iter().map(families).chain(all).collect()
}

/// The families of a figure over their grids.
fn families(inputs: &Inputs, studies: &mut Studies, id: &'static str) -> Result<Content> {
    let own = run(inputs, studies, id, &stability::of_figure(id))?;
    Content::new(view::errors(&own.sweeps), &own.rows, checks(&own.bounds))
}

fn special(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let own = run(inputs, studies, stability::SPECIAL, &[stability::SPECIAL])?;
    Content::new(view::worst_cases(&own.rows), &own.rows, checks(&own.bounds))
}

/// All families.
fn worst(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let mut rows: Vec<ErrorRow> = Vec::new();
    for id in stability::figures() {
        rows.extend_from_slice(&run(inputs, studies, id, &stability::of_figure(id))?.rows);
    }
    Content::new(view::worst_cases(&rows), &rows, checks(&[BoundCheck::finite(&rows)]))
}

fn checks(bounds: &[BoundCheck]) -> Vec<Check> {
    bounds.iter().map(|bound| Check::at_most(&bound.name, bound.got, bound.limit)).collect()
}
