//! The pointed arch as a flat profile, and openings of that shape cut into a wall.

use glam::{DVec2, DVec3};

/// A pointed arch over the springing line: the part common to two discs whose centres lie on that line, so that
/// each arc continues its jamb without a kink. `a` runs across from the axis, `b` is the height over the floor.
#[derive(Debug, Clone, Copy)]
pub struct Pointed {
    pub half: f64,
    pub spring: f64,
    rise: f64,
    radius: f64,
}

/// Where a line leaves a profile, and the profile's inward normal there.
pub struct Exit {
    pub t: f64,
    pub normal: DVec2,
}

impl Pointed {
    /// Half the span, height of the springing line, height of the apex over it (at least `half`).
    pub const fn new(half: f64, spring: f64, rise: f64) -> Self {
        Self { half, spring, rise, radius: (half * half + rise * rise) / (2.0 * half) }
    }

    pub const fn apex(&self) -> f64 {
        self.spring + self.rise
    }

    /// Distance to the jambs and arcs, positive inside.
    pub fn depth(&self, a: f64, b: f64) -> f64 {
        if b <= self.spring {
            return self.half - a.abs();
        }
        let (x, y) = (a.abs() + self.radius - self.half, b - self.spring);
        self.radius - (x * x + y * y).sqrt()
    }

    pub fn contains(&self, a: f64, b: f64) -> bool {
        self.depth(a, b) >= 0.0
    }

    /// Height of the arc over `a`; the springing height beyond the jambs.
    pub fn height(&self, a: f64) -> f64 {
        let x = a.abs() + self.radius - self.half;
        self.spring + (self.radius * self.radius - x * x).max(0.0).sqrt()
    }

    /// The slope of [`height`](Self::height) at `a`.
    pub fn slope(&self, a: f64) -> f64 {
        let x = a.abs() + self.radius - self.half;
        let y = (self.radius * self.radius - x * x).max(1e-6).sqrt();
        -x / y * a.signum()
    }

    /// Where the line `p + t·d`, inside at its start, crosses the jamb at `+half` or the arc over it.
    pub fn exit_right(&self, p: DVec2, d: DVec2) -> Exit {
        if d.x > 0.0 {
            let t = (self.half - p.x) / d.x;
            if p.y + t * d.y <= self.spring {
                return Exit { t, normal: DVec2::NEG_X };
            }
        }
        let never = Exit { t: f64::INFINITY, normal: DVec2::NEG_X };
        let c = DVec2::new(p.x + self.radius - self.half, p.y - self.spring);
        let (dd, cd) = (d.dot(d), c.dot(d));
        let root = cd * cd - dd * (c.dot(c) - self.radius * self.radius);
        if root < 0.0 || dd == 0.0 {
            return never;
        }
        let t = (root.sqrt() - cd) / dd;
        if c.y + t * d.y < 0.0 { never } else { Exit { t, normal: (c + d * t) / -self.radius } }
    }

    /// Where the line `p + t·d`, inside at its start, crosses either side.
    pub fn exit(&self, p: DVec2, d: DVec2) -> Exit {
        let flip = DVec2::new(-1.0, 1.0);
        let right = self.exit_right(p, d);
        let left = self.exit_right(p * flip, d * flip);
        if right.t <= left.t { right } else { Exit { t: left.t, normal: left.normal * flip } }
    }
}

/// A vertical plane with its own axes: `right` (horizontal) and `out` (away from the room), `origin` on the floor.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub origin: DVec3,
    pub right: DVec3,
    pub out: DVec3,
}

impl Frame {
    /// (across, height, depth behind the plane) of a point.
    pub fn local(&self, p: DVec3) -> DVec3 {
        let q = p - self.origin;
        DVec3::new(q.dot(self.right), q.y, q.dot(self.out))
    }

    pub fn local_direction(&self, d: DVec3) -> DVec3 {
        DVec3::new(d.dot(self.right), d.y, d.dot(self.out))
    }

    pub fn world_direction(&self, v: DVec3) -> DVec3 {
        self.right * v.x + DVec3::Y * v.y + self.out * v.z
    }

    pub fn world(&self, q: DVec3) -> DVec3 {
        self.origin + self.world_direction(q)
    }
}

/// What a line meets inside a recess: its side (with the normal in the wall's axes) or its back.
pub enum Met {
    Reveal(DVec3),
    Back,
}

/// A recess of pointed outline: flat sill, straight sides going back by `depth`.
#[derive(Debug, Clone, Copy)]
pub struct Recess {
    pub outline: Pointed,
    pub sill: f64,
    pub depth: f64,
}

impl Recess {
    pub fn contains(&self, a: f64, b: f64) -> bool {
        b > self.sill && self.outline.contains(a, b)
    }

    /// Follows the line from `p` in the wall's face (local axes of a [`Frame`]) to the first thing met behind it.
    pub fn trace(&self, p: DVec3, d: DVec3) -> (f64, Met) {
        let mut t = self.depth / d.z.max(1e-9);
        let mut met = Met::Back;
        let side = self.outline.exit(p.truncate(), d.truncate());
        if side.t < t {
            t = side.t.max(0.0);
            met = Met::Reveal(side.normal.extend(0.0));
        }
        let sill = (self.sill - p.y) / d.y;
        if d.y < 0.0 && sill < t {
            t = sill;
            met = Met::Reveal(DVec3::Y);
        }
        (t, met)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_arcs_meet_at_the_apex_and_continue_the_jambs() {
        let arch = Pointed::new(2.3, 4.5, 3.0);
        assert!((arch.height(0.0) - arch.apex()).abs() < 1e-12);
        assert!((arch.height(2.3) - 4.5).abs() < 1e-12);
        assert!(arch.contains(2.29, 4.6) && !arch.contains(2.31, 4.4) && !arch.contains(0.0, 7.51));
        let h = 1e-5;
        let slope = (arch.height(1.0 + h) - arch.height(1.0 - h)) / (2.0 * h);
        assert!((arch.slope(1.0) - slope).abs() < 1e-8);
    }

    #[test]
    fn a_line_leaves_the_arch_on_its_outline() {
        let arch = Pointed::new(2.3, 4.5, 3.0);
        for i in (0..360).filter(|&i| i != 270) {
            let angle = f64::from(i).to_radians();
            let (p, d) = (DVec2::new(0.4, 4.2), DVec2::new(libm::cos(angle), libm::sin(angle)));
            let exit = arch.exit(p, d);
            let q = p + d * exit.t;
            assert!(exit.t > 0.0 && arch.depth(q.x, q.y).abs() < 1e-9, "{i}°");
            assert!((exit.normal.length() - 1.0).abs() < 1e-9 && exit.normal.dot(d) < 0.0, "{i}°");
        }
    }
}
