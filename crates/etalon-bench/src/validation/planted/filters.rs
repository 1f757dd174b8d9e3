//! Mistakes in pixel filters: film positions sampled by one function, and light paths weighted by another.

use super::super::suite::filters::{KERNEL, Pdf, positions};
use super::fault::PlantedFault;

/// The case of the suite with a wrong pdf, and with the right one.
fn filter(name: &'static str, filter: &'static str, wrong: Pdf) -> PlantedFault {
    let [faulty, sound] =
        [("planted", wrong), ("sound", KERNEL)].map(|(kind, pdf)| positions(format!("{kind}/{name}"), filter, pdf));
    PlantedFault { name, mistake: "", faulty, sound }
}

/// exp(−x²/(2σ²)) for σ ½ within ±1, where it has the integral σ √(2π) erf(1/(σ√2)).
fn cut_off(x: f32) -> f64 {
    let integral = 0.5 * std::f64::consts::TAU.sqrt() * libm::erf(2f64.sqrt());
    (-2.0 * f64::from(x).powi(2)).exp() / integral
}

pub fn faults() -> Vec<PlantedFault> {
    vec![
        filter("filter/cut-off", "gaussian:1,0.5", |_, [x, y]| cut_off(x) * cut_off(y)).mistake(
            "light paths weighted by a Gaussian that is cut off, camera rays by one that falls to 0 at the radius",
        ),
        filter("filter/width-for-radius", "triangle:2", |prepared, [x, y]| 4.0 * KERNEL(prepared, [2.0 * x, 2.0 * y]))
            .mistake("the radius of a triangle taken for its whole width by light paths"),
    ]
}
