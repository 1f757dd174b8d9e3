//! Test cases: which of many lights is chosen, by the light tree as the kernel asks it.

use super::super::case::Case;
use super::inputs::in_lanes;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{
    Emission, EmitterVisibility, Falloff, Light, Material, Mesh, Object, Rectangle, Scene, Shape, Sphere, builtin,
};
use etalon_render::Settings;
use etalon_render::probe::{BLOCK, LANES, Lane, LightTree, Lights, NOTHING, Sampled, Selection};
use etalon_stats::{Discrete, Mass, Sample, density};
use glam::Vec3;
use std::sync::Arc;

/// The probability of a light by a tree, at a point with a normal or without.
pub type Pmf = fn(&LightTree, Vec3, Option<Vec3>, usize) -> f32;

/// Numbers of lights.
const COUNTS: [usize; 3] = [10, 200, 10_000];

/// The lights are in the unit cube.
const POINTS: [(&str, Vec3); 2] = [("inside", Vec3::new(0.4, 0.6, 0.3)), ("outside", Vec3::new(3.0, -1.0, 0.5))];
const NORMALS: [(&str, Option<Vec3>); 2] = [("sphere", None), ("normal", Some(Vec3::new(-0.6, 0.8, 0.0)))];

/// The cases.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in COUNTS {
        for (place, point) in POINTS {
            for (side, normal) in NORMALS {
                let name = format!("light/selection/{count}/{place}/{side}");
                cases.push(selection(name, count, point, normal, LightTree::pmf));
            }
        }
    }
    cases
}

/// The light that is chosen at a point, against its probability.
pub fn selection(name: String, count: usize, point: Vec3, normal: Option<Vec3>, pmf: Pmf) -> Case {
    Case::of(name, Discrete { outcomes: count }, move || {
        let lights = Lights::new(lights(count), 1);
        let tree = LightTree::new(&lights.all.iter().filter_map(Sampled::bounds).collect::<Vec<_>>());
        let choose = move |[u]: &[[Lane; 2]; 1], count: usize| {
            let mut chosen = [NOTHING; LANES];
            let mut probability = u[0];
            if let Some(selection) = lights.selection(point, normal) {
                for start in (0..count).step_by(BLOCK) {
                    let block = start..count.min(start + BLOCK);
                    let (light, p) = (&mut chosen[block.clone()], &mut probability[block]);
                    Selection::sample_each(&[selection; BLOCK], light, p);
                }
            }
            let of_lane = |i: usize| {
                let sample = Sample::with_pdf(chosen[i] as usize, f64::from(probability[i]));
                (chosen[i] != NOTHING).then_some(sample)
            };
            (0..count).map(of_lane).collect()
        };
        let pmf = move |light| f64::from(pmf(&tree, point, normal, light));
        (in_lanes(choose), density(pmf).with_mass(Mass::AtMostOne))
    })
}

/// So many lights of all shapes in the unit cube, with sizes and powers over two orders of magnitude.
fn lights(count: usize) -> Vec<Sampled> {
    let random = |i: usize, dimension| Independent::new(1, 0, i as u32).pair(dimension).map(|u| u as f32);
    let (scene, _) = builtin::furnace();
    let mut scene = Scene { objects: Vec::new(), lights: Vec::new(), environment: None, ..scene };
    for i in 0..count {
        let ([x, y], [z, size], [power, turn]) = (random(i, 0), random(i, 1), random(i, 2));
        let (centre, size) = (Vec3::new(x, y, z), 0.1 * 0.01f32.powf(size));
        let radiance = Rgb::splat(0.01f32.powf(power));
        let side = size * Vec3::new(turn.cos(), turn.sin(), 0.0);
        let shape = match i % 4 {
            0 => Some(Shape::Sphere(Sphere { centre, radius: size })),
            1 => Rectangle::new(centre, side, size * Vec3::Z).map(Shape::Rectangle),
            2 => {
                let corners = vec![centre, centre + side, centre + size * Vec3::Z];
                Mesh::new(corners, Vec::new(), vec![[0, 1, 2]]).ok().map(|mesh| Shape::Mesh(Arc::new(mesh)))
            }
            _ => None,
        };
        let visibility = EmitterVisibility::Sampled;
        let emission = Some(Emission { radiance, two_sided: i % 8 < 4, visibility });
        let falloff = Falloff::InverseSquare;
        match shape {
            Some(shape) => {
                scene.objects.push(Object { emission, ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO }) });
            }
            None => scene.lights.push(Light::Point { position: centre, intensity: radiance * size * size, falloff }),
        }
    }
    Sampled::all(&scene, &Settings::default(), &[])
}
