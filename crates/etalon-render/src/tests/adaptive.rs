//! Adaptive sampling renders the same however the work is cut, and leaves the first samples as they are.

use crate::film::PathClasses;
use crate::{Job, Sampling, Settings, Silent, render};
use etalon_core::raster::Metadata;
use etalon_core::scene::{Request, builtin};

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
