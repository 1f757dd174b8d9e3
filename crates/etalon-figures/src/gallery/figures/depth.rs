//! Mirror and glass sphere at increasing path depth: `depth-0` … `depth-5`, `depth-100`, and `depth-differences`. Spheres that absorb
//! nothing must have radiance 1 in an environment of radiance 1, a white furnace.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::depth::{self, DEPTHS, Depths, RadianceRow};
use etalon_bench::metal::worst;
use etalon_bench::object_ids::{Kind, ObjectIdBuffer};
use etalon_bench::pixel_mean::Mean;
use etalon_core::error::Result;
use etalon_core::raster::ToneMap;
use etalon_core::scene::{Material, Request, builtin};
use etalon_render::{Sampling, Settings, Silent, render};

/// One render, taken apart by path class.
pub fn series(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Depths>> {
    let (scene, request) = inputs.spheres();
    let settings = Settings { sampling: Sampling::Mis, ..inputs.settings() };
    studies.get("depths", || depth::depths(&scene, &request, &settings))
}

/// One figure for each of [`DEPTHS`], in that order, and one of what each adds.
pub fn figures() -> Vec<Figure> {
    let texts = [
        (
            "depth-0",
            "Mirror and glass sphere, maximum depth 0",
            "Figure 1a, maximum depth 0 (CBspheres.dae, -t 8 -s 64 -l 4 -m 0 -r 480 360)",
            "Only the area light itself is visible.",
            "An emitter that is seen directly needs no path at all: whatever else is bright here would be an error.",
        ),
        (
            "depth-1",
            "Mirror and glass sphere, maximum depth 1",
            "Figure 1b, maximum depth 1 (CBspheres.dae, -t 8 -s 64 -l 4 -m 1 -r 480 360)",
            "Direct light: lit walls, and the area light reflected by both spheres. The ceiling is dark.",
            "Direct light is what a renderer without global illumination shows, and the part that light samples find best.",
        ),
        (
            "depth-2",
            "Mirror and glass sphere, maximum depth 2",
            "Figure 1c, maximum depth 2 (CBspheres.dae, -t 8 -s 64 -l 4 -m 2 -r 480 360)",
            "Light after two scatterings: the ceiling, and the lit walls in the mirror sphere. The glass sphere is dark, because \
             light must enter and leave it.",
            "Indirect light takes the black from the ceiling: after direct light, no other scattering adds as much.",
        ),
        (
            "depth-3",
            "Mirror and glass sphere, maximum depth 3",
            "Figure 1d, maximum depth 3 (CBspheres.dae, -t 8 -s 64 -l 4 -m 3 -r 480 360)",
            "Two refractions pass the glass sphere: walls are visible through it, and it makes a caustic on the floor below.",
            "Paths through glass are found by chance alone when light samples cannot pass it: this is where a path tracer becomes noisy.",
        ),
        (
            "depth-4",
            "Mirror and glass sphere, maximum depth 4",
            "Figure 1e, maximum depth 4 (CBspheres.dae, -t 8 -s 64 -l 4 -m 4 -r 480 360)",
            "The glass sphere, as clear as before, appears in the mirror sphere.",
            "Each mirror or boundary in front of a phenomenon costs one scattering more, so that depth limits what mirrors can show.",
        ),
        (
            "depth-5",
            "Mirror and glass sphere, maximum depth 5",
            "Figure 1f, maximum depth 5 (CBspheres.dae, -t 8 -s 64 -l 4 -m 5 -r 480 360)",
            "The light that this depth adds is faint.",
            "The light that a depth adds falls off like the product of the reflectances: a limit here saves time and costs little.",
        ),
        (
            "depth-100",
            "Mirror and glass sphere, maximum depth 100",
            "Figure 1g, maximum depth 100 (CBspheres.dae, -t 8 -s 64 -l 4 -m 100 -r 480 360)",
            "Practically all light. Compare it with depth 5 to see how little was missing.",
            "A limit that no path reaches leaves no bias; Russian roulette ends paths at no such cost.",
        ),
    ];
    let figure = |(place, (id, title, reproduces, shows, matters)): (usize, (&'static str, _, _, _, _))| Figure {
        id,
        title,
        report: Report::Second,
        reproduces,
        shows,
        matters,
        papers: &[papers::HECKBERT, papers::KAJIYA],
        // Beside the depth before, the first beside the second.
        beside: Some(if place == 0 { texts[1].0 } else { texts[place - 1].0 }),
        command: Some(format!("etalon render cornell-spheres -s 64 -l 4 -m {} --tone report --uniform", DEPTHS[place])),
        ..Figure::by(move |inputs, studies| content(inputs, studies, place))
    };
    let differences = Figure {
        id: "depth-differences",
        title: "What each further scattering adds, by path class",
        report: Report::Second,
        reproduces: "Figure 1, what appears at each depth (CBspheres.dae, -t 8 -s 64 -l 4 -r 480 360)",
        shows: "Each depth minus the one before, with the path classes that make up the difference, in Heckbert's notation: L is \
                the light, D a diffuse reflection, S a mirror or glass, E the eye. Each is the sum of its path classes in one render, so that \
                the same paths make all differences; each has an exposure of its own, at which 98 % of its pixels are below white. No pixel is shown brighter than the third brightest \
                of its 3×3 block, because caustics seen in the spheres are found by chance and leave specks of one or two pixels.",
        matters: "Path classes say which phenomenon needs which depth: a caustic needs three scatterings, a caustic seen in a mirror one more.",
        papers: &[papers::HECKBERT],
        ..Figure::by(differences)
    };
    texts.into_iter().enumerate().map(figure).chain([differences]).collect()
}

fn content(inputs: &Inputs, studies: &mut Studies, place: usize) -> Result<Content> {
    let result = series(inputs, studies)?;
    let m = DEPTHS[place];
    let (scene, request) = inputs.spheres();
    let mut checks = vec![Check::equal("dropped samples", 0.0, result.dropped.total() as f64)];
    if let Some(before) = place.checked_sub(1).map(|p| DEPTHS[p]) {
        let name = format!("light at depth {before} over that at depth {m}");
        checks.push(Check::at_most(name, result.mean(before) / result.mean(m), 1.0));
    }
    if m == 0 {
        let light = depth::visible_area_lights(&scene);
        let name = "mean radiance (projected area of the area light)";
        checks.push(Check::within(name, light, result.mean(0), 5e-3 * light));
    }
    if m <= 5 {
        let request = Request { width: 120, height: 90, spp: 4, ..request };
        let truncated = depth::truncation(&scene, &request, &inputs.settings(), m)?;
        let name = format!("light of more than {m} scatterings in a render to depth {m}");
        checks.push(Check::equal(name, 0.0, truncated.beyond));
        let name = "largest difference of that render from the same path classes of a deeper one";
        checks.push(Check::at_most(name, truncated.largest_difference, 1e-4));
    }
    if m == 3 {
        let through = result.class("LDSSE", "glass").map_or(0.0, |class| class.lit_pixels);
        let name = "lit walls through the glass sphere (LDSSE), share of its pixels";
        checks.push(Check::at_least(name, through, 0.95));
    }
    if m == 100 {
        checks.extend(furnace(32, &inputs.settings())?.iter().map(white));
    }
    let image = &result.images[place];
    let rows: Vec<RadianceRow> = result.rows.iter().filter(|r| r.depth == m).cloned().collect();
    Ok(Content::new(view::image(image), &rows, checks)?.with_image(image, ToneMap::SecondReport))
}

fn differences(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    // Light paths find the caustics that paths from the eye meet by chance, as fireflies. A quarter of the pixels and four times
    // the samples of the series.
    let (scene, request) = inputs.spheres();
    let request = Request { width: request.width / 2, height: request.height / 2, spp: 4 * request.spp, ..request };
    let settings = Settings { sampling: Sampling::MisLt, ..inputs.settings() };
    let result = depth::depths(&scene, &request, &settings)?;
    let mut checks = vec![Check::within("total share of all path classes", 1.0, result.share(|_| true), 1e-6)];
    for pair in DEPTHS.windows(2) {
        let added = (result.mean(pair[1]) - result.mean(pair[0])) / result.mean(100);
        let name = format!("share of the classes of depth {} (the difference from depth {})", pair[1], pair[0]);
        checks.push(Check::within(name, added, result.share(|r| r.depth == pair[1]), 1e-6));
    }
    // Against the series, which has no light paths
    let series = series(inputs, studies)?;
    let [[mean, error], [of_series, error_of_series]] = [&result, &*series].map(Depths::mean_with_error);
    let z = (mean - of_series) / error.hypot(error_of_series);
    checks.push(Check::within("all light, minus that of depth-100 without light paths (standard errors)", 0.0, z, 4.0));
    let apart = |depth: &u32| {
        let [mine, theirs] = [&result, &*series].map(|depths| depths.share(|r| r.depth == *depth));
        (mine - theirs).abs()
    };
    let name = "largest difference of the share of a depth from that without light paths";
    checks.push(Check::at_most(name, worst(DEPTHS.iter().map(apart)), 0.01));
    Content::new(view::differences(&result), &result.classes, checks)
}

fn white(sphere: &FurnaceSphere) -> Check {
    let error = sphere.radiance.error.into_iter().fold(0.0, f64::max);
    // Samples that are all 1 are 1 to the last bits of f32.
    let tolerance = 4.0 * error + 1e-5;
    Check::within(format!("white furnace, {} sphere", sphere.material), 1.0, sphere.radiance.mean_rgb(), tolerance)
}

/// The mean radiance of one sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FurnaceSphere {
    pub material: &'static str,
    /// Over the pixels whose centre shows it.
    pub radiance: Mean,
}

/// Renders a diffuse, a mirror and a glass sphere at `spp` samples per pixel.
pub fn furnace(spp: u32, settings: &Settings) -> Result<[FurnaceSphere; 3]> {
    let (mut scene, request) = builtin::furnace();
    // Without the metal of the built-in scene, which absorbs and is reflected in the mirror.
    scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
    let rendered = render(&scene, &Request { spp, ..request }, settings, &Silent)?;
    let objects = ObjectIdBuffer::new(&scene, &request);
    let spheres = [(Kind::Diffuse, "diffuse"), (Kind::Mirror, "mirror"), (Kind::Glass, "glass")];
    Ok(spheres.map(|(kind, material)| FurnaceSphere {
        material,
        radiance: Mean::of(&rendered.part.film, &objects.mask(kind)),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sphere_gains_or_loses_light() {
        for sphere in furnace(4, &Settings::default()).unwrap() {
            let Mean { error, pixels, .. } = sphere.radiance;
            let error = error.into_iter().fold(0.0, f64::max);
            assert!(pixels > 100 && (sphere.radiance.mean_rgb() - 1.0).abs() < 4.0 * error + 1e-5, "{sphere:?}");
        }
    }
}
