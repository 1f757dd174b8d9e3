//! What the surfaces are made of: the share of light that they send back, patterned and filtered to the pixel's size.

use glam::DVec3;

use crate::glass::chance;
use crate::plan::{self, AISLE_VAULT, ARCADE, CLERESTORY, END, NAVE_VAULT, Vault, WALL};
use crate::ray::{Hit, Surface};

const STONE: DVec3 = DVec3::new(0.25, 0.22, 0.165);
const DRESSED: DVec3 = DVec3::new(0.29, 0.26, 0.20);
const PLASTER: DVec3 = DVec3::new(0.07, 0.11, 0.20);
const MARBLE: DVec3 = DVec3::new(0.22, 0.20, 0.165);
const SLATE: DVec3 = DVec3::new(0.075, 0.072, 0.076);
const PORPHYRY: DVec3 = DVec3::new(0.125, 0.05, 0.04);
/// Radius of the wheel in the middle of the floor.
const ROSETTE: f64 = 2.45;
const GILT: DVec3 = DVec3::new(0.60, 0.42, 0.14);
const OAK: DVec3 = DVec3::new(0.10, 0.05, 0.026);

/// Diffuse albedo where a ray met the church; `width` is the pixel's width there in metres.
pub fn albedo(hit: &Hit, width: f64) -> DVec3 {
    let p = hit.p;
    let colour = match hit.surface {
        Surface::Floor => floor(p, width),
        Surface::Wall => wall(p, hit.n, width),
        Surface::Vault => vault(&NAVE_VAULT, p.x, p.z, width),
        Surface::AisleVault => vault(&AISLE_VAULT, p.x.abs(), p.z, width),
        Surface::ApseVault => apse_vault(p, width),
        Surface::Column => DRESSED * 0.92,
        Surface::Dressed | Surface::Glass(..) => DRESSED,
        Surface::Niche => STONE * 0.35,
        Surface::Door => OAK * (1.0 - 0.6 * line(p.x, 0.32, 0.03, width)),
        Surface::Iron => GILT,
        Surface::Wax => DVec3::new(0.8, 0.7, 0.5),
        Surface::Altar => altar(p, width),
    };
    // Five centuries of soot and damp, in soft patches.
    colour * (0.84 + 0.32 * noise(p * 0.7))
}

/// How much of `0` to `half` either side of zero a pixel of the given width covers at distance `x`.
fn band(x: f64, half: f64, width: f64) -> f64 {
    let narrow = (2.0 * half / width).min(1.0);
    ((half - x.abs()) / width + 0.5).clamp(0.0, narrow)
}

/// Coverage by lines `pitch` apart.
fn line(x: f64, pitch: f64, half: f64, width: f64) -> f64 {
    let off = x - pitch * (x / pitch + 0.5).floor();
    band(off, half, width)
}

/// A chequer of unit squares, averaged over a box of the given width: 0 or 1, or between.
fn chequer(u: f64, v: f64, width: f64) -> f64 {
    let saw = |x: f64| {
        let f = 0.5 * x - (0.5 * x).floor();
        (f - 0.5).abs()
    };
    let wave = |x: f64| 2.0 * (saw(x - 0.5 * width) - saw(x + 0.5 * width)) / width;
    0.5 - 0.5 * wave(u) * wave(v)
}

/// Fades a detail of the given size out before it gets smaller than a pixel.
fn fade(size: f64, width: f64) -> f64 {
    (1.5 - 2.0 * width / size).clamp(0.0, 1.0)
}

fn floor(p: DVec3, width: f64) -> DVec3 {
    let (x, z) = (p.x, p.z);
    if x.abs() > WALL - 0.4 && z < END {
        let slab = chequer(x / 0.8, z / 0.8, width / 0.8);
        return MARBLE * (0.55 + 0.25 * slab) * (1.0 - 0.5 * line(x, 0.8, 0.012, width));
    }
    let r = (x * x + z * z).sqrt();
    if r < ROSETTE && z < END {
        return rosette(x, z, r, width);
    }
    let (u, v) = ((x + z) / 0.7, (x - z) / 0.7);
    let tile = chequer(u, v, width / 0.7);
    let tone = 1.0 + 0.25 * (chance([u.floor() as i32, v.floor() as i32, 5]) - 0.5) * fade(0.7, width);
    let field = SLATE.lerp(MARBLE, tile) * tone;
    // A frame of porphyry and marble around each bay.
    let a = z - plan::bay_z(plan::bay(z));
    let edge = (WALL - 0.4 - x.abs()).min(if z < END { 3.0 - a.abs() } else { 9.0 });
    let frame = PORPHYRY.lerp(MARBLE, band(edge - 0.38, 0.05, width));
    field.lerp(frame, 1.0 - ((edge - 0.45) / width + 0.5).clamp(0.0, 1.0))
}

/// The wheel in the middle bay: rings of small chequers, roundels and plain bands around a star.
fn rosette(x: f64, z: f64, r: f64, width: f64) -> DVec3 {
    let turn = libm::atan2(z, x) / std::f64::consts::TAU;
    let arc = width / (std::f64::consts::TAU * r.max(0.05));
    let inside = |edge: f64| ((edge - r) / width + 0.5).clamp(0.0, 1.0);
    let ring = |from: f64, row: f64, count: f64| {
        SLATE.lerp(MARBLE, chequer(turn * count, (r - from) / row, (arc * count).max(width / row)))
    };
    // How far the place is from the axis of the nearest of `count` equal sectors, in turns.
    let off = |count: f64| (turn - (turn * count + 0.5).floor() / count).abs();
    let star = ((1.0 - off(12.0) * 24.0 - (r - 0.18) / 0.3) / (arc * 24.0).max(1e-3) + 0.5).clamp(0.0, 1.0);
    let (u, v) = (off(20.0) * std::f64::consts::TAU * r, r - 1.81);
    let roundel = ((0.16 - (u * u + v * v).sqrt()) / width + 0.5).clamp(0.0, 1.0);
    let plain = MARBLE * 0.85;
    plain
        .lerp(ring(2.12, 0.11, 96.0), inside(2.34))
        .lerp(plain, inside(2.12))
        .lerp(SLATE, inside(2.06))
        .lerp(PORPHYRY, roundel * inside(2.06))
        .lerp(plain, inside(1.56))
        .lerp(PORPHYRY * 0.8, inside(1.5))
        .lerp(ring(0.96, 0.135, 60.0), inside(1.365))
        .lerp(plain, inside(0.96))
        .lerp(SLATE, inside(0.9))
        .lerp(plain, inside(0.54))
        .lerp(PORPHYRY * 0.8, inside(0.48))
        .lerp(plain, star * inside(0.48))
        .lerp(PORPHYRY * 0.8, inside(0.18))
}

/// Coursed blocks with thin joints, mouldings at the floors of the elevation, rings of dressed stone around openings.
fn wall(p: DVec3, n: DVec3, width: f64) -> DVec3 {
    const COURSE: f64 = 0.44;
    let along = p.x * n.z - p.z * n.x;
    let row = (p.y / COURSE).floor();
    let shifted = along / 0.95 + 0.5 * (row - 2.0 * (0.5 * row).floor());
    let block = chance([row as i32, shifted.floor() as i32, 11]) - 0.5;
    let joints = line(p.y, COURSE, 0.012, width).max(line(shifted * 0.95, 0.95, 0.012, width));
    let mut colour = STONE * (1.0 + 0.22 * block * fade(COURSE, width)) * (1.0 - 0.35 * joints);
    if n.x.abs() > 0.99 && p.x.abs() < WALL + 1.1 && p.z < END {
        let a = p.z - plan::bay_z(plan::bay(p.z));
        for (arch, sill) in [(&ARCADE, ARCADE.spring), (&CLERESTORY.outline, CLERESTORY.sill)] {
            let out = -arch.depth(a, p.y);
            if p.y > sill && out < 0.34 {
                let groove = line(out, 0.11, 0.02, width);
                colour = colour.lerp(DRESSED * (1.08 - 0.6 * groove), ((0.34 - out) / width).clamp(0.0, 1.0));
            }
        }
        for moulding in [plan::STRING_COURSE, 10.15] {
            let y = p.y - moulding;
            colour = colour.lerp(DRESSED * 1.15, band(y, 0.09, width));
            colour *= 1.0 - 0.55 * band(y + 0.15, 0.06, width);
        }
    }
    // Hangings on the lower walls of the apse, between a gilt rail and a gilt fringe.
    if p.z > END && p.y < 2.9 {
        let fold = libm::sin(along * 11.0) * fade(0.5, width);
        let cloth = DVec3::new(0.22, 0.022, 0.018) * (1.0 + 0.5 * fold);
        colour = cloth.lerp(GILT, band(p.y - 2.84, 0.06, width).max(band(p.y - 0.5, 0.08, width)));
    }
    colour
}

/// Blue webs between ribs: along the groins, along the ridges, and a gilt boss where they meet.
fn vault(vault: &Vault, x: f64, z: f64, width: f64) -> DVec3 {
    let (x, a) = (x - vault.centre, z - plan::bay_z(plan::bay(z)));
    let (long, cross) = (vault.across.height(x), vault.along.height(a));
    let (sx, sz) = (vault.across.slope(x), vault.along.slope(a));
    let groin = (long - cross) / (sx * sx + sz * sz).sqrt();
    let ridge = if long > cross { x } else { a };
    let boss = (x * x + a * a).sqrt();
    let scale = vault.across.half / WALL;
    let webs = PLASTER.lerp(GILT, 0.8 * star(x, a, width));
    ribbed(webs, groin, 0.17 * scale, width)
        .lerp(DRESSED, band(ridge, 0.07 * scale, width))
        .lerp(GILT, band(boss, 0.42 * scale, width))
}

fn apse_vault(p: DVec3, width: f64) -> DVec3 {
    // Between the two nearest walls the distances to their planes are equal: there is the rib.
    let mut depths = [f64::NEG_INFINITY; 2];
    for i in -2..=2 {
        let q = plan::apse_wall(i).local(p).z;
        if q > depths[0] {
            depths = [q, depths[0]];
        } else if q > depths[1] {
            depths[1] = q;
        }
    }
    let boss = (p.x * p.x + (p.z - END) * (p.z - END)).sqrt();
    ribbed(PLASTER, (depths[0] - depths[1]) / 0.62, 0.15, width).lerp(GILT, band(boss, 0.5, width))
}

/// A rib of three rolls: light in the middle, dark where it parts from the web.
fn ribbed(web: DVec3, off: f64, half: f64, width: f64) -> DVec3 {
    let shadow = band(off.abs() - half, 0.3 * half, width);
    web.lerp(DRESSED * 1.1, band(off, half, width)) * (1.0 - 0.6 * shadow)
}

/// Gilt stars on the webs, one in each square of 0.75 m, a little out of line.
fn star(x: f64, z: f64, width: f64) -> f64 {
    const PITCH: f64 = 0.75;
    let (i, j) = ((x / PITCH).floor(), (z / PITCH).floor());
    let jitter = |k: i32| 0.5 + 0.3 * (chance([i as i32, j as i32, k]) - 0.5);
    let (u, v) = (x - (i + jitter(21)) * PITCH, z - (j + jitter(22)) * PITCH);
    band((u * u + v * v).sqrt(), 0.07, width)
}

fn altar(p: DVec3, width: f64) -> DVec3 {
    let linen = DVec3::new(0.62, 0.58, 0.50);
    linen.lerp(DVec3::new(0.30, 0.03, 0.02), band(p.y - 0.35, 0.35, width)).lerp(GILT, band(p.y - 0.78, 0.05, width))
}

/// Smooth value noise in 0..1: random values at the integer points, mixed by a cubic.
fn noise(p: DVec3) -> f64 {
    let base = p.floor();
    let f = p - base;
    let f = f * f * (DVec3::splat(3.0) - 2.0 * f);
    let [i, j, k] = [base.x as i32, base.y as i32, base.z as i32];
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let edge = |j: i32, k: i32| mix(chance([i, j, k]), chance([i + 1, j, k]), f.x);
    mix(mix(edge(j, k), edge(j + 1, k), f.y), mix(edge(j, k + 1), edge(j + 1, k + 1), f.y), f.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filtered_patterns_keep_their_mean_and_sharpen_to_the_pattern() {
        let cell = |u: f64, v: f64| chequer(u, v, 1e-3);
        assert!((cell(0.5, 0.5) - cell(1.5, 1.5)).abs() < 1e-9);
        assert!((cell(0.5, 0.5) - cell(1.5, 0.5)).abs() > 1.0 - 1e-9);
        assert!((chequer(0.3, 0.7, 1e6) - 0.5).abs() < 1e-3);
        for width in [0.01, 0.1, 0.4] {
            let mean = (0..10_000).map(|i| line(f64::from(i) * 1e-3, 1.0, 0.05, width)).sum::<f64>() / 1e4;
            assert!((mean - 0.1).abs() < 1e-3, "{width}: {mean}");
        }
    }

    #[test]
    fn no_stone_sends_back_more_light_than_it_gets() {
        let surfaces = [Surface::Floor, Surface::Wall, Surface::Vault, Surface::AisleVault, Surface::ApseVault];
        for (i, surface) in surfaces.into_iter().cycle().take(5000).enumerate() {
            let at = |k: i32| chance([i as i32, k, 99]);
            let p = DVec3::new(12.0 * at(0) - 6.0, 18.0 * at(1), 35.0 * at(2) - 15.0);
            let n = if i & 1 == 0 { DVec3::X } else { DVec3::Z };
            let albedo = albedo(&Hit { t: 1.0, p, n, surface }, 0.01 + at(3));
            assert!(albedo.min_element() > 0.0 && albedo.max_element() < 1.0, "{surface:?} {p}: {albedo}");
        }
    }
}
