//! Brushed metal by the widths of its distribution of normals along the tangent and across it: `anisotropy`.

use crate::gallery::prelude::*;
use crate::scene::{Environment, Request, builtin};
use crate::study::anisotropy::{PairRow, render_pair};
use crate::view::renders as view;

/// Widths, along the tangent by column and across it by row.
const ALPHAS: [f32; 3] = [0.05, 0.15, 0.4];
/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// One figure with an image for each pair of widths.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "anisotropy",
        title: "Brushed metal by the widths along the grooves and across",
        report: Report::Neither,
        reproduces: "anisotropic distributions of microfacet normals",
        shows: "Copper under the map and two small area lights: a disc with circular grooves, and a sphere with grooves around \
                its vertical axis. The captions have α along the grooves, which are the tangents, and α across. A highlight is long \
                where normals vary most; where both widths are equal (GGX) there are no grooves.",
        matters: "Anisotropic materials show at once whether tangents and widths are exchanged, which no isotropic scene can.",
        papers: &[papers::HEITZ, papers::BURLEY_DISNEY],
        command: Some("etalon render brushed-metal --alpha 0.05,0.4 --envmap {map} --uniform".into()),
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let environment = Environment::upright(inputs.map.map.clone(), &inputs.map.name, builtin::BRUSHED_METAL_SCALE);
    let (scene, request) = builtin::brushed_metal(environment);
    let request = Request { spp: 16, ..request };
    let (scene, request) = scene.resized(request, inputs.effort.of([160, 80], [80, 40]));
    let mut renders = Vec::new();
    for alpha_y in ALPHAS {
        for alpha_x in ALPHAS {
            renders.push(render_pair(&scene, &request, &inputs.settings(), [alpha_x, alpha_y])?);
        }
    }
    let rows: Vec<PairRow> = renders.iter().map(|render| render.row).collect();
    let mut checks: Vec<Check> = rows.iter().flat_map(agreement).collect();
    for same_y in rows.chunks_exact(ALPHAS.len()) {
        for pair in same_y.windows(2) {
            let [narrow, wide] = [pair[0], pair[1]];
            let name =
                format!("width over height of the sphere's highlights, {} over {}", widths(&narrow), widths(&wide));
            checks.push(Check::at_most(name, narrow.elongation / wide.elongation, 1.0));
        }
    }
    let cells: Vec<_> = renders.iter().map(|render| (widths(&render.row), &render.image)).collect();
    Content::new(view::grid("Brushed copper, α along the grooves and across", 3, 0.0, &cells), &rows, checks)
}

fn widths(row: &PairRow) -> String {
    format!("α = ({}, {})", row.alpha_x, row.alpha_y)
}

fn agreement(row: &PairRow) -> [Check; 3] {
    let of = widths(row);
    let reference = format!("disc minus that of the reference path tracer (standard errors), {of}");
    let turned = format!("disc minus that of turned tangents and exchanged widths (standard errors), {of}");
    [
        Check::within(reference, 0.0, row.z_reference, SIGMAS),
        Check::within(turned, 0.0, row.z_turned, SIGMAS),
        Check::equal(format!("dropped samples, {of}"), 0.0, row.dropped as f64),
    ]
}
