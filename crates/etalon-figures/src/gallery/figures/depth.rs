//! Mirror and glass sphere at increasing path depth: `depth-0` … `depth-5`, `depth-100`, and `depth-differences`. Spheres that absorb
//! nothing must have radiance 1 in an environment of radiance 1, a white furnace.

use crate::gallery::prelude::*;
use crate::view::depth as view;
use etalon_bench::depth::{self, DEPTHS, Depths, RadianceRow};
use etalon_bench::metal::worst;
use etalon_bench::object_ids::{Kind, ObjectIdBuffer, PixelMean};
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

pub fn figures() -> Vec<Maker> {
    let depth = |(place, depth): (usize, &u32)| {
        maker(format!("depth-{depth}"), move |inputs, studies| content(inputs, studies, place))
    };
    DEPTHS.iter().enumerate().map(depth).chain([maker("depth-differences", differences)]).collect()
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
