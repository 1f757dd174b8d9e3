//! Unit tests of the light tree.

use super::*;
use crate::Settings;
use crate::light_sample::SampleLight;
use crate::lights::SampledLight;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{Emission, Material, Object, Rectangle, Scene, Shape, Sphere, builtin};
use etalon_stats::{Directions, Pole};

/// Random numbers from 0 to 1, and directions.
struct Random {
    index: u32,
}

impl Random {
    fn pair(&mut self) -> [f32; 2] {
        self.index += 1;
        Independent::new(5, 0, self.index).pair(0).map(|u| (u * 16_777_216.0).floor() as f32 / 16_777_216.0)
    }

    fn place(&mut self) -> Vec3 {
        let ([x, y], [z, _]) = (self.pair(), self.pair());
        Vec3::new(x, y, z)
    }

    fn direction(&mut self) -> Vec3 {
        let u = self.pair().map(f64::from);
        Vec3::from(Directions::sphere(Pole::Z).direction_at(u).map(|x| x as f32)).normalize()
    }
}

/// A rectangle that emits: centre, half sides, and what the tree knows of it.
struct Panel {
    centre: Vec3,
    half: [Vec3; 2],
    bounds: LightBounds,
}

impl Panel {
    fn new(centre: Vec3, axis: Vec3, half: [f32; 2], intensity: f32, two_sided: bool) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        let half = [x * half[0], y * half[1]];
        let extent = half[0].abs() + half[1].abs();
        let (min, max) = (centre - extent, centre + extent);
        Self { centre, half, bounds: LightBounds { min, max, intensity, axis, cos_o: 1.0, cos_e: 0.0, two_sided } }
    }

    /// Whether light from a corner or the middle reaches the point on the normal's side, beyond doubt.
    fn reaches(&self, point: Vec3, normal: Option<Vec3>) -> bool {
        let [x, y] = self.half;
        [Vec3::ZERO, x + y, x - y, y - x, -x - y].iter().any(|offset| {
            let to = (self.centre + offset).as_dvec3() - point.as_dvec3();
            let cos = -to.dot(self.bounds.axis.as_dvec3());
            let cos = if self.bounds.two_sided { cos.abs() } else { cos };
            cos > 0.0 && normal.is_none_or(|normal| to.dot(normal.as_dvec3()) > 0.0)
        })
    }
}

fn panels(count: usize, random: &mut Random) -> Vec<Panel> {
    (0..count)
        .map(|i| {
            let half = random.pair().map(|side| 0.5 * side.powi(4));
            let [intensity, _] = random.pair();
            Panel::new(4.0 * random.place(), random.direction(), half, 0.1 + intensity, i % 5 == 0)
        })
        .collect()
}

fn tree(panels: &[Panel]) -> LightTree {
    LightTree::new(&panels.iter().map(|panel| panel.bounds).collect::<Vec<_>>())
}

/// A light without extent that emits in all directions.
fn bulb(position: Vec3, intensity: f32) -> LightBounds {
    LightBounds { min: position, max: position, intensity, axis: Vec3::Z, cos_o: -1.0, cos_e: 0.0, two_sided: false }
}

#[test]
fn probabilities_sum_to_one_where_every_light_reaches_the_point() {
    let mut random = Random { index: 0 };
    let lights: Vec<_> = (0..1000).map(|_| bulb(random.place(), random.pair()[0])).collect();
    let tree = LightTree::new(&lights);
    for _ in 0..50 {
        let point = 2.0 * random.place();
        let sum: f64 = (0..1000).map(|i| f64::from(tree.at(point, None).pmf(i))).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{point}: {sum}");
    }
}

#[test]
fn a_light_that_reaches_the_point_can_be_sampled() {
    let mut random = Random { index: 0 };
    for count in [1, 8, 300] {
        let panels = panels(count, &mut random);
        let tree = tree(&panels);
        for round in 0..60_000 / count {
            let normal = (round % 3 != 0).then(|| random.direction());
            // Points anywhere, in the plane of a light, and on a light.
            let panel = &panels[round % count];
            let [x, y] = random.pair().map(|u| if round % 4 == 1 { 20.0 * u - 10.0 } else { 2.0 * u - 1.0 });
            let in_plane = panel.centre + x * panel.half[0] + y * panel.half[1];
            let point = if round % 2 == 0 { 6.0 * random.place() - 1.0 } else { in_plane };
            for (i, panel) in (0..).zip(&panels) {
                let pmf = tree.at(point, normal).pmf(i);
                assert!(pmf > 0.0 || !panel.reaches(point, normal), "{count} {round} {i}");
            }
        }
    }
}

#[test]
fn lights_that_do_not_reach_the_point_are_not_sampled() {
    let up = Panel::new(Vec3::ZERO, Vec3::Z, [0.1, 0.1], 1.0, false);
    let tree = tree(&[up, Panel::new(4.0 * Vec3::X, Vec3::Z, [0.1, 0.1], 1.0, true)]);
    let below = -Vec3::Z;
    assert_eq!(tree.at(below, None).pmf(0), 0.0);
    assert_eq!(tree.at(below, Some(Vec3::Z)).pmf(1), 1.0);
    assert_eq!(tree.at(below, Some(-Vec3::Z)).sample(0.5), None);
}

#[test]
fn importances_of_small_lights_are_their_contributions() {
    let (point, normal) = (Vec3::ZERO, Vec3::Y);
    let panels = [
        Panel::new(Vec3::new(0.0, 2.0, 0.0), -Vec3::Y, [1e-4; 2], 1.0, false),
        Panel::new(Vec3::new(3.0, 3.0, 0.0), -Vec3::Y, [1e-4; 2], 5.0, false),
        Panel::new(Vec3::new(0.0, 1.0, -2.0), Vec3::Z, [1e-4; 2], 0.5, false),
    ];
    // Power times both cosines over the squared distance.
    let expected = [1.0 / 4.0, 5.0 * 0.5 / 18.0, 0.5 * (2.0 / 5.0) / 5.0];
    let tree = tree(&panels);
    for i in 0..3 {
        let pmf = tree.at(point, Some(normal)).pmf(i as u32) * expected.iter().sum::<f32>();
        assert!((pmf / expected[i] - 1.0).abs() < 1e-3, "{i}: {pmf} {}", expected[i]);
    }
}

#[test]
fn each_light_has_one_interval_of_u() {
    let mut random = Random { index: 0 };
    let tree = tree(&panels(200, &mut random));
    let point = 4.0 * random.place();
    let mut lights: Vec<_> =
        (0..=u16::MAX).filter_map(|i| tree.at(point, None).sample(f32::from(i) / 65_536.0)).collect();
    lights.dedup();
    let runs = lights.len();
    lights.sort_by_key(|sample| sample.0);
    lights.dedup();
    assert_eq!((runs, lights.len() > 50), (lights.len(), true));
}

#[test]
fn bounds_of_area_lights_hold_what_they_emit() {
    let (scene, _) = builtin::furnace();
    let rectangle = Rectangle::new(Vec3::ONE, Vec3::new(0.5, 0.0, 0.5), Vec3::new(0.0, 0.25, 0.0)).unwrap();
    let sphere = Shape::Sphere(Sphere { centre: -Vec3::ONE, radius: 0.5 });
    let objects = [Shape::Rectangle(rectangle), sphere].map(|shape| Object {
        emission: Some(Emission::of_front(Rgb::ONE)),
        ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO })
    });
    let scene = Scene { objects: objects.into(), lights: Vec::new(), environment: None, ..scene };
    let lights = SampledLight::all(&scene, &Settings::default(), &[]);
    let bounds: Vec<_> = lights.iter().map(|light| light.bounds().unwrap()).collect();
    let intensities = [0.5f32.sqrt(), std::f32::consts::PI / 4.0];
    assert!(bounds.iter().zip(intensities).all(|(bounds, expected)| (bounds.intensity / expected - 1.0).abs() < 1e-6));
    let (tree, mut random) = (LightTree::new(&bounds), Random { index: 0 });
    for _ in 0..2000 {
        let (point, normal) = (4.0 * random.place() - 2.0, random.direction());
        for (i, light) in (0..).zip(&lights) {
            let sample = light.sample(point, random.pair());
            let arrives = sample.weight != Rgb::ZERO && sample.wi.dot(normal) > 0.0;
            assert!(!arrives || tree.at(point, Some(normal)).pmf(i) > 0.0, "{i} {point} {normal}");
        }
    }
}

#[test]
fn degenerate_lights() {
    assert_eq!(LightTree::new(&[]).at(Vec3::ZERO, None).sample(0.5), None);
    assert_eq!(LightTree::new(&[bulb(Vec3::X, 0.0)]).at(Vec3::ZERO, None).sample(0.5), None);
    let at_one_place = |count: usize| vec![bulb(Vec3::ONE, 1.0); count];
    let on_a_line = (0..5000).map(|i| bulb((i as f32).exp2().min(1e17) * Vec3::X, 1.0)).collect();
    let of_any_intensity = (0..60u8).map(|i| bulb(f32::from(i) * Vec3::Y, 10f32.powi(i32::from(i) - 30))).collect();
    let some_dark = (0..100u8).map(|i| bulb(f32::from(i) * Vec3::Z, f32::from(i % 2))).collect();
    for lights in [at_one_place(9), at_one_place(100_000), on_a_line, of_any_intensity, some_dark] {
        let tree = LightTree::new(&lights);
        for point in [Vec3::ZERO, Vec3::ONE, Vec3::splat(1e17), Vec3::splat(1e-20)] {
            for u in [0.0, 0.1, 0.5, 1.0 - f32::EPSILON / 2.0] {
                let (light, probability) = tree.at(point, None).sample(u).unwrap();
                assert!(lights[light as usize].intensity > 0.0 && probability > 0.0 && probability <= 1.0);
                assert_eq!(tree.at(point, None).pmf(light), probability);
            }
            let excluded = (0..lights.len()).filter(|i| tree.at(point, None).pmf(*i as u32) == 0.0);
            assert!(excluded.into_iter().all(|i| lights[i].intensity == 0.0));
        }
    }
}
