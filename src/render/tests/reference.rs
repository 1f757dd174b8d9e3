//! The path tracer in lanes against the reference.

use super::*;

/// The built-in scenes, and one outdoors.
fn all_scenes() -> Vec<Scene> {
    let map = || Environment::upright(Arc::new(EnvMap::new(busy())), "test", 1.0);
    let made = |built_in: builtin::BuiltIn| built_in.make(built_in.map_scale().map(|_| map()), None).unwrap().0;
    let mut scenes: Vec<Scene> = builtin::scenes().into_iter().map(made).collect();
    let mut outdoors = scenes.iter().find(|scene| scene.name == "cornell-statue-cu").unwrap().clone();
    outdoors.objects.retain(|object| !matches!(object.shape, Shape::Rectangle(_)));
    outdoors.environment = Some(map());
    outdoors.name = "outdoors".into();
    scenes.push(outdoors);
    scenes.push(many_lights());
    scenes
}

/// Both trace the same paths, so that a sample differs by rounding alone. At an edge or in the choice of a lobe rounding may
/// also turn a path: of 1200 samples at most 6.
#[test]
fn the_lanes_agree_with_the_reference_sample_by_sample() {
    let request = Request { width: 40, height: 30, spp: 1, light_samples: 2, max_depth: 8 };
    for scene in &all_scenes() {
        for sampling in ALL.into_iter().filter(|&sampling| sampling != Sampling::MisLt) {
            let densities = [MapSampling::COSINE, MapSampling::MAP, MapSampling::COSINE_COMPENSATED];
            // The last misses part of the light, which BSDF samples find.
            for density in densities.into_iter().filter(|density| density.entry().complete || sampling.is_mis()) {
                let image = |kernel| {
                    let settings =
                        Settings { sampling, density: Some(density), seed: 7, kernel, ..Settings::default() };
                    render(scene, &request, &settings, &Silent).unwrap().image
                };
                let (lanes, reference) = (image(Kernel::Lanes), image(Kernel::Reference));
                let pairs = lanes.pixels().iter().zip(reference.pixels());
                let differ = |(a, b): &(&Rgb, &Rgb)| (**a - **b).abs().max_element() > 1e-3 * b.max_element().max(0.01);
                let different = pairs.filter(differ).count();
                assert!(different <= 6, "{}, {sampling:?}, {density}: {different} samples", scene.name);
                assert!(lanes.pixels().iter().any(|p| p.max_element() > 0.0), "{}: all black", scene.name);
                if scene.environment.is_none() {
                    break;
                }
            }
        }
    }
}
