//! An ammonite on a turned foot: a built-in mesh with silhouettes, hollows and relief at many scales.
//!
//! The shell is a tube along a logarithmic spiral, r = e^(bφ), whose section grows in proportion: Moseley, "On the
//! geometrical forms of turbinated and discoid shells", *Philosophical Transactions* 128, 1838. It carries sickle-shaped
//! ribs that end in knobs and a corded keel; the tube turns inwards at the lip and ends at a wall deep inside.

use super::mesh::Mesh;
use glam::{Mat3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Growth of the spiral per turn.
const WHORL: f32 = 2.05;

/// Turns of the shell, from the first chamber to the lip.
const TURNS: f32 = 4.25;

/// Direction from the axis to the lip, from +x towards +y.
const LIP: f32 = 2.12;

/// Half the height of the tube, over the distance of its middle from the axis.
const TUBE: f32 = 0.365;

/// Width of the tube over its height.
const FLAT: f32 = 0.74;

const RIBS: f32 = 30.0;

/// How far the shell is turned to show its mouth.
const YAW: f32 = 0.62;

/// How deep the shell stands in the foot's cup.
const SUNK: f32 = 0.05;

/// Vertices around the tube, and along it outside and inside.
const AROUND: usize = 68;
const OUTSIDE: usize = 540;
const INSIDE: usize = 56;

/// Vertices around the foot and along its profile.
const FOOT_AROUND: usize = 160;
const FOOT_ALONG: usize = 56;

/// The statue: some 100 000 triangles, closed and smooth, standing on y = 0 around the y axis, 1 high and less than
/// 1.1 wide and deep; its front faces +z. Nothing in it is random.
pub fn statue() -> Mesh {
    let mut mesh = Mesh::default();
    shell(&mut mesh);
    // Its lowest point stands in the foot's cup, on the y axis.
    let lowest = mesh.positions.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a }).unwrap_or_default();
    for p in &mut mesh.positions {
        *p = Mat3::from_rotation_y(YAW) * (*p - lowest) + (TOP - SUNK) * Vec3::Y;
    }
    foot(&mut mesh);
    let [min, max] = mesh.bounds().unwrap_or_default();
    let scale = 1.0 / (max.y - min.y);
    for p in &mut mesh.positions {
        *p = (*p - min.y * Vec3::Y) * scale;
    }
    mesh.smooth();
    mesh
}

/// Adds a closed surface: `rings` closed curves of `columns` points each, and a point before the first and after the
/// last one. Seen from outside, columns advance to the left of the rings' direction.
fn closed(mesh: &mut Mesh, [rings, columns]: [usize; 2], ends: [Vec3; 2], at: impl Fn(usize, usize) -> Vec3) {
    let start = mesh.positions.len();
    let vertex = |ring: usize, column: usize| (start + ring * columns + column % columns) as u32;
    for ring in 0..rings {
        mesh.positions.extend((0..columns).map(|column| at(ring, column)));
    }
    let [first, last] = [0, 1].map(|i| vertex(rings, 0) + i);
    mesh.positions.extend(ends);
    for column in 0..columns {
        mesh.triangles.push([first, vertex(0, column), vertex(0, column + 1)]);
        for ring in 1..rings {
            let [a, b] = [ring - 1, ring].map(|ring| [column, column + 1].map(|column| vertex(ring, column)));
            mesh.triangles.extend([[a[0], b[0], a[1]], [b[0], b[1], a[1]]]);
        }
        mesh.triangles.push([last, vertex(rings - 1, column + 1), vertex(rings - 1, column)]);
    }
}

/// 1 where x is 0, with a width of about `width`.
fn bump(x: f32, width: f32) -> f32 {
    (-(x / width).powi(2)).exp()
}

/// From 0 at `a` to 1 at `b`.
fn step(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Distance of the tube's middle from the axis, `turns` before the lip.
fn spiral(turns: f32) -> f32 {
    WHORL.powf(-turns) * 0.5
}

/// A point of the tube `turns` before the lip: `out` from its middle, over its half height.
fn on_tube(turns: f32, out: Vec2) -> Vec3 {
    let (sin, cos) = (LIP - TAU * turns).sin_cos();
    // The back of the tube is inside the whorl before it; that of the first chamber reaches over the axis, so that one
    // cannot look through.
    let back = 1.25 + (1.15 / TUBE - 1.25) * step(TURNS - 1.2, TURNS - 0.5, turns);
    let inner = if out.x < 0.0 { back } else { 1.0 };
    let r = spiral(turns) * (1.0 + TUBE * inner * out.x);
    Vec3::new(r * cos, r * sin, spiral(turns) * TUBE * FLAT * out.y)
}

/// Height of the relief over the smooth tube, as a part of its half height. `side` is the angle around the tube, 0 at
/// the keel.
fn relief(turns: f32, side: f32) -> f32 {
    let flank = side.abs();
    // Ribs bend forwards near the keel.
    let phase = TAU * RIBS * turns + 1.1 * (2.0 * flank).sin() - 2.6 * bump(flank, 0.55);
    let rib = (0.5 + 0.5 * phase.cos()).powf(1.6);
    let ribs = 0.1 * rib * step(0.2, 0.5, flank) * step(2.75, 2.0, flank);
    let knobs = 0.11 * rib * rib * bump(flank - 0.68, 0.17) + 0.05 * rib * rib * bump(flank - 1.95, 0.2);
    let cord = 0.5 + 0.5 * (TAU * RIBS * turns - 8.0 * side).cos();
    let keel = bump(side, 0.15) * (0.08 + 0.1 * cord);
    let fade = step(0.02, 0.07, turns);
    (ribs + knobs) * (0.25 + 0.75 * fade) + keel - 0.035 * bump(flank - 0.28, 0.1)
}

fn shell(mesh: &mut Mesh) {
    let side = |column: usize| {
        let x = TAU * column as f32 / AROUND as f32 - PI;
        // Closer together at the keel.
        x - 0.45 * x.sin()
    };
    let at = |ring: usize, column: usize| {
        let side = side(column);
        let (sin, cos) = side.sin_cos();
        let unit = Vec2::new(cos, sin);
        if ring < OUTSIDE {
            // Rings are closer together where the shell is small, but fewer to a turn.
            let low = WHORL.powf(-0.5 * TURNS);
            let turns = -2.0 * (low + (1.0 - low) * ring as f32 / (OUTSIDE - 1) as f32).ln() / WHORL.ln();
            let flare = 0.12 * step(0.07, 0.0, turns) - 0.05 * bump(turns - 0.075, 0.02);
            let start = step(TURNS, TURNS - 0.1, turns).sqrt();
            on_tube(turns, unit * (1.0 + relief(turns, side) + flare) * start.max(0.05))
        } else {
            let inward = (ring - OUTSIDE + 1) as f32 / INSIDE as f32;
            // Around the lip, along the inner wall, and together at the back wall.
            let lip = (inward / 0.12).min(1.0);
            let turns = -0.012 * (PI * lip).sin() + 0.3 * inward;
            let wall = 1.12 - 0.2 * (0.5 - 0.5 * (PI * lip).cos());
            let close = (1.0 - step(0.75, 1.05, inward).powi(2)).max(0.0).sqrt();
            let keel = (relief(turns, side) * 0.7).min(0.1);
            on_tube(turns, unit * (wall + keel * (1.0 - lip)) * close)
        }
    };
    let ends = [on_tube(TURNS, Vec2::ZERO), on_tube(0.31, Vec2::ZERO)];
    closed(mesh, [OUTSIDE + INSIDE, AROUND], ends, at);
}

/// Radii of the foot, and the heights that belong to them, from the middle of its bottom to the middle of its top.
const RADII: [f32; 19] = [
    0.0, 0.18, 0.285, 0.3, 0.3, 0.288, 0.27, 0.27, 0.282, 0.27, 0.24, 0.185, 0.14, 0.122, 0.128, 0.155, 0.15, 0.105,
    0.0,
];
const HEIGHTS: [f32; 19] =
    [0.0, 0.0, 0.0, 0.008, 0.03, 0.04, 0.042, 0.05, 0.063, 0.078, 0.083, 0.1, 0.135, 0.17, 0.187, 0.2, 0.22, 0.22, 0.2];

/// Height of the foot's cup.
const TOP: f32 = 0.215;

fn foot(mesh: &mut Mesh) {
    let spans = RADII.len() - 1;
    let at = |ring: usize, column: usize| {
        let x = (ring + 1) as f32 / (FOOT_ALONG + 1) as f32 * spans as f32;
        let (span, t) = ((x as usize).min(spans - 1), x - (x as usize).min(spans - 1) as f32);
        let at = |i: usize| i.clamp(1, spans + 1) - 1;
        let point = |i: usize| Vec2::new(RADII[at(i)], HEIGHTS[at(i)]);
        // Catmull-Rom: through the points, without corners.
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| point(span + i));
        let p = b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
        let angle = TAU * column as f32 / FOOT_AROUND as f32;
        let flutes = step(0.083, 0.105, p.y) * step(0.183, 0.16, p.y) * (10.0 * angle).cos().abs();
        let r = p.x.max(0.002) * (1.0 - 0.09 * flutes);
        Vec3::new(r * angle.cos(), p.y, r * angle.sin())
    };
    let end = |i: usize| HEIGHTS[i] * Vec3::Y;
    closed(mesh, [FOOT_ALONG, FOOT_AROUND], [end(0), end(spans)], at);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn two_closed_surfaces_without_handles() {
        let mesh = statue();
        mesh.validate().unwrap();
        assert!((95_000..=105_000).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
        // Every edge once in each direction.
        let edges: HashSet<_> = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        assert_eq!(edges.len(), 3 * mesh.triangles.len());
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        // Euler: V − E + F is 2 for each sphere; no vertex belongs to none.
        let used: HashSet<_> = mesh.triangles.iter().flatten().collect();
        assert_eq!(used.len(), mesh.positions.len());
        assert_eq!(mesh.positions.len() + mesh.triangles.len(), edges.len() / 2 + 4);
    }

    #[test]
    fn it_stands_in_the_middle_of_the_floor_and_its_facets_look_outwards() {
        let mesh = statue();
        assert!((0..mesh.triangles.len() as u32).all(|i| mesh.facet(i).is_some()));
        let volume = |triangles: &[[u32; 3]]| -> f64 {
            let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
            triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
        };
        let (shell, foot) = mesh.triangles.split_at(2 * AROUND * (OUTSIDE + INSIDE));
        let (shell, foot) = (volume(shell), volume(foot));
        assert!((0.02..0.06).contains(&shell) && (0.01..0.02).contains(&foot), "{shell} {foot}");
        let [min, max] = mesh.bounds().unwrap();
        assert!(min.y == 0.0 && (max.y - 1.0).abs() < 1e-6);
        assert!(min.x.min(min.z) > -0.55 && max.x.max(max.z) < 0.55, "{min} {max}");
        assert!((min.x + max.x).abs() < 0.05 && (min.z + max.z).abs() < 0.05, "{min} {max}");
        assert_eq!(statue(), mesh);
    }
}
