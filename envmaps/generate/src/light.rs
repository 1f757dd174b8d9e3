//! The sky behind the glass, and the candles.

use glam::{DVec2, DVec3};

use crate::columns::{ALTAR, CANDLES, CHANDELIER_HEIGHT, CHANDELIER_RADIUS, CHANDELIERS, CIRCLE};
use crate::plan::Kind;
use crate::{glass, sun};

/// Radiant intensity of one candle, and its colour.
pub const CANDLE: DVec3 = DVec3::new(0.050, 0.030, 0.011);

/// Radiance of the window's glass at `q`, seen along `view` (from the eye to the glass); `None` at tracery.
pub fn window(kind: Kind, number: i32, q: DVec2, view: DVec3) -> Option<DVec3> {
    let (_, low, high) = kind.bounds();
    // Old glass is brightest towards the top, where the sky behind it is free.
    let height = 0.75 + 0.5 * (q.y - low) / (high - low);
    let south = matches!(kind, Kind::Clerestory | Kind::Aisle) && number & 1 == 0;
    let glare = if south { sun::glare(view) } else { DVec3::ONE };
    glass::transmittance(kind, number, q).map(|t| t * sky(kind, number) * glare * height)
}

/// Radiance of the sky behind a window.
pub fn sky(kind: Kind, number: i32) -> DVec3 {
    let south = number & 1 == 0;
    match kind {
        Kind::Clerestory | Kind::Aisle if south => DVec3::new(0.64, 0.58, 0.50),
        Kind::Clerestory => DVec3::new(0.58, 0.76, 1.35),
        Kind::Aisle => DVec3::new(0.34, 0.46, 0.80),
        Kind::Lancet => DVec3::new(0.58, 0.72, 1.05),
        Kind::Gallery | Kind::Rose => DVec3::new(0.48, 0.60, 0.88),
    }
}

/// A small light source: the number of its candles.
#[derive(Debug, Clone, Copy)]
pub struct Lamp {
    pub p: DVec3,
    pub candles: f64,
}

/// The lamps that light the stone: each chandelier, sconce, or group of candles is one point.
pub fn lamps() -> Vec<Lamp> {
    let mut all: Vec<Lamp> = CHANDELIERS
        .iter()
        .map(|&z| Lamp { p: DVec3::new(0.0, CHANDELIER_HEIGHT + 0.3, z), candles: CANDLES as f64 })
        .collect();
    all.extend(sconces());
    let (_, _, z, height) = ALTAR;
    all.push(Lamp { p: DVec3::new(0.0, height + 0.8, z), candles: 6.0 });
    all
}

/// A sconce on each free pier, on the side of the nave, and four on the outer walls.
fn sconces() -> impl Iterator<Item = Lamp> {
    [(-9.0, 5.5), (-3.0, 5.5), (3.0, 5.5), (9.0, 5.5), (-3.0, 11.2), (3.0, 11.2)]
        .into_iter()
        .flat_map(|(z, x)| [-1.0, 1.0].map(|side| Lamp { p: DVec3::new(side * x, 2.6, z), candles: 3.0 }))
}

/// Every flame as seen by the camera.
pub fn flames() -> Vec<Lamp> {
    let mut all = Vec::new();
    for z in CHANDELIERS {
        for (s, c) in CIRCLE {
            let p = DVec3::new(CHANDELIER_RADIUS * s, CHANDELIER_HEIGHT + 0.33, z + CHANDELIER_RADIUS * c);
            all.push(Lamp { p, candles: 1.0 });
        }
    }
    all.extend(sconces());
    let (_, _, z, height) = ALTAR;
    for i in [-5.0, -3.0, -1.0, 1.0, 3.0, 5.0] {
        all.push(Lamp { p: DVec3::new(0.24 * i, height + 0.75, z), candles: 1.0 });
    }
    all
}

/// Irradiance by the lamps at `p` on a surface with normal `n`; shadows are left out, so a lamp reaches 9 m at most.
pub fn lamplight(lamps: &[Lamp], p: DVec3, n: DVec3) -> DVec3 {
    const REACH: f64 = 9.0;
    let mut sum = 0.0;
    for lamp in lamps {
        let w = lamp.p - p;
        let dd = w.length_squared();
        let cosine = n.dot(w);
        if dd < REACH * REACH && cosine > 0.0 {
            let fade = 1.0 - dd / (REACH * REACH);
            sum += lamp.candles * cosine * fade * fade / ((dd + 0.02) * dd.sqrt());
        }
    }
    CANDLE * sum
}
