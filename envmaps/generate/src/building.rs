//! The shell of the church: where a ray that starts inside meets floor, walls, vaults or glass.
//!
//! The building is a chain of rooms, each simple enough for a closed answer: nave, arcade (the thickness of its wall),
//! aisle, apse. A ray is followed from room to room; rooms at x < 0 are mirrored to x > 0 first.

use glam::{DVec2, DVec3};

use crate::arch::{Frame, Met, Recess};
use crate::plan::{self, *};
use crate::ray::{Hit, Ray, Surface};
use crate::vault;

#[derive(Debug, Clone, Copy)]
enum Room {
    Nave,
    Arcade,
    Aisle,
    Apse,
}

enum Step {
    Hit(Hit),
    Enter(Room, f64),
}

/// The first surface of the shell along `ray`.
pub fn trace(ray: &Ray) -> Hit {
    let mut side = if ray.o.x < 0.0 { -1.0 } else { 1.0 };
    let mut room = match ray.o.x.abs() {
        _ if ray.o.z > END => Room::Apse,
        x if x <= WALL => Room::Nave,
        x if x < WALL_BACK => Room::Arcade,
        _ => Room::Aisle,
    };
    let mut t = 0.0;
    // A straight line crosses at most six rooms; the bound is for rays that graze an edge to the last bit.
    for _ in 0..12 {
        if matches!(room, Room::Nave) {
            side = if ray.d.x < 0.0 { -1.0 } else { 1.0 };
        }
        let mirrored = ray.mirrored(side);
        let step = match room {
            Room::Nave => nave(&mirrored, side, t),
            Room::Arcade => arcade(&mirrored, t),
            Room::Aisle => aisle(&mirrored, side, t),
            Room::Apse => apse(&mirrored, side, t),
        };
        match step {
            Step::Enter(next, at) => (room, t) = (next, at),
            Step::Hit(hit) => {
                let m = DVec3::new(side, 1.0, 1.0);
                return Hit { p: hit.p * m, n: hit.n * m, ..hit };
            }
        }
    }
    ray.hit(t, -ray.d, Surface::Dressed)
}

fn nave(ray: &Ray, side: f64, from: f64) -> Step {
    let wall = ray.reach(0, WALL);
    let floor = if ray.d.y < 0.0 { ray.reach(1, 0.0) } else { f64::INFINITY };
    let end = ray.leave(2, -END, END);
    let mut t = wall.min(floor).min(end).max(from);
    let spring = NAVE_VAULT.across.spring;
    let mut over = None;
    if ray.at(from).y.max(ray.at(t).y) > spring {
        over = vault::exit(&NAVE_VAULT, ray, from, t);
        t = over.map_or(t, |(t, _)| t);
        if let Some((at, n)) = vault::rib(ray, from, t) {
            return Step::Hit(ray.hit(at, n, Surface::Dressed));
        }
    }
    let p = ray.at(t);
    if let Some((_, n)) = over {
        Step::Hit(ray.hit(t, n, Surface::Vault))
    } else if t == floor {
        Step::Hit(ray.hit(t, DVec3::Y, Surface::Floor))
    } else if t == end {
        if ray.d.z > 0.0 { Step::Enter(Room::Apse, t) } else { Step::Hit(west_front(ray, side, t)) }
    } else {
        let bay = bay(p.z);
        let a = p.z - bay_z(bay);
        if p.y < ARCADE.spring || ARCADE.contains(a, p.y) {
            return Step::Enter(Room::Arcade, t);
        }
        let column = (a / NICHE_SPACING).round().clamp(-2.0, 2.0) * NICHE_SPACING;
        if CLERESTORY.contains(a, p.y) {
            let frame = side_wall(1.0, WALL, bay);
            Step::Hit(recess(ray, t, &frame, &CLERESTORY, |q| glass(Kind::Clerestory, plan::number(side, bay), q)))
        } else if NICHE.contains(a - column, p.y) {
            let mut frame = side_wall(1.0, WALL, bay);
            frame.origin.z += column;
            Step::Hit(recess(ray, t, &frame, &NICHE, |_| Surface::Niche))
        } else {
            Step::Hit(ray.hit(t, DVec3::NEG_X, Surface::Wall))
        }
    }
}

/// The thickness of the nave wall: open between the piers below the springing line, arches over it.
fn arcade(ray: &Ray, from: f64) -> Step {
    let floor = if ray.d.y < 0.0 { ray.reach(1, 0.0) } else { f64::INFINITY };
    let end = ray.leave(2, -END, END);
    let stop = ray.leave(0, WALL, WALL_BACK).min(end).min(floor).max(from);
    let spring = ray.reach(1, ARCADE.spring);
    // The part of the way that lies over the springing line.
    let (start, last) = if ray.d.y > 0.0 { (spring.max(from), stop) } else { (from, spring.min(stop)) };
    if start < last && ray.at(0.5 * (start + last)).y > ARCADE.spring {
        let p = ray.at(start);
        let a = p.z - bay_z(bay(p.z));
        if start > from && a.abs() > ARCADE.half {
            return Step::Hit(ray.hit(start, DVec3::NEG_Y, Surface::Dressed));
        }
        let exit = ARCADE.exit(DVec2::new(a, p.y), DVec2::new(ray.d.z, ray.d.y));
        let soffit = start + exit.t.max(0.0);
        if soffit < last {
            return Step::Hit(ray.hit(soffit, DVec3::new(0.0, exit.normal.y, exit.normal.x), Surface::Dressed));
        }
    }
    if stop == floor {
        Step::Hit(ray.hit(stop, DVec3::Y, Surface::Floor))
    } else if stop == end {
        Step::Hit(ray.hit(stop, DVec3::NEG_Z * ray.d.z.signum(), Surface::Wall))
    } else {
        Step::Enter(if ray.d.x < 0.0 { Room::Nave } else { Room::Aisle }, stop)
    }
}

fn aisle(ray: &Ray, side: f64, from: f64) -> Step {
    let wall = ray.leave(0, WALL_BACK, OUTER_WALL);
    let floor = if ray.d.y < 0.0 { ray.reach(1, 0.0) } else { f64::INFINITY };
    let end = ray.leave(2, -END, END);
    let t = wall.min(floor).min(end).max(from);
    if ray.at(from).y.max(ray.at(t).y) > AISLE_VAULT.across.spring
        && let Some((t, n)) = vault::exit(&AISLE_VAULT, ray, from, t)
    {
        return Step::Hit(ray.hit(t, n, Surface::AisleVault));
    }
    if t == floor {
        return Step::Hit(ray.hit(t, DVec3::Y, Surface::Floor));
    }
    if t == end {
        return Step::Hit(ray.hit(t, DVec3::NEG_Z * ray.d.z.signum(), Surface::Wall));
    }
    let p = ray.at(t);
    let bay = bay(p.z);
    let a = p.z - bay_z(bay);
    if ray.d.x < 0.0 {
        if p.y < ARCADE.spring || ARCADE.contains(a, p.y) {
            Step::Enter(Room::Arcade, t)
        } else {
            Step::Hit(ray.hit(t, DVec3::X, Surface::Wall))
        }
    } else if AISLE_WINDOW.contains(a, p.y) {
        let frame = side_wall(1.0, OUTER_WALL, bay);
        Step::Hit(recess(ray, t, &frame, &AISLE_WINDOW, |q| glass(Kind::Aisle, plan::number(side, bay), q)))
    } else {
        Step::Hit(ray.hit(t, DVec3::NEG_X, Surface::Wall))
    }
}

/// Five walls and, over each, a quarter tunnel of the nave's profile; open to the nave.
fn apse(ray: &Ray, side: f64, from: f64) -> Step {
    let p = ray.at(from);
    let (mut t, mut wall) = (f64::INFINITY, None);
    for i in -2..=2 {
        let frame = apse_wall(i);
        let (q, d) = (frame.local(p), frame.local_direction(ray.d));
        let exit = NAVE_VAULT.across.exit_right(DVec2::new(q.z + WALL, q.y), DVec2::new(d.z, d.y));
        let at = from + exit.t.max(0.0);
        if at < t {
            (t, wall) = (at, Some((i, frame, exit.normal)));
        }
    }
    let floor = if ray.d.y < 0.0 { ray.reach(1, 0.0) } else { f64::INFINITY };
    let arch = if ray.d.z < 0.0 { ray.reach(2, END) } else { f64::INFINITY };
    if arch < t.min(floor) {
        let q = ray.at(arch);
        return if NAVE_VAULT.across.contains(q.x, q.y) {
            Step::Enter(Room::Nave, arch)
        } else {
            Step::Hit(ray.hit(arch, DVec3::Z, Surface::Wall))
        };
    }
    match wall {
        Some((i, frame, normal)) if t < floor => {
            let q = frame.local(ray.at(t));
            if q.y > NAVE_VAULT.across.spring {
                let n = frame.out * normal.x + DVec3::Y * normal.y;
                Step::Hit(ray.hit(t, n, Surface::ApseVault))
            } else if LANCET.contains(q.x, q.y) {
                let number = if side < 0.0 { -i } else { i };
                Step::Hit(recess(ray, t, &frame, &LANCET, |q| glass(Kind::Lancet, number, q)))
            } else {
                Step::Hit(ray.hit(t, -frame.out, Surface::Wall))
            }
        }
        _ => Step::Hit(ray.hit(floor, DVec3::Y, Surface::Floor)),
    }
}

fn west_front(ray: &Ray, side: f64, t: f64) -> Hit {
    let mut frame = west_wall();
    let q = frame.local(ray.at(t));
    let place = (q.x / GALLERY_SPACING).round().clamp(-2.0, 2.0);
    if Kind::Rose.contains(q.x, q.y) {
        ray.hit(t, DVec3::Z, glass(Kind::Rose, 0, DVec2::new(q.x * side, q.y)))
    } else if GALLERY.contains(q.x - place * GALLERY_SPACING, q.y) {
        frame.origin.x = place * GALLERY_SPACING;
        recess(ray, t, &frame, &GALLERY, |q| glass(Kind::Gallery, (place * side) as i32, q))
    } else if PORTAL.contains(q.x, q.y) {
        recess(ray, t, &frame, &PORTAL, |_| Surface::Door)
    } else {
        ray.hit(t, DVec3::Z, Surface::Wall)
    }
}

fn glass(kind: Kind, number: i32, q: DVec2) -> Surface {
    Surface::Glass(kind, number, q)
}

/// Continues into a recess entered at `t`; `back` says what its back is at (across, height).
fn recess(ray: &Ray, t: f64, frame: &Frame, shape: &Recess, back: impl Fn(DVec2) -> Surface) -> Hit {
    let (q, d) = (frame.local(ray.at(t)), frame.local_direction(ray.d));
    let (more, met) = shape.trace(q, d);
    match met {
        Met::Reveal(n) => ray.hit(t + more, frame.world_direction(n), Surface::Dressed),
        Met::Back => ray.hit(t + more, -frame.out, back((q + d * more).truncate())),
    }
}

/// Whether a point lies in the air of the church, piers and furniture not counted.
pub fn contains(p: DVec3) -> bool {
    let (x, a) = (p.x.abs(), p.z - bay_z(bay(p.z)));
    let under = |vault: &Vault| vault.across.contains(x - vault.centre, p.y) || vault.along.contains(a, p.y);
    if p.y < 0.0 {
        false
    } else if p.z > END {
        let profile = &NAVE_VAULT.across;
        (-2..=2).all(|i| {
            let q = apse_wall(i).local(p).z + WALL;
            q < WALL && (q < 0.0 || profile.contains(q, p.y))
        })
    } else if p.z < -END {
        false
    } else if x < WALL {
        under(&NAVE_VAULT)
    } else if x < WALL_BACK {
        p.y < ARCADE.spring || ARCADE.contains(a, p.y)
    } else {
        x < OUTER_WALL && under(&AISLE_VAULT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions spread uniformly over the sphere.
    fn directions(count: u32) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (s, c) = libm::sincos(2.4 * f64::from(i));
            DVec3::new(s * (1.0 - y * y).sqrt(), y, c * (1.0 - y * y).sqrt())
        })
    }

    #[test]
    fn rays_stop_where_the_air_ends_and_not_before() {
        for o in [EYE, DVec3::new(-9.0, 2.0, 4.0), DVec3::new(8.8, 5.0, -11.0), DVec3::new(1.0, 9.0, 17.0)] {
            for d in directions(20_000) {
                let hit = trace(&Ray { o, d });
                assert!((hit.n.length() - 1.0).abs() < 1e-9 && hit.n.dot(d) < 1e-9, "{o} {d} {hit:?}");
                // The way up to the surface is air, but for ribs (in front of the vault) and recesses (behind walls).
                let solid = |t: f64| !contains(o + d * t);
                let recessed = matches!(hit.surface, Surface::Glass(..) | Surface::Niche | Surface::Door);
                if recessed || hit.surface == Surface::Dressed {
                    continue;
                }
                // Behind the end of an aisle lies the outermost corner of the apse.
                assert!(solid(hit.t + 1e-3) || (hit.p.z - END).abs() < 1e-6, "{o} {d} {hit:?}");
                for k in 1..20 {
                    let t = (hit.t - 1e-3) * f64::from(k) / 19.0;
                    assert!(!solid(t), "{o} {d} {hit:?} at {t}");
                }
            }
        }
    }

    #[test]
    fn the_camera_sees_every_kind_of_window_and_a_mirrored_church() {
        let mut seen = Vec::new();
        for d in directions(20_000) {
            if let Surface::Glass(kind, _, q) = trace(&Ray { o: EYE, d }).surface {
                assert!(kind.contains(q.x, q.y), "{kind:?} {q}");
                if !seen.contains(&kind) {
                    seen.push(kind);
                }
            }
            let o = DVec3::new(1.0, 2.0, 3.0);
            let m = DVec3::new(-1.0, 1.0, 1.0);
            let (a, b) = (trace(&Ray { o, d }), trace(&Ray { o: o * m, d: d * m }));
            assert!((a.p * m - b.p).length() < 1e-6, "{d}: {} {}", a.p, b.p);
        }
        assert_eq!(seen.len(), 5, "{seen:?}");
    }
}
