//! What the default chooses on scenes of different kinds, beside what the alternatives cost: `choice`.

use super::error_time::{cornell_curves, default_against_best, plan, small, sphere_curves, stopped};
use crate::gallery::prelude::*;
use crate::view::converge as view;
use etalon_bench::converge::contender::Contender;
use etalon_bench::converge::{Convergence, measure};
use etalon_core::scene::{Environment, Request, Scene, builtin};

/// Strategies on scenes that no other figure measures.
const UNDER_MAP: &str = "light-cosine mis mis-cosine mis-cosine-compensated mis-cosine-compensated+lt default";
const IN_BOX: &str = "light bsdf mis mis+adaptive mis+lt default";

pub fn figures() -> Vec<Maker> {
    vec![maker("choice", content)]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let map = &inputs.map;
    let environment = Environment::upright(map.map.clone(), map.name.clone(), 1.0);
    let scenes = [
        ("Diffuse sphere under the map", sphere_curves(inputs, studies)?),
        ("Brushed metal under the map", compared(inputs, studies, builtin::brushed_metal(environment), UNDER_MAP)?),
        ("Mirror and glass in a box", cornell_curves(inputs, studies)?),
        ("Diffuse spheres in a box", compared(inputs, studies, builtin::cornell_lambert(), IN_BOX)?),
    ];
    let named = |(title, result): &(&str, Rc<Convergence>)| {
        [stopped(result), default_against_best(result)]
            .map(|check| Check { name: format!("{title}: {}", check.name), ..check })
    };
    let checks = scenes.iter().flat_map(named).collect();
    Content::new(view::costs(&scenes), &view::cost_rows(&scenes), checks)
}

/// The curves of some strategies on a scene.
fn compared(
    inputs: &Inputs,
    studies: &mut Studies,
    scene: (Scene, Request),
    strategies: &str,
) -> Result<Rc<Convergence>> {
    let (scene, request) = small(inputs, scene);
    let plan = plan(inputs, inputs.effort.of(32, 16), 4);
    let strategies = strategies.split_whitespace().map(str::parse).collect::<Result<Vec<_>>>()?;
    studies.get(scene.name.clone(), || measure(&scene, &request, &Contender::of(&strategies), &plan, None))
}
