//! The path tracer in lanes against the reference.

use super::*;
use etalon_core::bsdf::families;

/// The built-in scenes, and one outdoors.
pub(super) fn all_scenes() -> Vec<Scene> {
    let map = || Environment::upright(Arc::new(EnvMap::new(busy())), "test", 1.0);
    let made = |built_in: builtin::BuiltIn| built_in.make(built_in.map_scale().map(|_| map()), None).unwrap().0;
    let mut scenes: Vec<Scene> = builtin::scenes().into_iter().map(made).collect();
    // The statues differ by their metals.
    scenes.retain(|scene| !scene.name.starts_with("cornell-statue") || scene.name.ends_with("-cu"));
    let mut outdoors = scenes.iter().find(|scene| scene.name == "cornell-statue-cu").unwrap().clone();
    outdoors.objects.retain(|object| !matches!(object.shape, Shape::Rectangle(_)));
    outdoors.environment = Some(map());
    outdoors.name = "outdoors".into();
    scenes.push(outdoors);
    scenes.push(many_lights());
    scenes.push(many_materials());
    scenes.extend(every_bsdf());
    scenes.push(textures::many_textures());
    scenes
}

/// The scene of many lights with surfaces of every kind of lobe: rough and anisotropic, with multiple scattering, coated, mixed.
fn many_materials() -> Scene {
    let mut scene = many_lights();
    scene.name = "many materials".into();
    scene.objects.retain(|object| object.emission.is_some() || matches!(object.shape, Shape::Rectangle(_)));
    let ggx = Distribution::Ggx;
    let metal = Conductor { two_sided: true, ..metal(0.6, Distribution::Beckmann) };
    let other = Conductor::new(metal.k, metal.eta, 0.3, ggx);
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.5) };
    let glass = Material::Dielectric(Dielectric::clear(1.5));
    let mix = |parts: &[(f32, Material)]| Material::Mixture(parts.iter().cloned().collect());
    let materials = [
        Material::Dielectric(Dielectric::rough(1.5, 0.2, ggx)),
        Material::Dielectric(Dielectric { alpha: [0.1, 0.5], ..Dielectric::rough(1.3, 0.0, Distribution::Beckmann) }),
        Material::Conductor(Conductor { alpha: [0.1, 0.5], distribution: ggx, ..metal }),
        Material::Conductor(Conductor { multiple_scattering: true, ..metal }),
        Material::Conductor(Conductor { alpha: [0.2, 0.8], multiple_scattering: true, distribution: ggx, ..metal }),
        mix(&[(0.5, diffuse.clone()), (0.5, Material::Conductor(metal))]),
        mix(&[(0.5, glass), (0.4, diffuse)]),
        // Two parts of the same lobe.
        mix(&[(0.7, Material::Conductor(other)), (0.3, Material::Conductor(metal))]),
    ];
    scene.objects.extend(balls(materials));
    scene
}

/// Scenes of many lights with every BSDF of the list.
fn every_bsdf() -> Vec<Scene> {
    let materials: Vec<Material> = families().map(|f| Material::from(f.with(&f.defaults()))).collect();
    let scene = |(i, materials): (usize, &[Material])| {
        let mut scene = many_lights();
        scene.name = format!("every BSDF, part {i}");
        scene.objects.retain(|object| object.emission.is_some() || matches!(object.shape, Shape::Rectangle(_)));
        scene.objects.extend(balls(materials.iter().cloned()));
        scene
    };
    materials.chunks(9).enumerate().map(scene).collect()
}

/// How many of 1200 samples differ by more than rounding.
fn different(scene: &Scene, settings: &Settings, max_depth: u32) -> usize {
    let request = Request { width: 40, height: 30, spp: 1, light_samples: 2, max_depth };
    let image = |kernel| render(scene, &request, &Settings { kernel, ..*settings }, &Silent).unwrap().image;
    let (lanes, reference) = (image(Kernel::Lanes), image(Kernel::Reference));
    assert!(lanes.pixels().iter().any(|p| p.max_element() > 0.0), "{}: all black", scene.name);
    let differ = |(a, b): &(&Rgb, &Rgb)| (**a - **b).abs().max_element() > 1e-3 * b.max_element().max(0.01);
    lanes.pixels().iter().zip(reference.pixels()).filter(differ).count()
}

/// Both trace the same paths, so that a sample differs by rounding alone. At an edge or in the choice of a lobe rounding may
/// also turn a path: of 1200 samples at most 6.
#[test]
fn the_lanes_agree_with_the_reference_sample_by_sample() {
    let filtered = ["triangle:2x1", "gaussian"].map(|filter| {
        let mut scene = many_materials();
        scene.camera.filter = filter.parse().unwrap();
        scene
    });
    for scene in all_scenes().iter().chain(&filtered) {
        for sampling in ALL.into_iter().filter(|&sampling| sampling != Sampling::MisLt) {
            let densities = [MapSampling::COSINE, MapSampling::MAP, MapSampling::COSINE_COMPENSATED];
            // The last misses part of the light, which BSDF samples find.
            for density in densities.into_iter().filter(|density| density.entry().complete || sampling.is_mis()) {
                let settings = Settings { sampling, density: Some(density), seed: 7, ..Settings::default() };
                // Deep paths, and paths that end at the first surface.
                for max_depth in [8, 1] {
                    let different = different(scene, &settings, max_depth);
                    let case = format!("{}, {sampling:?}, {density}, depth {max_depth}", scene.name);
                    assert!(different <= 6, "{case}: {different} samples");
                }
                if scene.environment.is_none() {
                    break;
                }
            }
        }
    }
}
