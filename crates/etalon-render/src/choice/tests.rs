//! The scores of candidates, and what operations cost.

use super::*;
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::scene::{Environment, builtin};
use std::sync::Arc;
use std::time::Instant;

/// A trial with these variances of blocks.
fn trial(variances: impl Fn(usize) -> f64) -> Trial {
    let block = |i: usize| Block { pixels: 12.0, variance: variances(i), ..Block::default() };
    Trial { cost: 1.0, blocks: std::array::from_fn(block), ..Trial::default() }
}

/// Whether a trial replaces the first one, with adaptive sampling and without, which have to agree.
fn replaces(first: &Trial, other: &Trial) -> bool {
    replaces_with(first, other, 0.0)
}

/// The same with variance that a pixel may have unseen.
fn replaces_with(first: &Trial, other: &Trial, unseen: f64) -> bool {
    let [a, b] =
        [true, false].map(|adaptive| other.score_alone(first, unseen, adaptive).is_better_than(&first.score(adaptive)));
    assert_eq!(a, b);
    a
}

#[test]
fn a_candidate_has_to_be_better_by_more_than_chance() {
    let first = trial(|_| 1.0);
    assert!(!replaces(&first, &first));
    assert!(replaces(&first, &Trial { cost: 0.9, ..trial(|_| 1.0) }));
    assert!(replaces(&first, &trial(|_| 0.5)));
    assert!(!replaces(&first, &Trial { cost: 2.0, ..trial(|_| 0.5) }));
    // A better sum may be luck where the blocks do not agree.
    let mixed = |better: f64| trial(move |i| if i % 2 == 0 { better } else { 1.5 });
    assert!(!replaces(&first, &mixed(0.6)) && replaces(&first, &mixed(0.05)));
    // One block tells nothing of chance.
    let one = |variance: f64| {
        let mut one = trial(|i| if i == 12 { variance } else { 0.0 });
        one.blocks.iter_mut().enumerate().for_each(|(i, block)| block.pixels = if i == 12 { 1.0 } else { 0.0 });
        one
    };
    assert!(!replaces(&one(1.0), &one(0.1)));
}

#[test]
fn bsdf_samples_are_not_taken_where_bright_light_may_be_unseen() {
    let first = trial(|_| 1.0);
    assert!(replaces_with(&first, &trial(|_| 0.1), 0.01) && !replaces_with(&first, &trial(|_| 0.1), 1.0));
    let (mut scene, _) = builtin::cornell_lambert();
    let before = first.unseen(&scene);
    let emission = scene.objects.iter_mut().find_map(|object| object.emission.as_mut()).unwrap();
    emission.radiance *= 10.0;
    assert!((first.unseen(&scene) / before - 100.0).abs() < 1e-3, "{before}");
}

#[test]
fn light_paths_are_kept_for_what_camera_paths_find_rarely() {
    let with = |of_light_paths: f64, spared: f64| {
        let mut first = Trial { cost_of_light_paths: 0.1, ..trial(|_| 1.0) };
        first.blocks[7] = Block { of_light_paths, spared, ..first.blocks[7] };
        first
    };
    let (useless, caustic) = (with(0.0, 0.0), with(0.1, 1e4));
    assert!(replaces(&useless, &useless), "without light paths");
    assert!(!replaces(&caustic, &caustic) && !replaces(&caustic, &trial(|_| 0.1)));
}

#[test]
fn what_is_not_a_number_is_not_taken() {
    let first = trial(|_| 1.0);
    for value in [f64::NAN, f64::INFINITY] {
        assert!(!replaces(&first, &trial(|_| value)));
        let mut infinite = trial(|_| 1.0);
        infinite.blocks[3].spared = value;
        assert!(!replaces(&infinite, &trial(|_| 0.1)));
    }
}

/// Seconds of a render, the least of several, and its rays, choices of lights, and rays of light paths.
fn measured(scene: &Scene, request: &Request, sampling: Sampling) -> [f64; 4] {
    let job = Job::new(scene, request, &Settings { sampling, ..Settings::default() }).unwrap();
    let columns: Vec<usize> = (0..request.width).collect();
    let run = || {
        let start = Instant::now();
        let rows = (0..request.height).map(|y| job.trace_row(&job.scene, &columns, y, &mut Default::default()));
        let counts = rows.fold([0; 3], |[rays, choices, of_light_paths], row| {
            [rays + row.work.rays, choices + row.work.choices, of_light_paths + row.light_path_rays]
        });
        (start.elapsed().as_secs_f64(), counts.map(|count| count as f64))
    };
    let runs: Vec<_> = (0..20).map(|_| run()).collect();
    let [rays, choices, of_light_paths] = runs[0].1;
    [runs.iter().map(|run| run.0).fold(f64::INFINITY, f64::min), rays, choices, of_light_paths]
}

#[test]
#[ignore = "measures times: run it alone, in a release build"]
fn costs_of_operations() {
    let map = Arc::new(EnvMap::new(Synthetic::Nave.make()));
    let (diffuse, request) = builtin::cornell_lambert();
    let request = Request { width: 60, height: 200, light_samples: 1, ..request };
    let under_map = Scene { environment: Some(Environment::upright(map, "nave", 1.0)), ..diffuse.clone() };
    let mut many_lights = diffuse.clone();
    let light = diffuse.objects.iter().find(|object| object.emission.is_some()).unwrap();
    many_lights.objects.extend(vec![light.clone(); 15]);
    for (name, scene) in [("one light", diffuse), ("a light and a map", under_map), ("16 lights", many_lights)] {
        let [bsdf, mis] = [Sampling::Bsdf, Sampling::Mis].map(|sampling| measured(&scene, &request, sampling));
        let ray = bsdf[0] / bsdf[1];
        let choice = (mis[0] / ray - mis[1]) / mis[2];
        println!("{name}: {:.0} ns a ray; a choice of a light as long as {choice:.2} rays", 1e9 * ray);
    }
    let statue = builtin::find("cornell-statue-au").unwrap().make(None, None).unwrap();
    for (scene, request) in [builtin::cornell_spheres(), statue] {
        let request = Request { width: 60, height: 200, light_samples: 1, ..request };
        let [mis, lt] = [Sampling::Mis, Sampling::MisLt].map(|sampling| measured(&scene, &request, sampling));
        let of_light_path = (lt[0] - mis[0]) / lt[3] * mis[1] / mis[0];
        println!("{}: a ray of a light path as long as {of_light_path:.2} rays", scene.name);
    }
}
