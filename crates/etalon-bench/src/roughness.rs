//! A metal statue in a Cornell box: its mean radiance, the share of its highlights, and the noise of the image.

use crate::object_ids::{Kind, ObjectIdBuffer, PixelMean, inside};
use etalon_core::bsdf::NormalSampling;
use etalon_core::error::Result;
use etalon_core::raster::Image;
use etalon_core::scene::{Conductor, Material, Request, Scene};
use etalon_render::film::PixelEstimate;
use etalon_render::{Dropped, Settings, Silent, render};
use serde::Serialize;

/// One image of a statue. Field names are the CSV columns; radiance of the pixels whose centre shows the statue, with
/// the standard error of the mean.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct StatueRow {
    /// Roughness α.
    pub alpha: f32,
    pub spp: u32,
    /// Light samples per camera sample.
    pub light_samples: u32,
    pub max_depth: u32,
    pub statue_pixels: usize,
    pub statue_r: f64,
    pub statue_g: f64,
    pub statue_b: f64,
    /// Standard error, red.
    pub statue_error_r: f64,
    pub statue_error_g: f64,
    pub statue_error_b: f64,
    /// Root mean square of the standard errors of the statue's pixels, each a mean over the channels.
    pub noise: f64,
    /// Share of the statue's light that comes from the brightest hundredth of its pixels.
    pub brightest_percent: f64,
}

pub struct StatueRender {
    pub row: StatueRow,
    pub statue: PixelMean,
    pub mask: Vec<bool>,
    pub objects: ObjectIdBuffer,
    pub image: Image,
    /// That of every pixel of the image.
    pub standard_error: Image,
    pub dropped: Dropped,
}

impl StatueRender {
    /// The mean and its standard error of every pixel, row by row from the top.
    pub fn estimates(&self) -> impl Iterator<Item = PixelEstimate> {
        let pixels = self.image.pixels().iter().zip(self.standard_error.pixels());
        pixels.map(|(&mean, &error)| PixelEstimate { mean, error })
    }
}

pub fn render_statue(scene: &Scene, request: &Request, settings: &Settings) -> Result<StatueRender> {
    let rendered = render(scene, request, settings, &Silent)?;
    let objects = ObjectIdBuffer::new(scene, request);
    let mask = objects.mask(Kind::Metal);
    let statue = PixelMean::of(rendered.part.film.estimates(), &mask);
    let [statue_r, statue_g, statue_b] = statue.value;
    let [statue_error_r, statue_error_g, statue_error_b] = statue.error;
    let squares =
        inside(rendered.part.film.estimates(), &mask).map(|e| (f64::from(e.error.element_sum()) / 3.0).powi(2));
    let noise = (squares.sum::<f64>() / statue.pixels as f64).sqrt();
    let light = inside(rendered.image.pixels(), &mask).map(|p| f64::from(p.element_sum()));
    let row = StatueRow {
        alpha: conductor(scene).map_or(f32::NAN, |c| c.alpha[0]),
        spp: request.spp,
        light_samples: request.light_samples,
        max_depth: request.max_depth,
        statue_pixels: statue.pixels,
        statue_r,
        statue_g,
        statue_b,
        statue_error_r,
        statue_error_g,
        statue_error_b,
        noise,
        brightest_percent: brightest_percent(light.collect()),
    };
    let standard_error = rendered.part.film.standard_error();
    Ok(StatueRender { row, statue, mask, objects, image: rendered.image, standard_error, dropped: rendered.dropped })
}

/// The statue's mean radiance with normals sampled from the full distribution, with a sixteenth of the samples and other random
/// numbers: independent of the image that it is compared with.
pub fn mean_by_all_normals(scene: &Scene, request: &Request, settings: &Settings, mask: &[bool]) -> Result<PixelMean> {
    let request = Request { spp: (request.spp / 16).max(2), ..*request };
    let mut settings = Settings { seed: settings.seed.wrapping_add(1), ..*settings };
    settings.model.normals = NormalSampling::Ndf;
    Ok(PixelMean::of(render(scene, &request, &settings, &Silent)?.part.film.estimates(), mask))
}

/// The first metal of a scene.
pub fn conductor(scene: &Scene) -> Option<&Conductor> {
    scene.objects.iter().find_map(|o| if let Material::Conductor(c) = &o.material { Some(c) } else { None })
}

/// Share of the largest hundredth of the values (at least one) in the sum of all.
pub fn brightest_percent(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    let count = values.len().div_ceil(100);
    values[..count].iter().sum::<f64>() / values.iter().sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::optics::metals;
    use etalon_core::scene::builtin;

    #[test]
    fn one_percent_of_uniform_light_is_one_percent() {
        assert!((brightest_percent(vec![2.0; 300]) - 0.01).abs() < 1e-12);
        assert_eq!(brightest_percent([vec![0.0; 99], vec![7.0]].concat()), 1.0);
    }

    #[test]
    fn all_normals_agree_and_another_metal_does_not() {
        let statue = |symbol: &str| {
            let (scene, request) = builtin::cornell_statue(metals::by_name(symbol).unwrap(), 0.25, None).unwrap();
            let request = Request { width: 48, height: 36, spp: 32, light_samples: 1, ..request };
            let shot = render_statue(&scene, &request, &Settings::default()).unwrap();
            let other = mean_by_all_normals(&scene, &request, &Settings::default(), &shot.mask).unwrap();
            (shot, other)
        };
        let ((gold, second), (iron, _)) = (statue("Au"), statue("Fe"));
        assert!(gold.statue.z(&second).abs() < 4.0, "{:?} {second:?}", gold.statue);
        assert!(gold.statue.z(&iron.statue).abs() > 4.0, "{:?} {:?}", gold.statue, iron.statue);
        assert!(gold.row.statue_r > gold.row.statue_g && gold.row.statue_g > gold.row.statue_b);
    }
}
