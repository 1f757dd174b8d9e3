//! A ray, and what it meets.

use glam::{DVec2, DVec3};

use crate::plan::Kind;

/// What a ray met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface {
    Floor,
    Wall,
    /// Dressed stone: soffits, ribs, reveals.
    Dressed,
    Vault,
    AisleVault,
    ApseVault,
    Column,
    Niche,
    Door,
    Iron,
    Wax,
    Altar,
    /// Window kind and number, and the place in it: across, height.
    Glass(Kind, i32, DVec2),
}

#[derive(Debug, Clone, Copy)]
pub struct Hit {
    pub t: f64,
    pub p: DVec3,
    /// Towards the side that the ray came from.
    pub n: DVec3,
    pub surface: Surface,
}

/// A straight line from `o`; `d` is unit.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    pub o: DVec3,
    pub d: DVec3,
}

impl Ray {
    pub fn at(&self, t: f64) -> DVec3 {
        self.o + self.d * t
    }

    pub fn hit(&self, t: f64, n: DVec3, surface: Surface) -> Hit {
        Hit { t, p: self.at(t), n, surface }
    }

    /// Where the coordinate `axis` reaches `value`, if that lies ahead.
    pub fn reach(&self, axis: usize, value: f64) -> f64 {
        let d = self.d[axis];
        if d == 0.0 { f64::INFINITY } else { (value - self.o[axis]) / d }
    }

    /// Where the ray leaves the slab `low..high` of coordinate `axis`.
    pub fn leave(&self, axis: usize, low: f64, high: f64) -> f64 {
        self.reach(axis, if self.d[axis] < 0.0 { low } else { high })
    }

    pub fn mirrored(&self, side: f64) -> Self {
        let m = DVec3::new(side, 1.0, 1.0);
        Self { o: self.o * m, d: self.d * m }
    }
}
