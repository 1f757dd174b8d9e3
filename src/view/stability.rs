//! Maps of errors over the inputs: the renderer's formula, the textbook's, the reports', and the error that rounding of the
//! input causes.

use super::text::capitalized;
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Shading};
use crate::study::stability::{Case, Precision, STABLE, Scale, Section, Sweep};

/// One colour scale for all maps: from below the rounding of f32 to a relative error of 1.
const SCALE: (f64, f64) = (1e-8, 1.0);
/// Half a unit of f32's last place: how far rounding an input moves it.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
/// Size of a map.
const FRAME: [f64; 2] = [180.0, 95.0];
/// The label of the colour bar, which all maps share.
const LABEL: &str = "relative error in f32 (darkest: 10^{−8} or less, lightest: 1 or more, grey: not finite)";

/// A row of maps for every grid of the sweeps, each of the relative errors in f32.
pub fn maps(sweeps: &[Sweep]) -> Drawing {
    let rows = sweeps.iter().flat_map(|sweep| (0..sweep.family.sections.len()).map(move |section| row(sweep, section)));
    Plot::grid(rows).frame_size(FRAME[0], FRAME[1]).draw()
}

/// The maps of one grid under their heading.
fn row(sweep: &Sweep, number: usize) -> (String, Vec<Panel>) {
    let section = &sweep.family.sections[number];
    let of = |i: usize| move |case: &Case| case.deviations[i].map_or(f64::NAN, |d| d.relative);
    let variants = sweep.family.variants.iter().enumerate();
    let mut panels: Vec<Panel> =
        variants.map(|(i, variant)| panel(sweep, number, title(variant.name), i == 0, &of(i))).collect();
    let rounding = |case: &Case| case.condition.max(1.0) * ROUNDING;
    // Beside the variant that renders: the other variants' number differs
    panels.insert(1, panel(sweep, number, "Rounding of the input".into(), false, &rounding));
    (capitalized(&format!("{} ({})", sweep.family.about, section.title)), panels)
}

/// What a variant is called in figures.
pub fn title(variant: &str) -> String {
    match variant.strip_prefix(STABLE) {
        Some(rest) => format!("As it renders{rest}"),
        None => capitalized(variant),
    }
}

/// A map of one grid; the first of a row names the y axis.
fn panel(sweep: &Sweep, number: usize, title: String, is_first: bool, value: &dyn Fn(&Case) -> f64) -> Panel {
    let Section { x, y, .. } = &sweep.family.sections[number];
    let side = sweep.side;
    let mut values = vec![f64::NAN; side * side];
    for case in sweep.cases.iter().filter(|case| case.precision == Precision::Single) {
        if let Some(place) = case.place.filter(|place| place.section == number) {
            // Row 0 of a map is at the top, where the y axis ends. Exact values take the colour of the least error.
            values[(side - 1 - place.row) * side + place.column] = value(case).max(SCALE.0);
        }
    }
    let axis = |scale: &Scale, label| Axis::log(label).range(scale.from, scale.to);
    let map = Heatmap::new(side, values, Shading::Log10, LABEL).range(SCALE.0, SCALE.1);
    Panel::new(axis(x, x.label), axis(y, if is_first { y.label } else { "" })).title(title).heatmap(map)
}
