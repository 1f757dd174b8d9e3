//! What a render chooses by itself; adaptive sampling renders the same however the work is cut, and leaves the first samples as they are.

use super::light_tracing::{WIDE, box_with, sphere};
use super::*;
use crate::film::PathClasses;
use etalon_core::raster::Metadata;

const SMALL: Request = Request { width: 40, height: 30, spp: 4, light_samples: 1, max_depth: 5 };

fn chosen(scene: &Scene, seed: u64) -> Settings {
    *Job::new(scene, &SMALL, &Settings { seed, ..Settings::usual() }).unwrap().settings()
}

fn glass() -> Material {
    Material::Dielectric(Dielectric::clear(1.5))
}

/// A diffuse sphere in a sphere that emits the same light everywhere.
fn within_light() -> Scene {
    let mut scene = box_with(vec![sphere(Material::Diffuse { albedo: Rgb::splat(0.5) })], WIDE);
    let around = Object::new(ball(Vec3::ZERO, 50.0), Material::Diffuse { albedo: Rgb::ZERO });
    scene.objects.truncate(1);
    let emission = Emission { two_sided: true, ..Emission::of_front(Rgb::ONE) };
    scene.objects.push(Object { emission: Some(emission), ..around });
    scene
}

/// Glass behind the wall of a box, where no light falls on it.
fn hidden_glass() -> Scene {
    let mut scene = box_with(Vec::new(), WIDE);
    scene.objects.push(Object::new(ball(Vec3::new(0.0, -20.0, 0.0), 0.5), glass()));
    scene
}

#[test]
fn techniques_that_find_nothing_are_left_out() {
    let left_out = |scene: &Scene, settings: Settings| Job::new(scene, &SMALL, &settings).unwrap().left_out();
    for (scene, techniques) in [
        (within_light(), &["light sampling", "light tracing"][..]),
        (super::sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE)).0, &["BSDF sampling", "light tracing"]),
        (box_with(vec![sphere(glass())], WIDE), &[]),
    ] {
        let parts = left_out(&scene, Settings { adaptive: true, ..Settings::default() });
        assert!(techniques.iter().all(|name| !parts.contains(name)), "the user asked for them");
        assert_eq!(left_out(&scene, Settings::usual()), [&parts, techniques].concat());
        let uniform = Settings { adaptive: false, ..Settings::usual() };
        assert_eq!(left_out(&scene, uniform), [&parts, techniques].concat(), "that is another choice");
    }
    for seed in 0..8 {
        assert_eq!(chosen(&within_light(), seed).sampling, Sampling::Bsdf);
        assert_ne!(chosen(&hidden_glass(), seed).sampling, Sampling::MisLt);
        assert_eq!(chosen(&box_with(vec![sphere(glass())], WIDE), seed).sampling, Sampling::MisLt);
    }
}

#[test]
fn what_is_chosen_renders_as_if_it_were_asked_for() {
    let (under_map, _) = super::sphere(busy());
    for scene in [within_light(), hidden_glass(), box_with(vec![sphere(glass())], WIDE), under_map] {
        let named = chosen(&scene, 3);
        assert!(!named.choose);
        let usual = Settings { seed: 3, ..Settings::usual() };
        let [a, b, c] = [usual, named, Settings { general: true, ..usual }]
            .map(|settings| render(&scene, &SMALL, &settings, &Silent).unwrap());
        assert_eq!(a.image, b.image, "{named:?}");
        assert_eq!(a.image, c.image, "{named:?}");
        assert_eq!(a.part.fingerprint, b.part.fingerprint);
    }
}

#[test]
fn threads_parts_and_specialised_kernels_change_no_bit() {
    let (mut scene, request) = builtin::cornell_spheres();
    let request = Request { width: 24, height: 18, spp: 20, ..request };
    for (sampling, filter) in [(Sampling::Mis, "box"), (Sampling::MisLt, "box"), (Sampling::MisLt, "gaussian")] {
        scene.camera.filter = filter.parse().unwrap();
        let settings = Settings { sampling, adaptive: true, paths: Some(PathClasses::up_to(3)), ..Settings::default() };
        let film = |threads: usize, settings: Settings, ends: &[u32]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut part = None;
                for ends in ends.windows(2) {
                    // Each range by a job of its own, as on another machine.
                    let job = Job::new(&scene, &request, &settings).unwrap();
                    let part = part.get_or_insert_with(|| job.part(Metadata::default()).unwrap());
                    job.run(part, ends[0].min(ends[1])..ends[0].max(ends[1]), &Silent);
                }
                part.filter(|part| part.is_complete()).unwrap().film
            })
        };
        let whole = film(1, settings, &[0, 20]);
        assert_eq!(whole, film(3, settings, &[20, 12, 3, 0]));
        assert_eq!(whole, film(2, Settings { general: true, ..settings }, &[0, 9, 20]));
        let counts: Vec<u32> = whole.pixels().iter().map(|pixel| pixel.camera_paths()).collect();
        assert!(counts.contains(&20) && counts.iter().any(|&n| n >= 2 * 20), "{counts:?}");
        // The first samples have one path each.
        let few = Request { spp: 8, ..request };
        let image = |adaptive| render(&scene, &few, &Settings { adaptive, ..settings }, &Silent).unwrap().image;
        assert_eq!(image(true), image(false));
    }
}
