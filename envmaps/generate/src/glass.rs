//! Stained glass: what each window lets through at a point, and where its stone tracery is.

use glam::{DVec2, DVec3};

use crate::arch::Pointed;
use crate::plan::{Kind, ROSE_HEIGHT, ROSE_RADIUS, Window};

/// Pot-metal glass: linear RGB transmittance of a sheet of middling thickness, so that thin ones let through more.
const COBALT: DVec3 = DVec3::new(0.03, 0.15, 0.95);
const SKY: DVec3 = DVec3::new(0.16, 0.50, 0.95);
const RUBY: DVec3 = DVec3::new(0.85, 0.035, 0.03);
const AMBER: DVec3 = DVec3::new(1.0, 0.52, 0.07);
const EMERALD: DVec3 = DVec3::new(0.05, 0.60, 0.20);
const VIOLET: DVec3 = DVec3::new(0.42, 0.12, 0.62);
const PEARL: DVec3 = DVec3::new(1.0, 0.93, 0.78);
const LEAD: DVec3 = DVec3::new(0.006, 0.005, 0.005);

/// What a glazier took from the shelf: grounds, and colours of the figures in the medallions.
struct Shelf {
    grounds: [DVec3; 4],
    robes: [DVec3; 8],
}

/// As was the custom: cold colours towards the north, warm ones towards the sun, all of them at the ends.
const COLD: Shelf =
    Shelf { grounds: [COBALT, SKY, COBALT, VIOLET], robes: [SKY, EMERALD, PEARL, COBALT, SKY, RUBY, VIOLET, EMERALD] };
const WARM: Shelf =
    Shelf { grounds: [AMBER, RUBY, EMERALD, RUBY], robes: [AMBER, RUBY, PEARL, AMBER, EMERALD, AMBER, SKY, PEARL] };
const MIXED: Shelf = Shelf {
    grounds: [COBALT, COBALT, RUBY, COBALT],
    robes: [RUBY, AMBER, EMERALD, PEARL, SKY, EMERALD, VIOLET, AMBER],
};

impl Shelf {
    fn of(kind: Kind, number: i32) -> &'static Self {
        match kind {
            Kind::Clerestory | Kind::Aisle if number & 1 == 0 => &WARM,
            Kind::Clerestory | Kind::Aisle => &COLD,
            _ => &MIXED,
        }
    }

    fn robe(&self, keys: [i32; 3]) -> DVec3 {
        self.robes[(chance(keys) * 8.0) as usize]
    }
}

/// Width of a lead came, with the paint along it.
const CAME: f64 = 0.045;
/// Width of the border of a light, between its cames.
const BORDER: f64 = 0.15;

/// Hashes a few small integers to [0, 1).
pub fn chance(keys: [i32; 3]) -> f64 {
    let mut h = 0x2545_f491_u32;
    for k in keys {
        h = (h ^ k as u32).wrapping_mul(0x9e37_79b1);
        h = (h ^ (h >> 15)).wrapping_mul(0x85eb_ca77);
        h ^= h >> 13;
    }
    f64::from(h >> 8) / f64::from(1 << 24)
}

/// Transmittance of the window at `q` (across, height); `None` where the stone of the tracery stands.
pub fn transmittance(kind: Kind, number: i32, q: DVec2) -> Option<DVec3> {
    let seed = number + 16 * kind as i32;
    let shelf = Shelf::of(kind, number);
    match kind {
        Kind::Clerestory => paired_lights(q, &CLERESTORY_TRACERY, shelf, seed),
        Kind::Aisle => paired_lights(q, &AISLE_TRACERY, shelf, seed),
        Kind::Lancet => light(q, &Pointed::new(1.22, 8.9, 2.26), 3.4, shelf, seed),
        Kind::Gallery => light(q, &Pointed::new(0.54, 6.9, 0.92), 5.36, shelf, seed),
        Kind::Rose => rose(q - DVec2::new(0.0, ROSE_HEIGHT)),
    }
}

/// Mean transmittance of a window's opening, the tracery counted as black.
pub fn mean_transmittance(window: &Window) -> DVec3 {
    const SIDE: u32 = 24;
    let (half, low, high) = window.kind.bounds();
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for i in 0..SIDE * SIDE {
        let u = DVec2::new(f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5) / f64::from(SIDE);
        let q = DVec2::new(half * (2.0 * u.x - 1.0), low + u.y * (high - low));
        if window.kind.contains(q.x, q.y) {
            sum += transmittance(window.kind, window.number, q).unwrap_or(DVec3::ZERO);
            count += 1.0;
        }
    }
    sum / count
}

/// Two lights side by side, their axes at ±`offset`, and a roundel over them.
struct Tracery {
    shape: Pointed,
    offset: f64,
    sill: f64,
    roundel: f64,
    radius: f64,
}

const CLERESTORY_TRACERY: Tracery =
    Tracery { shape: Pointed::new(0.80, 12.9, 1.15), offset: 0.90, sill: 9.7, roundel: 14.45, radius: 0.66 };
const AISLE_TRACERY: Tracery =
    Tracery { shape: Pointed::new(0.50, 4.1, 0.8), offset: 0.58, sill: 1.8, roundel: 5.2, radius: 0.38 };

fn paired_lights(q: DVec2, tracery: &Tracery, shelf: &Shelf, seed: i32) -> Option<DVec3> {
    let r = (q - DVec2::new(0.0, tracery.roundel)) / tracery.radius;
    if r.length_squared() < 1.0 {
        return Some(flower(r, tracery.radius, 6, seed));
    }
    let right = q.x >= 0.0;
    let across = if right { q.x - tracery.offset } else { q.x + tracery.offset };
    light(DVec2::new(across, q.y), &tracery.shape, tracery.sill, shelf, 2 * seed + i32::from(right))
}

/// One light: a border of beads around a column of medallions on a lattice ground.
fn light(q: DVec2, shape: &Pointed, sill: f64, shelf: &Shelf, seed: i32) -> Option<DVec3> {
    let edge = shape.depth(q.x, q.y).min(q.y - sill);
    if edge < 0.0 {
        return None;
    }
    if edge < CAME || (edge > CAME + BORDER && edge < 2.0 * CAME + BORDER) {
        return Some(LEAD);
    }
    let ground = shelf.grounds[(chance([seed, 1, 7]) * 4.0) as usize];
    if edge < CAME + BORDER {
        let along = (q.y + 0.6 * q.x.abs()) / 0.26;
        let bead = along.floor();
        if along - bead < CAME / 0.26 {
            return Some(LEAD);
        }
        let colour = if bead as i32 & 1 == 0 {
            AMBER
        } else if ground == RUBY {
            SKY
        } else {
            RUBY
        };
        return Some(colour * vary([seed, bead as i32, 2 + i32::from(q.x > 0.0)]));
    }
    let inner = shape.half - 2.0 * CAME - BORDER;
    let pitch = 2.0 * inner + 0.12;
    let step = (q.y - sill - 0.25) / pitch;
    let row = step.floor();
    let r = DVec2::new(q.x, (step - row - 0.5) * pitch) / inner;
    if r.length_squared() < 1.0 {
        return Some(medallion(r, inner, shelf, [seed, row as i32]));
    }
    let diagonal = DVec2::new(q.x + q.y, q.x - q.y) / 0.3;
    let cell = diagonal.floor();
    if (diagonal - cell).min_element() < CAME / 0.3 {
        return Some(LEAD);
    }
    Some(ground * vary([seed, cell.x as i32, cell.y as i32]))
}

/// A round picture: a ring of pearls around four quarters and a centre. `r` is relative to the radius.
fn medallion(r: DVec2, radius: f64, shelf: &Shelf, key: [i32; 2]) -> DVec3 {
    let came = CAME / radius;
    let rho = r.length();
    let quarter = i32::from(r.x > 0.0) + 2 * i32::from(r.y > 0.0);
    if rho > 1.0 - came || (rho - 0.80).abs() < 0.5 * came || (rho - 0.36).abs() < 0.5 * came {
        LEAD
    } else if rho > 0.80 {
        PEARL * (0.75 * vary([key[0], key[1], 40 + quarter]))
    } else if rho < 0.36 {
        shelf.robe([key[0], key[1], 50]) * (1.3 * vary([key[0], key[1], 51]))
    } else if r.x.abs().min(r.y.abs()) < 0.5 * came {
        LEAD
    } else {
        // Opposite quarters match.
        let pair = (quarter ^ (quarter >> 1)) & 1;
        shelf.robe([key[0], key[1], 60 + pair]) * vary([key[0], key[1], 70 + quarter])
    }
}

/// A roundel with petals. `r` is relative to the radius.
fn flower(r: DVec2, radius: f64, petals: u32, seed: i32) -> DVec3 {
    let came = CAME / radius;
    let rho = r.length();
    let turn = libm::atan2(r.y, r.x) / std::f64::consts::TAU + 0.5;
    let petal = (turn * f64::from(petals)).floor();
    // Distance from the axis of the petal, in petal widths.
    let across = (turn * f64::from(petals) - petal - 0.5).abs() * 2.0;
    if rho > 1.0 - came || (rho - 0.3).abs() < 0.5 * came {
        LEAD
    } else if rho < 0.3 {
        AMBER * 1.3
    } else if (1.0 - across) * rho * 3.0 / f64::from(petals) < 0.5 * came {
        LEAD
    } else if rho < 0.94 - 0.35 * across * across {
        if petals.is_multiple_of(2) && petal as i32 & 1 == 0 {
            RUBY * vary([seed, petal as i32, 80])
        } else {
            PEARL * 0.7
        }
    } else {
        COBALT * vary([seed, petal as i32, 81])
    }
}

/// The rose: an eye, twelve petals, twelve roundels between their tips, an outer ring of half petals.
fn rose(q: DVec2) -> Option<DVec3> {
    const BAR: f64 = 0.075;
    const PETALS: f64 = 12.0;
    let r = q.length();
    let rho = r / ROSE_RADIUS;
    if rho < 0.19 {
        return Some(flower(q / (0.19 * ROSE_RADIUS), 0.19 * ROSE_RADIUS, 8, 900));
    }
    if !(0.22..0.965).contains(&rho) {
        return None;
    }
    let turn = (libm::atan2(q.y, q.x) / std::f64::consts::TAU + 1.0) * PETALS;
    // Seen along the nearest border between two petals.
    let border = (turn + 0.5).floor();
    let off = (turn - border) * std::f64::consts::TAU / PETALS;
    let roundel = DVec2::new(r * libm::cos(off) - 0.80 * ROSE_RADIUS, r * libm::sin(off)) / (0.125 * ROSE_RADIUS);
    let around = roundel.length();
    if around < 1.0 {
        return Some(flower(roundel, 0.125 * ROSE_RADIUS, 4, 910 + border as i32 % 12));
    }
    if around < 1.2 || (rho < 0.80 && off.abs() * r < BAR) {
        return None;
    }
    let petal = turn.floor() as i32 % 12;
    let across = (turn - turn.floor() - 0.5).abs() * std::f64::consts::TAU / PETALS * r;
    if rho > 0.80 {
        return Some(if (rho - 0.88).abs() < 0.01 { LEAD } else { COBALT * vary([petal, 3, 920]) });
    }
    let band = ((rho - 0.22) / 0.145).floor();
    let in_band = (rho - 0.22) / 0.145 - band;
    if in_band < CAME / (0.145 * ROSE_RADIUS) {
        return Some(LEAD);
    }
    // A lozenge in each band, on blue and red grounds in turn.
    let lozenge = 1.0 - (in_band - 0.5).abs() * 2.0 - across / (0.17 * r);
    let even = (petal + band as i32) & 1 == 0;
    let key = [petal, band as i32, 930];
    Some(match () {
        () if lozenge.abs() < 0.07 => LEAD,
        () if lozenge > 0.0 => (if even { AMBER } else { PEARL }) * vary(key),
        () if even => COBALT * vary(key),
        () => RUBY * vary(key),
    })
}

/// Hand-blown sheets differ in thickness: a factor from 0.55 to 1.65, more often small than large.
fn vary(keys: [i32; 3]) -> f64 {
    let x = chance(keys);
    0.55 + 0.9 * x * x + 0.2 * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::windows;

    #[test]
    fn every_window_lets_some_coloured_light_through_and_never_amplifies_much() {
        for window in windows() {
            let mean = mean_transmittance(&window);
            assert!(
                mean.min_element() > 0.01 && mean.max_element() < 0.6,
                "{:?} {}: {mean}",
                window.kind,
                window.number
            );
            let (half, low, high) = window.kind.bounds();
            for i in 0..400 {
                let u = DVec2::new(f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0);
                let q = DVec2::new(half * (2.0 * u.x - 1.0), low + u.y * (high - low));
                if let Some(t) = transmittance(window.kind, window.number, q) {
                    assert!(t.min_element() > 0.0 && t.max_element() < 2.5, "{t}");
                }
            }
        }
    }
}
