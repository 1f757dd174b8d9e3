//! Maps of errors over the inputs: the renderer's formula, the textbook's, the reports', and the error that rounding of the
//! input causes.

use crate::figure::{Anchor, Axis, Drawing, Heatmap, Level, Panel, Plot, Shading, Text, theme};
use crate::study::stability::{Case, Precision, Scale, Section, Sweep};

/// One colour scale for all maps: from below the rounding of f32 to a relative error of 1.
const SCALE: (f64, f64) = (1e-8, 1.0);
/// Half a unit of f32's last place: how far rounding an input moves it.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
const HEADING: f64 = 20.0;

/// A row of maps for every grid of the sweeps, each of the relative errors in f32.
pub fn maps(sweeps: &[Sweep]) -> Drawing {
    let rows = sweeps.iter().flat_map(|sweep| (0..sweep.family.sections.len()).map(move |section| row(sweep, section)));
    Drawing::stacked(rows.collect(), 0.0, 1.5)
}

fn row(sweep: &Sweep, number: usize) -> Drawing {
    let section = &sweep.family.sections[number];
    let variants = sweep.family.variants.iter().enumerate();
    let mut panels = variants
        .map(|(i, variant)| {
            panel(sweep, number, variant.name.into(), "", &|case| case.deviations[i].map_or(f64::NAN, |d| d.relative))
        })
        .collect::<Vec<_>>();
    let heading = format!("{} ({})", sweep.family.about, section.title);
    let rounding = |case: &Case| case.condition.max(1.0) * ROUNDING;
    panels.push(panel(sweep, number, "rounding of the input".into(), "relative error in f32", &rounding));
    let maps = Plot::new(panels).frame_size(190.0, 150.0).draw();
    let mut row = Drawing::new(maps.width, HEADING + maps.height, maps.scale);
    let text = Text::new([14.0, HEADING], theme::TITLE_SIZE, heading).held(Anchor::Start, Level::Baseline);
    row.text(text.bold());
    row.append(maps, 0.0, HEADING);
    row
}

fn panel(sweep: &Sweep, number: usize, title: String, label: &str, value: &dyn Fn(&Case) -> f64) -> Panel {
    let Section { x, y, .. } = &sweep.family.sections[number];
    let side = sweep.side;
    let mut values = vec![f64::NAN; side * side];
    for case in sweep.cases.iter().filter(|case| case.precision == Precision::Single) {
        if let Some(place) = case.place.filter(|place| place.section == number) {
            // Row 0 of a map is at the top, where the y axis ends. Exact values take the colour of the least error.
            values[(side - 1 - place.row) * side + place.column] = value(case).max(SCALE.0);
        }
    }
    let axis = |scale: &Scale| Axis::log(scale.label).range(scale.from, scale.to);
    let map = Heatmap::new(side, values, Shading::Log10, label).range(SCALE.0, SCALE.1);
    Panel::new(axis(x), axis(y)).title(title).heatmap(map)
}
