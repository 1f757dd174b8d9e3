//! Random numbers for Monte Carlo rendering: hash functions, counter-based streams, the azimuth of a direction in turns.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]
#![warn(missing_docs)]

pub mod hash;
pub mod stream;

use std::f64::consts::PI;

/// The azimuth φ/2π of the point (x, y), in \[0, 1): atan2(y, x) / 2π, plus 1 where that is negative.
#[inline]
#[must_use]
pub fn turns(y: f64, x: f64) -> f64 {
    let t = y.atan2(x) * (0.5 / PI);
    // 1 added to a tiny negative angle rounds to 1, which is the seam: 0.
    if t >= 0.0 {
        t
    } else if t + 1.0 < 1.0 {
        t + 1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seam_is_zero() {
        assert_eq!(turns(-1e-30, 1.0), 0.0);
        assert_eq!(turns(0.0, 1.0), 0.0);
        assert!(turns(-1e-10, 1.0) > 0.999);
    }
}
