//! Where the light comes from: sky behind the glass, the sun through the south windows, candles.

use glam::{DVec2, DVec3};

use super::building::Ray;
use super::columns::{ALTAR, CANDLES, CHANDELIER_HEIGHT, CHANDELIER_RADIUS, CHANDELIERS, CIRCLE};
use super::glass;
use super::plan::{self, AISLE_WINDOW, CLERESTORY, Kind, OUTER_BAYS, OUTER_WALL, WALL};

/// Towards the sun: a little before noon, so high that its patches reach the floor of the nave.
const SUN: DVec3 = DVec3::new(-0.62, 1.0, 0.21);
/// Length of [`SUN`].
const SUN_LENGTH: f64 = 1.195198728245642;
/// Irradiance of the sun across its beam, before the glass.
const SUNLIGHT: DVec3 = DVec3::new(1.0, 0.86, 0.66);
const SUN_STRENGTH: f64 = 2.2;
/// Radiance that the air scatters out of a beam, per metre, as part of the beam's irradiance.
const HAZE: f64 = 0.0009;
/// Radiant intensity of one candle, and its colour.
pub const CANDLE: DVec3 = DVec3::new(0.050, 0.030, 0.011);

/// Radiance of the window's glass at `q`, seen along `view` (from the eye to the glass); `None` at tracery.
pub fn window(kind: Kind, number: i32, q: DVec2, view: DVec3) -> Option<DVec3> {
    let (_, low, high) = kind.bounds();
    // Old glass is brightest towards the top, where the sky behind it is free.
    let height = 0.75 + 0.5 * (q.y - low) / (high - low);
    let south = matches!(kind, Kind::Clerestory | Kind::Aisle) && number & 1 == 0;
    let glare = if south {
        let off = 1.0 - view.dot(SUN) / SUN_LENGTH;
        DVec3::ONE + SUNLIGHT * (16.0 * libm::exp(-off / 0.0012) + 2.0 * libm::exp(-off / 0.03))
    } else {
        DVec3::ONE
    };
    glass::transmittance(kind, number, q).map(|t| t * sky(kind, number) * glare * height)
}

/// Radiance of the sky behind a window.
pub fn sky(kind: Kind, number: i32) -> DVec3 {
    let south = number & 1 == 0;
    match kind {
        Kind::Clerestory | Kind::Aisle if south => DVec3::new(0.60, 0.58, 0.60),
        Kind::Clerestory => DVec3::new(0.32, 0.40, 0.58),
        Kind::Aisle => DVec3::new(0.24, 0.31, 0.46),
        Kind::Lancet => DVec3::new(0.66, 0.70, 0.82),
        Kind::Gallery | Kind::Rose => DVec3::new(0.46, 0.54, 0.72),
    }
}

/// Irradiance by the sun at `p` on a surface with normal `n`, coloured by the glass it came through.
pub fn sun(p: DVec3, n: DVec3) -> DVec3 {
    let cosine = n.dot(SUN) / SUN_LENGTH;
    if cosine <= 0.0 || p.x > WALL + 0.2 {
        return DVec3::ZERO;
    }
    let (kind, wall, shape) = if p.x > -WALL - 0.2 {
        (Kind::Clerestory, WALL, CLERESTORY)
    } else {
        (Kind::Aisle, OUTER_WALL, AISLE_WINDOW)
    };
    let (face, pane) = (along_sun(p, -wall), along_sun(p, -wall - shape.depth));
    let bay = plan::bay(pane.x);
    let centre = DVec2::new(plan::bay_z(bay), 0.0);
    let (face, pane) = (face - centre, pane - centre);
    if !shape.contains(face.x, face.y) || !shape.contains(pane.x, pane.y) {
        return DVec3::ZERO;
    }
    // The sun is half a degree wide and the glass uneven: colours run into each other on their way down.
    const BLUR: f64 = 0.13;
    let mut sum = DVec3::ZERO;
    for (a, b) in TAPS {
        let q = pane + DVec2::new(a, b) * BLUR;
        sum += glass::transmittance(kind, plan::number(-1.0, bay), q).unwrap_or(DVec3::ZERO);
    }
    sum * SUNLIGHT * (SUN_STRENGTH * cosine / TAPS.len() as f64)
}

const TAPS: [(f64, f64); 7] =
    [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.5, 0.87), (-0.5, 0.87), (0.5, -0.87), (-0.5, -0.87)];

/// (z, height) at which the line from `p` to the sun crosses the plane at `x`.
fn along_sun(p: DVec3, x: f64) -> DVec2 {
    let t = (x - p.x) / SUN.x;
    DVec2::new(p.z + t * SUN.z, p.y + t * SUN.y)
}

/// Light that the hazy air of the nave scatters out of the sun's beams towards the ray's origin.
pub fn beams(ray: &Ray, limit: f64, tints: &[DVec3]) -> DVec3 {
    let start = along_sun(ray.o, -WALL);
    let step = along_sun(ray.at(1.0), -WALL) - start;
    let mut sum = DVec3::ZERO;
    for bay in -OUTER_BAYS..=OUTER_BAYS {
        let z = plan::bay_z(bay);
        let half = CLERESTORY.outline.half - 0.2;
        let (mut near, mut far) = (0.0_f64, limit);
        for (o, d, low, high) in [
            (start.x, step.x, z - half, z + half),
            (start.y, step.y, CLERESTORY.sill, CLERESTORY.outline.apex() - 0.6),
        ] {
            let (a, b) = ((low - o) / d, (high - o) / d);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        if far > near {
            sum += tints[(bay + OUTER_BAYS) as usize] * (far - near);
        }
    }
    sum * SUNLIGHT * (SUN_STRENGTH * HAZE)
}

/// The mean colour of each beam, by bay.
pub fn beam_tints() -> Vec<DVec3> {
    let south = |w: &plan::Window| w.kind == Kind::Clerestory && w.number & 1 == 0;
    let mut windows: Vec<_> = plan::windows().into_iter().filter(south).collect();
    windows.sort_by_key(|w| w.number);
    windows.iter().map(glass::mean_transmittance).collect()
}

/// Something small that shines: how many candles burn there.
#[derive(Debug, Clone, Copy)]
pub struct Lamp {
    pub p: DVec3,
    pub candles: f64,
}

/// The lamps as seen by the stone: each chandelier, sconce, or group of candles is one point.
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

/// A sconce on each free pier, on the side of the nave.
fn sconces() -> impl Iterator<Item = Lamp> {
    [-9.0, -3.0, 3.0, 9.0]
        .into_iter()
        .flat_map(|z| [-1.0, 1.0].map(|side| Lamp { p: DVec3::new(side * 5.5, 2.6, z), candles: 3.0 }))
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
