//! Mirror and glass sphere at increasing path depth: `depth-0` … `depth-5`, `depth-100`, and `depth-differences`. Spheres that absorb
//! nothing must have radiance 1 in an environment of radiance 1, a white furnace.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::depth::{self, DEPTHS, Depths, RadianceRow};
use etalon_bench::object_ids::{Kind, ObjectIdBuffer, PixelMean};
use etalon_core::error::{Error, Result};
use etalon_core::raster::ToneMap;
use etalon_core::scene::{Material, Request, Scene, builtin};
use etalon_render::{Sampling, Settings, Silent, render};

/// One render, decomposed by path class: a quarter of the pixels and four times the samples of the report, and light paths, which find
/// the caustics that paths from the eye meet by chance.
pub fn by_class(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<Depths>> {
    let (scene, request) = inputs.spheres();
    let request = Request { width: request.width / 2, height: request.height / 2, spp: 4 * request.spp, ..request };
    studies.get("depths", || depth::depths(&scene, &request, &with_light_paths(inputs)))
}

fn with_light_paths(inputs: &Inputs) -> Settings {
    Settings { sampling: Sampling::MisLt, ..inputs.settings() }
}

pub fn figures() -> Vec<Maker> {
    let depth = |(place, depth): (usize, &u32)| {
        maker(format!("depth-{depth}"), move |inputs, studies| content(inputs, studies, place))
    };
    DEPTHS.iter().enumerate().map(depth).chain([maker("depth-differences", differences)]).collect()
}

fn content(inputs: &Inputs, studies: &mut Studies, place: usize) -> Result<Content> {
    let m = DEPTHS[place];
    let (scene, request) = inputs.spheres();
    let result = studies.get("depth series", || depth::series(&scene, &request, &with_light_paths(inputs)))?;
    let mean = |place: usize| depth::mean(&result.images[place]);
    let mut checks = vec![Check::equal("dropped samples", 0.0, result.dropped.total() as f64)];
    if let Some(before) = place.checked_sub(1) {
        let name = format!("light at depth {} over that at depth {m}", DEPTHS[before]);
        checks.push(Check::at_most(name, mean(before) / mean(place), 1.0));
    }
    if m == 0 {
        let light = depth::visible_area_lights(&scene);
        let name = "mean radiance (projected area of the area light)";
        checks.push(Check::within(name, light, mean(0), 5e-3 * light));
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
        let through = by_class(inputs, studies)?.class("LDSSE", "glass").map_or(0.0, |class| class.lit_pixels);
        let name = "lit walls through the glass sphere (LDSSE), share of its pixels";
        checks.push(Check::at_least(name, through, 0.95));
    }
    if m == 100 {
        checks.extend(furnace(32, &inputs.settings())?.iter().map(white));
    }
    let image = &result.images[place];
    let rows: Vec<RadianceRow> = result.rows.iter().filter(|r| r.depth == m).cloned().collect();
    Ok(Content::new(view::image(&view::without_specks(image)), &rows, checks)?.with_image(image, ToneMap::SecondReport))
}

fn differences(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let result = by_class(inputs, studies)?;
    let mut checks = vec![Check::within("total share of all path classes", 1.0, result.share(|_| true), 1e-6)];
    for pair in DEPTHS.windows(2) {
        let added = (result.mean(pair[1]) - result.mean(pair[0])) / result.mean(100);
        let name = format!("share of the classes of depth {} (the difference from depth {})", pair[1], pair[0]);
        checks.push(Check::within(name, added, result.share(|r| r.depth == pair[1]), 1e-6));
    }
    let z = by_light_paths(&inputs.settings(), &inputs.spheres())?;
    checks.push(Check::within(
        "all light of a small render, minus that without light paths (standard errors)",
        0.0,
        z,
        4.0,
    ));
    Content::new(view::differences(&result), &result.classes, checks)
}

/// The mean of a small render with light paths minus that of one without, in standard errors.
fn by_light_paths(settings: &Settings, (scene, request): &(Scene, Request)) -> Result<f64> {
    let request = Request { width: 60, height: 45, spp: 256, max_depth: DEPTHS[DEPTHS.len() - 1], ..*request };
    let mean = |sampling: Sampling, seed: u64| {
        let rendered = render(scene, &request, &Settings { sampling, seed, ..*settings }, &Silent)?;
        Ok::<_, Error>(PixelMean::of(rendered.part.film.estimates(), &vec![true; request.width * request.height]))
    };
    Ok(mean(Sampling::MisLt, settings.seed)?.z(&mean(Sampling::Mis, settings.seed.wrapping_add(1))?))
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
    pub radiance: PixelMean,
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
        radiance: PixelMean::of(rendered.part.film.estimates(), &objects.mask(kind)),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sphere_gains_or_loses_light() {
        for sphere in furnace(4, &Settings::default()).unwrap() {
            let PixelMean { error, pixels, .. } = sphere.radiance;
            let error = error.into_iter().fold(0.0, f64::max);
            assert!(pixels > 100 && (sphere.radiance.mean_rgb() - 1.0).abs() < 4.0 * error + 1e-5, "{sphere:?}");
        }
    }
}
