//! The first report's figures: how each is made and what it must meet.

use super::check::Check;
use super::context::{Context, STRATEGIES, Size};
use super::map::Display;
use super::registry::{Entry, Made, Picture};
use super::{fresnel as fresnel_view, output, proposal as proposal_view, sphere as sphere_view};
use crate::envmap::cut::{SideRule, Split};
use crate::envmap::irradiance::IrradianceTree;
use crate::envmap::samplers::CdfSampler;
use crate::errata::Conventions;
use crate::error::Result;
use crate::figure::Drawing;
use crate::raster::ToneMap;
use crate::study::fresnel;
use crate::study::map_samples;
use crate::study::median_cut::{self, Centroid};
use crate::study::proposal;
use crate::study::sphere::Row;
use glam::DVec3;

/// The report's glass.
const GLASS: f64 = 1.45;
/// Side of the windows that mark samples, in texels.
const WINDOW: usize = 5;
/// Samples per pixel of the report's renders.
const SPP: [u32; 4] = [8, 16, 32, 64];

pub(super) fn all() -> Vec<Entry> {
    let mut list = vec![
        entry("fresnel-enter", "Reflectance from air into glass", "first report: Fresnel curves, entering", |_| {
            dielectric(1.0, GLASS)
        })
        .shows(
            "Reflectance of both polarizations and of unpolarized light over the angle of incidence, beside Schlick's \
             approximation and its error; one polarization vanishes at Brewster's angle.",
        )
        .beside("fresnel-exit")
        .command("etalon fresnel --eta-i 1 --eta-t 1.45"),
        entry("fresnel-exit", "Reflectance from glass into air", "first report: Fresnel curves, leaving", |_| {
            dielectric(GLASS, 1.0)
        })
        .shows("The same from inside: everything is reflected beyond the critical angle.")
        .beside("fresnel-enter")
        .command("etalon fresnel --eta-i 1.45 --eta-t 1"),
    ];
    for (id, n, beside, command) in [
        ("envmap-samples-64", 64, "envmap-samples-256", "etalon envmap sample {map} -n 64"),
        ("envmap-samples-256", 256, "median-cut-64", "etalon envmap sample {map} -n 256"),
        ("envmap-samples-1024", 1024, "envmap-samples-256", "etalon envmap sample {map} -n 1024"),
    ] {
        list.push(
            entry(id, "Importance samples of the map", "first report: environment-map samples", move |c| {
                samples(c, n, Display::samples)
            })
            .shows("A blue window at each direction that was drawn in proportion to the light from there.")
            .beside(beside)
            .command(command),
        );
    }
    list.push(
        entry(
            "envmap-samples-only-256",
            "The samples alone, in the colours that they see",
            "first report: environment-map samples, radiance",
            |c| samples(c, 256, Display::samples_only),
        )
        .shows("The same 256 samples without the map: each window has the radiance that its sample meets.")
        .beside("envmap-samples-256")
        .command("etalon envmap sample {map} -n 256"),
    );
    list.push(
        entry(
            "proposal",
            "Why inversion wants uniform numbers",
            "first report: proposal distributions",
            proposal_figure,
        )
        .shows(
            "Rows of the map drawn by inverting its distribution: uniform numbers give its density back, Gaussian numbers \
             do not.",
        )
        .command("etalon envmap proposal {map}"),
    );
    for (id, n, beside, command) in [
        ("median-cut-2", 2, "median-cut-4", "etalon envmap cut {map} -n 2"),
        ("median-cut-4", 4, "median-cut-16", "etalon envmap cut {map} -n 4"),
        ("median-cut-16", 16, "median-cut-64", "etalon envmap cut {map} -n 16"),
        ("median-cut-64", 64, "median-cut-radiance-64", "etalon envmap cut {map} -n 64"),
    ] {
        list.push(
            entry(id, "Median cut of the map", "first report: median cut", move |c| {
                cut(c, n, |display, rows| display.partition(rows))
            })
            .shows("Regions of equal energy, halved along their longer side, each with the centroid of its light.")
            .beside(beside)
            .command(command),
        );
    }
    list.push(
        entry(
            "median-cut-radiance-64",
            "The lights that stand for 64 regions",
            "first report: median cut, radiance",
            |c| cut(c, 64, |display, rows| display.lights(rows, WINDOW)),
        )
        .shows("One light at each centroid, in the colour of its region's flux.")
        .beside("median-cut-64")
        .command("etalon envmap cut {map} -n 64"),
    );
    for (id, spp, beside, command) in [
        ("sphere-8", 8, "sphere-64", "etalon render sphere-env --envmap {map} -s 8 -l 4"),
        ("sphere-16", 16, "sphere-8", "etalon render sphere-env --envmap {map} -s 16 -l 4"),
        ("sphere-32", 32, "sphere-16", "etalon render sphere-env --envmap {map} -s 32 -l 4"),
        ("sphere-64", 64, "sphere-32", "etalon render sphere-env --envmap {map} -s 64 -l 4"),
    ] {
        list.push(
            entry(id, "The lit sphere and its error", "first report: PBRT renders", move |c| sphere(c, spp))
                .shows(
                    "A white diffuse sphere under the map, and how far each pixel is from the exact integral: noise that \
                     shrinks with the samples, without a bias.",
                )
                .beside(beside)
                .command(command),
        );
    }
    list.push(
        entry(
            "sphere-error",
            "Error of the lit sphere against samples and time",
            "first report: PBRT renders, measured",
            sphere_error,
        )
        .shows("Four ways of choosing directions towards the light, by the error that they leave."),
    );
    list
}

pub(super) fn entry(
    id: &'static str,
    title: &'static str,
    answers: &'static str,
    make: impl Fn(&Context) -> Result<Made> + Send + Sync + 'static,
) -> Entry {
    Entry::new(id, title, answers, Box::new(make))
}

fn dielectric(eta_i: f64, eta_t: f64) -> Result<Made> {
    let curves = fresnel::curves(eta_i, eta_t, 901, Conventions::CORRECT)?;
    let mut checks = vec![
        Check::near("normal reflectance", 0.033_735_943_356_934, curves.r_normal, 1e-14),
        Check::near(
            "both components at normal incidence",
            curves.r_normal_parallel,
            curves.r_normal_perpendicular,
            1e-15,
        ),
    ];
    // Entering at 55.4°, leaving at the complement.
    const BREWSTER: f64 = 55.407_711_312_490_06;
    let brewster = if eta_t > eta_i { BREWSTER } else { 90.0 - BREWSTER };
    checks.push(Check::near("Brewster angle (degrees)", brewster, curves.brewster_deg.unwrap_or(f64::NAN), 1e-11));
    if eta_i > eta_t {
        let critical = curves.critical_deg.unwrap_or(f64::NAN);
        checks.push(Check::near("critical angle (degrees)", 43.602_818_972_703_62, critical, 1e-11));
        let beyond = curves.rows.iter().filter(|r| r.theta_deg > critical).map(|r| r.r_unpolarized);
        checks.push(Check::near("least reflectance beyond it", 1.0, beyond.fold(1.0, f64::min), 0.0));
    }
    Ok(Made { drawing: fresnel_view::dielectric(&curves), table: output::table(&curves.rows)?, picture: None, checks })
}

fn samples(
    context: &Context,
    n: usize,
    draw: impl Fn(&Display, &[map_samples::Row], usize) -> Drawing,
) -> Result<Made> {
    let map = &context.source.map;
    let result = map_samples::draw(map, &CdfSampler::new(map.clone()), DVec3::Y, n, context.seed)?;
    let flux = context.info.flux_rgb.iter().sum::<f64>() / 3.0;
    Ok(Made {
        drawing: draw(context.display(), &result.rows, WINDOW),
        table: output::table(&result.rows)?,
        picture: None,
        checks: vec![
            Check::near("samples", if flux > 0.0 { n as f64 } else { 0.0 }, result.rows.len() as f64, 0.0),
            Check::near("densities unlike pdf(direction)", 0.0, result.pdf_mismatches as f64, 0.0),
            Check::near("flux estimated from the samples", flux, result.flux_estimate, 1e-6 * flux),
        ],
    })
}

fn proposal_figure(context: &Context) -> Result<Made> {
    let Some(result) = proposal::compare(&context.source.map, 100_000, context.seed)? else {
        return Ok(Made {
            drawing: proposal_view::nothing_to_test(),
            table: output::table::<proposal::Bin>(&[])?,
            picture: None,
            checks: vec![Check::near("the map has light in rows enough for a test", 1.0, 0.0, 0.0)],
        });
    };
    Ok(Made {
        drawing: proposal_view::drawing(&result),
        table: output::table(&result.bins)?,
        picture: None,
        checks: vec![
            // Rejected at the level of 0.1 % at either end: a fit that is too good is suspicious, too.
            Check::near("p-value with uniform numbers", 0.5, result.uniform.p, 0.499),
            Check::at_most("p-value with Gaussian numbers", result.gaussian.p, 1e-6),
        ],
    })
}

fn cut(context: &Context, n: usize, draw: impl Fn(&Display, &[median_cut::Row]) -> Drawing) -> Result<Made> {
    let map = &context.source.map;
    let rows = median_cut::cut(map, &[n], Split::Energy, SideRule::default(), Centroid::Energy)?.remove(0);
    Ok(Made {
        drawing: draw(context.display(), &rows),
        table: output::table(&rows)?,
        picture: None,
        checks: vec![
            Check::near("regions", n as f64, rows.len() as f64, 0.0),
            Check::at_most(
                "flux of the regions off the map's",
                median_cut::flux_error(&rows, context.info.flux_rgb),
                1e-9,
            ),
        ],
    })
}

fn sphere(context: &Context, spp: u32) -> Result<Made> {
    let shot = context.shot(Size::Full, 0, spp)?;
    let pbrt = sphere_view::PBRT.iter().find(|(n, _)| *n == spp).map_or(f64::NAN, |(_, e)| *e);
    Ok(Made {
        drawing: sphere_view::shot(&shot)?,
        table: output::table(&[shot.row])?,
        picture: Some(Picture { image: shot.rendered.image.clone(), tone: ToneMap::LinearMax }),
        checks: vec![
            Check::at_most("relative RMSE, at most half of PBRT-v2's on Grace", shot.row.rel_rmse, pbrt / 2.0),
            Check::near("relative bias", 0.0, shot.row.rel_bias, 2e-3),
            Check::near("dropped samples", 0.0, shot.rendered.dropped.total() as f64, 0.0),
        ],
    })
}

fn sphere_error(context: &Context) -> Result<Made> {
    #[derive(Default, serde::Serialize)]
    struct Line {
        strategy: &'static str,
        spp: u32,
        light_samples: u32,
        seconds: f64,
        rel_rmse: f64,
        rmse_of_ratio: f64,
        rel_bias: f64,
    }
    let mut series = Vec::new();
    let mut lines = Vec::new();
    for (i, (label, ..)) in STRATEGIES.iter().enumerate() {
        let rows =
            SPP.iter().map(|&spp| Ok(context.shot(Size::Measuring, i, spp)?.row)).collect::<Result<Vec<Row>>>()?;
        lines.extend(rows.iter().map(|r| Line {
            strategy: label,
            spp: r.spp,
            light_samples: r.light_samples,
            seconds: r.seconds,
            rel_rmse: r.rel_rmse,
            rmse_of_ratio: r.rmse_of_ratio,
            rel_bias: r.rel_bias,
        }));
        series.push(sphere_view::Series { label, rows });
    }
    let grace = context.info.is_grace();
    let mut checks: Vec<Check> = series
        .iter()
        .map(|s| {
            let (first, last) = (&s.rows[0], &s.rows[s.rows.len() - 1]);
            let slope = (last.rel_rmse / first.rel_rmse).ln() / (f64::from(last.spp) / f64::from(first.spp)).ln();
            // Independent numbers have −1/2; scrambled Sobol' numbers may reach −3/2.
            Check::near(format!("slope of the error, {}", s.label), -0.95, slope, 0.55)
        })
        .collect();
    if grace {
        checks.extend(grace_checks(context));
    }
    Ok(Made { drawing: sphere_view::errors(&series, grace), table: output::table(&lines)?, picture: None, checks })
}

/// Radiance of the report's sphere under the Grace map at six normals, confirmed by a real PBRT render.
fn grace_checks(context: &Context) -> Vec<Check> {
    const S: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const KNOWN: [([f64; 3], [f64; 3]); 6] = [
        ([0.0, S, S], [0.33820, 0.19120, 0.26335]),
        ([0.0, -S, S], [0.16658, 0.04898, 0.01052]),
        ([S, 0.0, S], [0.36022, 0.16219, 0.17004]),
        ([-S, 0.0, S], [0.12029, 0.04990, 0.04182]),
        ([0.0, 1.0, 0.0], [0.26653, 0.20347, 0.32621]),
        ([0.0, 0.0, 1.0], [0.28311, 0.10953, 0.08941]),
    ];
    let tree = IrradianceTree::new(&context.source.map);
    let scale = f64::from(crate::scene::builtin::SPHERE_ENV_SCALE) / std::f64::consts::PI;
    let mut checks = Vec::new();
    for (n, expected) in KNOWN {
        let got = tree.irradiance(DVec3::from_array(n)).value * scale;
        for (c, channel) in ["R", "G", "B"].into_iter().enumerate() {
            let name = format!("PBRT's Grace sphere at n = ({:.3} {:.3} {:.3}), {channel}", n[0], n[1], n[2]);
            checks.push(Check::near(name, expected[c], got[c], 0.01 * expected[c]));
        }
    }
    checks
}
