//! The measures of the church, in metres, and the list of its windows.

use glam::DVec3;

use crate::arch::{Frame, Pointed, Recess};

/// The lens of the camera, a little off the axis and off the middle of the bay, at eye height.
pub const EYE: DVec3 = DVec3::new(0.35, 1.65, -0.5);
/// From pier to pier.
pub const BAY: f64 = 6.0;
/// Bays on either side of the middle one.
pub const OUTER_BAYS: i32 = 2;
/// |z| of the west front and of the chancel arch.
pub const END: f64 = 15.0;
/// |x| of the nave walls, of their far face in the aisles, and of the outer walls.
pub const WALL: f64 = 6.0;
pub const WALL_BACK: f64 = 7.0;
pub const OUTER_WALL: f64 = 11.4;
/// Over this height the arcade has its wall, with the gallery of niches and the clerestory.
pub const STRING_COURSE: f64 = 7.5;

pub const ARCADE: Pointed = Pointed::new(2.25, 3.7, 3.4);
pub const NAVE_VAULT: Vault =
    Vault { centre: 0.0, across: Pointed::new(WALL, 11.5, 7.0), along: Pointed::new(BAY / 2.0, 11.5, 7.0) };
pub const AISLE_VAULT: Vault =
    Vault { centre: 9.2, across: Pointed::new(2.2, 3.7, 3.6), along: Pointed::new(BAY / 2.0, 3.7, 3.6) };
/// The transverse ribs of the nave vault: half their width along z, and their arch.
pub const RIB_HALF: f64 = 0.28;
pub const RIB: Pointed = Pointed::new(WALL - 0.3, 11.5, 6.72);

pub const NICHE: Recess = Recess { outline: Pointed::new(0.44, 8.5, 0.65), sill: 7.75, depth: 0.35 };
pub const NICHE_SPACING: f64 = 1.15;
pub const CLERESTORY: Recess = Recess { outline: Pointed::new(1.85, 13.1, 2.9), sill: 9.6, depth: 0.45 };
pub const AISLE_WINDOW: Recess = Recess { outline: Pointed::new(1.2, 4.3, 1.9), sill: 1.7, depth: 0.45 };
pub const LANCET: Recess = Recess { outline: Pointed::new(1.3, 8.9, 2.4), sill: 3.3, depth: 0.3 };
pub const GALLERY: Recess = Recess { outline: Pointed::new(0.6, 6.9, 1.0), sill: 5.3, depth: 0.3 };
pub const GALLERY_SPACING: f64 = 1.7;
pub const PORTAL: Recess = Recess { outline: Pointed::new(1.7, 2.2, 2.2), sill: 0.0, depth: 0.7 };
pub const ROSE_RADIUS: f64 = 3.7;
pub const ROSE_HEIGHT: f64 = 12.6;

/// A vault in bays: two pointed tunnels that cross, the one along z at x = ±`centre`, the other along x in each bay.
#[derive(Debug, Clone, Copy)]
pub struct Vault {
    pub centre: f64,
    pub across: Pointed,
    pub along: Pointed,
}

/// What shape a window has and what is painted in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Clerestory,
    Aisle,
    Lancet,
    Gallery,
    Rose,
}

/// One window: `number` tells it from its sisters.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub kind: Kind,
    pub number: i32,
    pub frame: Frame,
}

impl Kind {
    /// The recess that holds the glass; the rose sits flush in the west wall.
    pub fn recess(self) -> Option<Recess> {
        match self {
            Kind::Clerestory => Some(CLERESTORY),
            Kind::Aisle => Some(AISLE_WINDOW),
            Kind::Lancet => Some(LANCET),
            Kind::Gallery => Some(GALLERY),
            Kind::Rose => None,
        }
    }

    /// The box around the glass: half the width, lowest and highest point.
    pub fn bounds(self) -> (f64, f64, f64) {
        match self.recess() {
            Some(r) => (r.outline.half, r.sill, r.outline.apex()),
            None => (ROSE_RADIUS, ROSE_HEIGHT - ROSE_RADIUS, ROSE_HEIGHT + ROSE_RADIUS),
        }
    }

    /// Whether the point of the wall (across, height) lies in the opening.
    pub fn contains(self, a: f64, b: f64) -> bool {
        match self.recess() {
            Some(r) => r.contains(a, b),
            None => a * a + (b - ROSE_HEIGHT) * (b - ROSE_HEIGHT) < ROSE_RADIUS * ROSE_RADIUS,
        }
    }
}

/// The bay that holds `z`, counted from the middle one.
pub fn bay(z: f64) -> i32 {
    ((z + END) / BAY).clamp(0.0, f64::from(2 * OUTER_BAYS)) as i32 - OUTER_BAYS
}

/// The z of the middle of a bay.
pub fn bay_z(bay: i32) -> f64 {
    BAY * f64::from(bay)
}

/// A wall along the nave at x = `side`·`x`, with its axes centred on a bay.
pub fn side_wall(side: f64, x: f64, bay: i32) -> Frame {
    Frame { origin: DVec3::new(side * x, 0.0, bay_z(bay)), right: DVec3::Z, out: DVec3::X * side }
}

/// The west front (at −z), where the rose is.
pub fn west_wall() -> Frame {
    Frame { origin: DVec3::new(0.0, 0.0, -END), right: DVec3::X, out: DVec3::NEG_Z }
}

/// Wall `i` (−2 to 2) of the apse: five sides of a decagon around (0, `END`).
pub fn apse_wall(i: i32) -> Frame {
    /// Sine and cosine of 36° and 72°.
    const SIN: [f64; 3] = [0.0, 0.587_785_252_292_473_1, 0.951_056_516_295_153_5];
    const COS: [f64; 3] = [1.0, 0.809_016_994_374_947_5, 0.309_016_994_374_947_45];
    let (s, c) = (SIN[i.unsigned_abs() as usize] * f64::from(i.signum()), COS[i.unsigned_abs() as usize]);
    let out = DVec3::new(s, 0.0, c);
    Frame { origin: DVec3::new(0.0, 0.0, END) + out * WALL, right: DVec3::new(c, 0.0, -s), out }
}

/// Every window of the church.
pub fn windows() -> Vec<Window> {
    let mut all = Vec::new();
    for bay in -OUTER_BAYS..=OUTER_BAYS {
        for side in [-1.0, 1.0] {
            all.push(Window { kind: Kind::Clerestory, number: number(side, bay), frame: side_wall(side, WALL, bay) });
            all.push(Window { kind: Kind::Aisle, number: number(side, bay), frame: side_wall(side, OUTER_WALL, bay) });
        }
        all.push(Window { kind: Kind::Lancet, number: bay, frame: apse_wall(bay) });
    }
    for i in -2..=2 {
        let mut frame = west_wall();
        frame.origin.x = GALLERY_SPACING * f64::from(i);
        all.push(Window { kind: Kind::Gallery, number: i, frame });
    }
    all.push(Window { kind: Kind::Rose, number: 0, frame: west_wall() });
    all
}

/// The number of a window in a side wall: south (−x) even, north odd.
pub fn number(side: f64, bay: i32) -> i32 {
    2 * bay + i32::from(side > 0.0)
}
