//! Tests of sampling by radiance × cosine: the weights of samples, and MIS compensation.

use super::*;
use crate::math::Rgb;
use crate::raster::Image;

#[test]
fn sample_weights_are_the_irradiance() {
    let map = Arc::new(EnvMap::new(Image::from_fn(256, 128, |x, y| Rgb::splat(((x / 9 + y / 7) % 4) as f32 + 0.1))));
    let sampler = CosineSampler::new(map.clone());
    for n in [DVec3::Y, DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64)] {
        let expected = crate::envmap::irradiance::IrradianceTree::new(&map).irradiance(n).value.x;
        let (mut sum, mut sum2) = (0.0, 0.0);
        let count = 4096;
        for i in 0..count {
            let u = [(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * 0.618_034).fract()];
            let weight =
                sampler.sample_for(u, n).map_or(0.0, |s| f64::from(s.radiance.x) * s.wi.dot(n).max(0.0) / s.pdf);
            sum += weight;
            sum2 += weight * weight;
        }
        let (mean, mean2) = (sum / f64::from(count), sum2 / f64::from(count));
        assert!((mean / expected - 1.0).abs() < 2e-3, "{mean} against {expected}");
        // A sampler of the map alone has 1.67 for a constant map.
        assert!(mean2 / (mean * mean) - 1.0 < 0.1, "relative variance {}", mean2 / (mean * mean) - 1.0);
    }
}

#[test]
fn compensation_leaves_the_dim_part_of_a_map_to_the_bsdf() {
    let is_bright = |x: usize, y: usize| (x / 4 + y / 4).is_multiple_of(5);
    let level = |x, y| Rgb::splat(if is_bright(x, y) { 10.0 } else { 0.5 });
    let map = Arc::new(EnvMap::new(Image::from_fn(64, 32, level)));
    let (sampler, g) = (CosineSampler::compensated(map.clone()), map.geometry());
    let n = DVec3::new(0.6, 0.0, 0.8);
    for (x, y) in (0..32).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let wi = g.direction_in_texel(x, y, 0.5, 0.5);
        if wi.dot(n) > 0.1 {
            assert_eq!(sampler.pdf_for(wi, n) > 0.0, is_bright(x, y), "{x} {y}");
        }
    }
    // Light and BSDF samples combined by the balance heuristic have the irradiance as their mean.
    let frame = crate::math::Frame::from_normal(n.as_vec3());
    let count = 1 << 16;
    let weight = |wi: DVec3| {
        let cos = wi.dot(n).max(0.0);
        let pdf = sampler.pdf_for(wi, n) + cos / std::f64::consts::PI;
        if cos > 0.0 { f64::from(map.radiance(wi).x) * cos / pdf } else { 0.0 }
    };
    let mut sum = 0.0;
    for i in 0..count {
        let u = [(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * 0.618_034).fract()];
        sum += sampler.sample_for(u, n).map_or(0.0, |s| weight(s.wi));
        let local = crate::sampling::warp::cosine_hemisphere(u);
        sum += weight(frame.to_world(local.as_vec3()).as_dvec3());
    }
    let expected = crate::envmap::irradiance::IrradianceTree::new(&map).irradiance(n).value.x;
    let mean = sum / f64::from(count);
    assert!((mean / expected - 1.0).abs() < 5e-3, "{mean} against {expected}");
    // A constant map has nothing above its mean.
    let constant = Arc::new(EnvMap::new(Image::from_fn(33, 17, |_, _| Rgb::splat(0.3))));
    assert_eq!(CosineSampler::compensated(constant).sample_for([0.5; 2], n), None);
}
