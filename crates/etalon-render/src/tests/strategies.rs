//! Every strategy has the same expectation, in every kind of scene: the choice of a strategy is a matter of noise alone.

use super::reference::all_scenes;
use super::*;

/// A pane and a sphere of frosted glass and a mixture that transmits, in front of a bright place of a map and of an area light.
fn frosted() -> Scene {
    let (mut scene, _) = sphere(busy());
    let place = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let glass = |alpha| Material::Dielectric(Dielectric::rough(1.5, alpha, Distribution::Ggx));
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) };
    let mixed = Material::Mixture([(0.6, glass(0.2)), (0.4, diffuse)].into_iter().collect());
    let sphere = |x, material| Object::new(ball(place(x, 0.0), 0.4), material);
    let pane = Rectangle::new(place(0.0, 0.6), 0.9 * Vec3::X, 0.2 * Vec3::Y).unwrap();
    let panel = Rectangle::new(place(0.0, -1.5), 0.5 * Vec3::X, 0.5 * Vec3::Y).unwrap();
    scene.objects = vec![
        sphere(-0.5, glass(0.3)),
        sphere(0.5, mixed),
        Object::new(Shape::Rectangle(pane), glass(0.1)),
        emitter(Shape::Rectangle(panel)),
    ];
    scene.name = "frosted".into();
    scene
}

/// A floor of broad metal that reflects one end of a light, which hangs beside the visible place.
fn broad_metal(distribution: Distribution, alpha: f32) -> Scene {
    let panel = Rectangle::new(Vec3::new(1.0, 1.0, 0.3), 0.8 * Vec3::X, 0.5 * Vec3::Z).unwrap();
    let mut scene = floor(vec![emitter(Shape::Rectangle(panel))], Vec::new());
    scene.objects[0].material = Material::Conductor(metal(alpha, distribution));
    scene.name = "broad metal".into();
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

/// One comparison of equal means in two million is that far apart; there are about a hundred.
const STANDARD_ERRORS: f64 = 5.0;

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn all_strategies_have_the_same_mean() {
    let mut scenes = all_scenes();
    scenes.push(frosted());
    let broad = [Distribution::Beckmann, Distribution::Ggx].map(|of| [0.2, 0.5].map(|alpha| broad_metal(of, alpha)));
    scenes.extend(broad.into_iter().flatten());
    // After one scattering, light is found where none was sampled.
    let is_rough = |name: &str| ["many materials", "frosted", "broad metal"].contains(&name);
    let rough = scenes.iter().filter(|scene| is_rough(&scene.name)).map(|scene| (scene, 1, 3));
    for (scene, max_depth, light_samples) in scenes.iter().map(|scene| (scene, 4, 1)).chain(rough) {
        let request = Request { width: 32, height: 24, spp: 256, light_samples, max_depth };
        let mis = Settings { sampling: Sampling::Mis, stream: StreamKind::Independent, ..Settings::default() };
        for (seed, other) in (1..).zip(strategies(scene)) {
            let z = z(scene, &request, &mis, &Settings { seed, ..other });
            let case = format!("{}, {:?} {:?}, {max_depth}", scene.name, other.sampling, other.density);
            assert!(z.abs() < STANDARD_ERRORS, "{case}: {z}");
        }
    }
}
