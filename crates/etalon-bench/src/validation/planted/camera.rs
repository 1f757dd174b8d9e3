//! A mistake in what light paths are weighted with where they reach the camera.

use super::super::suite::camera::{KERNEL, WIDE, camera};
use super::fault::PlantedFault;

pub fn faults() -> Vec<PlantedFault> {
    let name = "camera/missing-cosine";
    let [faulty, sound] = [("planted", (|_, area| 1.0 / area) as fn(f64, f64) -> f64), ("sound", KERNEL)]
        .map(|(kind, pdf)| camera(format!("{kind}/{name}"), WIDE, pdf));
    let mistake =
        "the importance of a pinhole camera without the cosine at the film: towards the edges the image is too bright";
    vec![PlantedFault { name, mistake, faulty, sound }]
}
