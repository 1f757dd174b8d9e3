//! What every sampler of the registry must do, and its entry say.

use super::*;
use crate::math::Rgb;
use crate::raster::Image;
use glam::DVec3;

/// A map with dark texels and strong contrast.
fn map_of(w: usize, h: usize) -> Arc<EnvMap> {
    let value = |x: usize, y: usize| match (x * 7 + y * 13) % 5 {
        0 => Rgb::ZERO,
        4 if x == 1 => Rgb::splat(1e5),
        k => Rgb::new(k as f32, 0.5, 0.1),
    };
    Arc::new(EnvMap::new(Image::from_fn(w, h, |x, y| value(x + usize::from(w == 1), y))))
}

/// Maps of every size of trouble.
fn maps() -> [Arc<EnvMap>; 5] {
    [(1, 1), (2, 1), (3, 2), (10, 10), (64, 33)].map(|(w, h)| map_of(w, h))
}

fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..n * n).map(move |i| [(f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n)])
}

const NORMALS: [DVec3; 4] =
    [DVec3::Y, DVec3::new(0.48, -0.6, 0.64), DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64)];

/// Every sampler of directions on a map, with its entry.
fn samplers(map: &Arc<EnvMap>) -> Vec<(&'static Entry, Box<dyn SurfaceSampler>)> {
    let all = ALL.iter().map(|&entry| MapSampling::new(entry));
    let sampled = all.filter(|sampling| !sampling.has_fixed_lights());
    sampled.map(|sampling| (sampling.entry(), sampling.sampler(map.clone()).unwrap())).collect()
}

#[test]
fn entries_are_documented_and_found_by_their_names() {
    for &entry in ALL {
        assert!(entry.doc.len() > 10, "{}", entry.name);
        let sampling = MapSampling::with_regions(entry, 7);
        assert_eq!(sampling.to_string().parse::<MapSampling>().unwrap(), sampling);
        let by_density: MapSampling = sampling.density().parse().unwrap();
        assert_eq!(by_density.entry().density, entry.density);
    }
    assert_eq!("map".parse::<MapSampling>().unwrap(), MapSampling::MAP);
    for wrong in ["", "cosin", "median-cut", "median-cut-", "median-cut--1", "cdf-4", "median-cut-1e3", "K"] {
        assert!(wrong.parse::<MapSampling>().is_err(), "{wrong}");
    }
}

#[test]
fn samples_carry_the_pdf_of_their_direction_to_the_last_bit_and_can_be_inverted() {
    // In the largest maps the blocks of `cosine` are of several texels.
    for map in maps().into_iter().chain([map_of(1030, 516)]) {
        for (entry, sampler) in samplers(&map) {
            for normal in NORMALS {
                let mut drawn = 0;
                for u in grid(60).chain([[0.0, 0.0], [1.0f64.next_down(); 2]]) {
                    let Some(s) = sampler.sample_for(u, normal) else { continue };
                    drawn += 1;
                    assert_eq!(s.pdf.to_bits(), sampler.pdf_for(s.wi, normal).to_bits(), "{}", entry.name);
                    assert!(s.pdf > 0.0 && s.pdf.is_finite());
                    assert_eq!(s.radiance, map.radiance(s.wi));
                    let back = sampler.invert_for(s.wi, normal);
                    assert_eq!(back.is_some(), entry.invertible, "{}", entry.name);
                    let is_back = |back: [f64; 2]| (0..2).all(|i| (back[i] - u[i]).abs() < 1e-8);
                    assert!(back.is_none_or(is_back), "{u:?} came back {back:?}");
                }
                let all = matches!(entry.method, Method::Directions(_));
                // MIS compensation by the normal leaves a constant map to the BSDF, and a normal without bright light.
                assert!(drawn == 3602 || !all && (drawn > 1000 || !entry.complete), "{}: {drawn}", entry.name);
            }
        }
    }
}

#[test]
fn many_samples_are_the_single_ones_to_the_last_bit() {
    let numbers: Vec<[f64; 2]> = grid(60).chain([[0.0, 0.0], [1.0f64.next_down(); 2]]).collect();
    for map in maps() {
        for (_, sampler) in samplers(&map) {
            let normals: Vec<DVec3> = (0..numbers.len()).map(|i| NORMALS[i % 4]).collect();
            let mut each = vec![None; numbers.len()];
            sampler.sample_each(&numbers, &normals, &mut each);
            for (i, sample) in each.into_iter().enumerate() {
                assert_eq!(sample, sampler.sample_for(numbers[i], normals[i]));
            }
        }
    }
}

#[test]
fn densities_integrate_to_one_and_are_complete_where_they_say_so() {
    for map in maps() {
        let g = map.geometry();
        for (entry, sampler) in samplers(&map) {
            for normal in NORMALS {
                let (mut mass, mut missed) = (0.0, 0);
                for (x, y) in (0..g.height()).flat_map(|y| (0..g.width()).map(move |x| (x, y))) {
                    let wi = g.direction_in_texel(x, y, 0.5, 0.5);
                    let pdf = sampler.pdf_for(wi, normal);
                    mass += pdf * g.solid_angle(y);
                    let above = |fx, fy| g.direction_in_texel(x, y, fx, fy).dot(normal) > 0.0;
                    let places = [0.01, 0.5, 0.99];
                    let above = places.iter().any(|&fx| places.iter().any(|&fy| above(fx, fy)));
                    let received = above || matches!(entry.method, Method::Directions(_));
                    missed += i32::from(received && map.mean_rgb(x, y) > 0.0 && pdf == 0.0);
                }
                match entry.method {
                    Method::Directions(_) => assert!((mass - 1.0).abs() < 1e-9, "{}: {mass}", entry.name),
                    // All that is sampled may be below the horizon.
                    _ => assert!((mass - 1.0).abs() < 1e-9 || mass == 0.0 && !entry.complete, "{}: {mass}", entry.name),
                }
                assert!(missed == 0 || !entry.complete, "{}: {missed}", entry.name);
                // What is said to miss light does so on the largest map.
                assert!(missed > 0 || entry.complete || g.width() < 64, "{}", entry.name);
            }
        }
    }
}

#[test]
fn a_black_map_has_no_samples() {
    let map = Arc::new(EnvMap::new(Image::new(4, 2)));
    for (entry, sampler) in samplers(&map) {
        assert_eq!(sampler.sample_for([0.5, 0.5], DVec3::Y), None, "{}", entry.name);
        assert!(!sampler.has_samples(), "{}", entry.name);
        assert_eq!(sampler.pdf_for(DVec3::Y, DVec3::Y), 0.0, "{}", entry.name);
    }
}

#[test]
fn fixed_lights_have_the_flux_of_the_map() {
    for map in maps() {
        let flux: DVec3 = (0..map.geometry().height())
            .map(|y| map.image().row(y).iter().map(|p| p.as_dvec3()).sum::<DVec3>() * map.geometry().solid_angle(y))
            .sum();
        let regions = map.image().pixels().len().min(6) as u32;
        for sampling in ALL.iter().map(|&entry| MapSampling::with_regions(entry, regions)) {
            let Some(lights) = sampling.fixed_lights(&map).unwrap() else { continue };
            assert_eq!(lights.len(), regions as usize);
            let sum: DVec3 = lights.iter().map(|light| light.irradiance).sum();
            assert!((sum - flux).length() < 1e-9 * flux.length(), "{sampling}: {sum} {flux}");
            assert!(sampling.sampler(map.clone()).is_err());
        }
    }
}
