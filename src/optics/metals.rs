//! Complex refractive indices of metals at 614, 549 and 466 nm, the wavelengths that stand for R, G and B.

/// η + i k of a metal in air, for the three colour channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    /// Chemical symbol.
    pub symbol: &'static str,
    /// English name, lower case.
    pub name: &'static str,
    pub eta: [f64; 3],
    pub k: [f64; 3],
}

/// Wavelengths of the three channels in nanometres.
pub const WAVELENGTHS_NM: [f64; 3] = [614.0, 549.0, 466.0];

/// The metals known by name. Iron is the second report's table; the others are those of its course's scenes.
pub const METALS: [Metal; 5] = [
    Metal { symbol: "Ag", name: "silver", eta: [0.059_193, 0.059_881, 0.047_366], k: [4.1283, 3.5892, 2.8132] },
    Metal { symbol: "Al", name: "aluminium", eta: [1.3352, 1.0109, 0.689_55], k: [7.3398, 6.6157, 5.6471] },
    Metal { symbol: "Au", name: "gold", eta: [0.216_46, 0.428_33, 1.3284], k: [3.2390, 2.4599, 1.8661] },
    Metal { symbol: "Cu", name: "copper", eta: [0.332_28, 1.0162, 1.2474], k: [3.1646, 2.5785, 2.4603] },
    Metal { symbol: "Fe", name: "iron", eta: [2.8851, 2.9500, 2.6000], k: [3.0449, 2.9300, 2.7670] },
];

/// Looks a metal up by symbol or name, in any case.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Metal> {
    METALS.iter().find(|m| m.symbol.eq_ignore_ascii_case(name) || m.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductor::normal_reflectance;

    #[test]
    fn every_metal_absorbs_and_reflects_like_a_metal() {
        for metal in METALS {
            for channel in 0..3 {
                assert!(metal.eta[channel] > 0.0 && metal.k[channel] > 1.0, "{}", metal.name);
                let r = normal_reflectance(metal.eta[channel], metal.k[channel]);
                assert!((0.3..1.0).contains(&r), "{} channel {channel}: {r}", metal.name);
            }
        }
        let [gold, copper] = [by_name("au").unwrap(), by_name("Copper").unwrap()];
        for metal in [gold, copper] {
            let r = |c: usize| normal_reflectance(metal.eta[c], metal.k[c]);
            assert!(r(0) > r(1) && r(1) > r(2), "{} is reddish", metal.name);
        }
        assert!(by_name("unobtainium").is_none());
    }
}
