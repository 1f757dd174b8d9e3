//! A golden statue of increasing roughness: `roughness-0.005`, `-0.05`, `-0.25`, `-0.5`; one in iron: `iron`.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::roughness::{self, StatueRender};
use etalon_core::optics::metals::{IRON, WAVELENGTHS_NM};
use etalon_core::raster::ToneMap;

/// Roughness of the report's statues of gold.
pub const ALPHAS: [f32; 4] = [0.005, 0.05, 0.25, 0.5];
/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// The statue of a metal with roughness α.
pub fn statue(inputs: &Inputs, studies: &mut Studies, metal: &str, alpha: f32) -> Result<Rc<StatueRender>> {
    studies.get(format!("{metal} {alpha}"), || {
        let (scene, request) = inputs.statue(metal, alpha)?;
        roughness::render_statue(&scene, &request, &inputs.settings())
    })
}

pub fn figures() -> Vec<Maker> {
    let statue = |place: usize| {
        maker(format!("roughness-{}", ALPHAS[place]), move |inputs, studies| {
            let mut content = content(inputs, studies, "Au", ALPHAS[place])?;
            if place > 0 {
                content.checks.push(dimmer(inputs, studies, ALPHAS[place], ALPHAS[place - 1])?);
            }
            Ok(content)
        })
    };
    (0..ALPHAS.len()).map(statue).chain([maker("iron", iron)]).collect()
}

fn iron(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let mut content = content(inputs, studies, "Fe", 0.5)?;
    // Grey: no channel differs from the mean of all by more than a fifth.
    let radiance = statue(inputs, studies, "Fe", 0.5)?.statue;
    let colour = radiance.value.map(|v| (v / radiance.mean_rgb() - 1.0).abs());
    let largest = colour.into_iter().fold(0.0, f64::max);
    content.checks.push(Check::at_most("largest relative difference of a channel from grey", largest, 0.2));
    content.checks.extend(iron_of_the_report());
    Ok(content.with_printed(printed_iron()))
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
        Check::equal("dropped samples", 0.0, shot.dropped.total() as f64),
        Check::within("mean of the statue, visible minus all normals (standard errors)", 0.0, z, SIGMAS),
    ];
    let content = Content::new(view::image(&shot.image), std::slice::from_ref(&shot.row), checks)?;
    Ok(content.with_image(&shot.image, ToneMap::SecondReport))
}

/// Rougher metal has dimmer highlights.
fn dimmer(inputs: &Inputs, studies: &mut Studies, alpha: f32, smoother: f32) -> Result<Check> {
    let [rough, smooth] = [alpha, smoother].map(|alpha| statue(inputs, studies, "Au", alpha));
    let ratio = rough?.row.brightest_percent / smooth?.row.brightest_percent;
    let name = format!("share of light in the brightest hundredth of the pixels, over that at α = {smoother}");
    Ok(Check::at_most(name, ratio, 1.0))
}
