//! Maps from the unit square to directions.

use super::Case;
use crate::sampling::warp;
use crate::stats::{Directions, Draw, Pole, density, sampler};
use glam::DVec3;

pub fn cases() -> Vec<Case> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        Case::of("warp/uniform-hemisphere", half, || {
            let draw = |u: &[f64]| Some(Draw::new(warp::uniform_hemisphere([u[0], u[1]])));
            let sampler = sampler(2, draw).with_inverse(|w| warp::invert_uniform_hemisphere(w).to_vec());
            (sampler, density(|_: DVec3| warp::UNIFORM_HEMISPHERE_PDF))
        }),
        Case::of("warp/cosine-hemisphere", half, || {
            let draw = |u: &[f64]| Some(Draw::new(warp::cosine_hemisphere([u[0], u[1]])));
            let sampler = sampler(2, draw).with_inverse(|w| warp::invert_cosine_hemisphere(w).to_vec());
            (sampler, density(|w: DVec3| warp::cosine_hemisphere_pdf(w.z)))
        }),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::super::run;
    use super::*;
    use crate::stats::Protocol;

    #[test]
    fn all_are_accepted() {
        let validation = run(&cases(), &Protocol::default(), &|_| ()).unwrap();
        assert_eq!(validation.accepted, cases().len(), "{validation:?}");
    }
}
