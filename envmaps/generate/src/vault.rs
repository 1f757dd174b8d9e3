//! Where a ray meets the vaults: the union of two crossing tunnels, and the ribs between the bays.

use glam::{DVec2, DVec3};

use crate::plan::{BAY, END, OUTER_BAYS, RIB, RIB_HALF, Vault, bay, bay_z};
use crate::ray::Ray;

/// Where the ray leaves the union of the vault's tunnels between `from` and `to`, with the surface's normal there.
pub fn exit(vault: &Vault, ray: &Ray, from: f64, to: f64) -> Option<(f64, DVec3)> {
    const PROGRESS: f64 = 1e-7;
    let (mut t, mut n) = (from, DVec3::NEG_Y);
    while t < to {
        let p = ray.at(t);
        let long = vault.across.exit(DVec2::new(p.x - vault.centre, p.y), DVec2::new(ray.d.x, ray.d.y));
        if vault.across.contains(p.x - vault.centre, p.y) && long.t > PROGRESS {
            t += long.t;
            n = DVec3::new(long.normal.x, long.normal.y, 0.0);
            continue;
        }
        let a = p.z - bay_z(bay(p.z));
        let cross = vault.along.exit(DVec2::new(a, p.y), DVec2::new(ray.d.z, ray.d.y));
        if vault.along.contains(a, p.y) && cross.t > PROGRESS {
            t += cross.t;
            n = DVec3::new(0.0, cross.normal.y, cross.normal.x);
            continue;
        }
        return Some((t, n));
    }
    None
}

/// The first transverse rib of the nave vault between `from` and `to`.
pub fn rib(ray: &Ray, from: f64, to: f64) -> Option<(f64, DVec3)> {
    let (z0, z1) = (ray.at(from).z, ray.at(to).z);
    let forward = ray.d.z >= 0.0;
    for i in 0..=2 * OUTER_BAYS + 1 {
        let place = f64::from(if forward { i } else { 2 * OUTER_BAYS + 1 - i });
        let z = place * BAY - END;
        if z + RIB_HALF < z0.min(z1) || z - RIB_HALF > z0.max(z1) {
            continue;
        }
        let (near, far) = (ray.reach(2, z - RIB_HALF), ray.reach(2, z + RIB_HALF));
        let (enter, leave) = if ray.d.z == 0.0 { (from, to) } else { (near.min(far).max(from), near.max(far).min(to)) };
        let p = ray.at(enter);
        if p.y > RIB.spring && !RIB.contains(p.x, p.y) {
            return Some((enter, if forward { DVec3::NEG_Z } else { DVec3::Z }));
        }
        let exit = RIB.exit(DVec2::new(p.x, p.y), DVec2::new(ray.d.x, ray.d.y));
        let at = enter + exit.t.max(0.0);
        if at < leave && ray.at(at).y > RIB.spring {
            return Some((at, DVec3::new(exit.normal.x, exit.normal.y, 0.0)));
        }
    }
    None
}
