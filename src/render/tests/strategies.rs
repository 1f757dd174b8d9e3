//! Every strategy has the same expectation, in every kind of scene: the choice of a strategy is a matter of noise alone.

use super::reference::all_scenes;
use super::*;
use crate::scene::Distribution;

/// A pane and a sphere of frosted glass and a mixture that transmits, in front of a bright place of a map and of an area light.
fn frosted() -> Scene {
    let (mut scene, _) = sphere(busy());
    let place = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let glass = |alpha| Material::Dielectric(Dielectric::rough(1.5, alpha, Distribution::Ggx));
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) };
    let mixed = Material::Mixture([(0.6, glass(0.2)), (0.4, diffuse)].into_iter().collect());
    let ball = |x, material| Object::new(Shape::Sphere(Sphere { centre: place(x, 0.0), radius: 0.4 }), material);
    let pane = Rectangle::new(place(0.0, 0.6), 0.9 * Vec3::X, 0.2 * Vec3::Y).unwrap();
    let panel = Rectangle::new(place(0.0, -1.5), 0.5 * Vec3::X, 0.5 * Vec3::Y).unwrap();
    scene.objects = vec![
        ball(-0.5, glass(0.3)),
        ball(0.5, mixed),
        Object::new(Shape::Rectangle(pane), glass(0.1)),
        emitter(Shape::Rectangle(panel)),
    ];
    scene.name = "frosted".into();
    scene
}

/// The strategies: techniques, each with every density of the map that may be used with it.
fn strategies(scene: &Scene) -> Vec<Settings> {
    let densities = [MapSampling::COSINE, MapSampling::MAP, MapSampling::COSINE_COMPENSATED];
    let by = |sampling: Sampling| {
        let by_map = scene.environment.is_some() && sampling.by_light();
        let allowed = move |density: &MapSampling| sampling.is_mis() || density.entry().complete;
        let settings = Settings { sampling, stream: StreamKind::Independent, ..Settings::default() };
        let densities: Vec<_> = densities.into_iter().filter(allowed).map(Some).collect();
        let densities = if by_map { densities } else { vec![None] };
        densities.into_iter().map(move |density| Settings { density, ..settings })
    };
    ALL.into_iter().flat_map(by).collect()
}

/// Of equal means, one comparison in two million is that far apart; there are about a hundred.
const STANDARD_ERRORS: f64 = 5.0;

#[test]
fn all_strategies_have_the_same_mean() {
    let mut scenes = all_scenes();
    scenes.push(frosted());
    // The statues differ by their metals.
    scenes.retain(|scene| !scene.name.starts_with("cornell-statue") || scene.name.ends_with("-cu"));
    // After one scattering, light is found where none was sampled.
    let rough = scenes.iter().filter(|scene| ["many materials", "frosted"].contains(&scene.name.as_str()));
    for (scene, max_depth) in scenes.iter().map(|scene| (scene, 4)).chain(rough.map(|scene| (scene, 1))) {
        let request = Request { width: 32, height: 24, spp: 256, light_samples: 1, max_depth };
        let mis = Settings { sampling: Sampling::Mis, stream: StreamKind::Independent, ..Settings::default() };
        for (seed, other) in (1..).zip(strategies(scene)) {
            let z = z(scene, &request, &mis, &Settings { seed, ..other });
            let case = format!("{}, {:?} {:?}, {max_depth}", scene.name, other.sampling, other.density);
            assert!(z.abs() < STANDARD_ERRORS, "{case}: {z}");
        }
    }
}

/// A sphere that reflects all light, half of it as a mirror, is invisible in a white furnace after one scattering.
#[test]
fn delta_lobes_find_light_after_the_last_scattering() {
    let (mut scene, request) = sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE));
    let (diffuse, mirror) = (Material::Diffuse { albedo: Rgb::ONE }, Material::Mirror { reflectance: Rgb::ONE });
    scene.objects[0].material = Material::Mixture([(0.5, diffuse), (0.5, mirror)].into_iter().collect());
    let request = Request { spp: 64, max_depth: 1, ..request };
    for sampling in ALL {
        let (mean, error) = mean(&scene, &request, &Settings { sampling, ..Settings::default() });
        assert!((mean - 1.0).abs() < 4.0 * error + 1e-5, "{sampling:?}: {mean} ± {error}");
    }
}

/// A light around the scene, which a sphere hides from part of the floor.
#[test]
fn a_light_around_the_scene_is_occluded() {
    let mut scene = floor(Vec::new(), Vec::new());
    let mut around = emitter(Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 6.0 }));
    around.emission = around.emission.map(|emission| Emission { two_sided: true, ..emission });
    let black = Material::Diffuse { albedo: Rgb::ZERO };
    scene.objects.push(around);
    scene.objects.push(Object::new(Shape::Sphere(Sphere { centre: Vec3::new(0.3, 1.2, 0.2), radius: 0.6 }), black));
    // The camera is below the sphere, whose share of cos θ / π is (r/d)².
    let expected = 2.0 * 0.5 * (1.0 - 0.25);
    for sampling in ALL {
        let (found, error) = rendered_mean(&scene, &Settings { sampling, ..Settings::default() });
        assert!((found - expected).abs() < 4.0 * error + 1e-4, "{sampling:?}: {found} ± {error}, not {expected}");
    }
}
