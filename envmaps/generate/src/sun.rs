//! The sun through the south windows: coloured patches where it lands, and beams in the hazy air.

use glam::{DVec2, DVec3};

use crate::arch::Recess;
use crate::glass;
use crate::plan::{self, AISLE_WINDOW, CLERESTORY, Kind, OUTER_BAYS, OUTER_WALL, WALL};
use crate::ray::Ray;

/// Towards the sun: before noon, and so high that its patches reach the floor of the nave.
const DIRECTION: DVec3 = DVec3::new(-0.66, 1.0, 0.32);
/// Length of [`DIRECTION`].
const LENGTH: f64 = 1.240_161_280_087_226_6;
/// Irradiance of the sun across its beam, before the glass.
const STRENGTH: DVec3 = DVec3::new(2.7, 2.5, 2.2);
/// Radiance that a metre of air scatters out of a beam, as part of the beam's irradiance.
const HAZE: f64 = 0.0007;
/// Cell of the slides, and how many cells their colours run into each other on the way down: the sun is half a
/// degree wide, and old glass uneven.
const CELL: f64 = 0.06;
const BLUR: i32 = 1;

/// The sun, with a slide for each window that its light passes.
pub struct Sun {
    clerestory: Vec<Slide>,
    aisle: Vec<Slide>,
}

/// The light that a window lets through towards the floor, on a grid over its pane.
struct Slide {
    corner: DVec2,
    width: usize,
    cells: Vec<DVec3>,
    mean: DVec3,
}

/// How much brighter than the plain sky the glass of a south window looks along `view`: light scattered forwards.
pub fn glare(view: DVec3) -> DVec3 {
    let off = 1.0 - view.dot(DIRECTION) / LENGTH;
    DVec3::ONE + STRENGTH * (4.0 * libm::exp(-off / 0.006) + 0.7 * libm::exp(-off / 0.05))
}

impl Sun {
    pub fn new() -> Self {
        let slides =
            |kind, shape: &Recess| (-OUTER_BAYS..=OUTER_BAYS).map(|bay| Slide::new(kind, shape, bay)).collect();
        Self { clerestory: slides(Kind::Clerestory, &CLERESTORY), aisle: slides(Kind::Aisle, &AISLE_WINDOW) }
    }

    /// Irradiance at `p` on a surface with normal `n`.
    pub fn irradiance(&self, p: DVec3, n: DVec3) -> DVec3 {
        let cosine = n.dot(DIRECTION) / LENGTH;
        if cosine <= 0.0 || p.x > WALL + 0.3 {
            return DVec3::ZERO;
        }
        let (slides, pane) = if p.x > -WALL - 0.3 {
            (&self.clerestory, -WALL - CLERESTORY.depth)
        } else {
            (&self.aisle, -OUTER_WALL - AISLE_WINDOW.depth)
        };
        let q = towards_sun(p, pane);
        let bay = plan::bay(q.x);
        let light = slides[(bay + OUTER_BAYS) as usize].at(q - DVec2::new(plan::bay_z(bay), 0.0));
        light * STRENGTH * cosine
    }

    /// Light that the air of the nave scatters out of the beams towards the ray's origin.
    pub fn beams(&self, ray: &Ray, limit: f64) -> DVec3 {
        let start = towards_sun(ray.o, -WALL);
        let step = towards_sun(ray.at(1.0), -WALL) - start;
        let half = CLERESTORY.outline.half - 0.2;
        let (top, bottom) = (CLERESTORY.outline.apex() - 0.6, CLERESTORY.sill);
        let between = |o: f64, d: f64, low: f64, high: f64| {
            let (a, b) = ((low - o) / d, (high - o) / d);
            (a.min(b), a.max(b))
        };
        let (low, high) = between(start.y, step.y, bottom, top);
        let (low, high) = (low.max(0.0), high.min(limit));
        let mut sum = DVec3::ZERO;
        if low < high {
            for (bay, slide) in (-OUTER_BAYS..).zip(&self.clerestory) {
                let z = plan::bay_z(bay);
                let (near, far) = between(start.x, step.x, z - half, z + half);
                sum += slide.mean * (far.min(high) - near.max(low)).max(0.0);
            }
        }
        sum * STRENGTH * HAZE
    }
}

/// (z, height) at which the line from `p` to the sun crosses the plane at `x`.
fn towards_sun(p: DVec3, x: f64) -> DVec2 {
    let t = (x - p.x) / DIRECTION.x;
    DVec2::new(p.z + t * DIRECTION.z, p.y + t * DIRECTION.y)
}

impl Slide {
    fn new(kind: Kind, shape: &Recess, bay: i32) -> Self {
        let margin = CELL * f64::from(2 * BLUR + 1);
        let corner = DVec2::new(-shape.outline.half - margin, shape.sill - margin);
        let size = DVec2::new(shape.outline.half, shape.outline.apex()) + margin - corner;
        let (width, height) = ((size.x / CELL) as usize, (size.y / CELL) as usize);
        // Light must also clear the sill and the far jamb of the recess.
        let inner = DVec2::new(DIRECTION.z, DIRECTION.y) / DIRECTION.x * shape.depth;
        let cell = |i: usize| {
            let q = corner + DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5) * CELL;
            let free = shape.contains(q.x, q.y) && shape.contains(q.x + inner.x, q.y + inner.y);
            let light = free.then(|| glass::transmittance(kind, plan::number(-1.0, bay), q)).flatten();
            light.unwrap_or(DVec3::ZERO)
        };
        let mut cells: Vec<DVec3> = (0..width * height).map(cell).collect();
        // Two runs of a box along each axis: nearly a bell.
        for stride in [1, width, 1, width] {
            cells = (0..cells.len() as i32)
                .map(|i| {
                    let near = (-BLUR..=BLUR).filter_map(|k| cells.get((i + k * stride as i32) as usize));
                    near.sum::<DVec3>() / f64::from(2 * BLUR + 1)
                })
                .collect();
        }
        let mean = cells.iter().sum::<DVec3>() / cells.len() as f64;
        Self { corner, width, cells, mean }
    }

    /// The light at a point of the pane, linear between cells; none outside.
    fn at(&self, q: DVec2) -> DVec3 {
        let g = (q - self.corner) / CELL - 0.5;
        let base = g.floor();
        let height = self.cells.len() / self.width;
        if base.min_element() < 0.0 || base.x + 1.0 >= self.width as f64 || base.y + 1.0 >= height as f64 {
            return DVec3::ZERO;
        }
        let f = g - base;
        let i = base.y as usize * self.width + base.x as usize;
        let row = |i: usize| self.cells[i].lerp(self.cells[i + 1], f.x);
        row(i).lerp(row(i + self.width), f.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_lays_coloured_patches_on_the_floor_and_nothing_behind_the_north_wall() {
        let sun = Sun::new();
        let (mut lit, mut coloured, mut total) = (0, 0, 0);
        for i in 0..100 {
            for j in 0..100 {
                let p = DVec3::new(-5.5 + 0.11 * f64::from(i), 0.0, -14.0 + 0.28 * f64::from(j));
                let light = sun.irradiance(p, DVec3::Y);
                assert!(light.min_element() >= 0.0 && light.max_element() < 5.0, "{p}: {light}");
                total += 1;
                lit += i32::from(light.max_element() > 0.05);
                coloured += i32::from(light.max_element() > 0.05 && light.max_element() > 2.0 * light.min_element());
            }
        }
        assert!(lit * 20 > total && lit * 2 < total, "{lit} of {total}");
        assert!(coloured * 2 > lit, "{coloured} of {lit}");
        assert_eq!(sun.irradiance(DVec3::new(8.0, 0.0, 0.0), DVec3::Y), DVec3::ZERO);
        assert_eq!(sun.irradiance(DVec3::new(2.0, 1.0, 0.0), DVec3::NEG_Y), DVec3::ZERO);
    }
}
