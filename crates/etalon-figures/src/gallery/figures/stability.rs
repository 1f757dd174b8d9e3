//! Numerical errors of the code that renders: `stability-fresnel`, `-conductor`, `-microfacet`, `-sampling`, `-geometry`,
//! `-special`, `-sums`. The registry of the study says which figure shows which family.

use crate::gallery::prelude::*;
use crate::view::stability as view;
use etalon_bench::stability::{self, Stability, Workload};

/// Ids and titles of the figures.
const TITLES: [(&str, &str); 7] = [
    ("stability-fresnel", "Errors of dielectric Fresnel and of refraction"),
    ("stability-conductor", "Errors of conductor Fresnel"),
    ("stability-microfacet", "Errors of microfacet distributions, pdfs and shadowing"),
    ("stability-sampling", "Errors of sampled normals"),
    ("stability-geometry", "Errors of half vectors, spheres, triangles and offsets"),
    (SPECIAL, "Errors at special directions, indices and widths"),
    (SUMS, "The worst case of every family, sums, tables and long paths included"),
];

/// The figure of what has no grids.
const SPECIAL: &str = "stability-special";
const SPECIAL_SHOWS: &str = "The code that renders, in f32 (filled) and f64 (open), at cosines 0, −0, the smallest denormal number and 1 ± 4 units of the last place, indices of refraction at and next to 1, \
                            √½ and √2, and the least and largest widths; of normals sampled also with a random number of 0, whose exact slope is infinite. Left, the largest relative error of each function; pale bars show how far rounding of the input alone may move the result there. \
                            Right, the largest error over that reach. Two points lie far out. beckmann-normal in f64: at a random number of 0 the code bounds the infinite slope, \
                            which moves the normal by 4·10⁻⁶, small for a render and 10¹⁰ last places of f64. dielectric-pdf: two directions that are opposite along the surface, up to \
                            the smallest denormal number, have no half vector; the code returns a pdf of 0. BSDFs have no formula to compare with: of them is tested that nothing is NaN, infinite or negative.";
const SPECIAL_MATTERS: &str = "A cosine of 1.0000001 under a root made glass reflect all light at its normal: a NaN is caught by no tolerance, and most grids of tests do not meet it.";
/// The figure of what has no maps; it also summarizes the other figures.
const SUMS: &str = "stability-sums";
const SUMMARY: &str = "Left, the largest relative error of each family: of the code that renders, of textbook formulas and of the \
                       reports', in f32 (filled) and f64 (open); pale bars show how far rounding of the input alone may move the \
                       result there (condition number × half a last place). Right, the largest error over that reach: left of \
                       the dotted line the input explains all of it. Errors at either end of the scale are that or beyond.";
const SUMMARY_MATTERS: &str = "It tells errors that a better formula would avoid from those that no formula can avoid, because the input was rounded before.";
const MAPS_MATTER: &str = "A formula that is right on paper may lose all its digits where two numbers nearly cancel, and a render may then show spots that no \
                           number of samples removes.";
const MAPS: &str = "Relative errors in f32 over the inputs: of the code that renders, of textbook formulas and of the reports', \
                    beside what rounding of the input alone causes: no formula can be expected to do better than that.";

/// The families and experiments of the figure of that id.
fn families(inputs: &Inputs, studies: &mut Studies, id: &str) -> Result<Rc<Stability>> {
    let workload = inputs.effort.of(Workload::FIGURES, Workload::QUICK);
    studies.get(id, || stability::run(&stability::of_figure(id), &workload, inputs.seed, &mut |_| {}))
}

/// A figure for each of [`TITLES`].
pub fn figures() -> Vec<Figure> {
    let figure = |(id, title)| Figure {
        id,
        title,
        report: Report::Neither,
        reproduces: "stability study",
        shows: texts(id)[0],
        matters: texts(id)[1],
        papers: &[papers::HIGHAM],
        ..Figure::by(move |inputs, studies| content(inputs, studies, id))
    };
    TITLES.into_iter().map(figure).collect()
}

/// What the figure of that id shows, and why it matters.
fn texts(id: &str) -> [&'static str; 2] {
    match id {
        SUMS => [SUMMARY, SUMMARY_MATTERS],
        SPECIAL => [SPECIAL_SHOWS, SPECIAL_MATTERS],
        _ => [MAPS, MAPS_MATTER],
    }
}

fn content(inputs: &Inputs, studies: &mut Studies, id: &'static str) -> Result<Content> {
    let own = families(inputs, studies, id)?;
    let drawing = if id == SPECIAL {
        view::worst_cases(&own.rows)
    } else if id == SUMS {
        let mut rows = Vec::new();
        for figure in stability::figures().into_iter().filter(|figure| *figure != SPECIAL) {
            rows.extend_from_slice(&families(inputs, studies, figure)?.rows);
        }
        view::worst_cases(&rows)
    } else {
        view::maps(&own.sweeps)
    };
    let checks = own.bounds.iter().map(|bound| Check::at_most(&bound.name, bound.got, bound.limit));
    Content::new(drawing, &own.rows, checks.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_that_the_study_names_is_made() {
        assert_eq!(TITLES.map(|(id, _)| id).to_vec(), stability::figures());
    }
}
