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
    /// Where the numbers were measured.
    pub source: &'static str,
}

const NOBLE: &str = "Johnson & Christy 1972";
const ALUMINIUM: &str = "Rakic 1995";
const IRON: &str = "second report, Table 1 (within 0.002 of Johnson & Christy 1974)";

/// Wavelengths of the three channels in nanometres.
pub const WAVELENGTHS_NM: [f64; 3] = [614.0, 549.0, 466.0];

/// The metals known by name. Iron is Table 1 of the second report; the others are those of its course's scenes.
///
/// Sources, interpolated linearly in the wavelength: Johnson & Christy, "Optical constants of the noble metals", Phys.
/// Rev. B 6, 4370 (1972), for silver, gold and copper; Rakić, "Algorithm for the determination of intrinsic optical
/// constants of metal films: application to aluminum", Appl. Opt. 34, 4755 (1995). The report's iron is that of Johnson &
/// Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056 (1974), but for k at 466 nm, which is 0.002
/// larger.
#[rustfmt::skip]
pub const METALS: [Metal; 5] = [
    Metal { symbol: "Ag", name: "silver", eta: [0.059_193, 0.059_881, 0.047_366], k: [4.1283, 3.5892, 2.8132], source: NOBLE },
    Metal { symbol: "Al", name: "aluminium", eta: [1.3352, 1.0109, 0.689_55], k: [7.3398, 6.6157, 5.6471], source: ALUMINIUM },
    Metal { symbol: "Au", name: "gold", eta: [0.216_46, 0.428_33, 1.3284], k: [3.2390, 2.4599, 1.8661], source: NOBLE },
    Metal { symbol: "Cu", name: "copper", eta: [0.332_28, 1.0162, 1.2474], k: [3.1646, 2.5785, 2.4603], source: NOBLE },
    Metal { symbol: "Fe", name: "iron", eta: [2.8851, 2.9500, 2.6500], k: [3.0449, 2.9300, 2.8095], source: IRON },
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

    /// Rows (wavelength, η, k) of the published tables, on either side of each channel's wavelength.
    type Rows = [[[f64; 3]; 2]; 3];

    #[test]
    fn the_indices_are_those_of_the_published_tables() {
        const PUBLISHED: [(&str, Rows); 5] = [
            (
                "Ag",
                [
                    [[582.1, 0.05, 3.858], [616.8, 0.06, 4.152]],
                    [[548.6, 0.06, 3.586], [582.1, 0.05, 3.858]],
                    [[450.9, 0.04, 2.657], [471.4, 0.05, 2.869]],
                ],
            ),
            (
                "Al",
                [
                    [[563.57, 1.0728, 6.7839], [619.93, 1.3660, 7.4052]],
                    [[516.60, 0.8734, 6.2418], [563.57, 1.0728, 6.7839]],
                    [[442.80, 0.6079, 5.3676], [476.87, 0.7278, 5.7781]],
                ],
            ),
            (
                "Au",
                [
                    [[582.1, 0.29, 2.863], [616.8, 0.21, 3.272]],
                    [[548.6, 0.43, 2.455], [582.1, 0.29, 2.863]],
                    [[450.9, 1.38, 1.914], [471.4, 1.31, 1.849]],
                ],
            ),
            (
                "Cu",
                [
                    [[582.1, 0.70, 2.704], [616.8, 0.30, 3.205]],
                    [[548.6, 1.02, 2.577], [582.1, 0.70, 2.704]],
                    [[450.9, 1.24, 2.397], [471.4, 1.25, 2.483]],
                ],
            ),
            (
                "Fe",
                [
                    [[582.0, 2.94, 2.99], [617.0, 2.88, 3.05]],
                    [[549.0, 2.95, 2.93], [582.0, 2.94, 2.99]],
                    [[451.0, 2.59, 2.77], [471.0, 2.67, 2.82]],
                ],
            ),
        ];
        for (symbol, rows) in PUBLISHED {
            let metal = by_name(symbol).unwrap();
            for (channel, [low, high]) in rows.into_iter().enumerate() {
                let t = (WAVELENGTHS_NM[channel] - low[0]) / (high[0] - low[0]);
                let [eta, k] = [1, 2].map(|i| low[i] + t * (high[i] - low[i]));
                // The report's iron differs from the published table in one number.
                let tolerance = if (symbol, channel) == ("Fe", 2) { 2.1e-3 } else { 6e-5 };
                let (off_eta, off_k) = ((metal.eta[channel] - eta).abs(), (metal.k[channel] - k).abs());
                assert!(off_eta < 6e-5 && off_k < tolerance, "{symbol} {channel}: {eta} {k}");
            }
        }
        // Table 1 of the second report.
        let iron = by_name("Fe").unwrap();
        assert_eq!((iron.eta, iron.k), ([2.8851, 2.9500, 2.6500], [3.0449, 2.9300, 2.8095]));
    }
}
