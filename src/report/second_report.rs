//! The second report's figures: how each is made and what it must meet.

use super::check::Check;
use super::context::{Context, GOLD, IRON};
use super::depth as depth_view;
use super::entries::entry;
use super::registry::{Entry, Made, Picture};
use super::{metals as metals_view, output, statue as statue_view};
use crate::error::Result;
use crate::optics::metals::Metal;
use crate::raster::{Image, ToneMap};
use crate::render::{Silent, render};
use crate::scene::{Material, Request, builtin};
use crate::study::depth::{self, ALL, DEPTHS, Depths};
use crate::study::metals;
use crate::study::object_ids::{Kind, Mean, ObjectIdBuffer};
use crate::study::roughness::{self, Shot};
use crate::study::sampling_strategies::RIM;

/// Angles of a curve of the metals' table.
const POINTS: usize = 181;
/// Standard errors that two means may differ by.
const SIGMAS: f64 = 4.0;
/// Widths of the lobe in the report's roughness series.
const ALPHAS: [(&str, f32, &str, &str); 4] = [
    (
        "roughness-0.005",
        0.005,
        "roughness-0.05",
        "etalon render cornell-statue-au --alpha 0.005 -s 128 -l 1 -m 5 --tone report",
    ),
    (
        "roughness-0.05",
        0.05,
        "roughness-0.005",
        "etalon render cornell-statue-au --alpha 0.05 -s 128 -l 1 -m 5 --tone report",
    ),
    (
        "roughness-0.25",
        0.25,
        "roughness-0.05",
        "etalon render cornell-statue-au --alpha 0.25 -s 128 -l 1 -m 5 --tone report",
    ),
    (
        "roughness-0.5",
        0.5,
        "roughness-0.25",
        "etalon render cornell-statue-au --alpha 0.5 -s 128 -l 1 -m 5 --tone report",
    ),
];
/// What appears at each depth of the report.
const SEEN_AT_DEPTH: [&str; 7] = [
    "Only the lamp itself is seen.",
    "Light straight from the lamp: lit walls, and the lamp in both balls. The ceiling is dark.",
    "Light over a second surface: the ceiling, and the lit walls in the mirror ball. Glass is dark, because light has to get \
     in and out again.",
    "Two scatterings pass the glass ball: walls are seen through it, and it focuses light on the floor below.",
    "The glass ball, as clear as before, is seen in the mirror ball.",
    "What is left to come is faint: light that glass and mirror pass on once more.",
    "As good as all light. Compare it with depth 5 to see how little was missing.",
];

pub(super) fn all() -> Vec<Entry> {
    let mut list = Vec::new();
    for (place, (id, beside, command)) in [
        ("depth-0", "depth-1", "etalon render cornell-spheres -s 64 -l 4 -m 0 --tone report"),
        ("depth-1", "depth-0", "etalon render cornell-spheres -s 64 -l 4 -m 1 --tone report"),
        ("depth-2", "depth-1", "etalon render cornell-spheres -s 64 -l 4 -m 2 --tone report"),
        ("depth-3", "depth-2", "etalon render cornell-spheres -s 64 -l 4 -m 3 --tone report"),
        ("depth-4", "depth-3", "etalon render cornell-spheres -s 64 -l 4 -m 4 --tone report"),
        ("depth-5", "depth-4", "etalon render cornell-spheres -s 64 -l 4 -m 5 --tone report"),
        ("depth-100", "depth-5", "etalon render cornell-spheres -s 64 -l 4 -m 100 --tone report"),
    ]
    .into_iter()
    .enumerate()
    {
        list.push(
            entry(id, "Mirror and glass ball, light followed to a depth", "second report: max_ray_depth", {
                move |c| picture_of_depth(c, place)
            })
            .shows(SEEN_AT_DEPTH[place])
            .beside(beside)
            .command(command),
        );
    }
    list.push(
        entry(
            "depth-differences",
            "What each further scattering adds, by path class",
            "second report: what appears at each depth",
            differences,
        )
        .shows("Each depth less the one before, on one scale, with the classes of paths that make the difference."),
    );
    for (i, (id, alpha, beside, command)) in ALPHAS.into_iter().enumerate() {
        list.push(
            entry(id, "Golden statue of growing roughness", "second report: microfacet alpha", move |c| {
                roughness(c, alpha, i.checked_sub(1).map(|before| ALPHAS[before].1))
            })
            .shows("The wider the facets are spread, the wider and dimmer are the gleams.")
            .beside(beside)
            .command(command),
        );
    }
    list.push(
        entry(
            "sampling-importance",
            "Copper statue, directions drawn as it reflects",
            "second report: importance sampling",
            |c| sampling(c, true),
        )
        .shows("Directions in proportion to what the metal reflects: little noise at few samples.")
        .beside("sampling-hemisphere")
        .command("etalon render cornell-statue-cu -s 64 -l 1 -m 5 --tone report"),
    );
    list.push(
        entry(
            "sampling-hemisphere",
            "Copper statue, directions spread evenly",
            "second report: hemisphere sampling",
            |c| sampling(c, false),
        )
        .shows("The same samples spread evenly: most miss what the metal reflects, so that it looks dark and noisy.")
        .beside("sampling-importance")
        .command("etalon render cornell-statue-cu -s 64 -l 1 -m 5 --normals hemisphere --tone report"),
    );
    list.push(
        entry(
            "sampling-error",
            "Noise by both, and what they show from the silhouette inwards",
            "second report: the dark rim of hemisphere sampling",
            sampling_error,
        )
        .shows(
            "Both ways give the same light on average; spread evenly, its median is far below its mean, and the eye sees a \
             dark rim.",
        ),
    );
    list.push(
        entry("iron", "Iron statue", "second report: another material", |c| {
            let shot = c.statue_shot(IRON, 0.5)?;
            let mut made = statue(c, &shot, IRON, 0.5)?;
            // Grey: no channel is off their mean by more than a fifth.
            let off = shot.statue.value.map(|v| (v / shot.statue.intensity() - 1.0).abs());
            made.checks.push(Check::at_most("colour of the statue off grey", off.into_iter().fold(0.0, f64::max), 0.2));
            Ok(made)
        })
        .shows("The same statue in iron: all colours are reflected nearly alike.")
        .beside("roughness-0.5")
        .command("etalon render cornell-statue-fe -s 128 -l 1 -m 5 --tone report"),
    );
    list.push(
        entry(
            "metals-table",
            "Five metals: indices, special angles, albedo, error of the approximation",
            "second report: eta and k of metals",
            |_| metals_table(),
        )
        .shows(
            "Reflectance of each metal in red, green and blue over the angle, exact and by the report's formula. η and k: \
             Johnson & Christy 1972 (Ag, Au, Cu), Rakic 1995 (Al), Table 1 of the report (Fe).",
        ),
    );
    list
}

fn picture(image: &Image) -> Option<Picture> {
    Some(Picture { image: image.clone(), tone: ToneMap::Report })
}

fn picture_of_depth(context: &Context, place: usize) -> Result<Made> {
    let result = context.depths()?;
    let m = DEPTHS[place];
    let rows: Vec<depth::Row> = result.rows.iter().filter(|r| r.depth == m).cloned().collect();
    let mut checks = vec![Check::near("dropped samples", 0.0, result.dropped.total() as f64, 0.0)];
    let (scene, request) = context.spheres();
    if let Some(before) = place.checked_sub(1).map(|p| DEPTHS[p]) {
        let name = format!("light at depth {before} over that at depth {m}");
        checks.push(Check::at_most(name, result.mean(before) / result.mean(m), 1.0));
    }
    if m == 0 {
        let lamp = depth::seen_lamps(&scene);
        checks.push(Check::near("mean radiance: the lamp's projected area", lamp, result.mean(0), 5e-3 * lamp));
    }
    if m <= 5 {
        let request = Request { width: 120, height: 90, spp: 4, ..request };
        let t = depth::truncation(&scene, &request, &context.settings(), m)?;
        checks.push(Check::near(
            format!("light of more than {m} scatterings in a render to depth {m}"),
            0.0,
            t.beyond,
            0.0,
        ));
        checks.push(Check::at_most(
            "that render less these classes of a deeper one, at most",
            t.largest_difference,
            1e-4,
        ));
    }
    checks.extend(evidence(&result, m));
    if m == 100 {
        let share = 1.0 - result.mean(5) / result.mean(100);
        checks.push(Check::near("share of the light that was scattered more than 5 times", 0.03, share, 0.02));
        checks.extend(furnace(context)?);
    }
    let (drawing, image) = (depth_view::picture(&result, place), &result.pictures[place]);
    Ok(Made { drawing, table: output::table(&rows)?, picture: picture(image), checks })
}

/// What the report sees appear at each depth, by path class and by the share of an object's pixels that it lights.
fn evidence(result: &Depths, depth: u32) -> Vec<Check> {
    let lit = |name: &str, class: &str, on: &str, expected: f64, tolerance: f64| {
        let got = result.class(class, on).map_or(0.0, |r| r.lit_pixels);
        Check::near(format!("{name} ({class}), share of its pixels"), expected, got, tolerance)
    };
    match depth {
        // The ceiling gets no light directly.
        1 => vec![
            lit("lit walls", "LDE", "room", 0.83, 0.03),
            lit("the lamp in the mirror ball", "LSE", "mirror", 0.028, 0.01),
            lit("the lamp on the glass ball", "LSE", "glass", 0.022, 0.01),
        ],
        2 => vec![lit("lit walls in the mirror ball", "LDSE", "mirror", 0.67, 0.03)],
        3 => {
            let (width, height) = (result.request.width as f64, result.request.height as f64);
            let [x, y] = result.class("LSSDE", "room").map_or([f64::NAN; 2], |r| [r.centroid_x, r.centroid_y]);
            vec![
                lit("lit walls through the glass ball", "LDSSE", "glass", 1.0, 0.05),
                Check::near(
                    "light focused by glass (LSSDE) is below the ball: across the picture",
                    0.70,
                    x / width,
                    0.02,
                ),
                Check::near("and down the picture", 0.91, y / height, 0.02),
            ]
        }
        4 => vec![lit("the glass ball in the mirror ball", "LDSSSE", "mirror", 0.035, 0.015)],
        _ => Vec::new(),
    }
}

/// A white furnace through the same renderer: three balls that must vanish before light from everywhere.
fn furnace(context: &Context) -> Result<Vec<Check>> {
    let (mut scene, request) = builtin::furnace();
    // A mirror shows its neighbours, and one of them loses light.
    scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
    let rendered = render(&scene, &Request { spp: 32, ..request }, &context.settings(), &Silent)?;
    let objects = ObjectIdBuffer::new(&scene, &request);
    let checks = [(Kind::Room, "diffuse"), (Kind::Mirror, "mirror"), (Kind::Glass, "glass")].map(|(kind, name)| {
        let mean = Mean::of(&rendered.part.film, &objects.mask(kind));
        let error = mean.error.into_iter().fold(0.0, f64::max);
        // Samples that are all 1 are 1 to the last bits of f32.
        Check::near(format!("white furnace, {name} ball"), 1.0, mean.intensity(), SIGMAS * error + 1e-5)
    });
    Ok(checks.into())
}

fn differences(context: &Context) -> Result<Made> {
    let result = context.depths()?;
    let sum = |of: &dyn Fn(&depth::ClassRow) -> bool| -> f64 {
        result.classes.iter().filter(|r| r.seen_on == ALL && of(r)).map(|r| r.share_of_light).sum()
    };
    let mut checks = vec![Check::near("shares of all classes", 1.0, sum(&|_| true), 1e-6)];
    for pair in DEPTHS.windows(2) {
        let added = (result.mean(pair[1]) - result.mean(pair[0])) / result.mean(100);
        let name = format!("classes of depth {} make up its difference to depth {}", pair[1], pair[0]);
        checks.push(Check::near(name, added, sum(&|r| r.depth == pair[1]), 1e-6));
    }
    let drawing = depth_view::differences(&result);
    Ok(Made { drawing, table: output::table(&result.classes)?, picture: None, checks })
}

fn roughness(context: &Context, alpha: f32, smoother: Option<f32>) -> Result<Made> {
    let shot = context.statue_shot(GOLD, alpha)?;
    let mut made = statue(context, &shot, GOLD, alpha)?;
    if let Some(smoother) = smoother {
        let before = context.statue_shot(GOLD, smoother)?;
        let ratio = shot.row.brightest_percent / before.row.brightest_percent;
        let name = format!("gleam of the brightest hundredth, over that at alpha {smoother}");
        made.checks.push(Check::at_most(name, ratio, 1.0));
    }
    Ok(made)
}

fn statue(context: &Context, shot: &Shot, metal: &'static Metal, alpha: f32) -> Result<Made> {
    let (scene, request) = context.statue(metal, alpha)?;
    let other = roughness::second_opinion(&scene, &request, &context.settings(), &shot.mask)?;
    Ok(Made {
        drawing: statue_view::picture(shot, metal.name),
        table: output::table(std::slice::from_ref(&shot.row))?,
        picture: picture(&shot.rendered.image),
        checks: vec![
            Check::near("dropped samples", 0.0, shot.rendered.dropped.total() as f64, 0.0),
            Check::near(
                "statue against facets drawn as they lie (standard errors)",
                0.0,
                shot.statue.z(&other),
                SIGMAS,
            ),
        ],
    })
}

fn sampling(context: &Context, importance: bool) -> Result<Made> {
    let result = context.comparison()?;
    let (shot, how) = if importance {
        (&result.importance, "directions drawn as the metal reflects")
    } else {
        (&result.hemisphere, "directions spread evenly over the hemisphere")
    };
    Ok(Made {
        drawing: statue_view::strategy(shot, how),
        table: output::table(std::slice::from_ref(&shot.row))?,
        picture: picture(&shot.rendered.image),
        checks: vec![
            Check::near("dropped samples", 0.0, shot.rendered.dropped.total() as f64, 0.0),
            Check::near("mean against the other picture's (standard errors)", 0.0, result.z_picture, SIGMAS),
            Check::near("statue against the other picture's (standard errors)", 0.0, result.z_statue, SIGMAS),
        ],
    })
}

fn sampling_error(context: &Context) -> Result<Made> {
    let result = context.comparison()?;
    let rim = result.profile.iter().filter(|b| b.from_px >= 0.0 && b.to_px <= RIM);
    let (importance, hemisphere) = rim.fold((0.0, 0.0), |(i, h), b| (i + b.importance_median, h + b.hemisphere_median));
    let noise = result.importance.row.noise / result.hemisphere.row.noise;
    let mut checks = vec![
        Check::near("light of the rim by one against the other (standard errors)", 0.0, result.z_rim, SIGMAS),
        Check::at_most("median of the rim, hemisphere over importance: it looks dark", hemisphere / importance, 0.5),
    ];
    // The files' lamp is a light without a surface: only light samples find it, and highlights are as noisy in both.
    if !context.has_originals() {
        checks.push(Check::at_most("noise on the statue, importance over hemisphere", noise, 0.25));
    }
    Ok(Made { drawing: statue_view::errors(&result)?, table: output::table(&result.profile)?, picture: None, checks })
}

fn metals_table() -> Result<Made> {
    let (rows, curves) = metals::table(POINTS)?;
    let worst = |f: &dyn Fn(&metals::Row) -> f64| rows.iter().map(f).fold(0.0, f64::max);
    let normal = |r: &metals::Row| {
        let (minus, plus) = ((r.eta - 1.0).powi(2) + r.k * r.k, (r.eta + 1.0).powi(2) + r.k * r.k);
        (curves.iter().flat_map(|c| &c.channels).find(|c| c.eta == r.eta).map_or(f64::NAN, |c| c.rows[0].r_unpolarized)
            - minus / plus)
            .abs()
    };
    let closed = |r: &metals::Row| (r.albedo_approximate - metals::approximate_albedo(r.eta, r.k)).abs();
    let checks = vec![
        Check::near("metals in three channels", 15.0, rows.len() as f64, 0.0),
        Check::at_most("reflectance at 0° off ((η−1)²+k²)/((η+1)²+k²)", worst(&normal), 1e-14),
        Check::at_most("albedo of the approximation off its closed form", worst(&closed), 1e-9),
        Check::at_most("largest error of the approximation", worst(&|r| r.approximate_max_abs_error), 8e-3),
        Check::at_most("largest error of its albedo", worst(&|r| (r.albedo_approximate / r.albedo - 1.0).abs()), 6e-3),
    ];
    Ok(Made { drawing: metals_view::drawing(&curves), table: output::table(&rows)?, picture: None, checks })
}
