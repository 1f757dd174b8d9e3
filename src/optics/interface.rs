//! The special angles of a dielectric interface, in f64 radians.

/// Brewster's angle atan(η): light polarized in the plane of incidence is not reflected there. Both sides have one.
#[must_use]
pub fn brewster(eta: f64) -> f64 {
    eta.atan()
}

/// The critical angle asin(η), beyond which all light is reflected; `None` where there is none (η ≥ 1).
#[must_use]
pub fn critical(eta: f64) -> Option<f64> {
    (eta < 1.0).then(|| eta.asin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textbook_values() {
        assert!((brewster(1.45).to_degrees() - 55.407_711_312_490_06).abs() < 1e-11);
        assert!((critical(1.0 / 1.45).unwrap().to_degrees() - 43.602_818_972_703_62).abs() < 1e-11);
        assert_eq!(critical(1.0), None);
        assert!((brewster(1.45) + brewster(1.0 / 1.45) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }
}
