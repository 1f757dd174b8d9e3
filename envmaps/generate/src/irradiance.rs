//! Irradiance in the air of the church, on a coarse grid: windows with their shadows, and light from lit stone.
//!
//! Each grid point keeps the irradiance of six small surfaces that face along ±x, ±y, ±z; any other orientation is
//! their mean weighted by the squared components of its normal, and any other place a linear mix of eight points.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use crate::plan::{Window, windows};
use crate::ray::{Hit, Ray};
use crate::{building, columns, glass, light};

const ORIGIN: DVec3 = DVec3::new(-10.8, 0.4, -14.4);
const STEP: DVec3 = DVec3::new(1.2, 1.7, 1.74);
const COUNT: [usize; 3] = [19, 11, 21];
/// Rays per grid point for light from stone.
const RAYS: u32 = 48;
/// Light goes on bouncing after the one bounce that is traced.
const LATER_BOUNCES: f64 = 1.2;
/// Points inside stone are filled from their neighbours and count this much.
const FILLED: f32 = 0.02;

type Cube = [Vec3A; 6];

const DARK: Cube = [Vec3A::ZERO; 6];

/// The grid.
pub struct Irradiance {
    cubes: Vec<Cube>,
    weights: Vec<f32>,
}

/// A part of a window, as a source.
struct Patch {
    p: DVec3,
    inward: DVec3,
    /// Radiance times area.
    power: DVec3,
}

impl Irradiance {
    /// Light that comes straight from the windows.
    pub fn by_windows() -> Self {
        let patches: Vec<Patch> = windows().iter().flat_map(patches).collect();
        Self::fill(|p| direct(p, &patches))
    }

    /// Light from stone of the given radiance.
    pub fn bounce(&self, radiance: impl Fn(&Hit) -> DVec3 + Sync) -> Self {
        Self::fill(|p| gather(p, &radiance).map(|face| face * LATER_BOUNCES))
    }

    pub fn add(&mut self, other: &Self) {
        for (cube, more) in self.cubes.iter_mut().zip(&other.cubes) {
            for (face, more) in cube.iter_mut().zip(more) {
                *face += *more;
            }
        }
    }

    /// Irradiance of a surface at `p` with normal `n`.
    pub fn at(&self, p: DVec3, n: DVec3) -> DVec3 {
        // Looked up a little off the wall, where the grid is not yet inside it.
        let g = (p + n * 0.35 - ORIGIN) / STEP;
        let top = DVec3::new((COUNT[0] - 1) as f64, (COUNT[1] - 1) as f64, (COUNT[2] - 1) as f64);
        let g = g.clamp(DVec3::ZERO, top - 1e-6);
        let base = [g.x as usize, g.y as usize, g.z as usize];
        let f = g - DVec3::new(base[0] as f64, base[1] as f64, base[2] as f64);
        let faces = [usize::from(n.x < 0.0), 2 + usize::from(n.y < 0.0), 4 + usize::from(n.z < 0.0)];
        let (share, f) = ((n * n).as_vec3(), f.as_vec3());
        let (mut sum, mut weight) = (Vec3A::ZERO, 0.0);
        for corner in 0..8 {
            let [i, j, k] = [corner & 1, (corner >> 1) & 1, corner >> 2];
            let at = index(base[0] + i, base[1] + j, base[2] + k);
            let side = |far: usize, f: f32| if far == 1 { f } else { 1.0 - f };
            let w = side(i, f.x) * side(j, f.y) * side(k, f.z) * self.weights[at];
            let cube = &self.cubes[at];
            sum += (cube[faces[0]] * share.x + cube[faces[1]] * share.y + cube[faces[2]] * share.z) * w;
            weight += w;
        }
        sum.as_dvec3() / f64::from(weight.max(1e-9))
    }

    /// Evaluates `light` at the points in the air. Points inside stone get the mean of their lit neighbours, in two
    /// rounds so that thick walls are filled too.
    fn fill(light: impl Fn(DVec3) -> [DVec3; 6] + Sync) -> Self {
        let total = COUNT.iter().product();
        let air: Vec<bool> = (0..total).map(|i| building::contains(place(i))).collect();
        let mut cubes: Vec<Cube> = (0..total)
            .into_par_iter()
            .map(|i| if air[i] { light(place(i)).map(|face| face.as_vec3a()) } else { DARK })
            .collect();
        let mut known = air.clone();
        for _ in 0..2 {
            let before = known.clone();
            for at in (0..total).filter(|&at| !before[at]) {
                let near: Vec<usize> = neighbours(at).filter(|&n| before[n]).collect();
                if !near.is_empty() {
                    cubes[at] = std::array::from_fn(|face| {
                        near.iter().map(|&n| cubes[n][face]).sum::<Vec3A>() / near.len() as f32
                    });
                    known[at] = true;
                }
            }
        }
        Self { cubes, weights: air.iter().map(|&air| if air { 1.0 } else { FILLED }).collect() }
    }
}

fn index(i: usize, j: usize, k: usize) -> usize {
    (k * COUNT[1] + j) * COUNT[0] + i
}

fn split(at: usize) -> [usize; 3] {
    [at % COUNT[0], at / COUNT[0] % COUNT[1], at / COUNT[0] / COUNT[1]]
}

fn place(at: usize) -> DVec3 {
    let [i, j, k] = split(at);
    ORIGIN + DVec3::new(i as f64, j as f64, k as f64) * STEP
}

fn neighbours(at: usize) -> impl Iterator<Item = usize> {
    let here = split(at);
    (0..6).filter_map(move |face| {
        let mut there = here;
        let axis = face / 2;
        if face % 2 == 0 {
            there[axis] = here[axis].checked_sub(1)?;
        } else if here[axis] + 1 < COUNT[axis] {
            there[axis] += 1;
        } else {
            return None;
        }
        Some(index(there[0], there[1], there[2]))
    })
}

/// Splits a window into pieces about as wide as high.
fn patches(window: &Window) -> Vec<Patch> {
    let (half, low, high) = window.kind.bounds();
    let rows = ((high - low) / (2.0 * half)).round().max(1.0);
    let columns = if rows == 1.0 { 2.0 } else { 1.0 };
    let radiance = glass::mean_transmittance(window) * light::sky(window.kind, window.number);
    let (width, height) = (2.0 * half / columns, (high - low) / rows);
    // A pointed outline fills about this part of its box.
    let power = radiance * (0.85 * width * height);
    let depth = window.kind.recess().map_or(0.0, |r| r.depth);
    let mut all = Vec::new();
    for i in 0..(rows * columns) as u32 {
        let (column, row) = (f64::from(i) % columns, (f64::from(i) / columns).floor());
        let q = DVec3::new(width * (column + 0.5) - half, low + height * (row + 0.5), depth);
        all.push(Patch { p: window.frame.world(q), inward: -window.frame.out, power });
    }
    all
}

/// Irradiance by the windows, with shadows of walls and piers.
fn direct(p: DVec3, patches: &[Patch]) -> [DVec3; 6] {
    let mut cube = [DVec3::ZERO; 6];
    for patch in patches {
        let w = patch.p - p;
        let dd = w.length_squared();
        let distance = dd.sqrt();
        let d = w / distance;
        let cosine = -d.dot(patch.inward);
        if cosine <= 0.0 {
            continue;
        }
        let ray = Ray { o: p, d };
        if building::trace(&ray).t < distance - 0.5 || columns::trace(&ray, distance).is_some() {
            continue;
        }
        add(&mut cube, d, patch.power * (cosine / (dd + 1.0)));
    }
    cube
}

/// Irradiance by lit stone, from rays spread uniformly over the sphere.
fn gather(p: DVec3, reflected: impl Fn(&Hit) -> DVec3) -> [DVec3; 6] {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let mut cube = [DVec3::ZERO; 6];
    for i in 0..RAYS {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(RAYS);
        let (s, c) = libm::sincos(GOLDEN_ANGLE * f64::from(i));
        let r = (1.0 - y * y).sqrt();
        let d = DVec3::new(r * c, y, r * s);
        let ray = Ray { o: p, d };
        let shell = building::trace(&ray);
        let hit = columns::trace(&ray, shell.t).unwrap_or(shell);
        add(&mut cube, d, reflected(&hit) * (4.0 * std::f64::consts::PI / f64::from(RAYS)));
    }
    cube
}

/// Adds light from direction `d` to the faces that it reaches.
fn add(cube: &mut [DVec3; 6], d: DVec3, light: DVec3) {
    for axis in 0..3 {
        cube[2 * axis + usize::from(d[axis] < 0.0)] += light * d[axis].abs();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_light_the_walls_that_face_them() {
        let light = Irradiance::by_windows();
        let at = |p: [f64; 3], n: DVec3| light.at(DVec3::from_array(p), n).element_sum();
        // The north wall of the nave faces the south clerestory; a floor sees more window than a vault does.
        assert!(at([5.9, 9.0, 0.0], DVec3::NEG_X) > 0.0);
        assert!(at([0.0, 0.0, 0.0], DVec3::Y) > 2.0 * at([0.0, 0.5, 0.0], DVec3::NEG_Y));
        // Before the apse, what faces its tall windows is brighter than what turns its back on them.
        assert!(at([0.0, 3.0, 11.0], DVec3::Z) > 2.0 * at([0.0, 3.0, 11.0], DVec3::NEG_Z));
    }

    #[test]
    fn stone_of_even_radiance_gives_even_light() {
        // Inside a closed room of radiance 1 the irradiance is π on every side.
        let cube = gather(DVec3::new(0.0, 3.0, 0.0), |_| DVec3::ONE);
        for face in cube {
            assert!((face.x / std::f64::consts::PI - 1.0).abs() < 0.03, "{face}");
        }
    }
}
