//! A golden statue of increasing roughness: `roughness-0.005`, `-0.05`, `-0.25`, `-0.5`; one in iron: `iron`.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::roughness::{self, StatueRender};
use etalon_core::optics::metals::{IRON, WAVELENGTHS_NM};
use etalon_core::raster::ToneMap;

/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// The statue of a metal with roughness α.
pub fn statue(inputs: &Inputs, studies: &mut Studies, metal: &str, alpha: f32) -> Result<Rc<StatueRender>> {
    studies.get(format!("{metal} {alpha}"), || {
        let (scene, request) = inputs.statue(metal, alpha)?;
        roughness::render_statue(&scene, &request, &inputs.settings())
    })
}

/// One figure for each α, each checked against the smoother one before it.
pub fn figures() -> Vec<Figure> {
    let figure = |id, title, alpha, smoother: Option<f32>, reproduces, beside| Figure {
        id,
        title,
        report: Report::Second,
        reproduces,
        shows: "The wider the distribution of microfacet normals, the wider and dimmer are the highlights. Shown as in the \
                report: √2 times the radiance, encoded by a gamma of 2.2.",
        matters: "One parameter takes the statue from a mirror to a nearly diffuse body, and a sampler has to follow it over that whole range.",
        papers: &[papers::COOK_TORRANCE, papers::WALTER],
        beside: Some(beside),
        command: Some(format!(
            "etalon render cornell-statue-au --alpha {alpha} -s 128 -l 1 -m 5 --tone report --uniform"
        )),
        ..Figure::by(move |inputs, studies| {
            let mut content = content(inputs, studies, "Au", alpha)?;
            if let Some(smoother) = smoother {
                content.checks.push(dimmer(inputs, studies, alpha, smoother)?);
            }
            Ok(content)
        })
    };
    vec![
        figure(
            "roughness-0.005",
            "Golden statue, α = 0.005",
            0.005,
            None,
            "Figure 2a, α = 0.005 (CBdragon_microfacet_au.dae, -t 8 -s 128 -l 1 -m 5 -r 480 360)",
            "roughness-0.05",
        ),
        figure(
            "roughness-0.05",
            "Golden statue, α = 0.05",
            0.05,
            Some(0.005),
            "Figure 2b, α = 0.05 (CBdragon_microfacet_au.dae, -t 8 -s 128 -l 1 -m 5 -r 480 360)",
            "roughness-0.005",
        ),
        figure(
            "roughness-0.25",
            "Golden statue, α = 0.25",
            0.25,
            Some(0.05),
            "Figure 2c, α = 0.25 (CBdragon_microfacet_au.dae, -t 8 -s 128 -l 1 -m 5 -r 480 360)",
            "roughness-0.05",
        ),
        figure(
            "roughness-0.5",
            "Golden statue, α = 0.5",
            0.5,
            Some(0.25),
            "Figure 2d, α = 0.5 (CBdragon_microfacet_au.dae, -t 8 -s 128 -l 1 -m 5 -r 480 360)",
            "roughness-0.25",
        ),
    ]
}

pub fn iron() -> Vec<Figure> {
    vec![Figure {
        id: "iron",
        title: "Iron statue, α = 0.5",
        report: Report::Second,
        reproduces: "Figure 4, iron, α = 0.5 (CBdragon_microfacet_fe.dae, -t 8 -s 128 -l 1 -m 5 -r 480 360)",
        shows: "The scene of `roughness-0.5` with the indices of iron, those of Table 1, in place of gold's: all colours are reflected \
                nearly alike. Shown as in the report: √2 times the radiance, encoded by a gamma of 2.2.",
        matters: "Only the indices of refraction differ from those of the golden statue: they alone make it grey.",
        papers: &[papers::JOHNSON_CHRISTY, papers::COOK_TORRANCE],
        beside: Some("roughness-0.5"),
        command: Some("etalon render cornell-statue-fe -s 128 -l 1 -m 5 --tone report --uniform".into()),
        ..Figure::by(|inputs, studies| {
            let mut content = content(inputs, studies, "Fe", 0.5)?;
            // Grey: no channel differs from the mean of all by more than a fifth.
            let radiance = statue(inputs, studies, "Fe", 0.5)?.statue;
            let colour = radiance.value.map(|v| (v / radiance.mean_rgb() - 1.0).abs());
            let largest = colour.into_iter().fold(0.0, f64::max);
            content.checks.push(Check::at_most("largest relative difference of a channel from grey", largest, 0.2));
            content.checks.extend(iron_of_the_report());
            Ok(content.with_printed(printed_iron()))
        })
    }]
}

/// η and k of iron, red, green and blue, in the report.
const TABLE_1: [[f64; 2]; 3] = [[2.8851, 3.0449], [2.9500, 2.9300], [2.6500, 2.8095]];

/// The report's Table 1 beside the indices of iron that are rendered.
pub fn printed_iron() -> Vec<Printed> {
    let index = |[eta, k]: [f64; 2]| format!("{eta:.4} + {k:.4}i");
    let rows = TABLE_1.into_iter().zip(WAVELENGTHS_NM).zip(IRON.eta.into_iter().zip(IRON.k));
    let row = |((printed, nm), (eta, k)): (([f64; 2], f64), (f64, f64))| Printed {
        quantity: format!("η + ki of iron at {nm} nm"),
        report: index(printed),
        ours: index([eta, k]),
    };
    rows.map(row).collect()
}

/// The indices of iron that are rendered, and those of the report's Table 1.
pub fn iron_of_the_report() -> Vec<Check> {
    let channels = TABLE_1.into_iter().zip(WAVELENGTHS_NM).zip(IRON.eta.into_iter().zip(IRON.k));
    let checks = |(([eta, k], nm), ours): (([f64; 2], f64), (f64, f64))| {
        [("η", eta, ours.0), ("k", k, ours.1)].map(|(name, table, ours)| {
            Check::equal(format!("{name} of iron at {nm} nm (the report's Table 1: {table:.4})"), table, ours)
        })
    };
    channels.flat_map(checks).collect()
}

/// A statue, checked against a render with another way of sampling normals.
fn content(inputs: &Inputs, studies: &mut Studies, symbol: &str, alpha: f32) -> Result<Content> {
    let shot = statue(inputs, studies, symbol, alpha)?;
    let (scene, request) = inputs.statue(symbol, alpha)?;
    let other = roughness::mean_by_all_normals(&scene, &request, &inputs.settings(), &shot.mask)?;
    let z = shot.statue.z(&other);
    let checks = vec![
        Check::equal("dropped samples", 0.0, shot.rendered.dropped.total() as f64),
        Check::within("mean of the statue, visible minus all normals (standard errors)", 0.0, z, SIGMAS),
    ];
    let content = Content::new(view::image(&shot.rendered.image), std::slice::from_ref(&shot.row), checks)?;
    Ok(content.with_image(&shot.rendered.image, ToneMap::SecondReport))
}

/// Rougher metal has dimmer highlights.
fn dimmer(inputs: &Inputs, studies: &mut Studies, alpha: f32, smoother: f32) -> Result<Check> {
    let [rough, smooth] = [alpha, smoother].map(|alpha| statue(inputs, studies, "Au", alpha));
    let ratio = rough?.row.brightest_percent / smooth?.row.brightest_percent;
    let name = format!("share of light in the brightest hundredth of the pixels, over that at α = {smoother}");
    Ok(Check::at_most(name, ratio, 1.0))
}
