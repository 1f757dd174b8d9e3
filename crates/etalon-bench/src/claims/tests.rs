//! The claims on depths, in the scene that they are about and in one without mirror and glass.

use super::*;
use crate::depth::depths;
use etalon_core::scene::{Request, Scene, builtin};
use etalon_render::Settings;

const EFFORT: Effort = Effort { to_diffuse: 8, to_specular: 32, from_walls: 2, from_light: 1 << 15 };

fn of_scene((scene, request): (Scene, Request)) -> DepthClaims {
    let request = Request { width: 120, height: 90, spp: 32, ..request };
    let depths = depths(&scene, &request, &Settings::default()).unwrap();
    depth_claims(&scene, &depths, EFFORT, 1).unwrap()
}

#[test]
fn what_appears_at_each_depth_is_what_the_renderer_has() {
    let tested = of_scene(builtin::cornell_spheres());
    assert!(tested.agreement.len() == 5 && tested.agreement.iter().all(|a| a.z.abs() < 4.0));
    let verdict = |start: &str| tested.claims.iter().find(|c| c.claim.starts_with(start)).unwrap().verdict();
    assert_eq!(verdict("Depth 2 adds the walls in the mirror"), Verdict::Holds);
    assert_eq!(verdict("Depth 3 adds the caustic"), Verdict::Holds);
    assert_eq!(verdict("The glazing is reflection"), Verdict::DoesNotHold);
}

#[test]
fn claims_on_mirror_and_glass_do_not_hold_without_them() {
    let tested = of_scene(builtin::cornell_lambert());
    let of_spheres = |claim: &&Claim| claim.claim.contains("sphere") || claim.claim.contains("glass");
    assert!(tested.claims.iter().filter(of_spheres).count() > 8);
    for claim in tested.claims.iter().filter(of_spheres) {
        assert!(![Verdict::Holds, Verdict::HoldsPartly].contains(&claim.verdict()), "{}", claim.claim);
    }
    assert!(tested.claims.iter().any(|claim| claim.verdict() == Verdict::Holds), "the walls are there");
}
