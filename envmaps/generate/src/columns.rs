//! What stands or hangs in the church and is round: piers, vault shafts, chandeliers; and the altar, which is a box.

use glam::DVec3;

use crate::plan::{BAY, END, WALL};
use crate::ray::{Hit, Ray, Surface};

/// An upright cylinder with flat ends.
struct Drum {
    x: f64,
    z: f64,
    radius: f64,
    low: f64,
    high: f64,
    surface: Surface,
}

const fn drum(x: f64, z: f64, radius: f64, low: f64, high: f64) -> Drum {
    Drum { x, z, radius, low, high, surface: Surface::Column }
}

/// The middle of the nave wall, where the piers stand.
const PIER: f64 = 6.5;
const PIER_REACH: f64 = 0.86;
/// A pier around its own axis: plinth, base, core with four shafts, capital.
const PIER_DRUMS: [Drum; 9] = [
    drum(0.0, 0.0, PIER_REACH, 0.0, 0.3),
    drum(0.0, 0.0, 0.76, 0.3, 0.5),
    drum(0.0, 0.0, 0.48, 0.5, 3.3),
    drum(0.53, 0.0, 0.19, 0.5, 3.3),
    drum(-0.53, 0.0, 0.19, 0.5, 3.3),
    drum(0.0, 0.53, 0.19, 0.5, 3.3),
    drum(0.0, -0.53, 0.19, 0.5, 3.3),
    drum(0.0, 0.0, 0.74, 3.3, 3.5),
    drum(0.0, 0.0, PIER_REACH, 3.5, 3.72),
];
/// The three shafts that carry the ribs, and their capital, around a point of the nave wall's face.
const SHAFT_REACH: f64 = 0.48;
const SHAFT_DRUMS: [Drum; 4] = [
    drum(-0.1, 0.0, 0.17, 3.7, 11.3),
    drum(0.0, 0.3, 0.15, 3.7, 11.3),
    drum(0.0, -0.3, 0.15, 3.7, 11.3),
    drum(0.05, 0.0, SHAFT_REACH, 11.3, 11.55),
];

/// Chandeliers hang over the axis at these z.
pub const CHANDELIERS: [f64; 2] = [-4.0, 3.5];
pub const CHANDELIER_RADIUS: f64 = 0.85;
pub const CHANDELIER_HEIGHT: f64 = 6.2;
pub const CANDLES: usize = 10;
/// Sine and cosine of the multiples of 36°, where the candles stand on the ring.
pub const CIRCLE: [(f64, f64); CANDLES] = {
    const S1: f64 = 0.587_785_252_292_473_1;
    const C1: f64 = 0.809_016_994_374_947_5;
    const S2: f64 = 0.951_056_516_295_153_5;
    const C2: f64 = 0.309_016_994_374_947_45;
    [(0.0, 1.0), (S1, C1), (S2, C2), (S2, -C2), (S1, -C1), (0.0, -1.0), (-S1, -C1), (-S2, -C2), (-S2, C2), (-S1, C1)]
};

/// Half the size of the altar, its middle along z, its height.
pub const ALTAR: (f64, f64, f64, f64) = (1.5, 0.5, END + 2.4, 1.2);

/// The first round thing (or the altar) along the ray before `limit`.
pub fn trace(ray: &Ray, limit: f64) -> Option<Hit> {
    let mut best = Best { ray, limit, hit: None };
    for side in [-1.0, 1.0] {
        row(&mut best, side * PIER, PIER_REACH, (0.0, 3.72), &PIER_DRUMS);
        row(&mut best, side * WALL, SHAFT_REACH, (3.7, 11.55), &SHAFT_DRUMS);
    }
    for z in CHANDELIERS {
        chandelier(&mut best, z);
    }
    altar(&mut best);
    best.hit
}

struct Best<'a> {
    ray: &'a Ray,
    limit: f64,
    hit: Option<Hit>,
}

impl Best<'_> {
    fn offer(&mut self, t: f64, n: DVec3, surface: Surface) {
        if t > 1e-6 && t < self.limit {
            self.limit = t;
            self.hit = Some(self.ray.hit(t, n, surface));
        }
    }

    /// The interval of the ray, up to the limit, in which the coordinate lies in `low..high`; `None` when empty.
    fn clip(&self, axis: usize, low: f64, high: f64, within: (f64, f64)) -> Option<(f64, f64)> {
        let (o, d) = (self.ray.o[axis], self.ray.d[axis]);
        if d == 0.0 {
            return (o > low && o < high).then_some(within);
        }
        let (a, b) = ((low - o) / d, (high - o) / d);
        let (start, end) = (within.0.max(a.min(b)), within.1.min(a.max(b)));
        (start < end).then_some((start, end))
    }

    fn whole(&self) -> (f64, f64) {
        (0.0, self.limit)
    }
}

/// A row of equal groups of drums along the nave, one at each bay's border.
fn row(best: &mut Best, x: f64, reach: f64, heights: (f64, f64), drums: &[Drum]) {
    let Some(inside) = best.clip(1, heights.0, heights.1, best.whole()) else { return };
    let Some((start, end)) = best.clip(0, x - reach, x + reach, inside) else { return };
    let (z0, z1) = (best.ray.at(start).z, best.ray.at(end).z);
    let first = ((z0.min(z1) - reach + END) / BAY).ceil().max(0.0);
    let last = ((z0.max(z1) + reach + END) / BAY).min(2.0 * END / BAY);
    let mut border = first;
    while border <= last {
        group(best, x, BAY * border - END, drums);
        border += 1.0;
    }
}

fn group(best: &mut Best, x: f64, z: f64, drums: &[Drum]) {
    for d in drums {
        cylinder(best, &Drum { x: x + d.x * x.signum(), z: z + d.z, ..*d });
    }
}

fn cylinder(best: &mut Best, drum: &Drum) {
    let (o, d) = (best.ray.o, best.ray.d);
    let (x, z) = (o.x - drum.x, o.z - drum.z);
    let a = d.x * d.x + d.z * d.z;
    let b = x * d.x + z * d.z;
    let root = b * b - a * (x * x + z * z - drum.radius * drum.radius);
    if root <= 0.0 {
        return;
    }
    let t = (-b - root.sqrt()) / a;
    let y = o.y + t * d.y;
    if y >= drum.low && y <= drum.high {
        let n = DVec3::new((x + t * d.x) / drum.radius, 0.0, (z + t * d.z) / drum.radius);
        best.offer(t, n, drum.surface);
        return;
    }
    let (cap, n) = if d.y < 0.0 { (drum.high, DVec3::Y) } else { (drum.low, DVec3::NEG_Y) };
    let t = (cap - o.y) / d.y;
    let (x, z) = (x + t * d.x, z + t * d.z);
    if x * x + z * z < drum.radius * drum.radius {
        best.offer(t, n, drum.surface);
    }
}

/// A hoop of gilded iron on a chain, with candles on it.
fn chandelier(best: &mut Best, z: f64) {
    const REACH: f64 = CHANDELIER_RADIUS + 0.06;
    let Some(inside) = best.clip(2, z - REACH, z + REACH, best.whole()) else { return };
    let Some((start, end)) = best.clip(0, -REACH, REACH, inside) else { return };
    let (y0, y1) = (best.ray.at(start).y, best.ray.at(end).y);
    let hoop = CHANDELIER_HEIGHT;
    if y0.max(y1) < hoop - 0.3 {
        return;
    }
    if y0.min(y1) < hoop + 0.5 {
        for radius in [CHANDELIER_RADIUS, 0.3] {
            hoop_band(best, z, radius, hoop - 0.07, hoop + 0.07);
        }
        for (s, c) in CIRCLE {
            let (x, z) = (CHANDELIER_RADIUS * s, z + CHANDELIER_RADIUS * c);
            cylinder(best, &Drum { x, z, radius: 0.035, low: hoop, high: hoop + 0.25, surface: Surface::Wax });
        }
    }
    cylinder(best, &Drum { x: 0.0, z, radius: 0.03, low: hoop - 0.25, high: 18.5, surface: Surface::Iron });
}

/// A thin band seen from both sides.
fn hoop_band(best: &mut Best, z: f64, radius: f64, low: f64, high: f64) {
    let (o, d) = (best.ray.o, best.ray.d);
    let (x, z) = (o.x, o.z - z);
    let a = d.x * d.x + d.z * d.z;
    let b = x * d.x + z * d.z;
    let root = b * b - a * (x * x + z * z - radius * radius);
    if root <= 0.0 {
        return;
    }
    for sign in [-1.0, 1.0] {
        let t = (sign * root.sqrt() - b) / a;
        let y = o.y + t * d.y;
        if y > low && y < high {
            let n = DVec3::new(x + t * d.x, 0.0, z + t * d.z) * (-sign / radius);
            best.offer(t, n, Surface::Iron);
        }
    }
}

fn altar(best: &mut Best) {
    let (half_x, half_z, z, height) = ALTAR;
    let Some(a) = best.clip(0, -half_x, half_x, best.whole()) else { return };
    let Some(b) = best.clip(1, 0.0, height, a) else { return };
    let Some((t, _)) = best.clip(2, z - half_z, z + half_z, b) else { return };
    if t <= 0.0 {
        return;
    }
    let d = best.ray.d;
    let n = if t > b.0 {
        DVec3::NEG_Z * d.z.signum()
    } else if t > a.0 {
        DVec3::NEG_Y * d.y.signum()
    } else {
        DVec3::NEG_X * d.x.signum()
    };
    best.offer(t, n, Surface::Altar);
}
