//! Complex refractive indices of metals at 614, 549 and 466 nm, the wavelengths that stand for R, G and B.
//!
//! A new metal is one entry in [`METALS`]'s list below: everything that speaks of metals (the command line, scene files,
//! the statue scenes, the figure of all metals, the tests) takes its list from there.

use super::D_LINE_NM;
use crate::math::Rgb;

/// η + i k of a metal in air, for the three colour channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    pub symbol: &'static str,
    /// English name, lower case.
    pub name: &'static str,
    /// Index of refraction at the [`WAVELENGTHS_NM`].
    pub eta: [f64; 3],
    /// Extinction coefficient there.
    pub k: [f64; 3],
    /// Where the numbers were measured.
    pub source: &'static str,
    /// Rows (wavelength in nm, η, k) of the published table on either side of each channel's wavelength: η and k are
    /// interpolated between them.
    pub published: [[[f64; 3]; 2]; 3],
}

impl Metal {
    pub fn eta_rgb(&self) -> Rgb {
        Rgb::from_array(self.eta.map(|x| x as f32))
    }

    pub fn k_rgb(&self) -> Rgb {
        Rgb::from_array(self.k.map(|x| x as f32))
    }

    /// η and k at the d line ([`D_LINE_NM`]), interpolated linearly in the published table.
    pub fn index_d(&self) -> [f64; 2] {
        // The rows about the red channel's wavelength lie about the d line, too.
        interpolated(self.published[0], D_LINE_NM)
    }
}

/// Wavelengths of the three channels in nanometres.
pub const WAVELENGTHS_NM: [f64; 3] = [614.0, 549.0, 466.0];

/// η and k at a wavelength between two rows of a published table.
fn interpolated([low, high]: [[f64; 3]; 2], nm: f64) -> [f64; 2] {
    let t = (nm - low[0]) / (high[0] - low[0]);
    [1, 2].map(|i| low[i] + t * (high[i] - low[i]))
}

/// Makes a constant of each metal, and [`METALS`] of them all.
macro_rules! metals {
    ($($(#[$doc:meta])* $constant:ident = $metal:expr;)*) => {
        $($(#[$doc])* pub const $constant: &Metal = &$metal;)*

        /// Every metal known by name, in the order of their symbols.
        ///
        /// η and k are interpolated linearly in the wavelength. Sources: Johnson & Christy, "Optical constants of the noble
        /// metals", Phys. Rev. B 6, 4370 (1972), for silver, gold and copper; Rakić, "Algorithm for the determination of
        /// intrinsic optical constants of metal films: application to aluminum", Appl. Opt. 34, 4755 (1995). Iron is Table 1
        /// of the second report: Johnson & Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056 (1974),
        /// except for k at 466 nm, which is 0.002 larger.
        pub const METALS: &[&Metal] = &[$($constant),*];
    };
}

metals! {
    /// Silver.
    SILVER = Metal {
        symbol: "Ag",
        name: "silver",
        eta: [0.059_193, 0.059_881, 0.047_366],
        k: [4.1283, 3.5892, 2.8132],
        source: "Johnson & Christy 1972",
        published: [
            [[582.1, 0.05, 3.858], [616.8, 0.06, 4.152]],
            [[548.6, 0.06, 3.586], [582.1, 0.05, 3.858]],
            [[450.9, 0.04, 2.657], [471.4, 0.05, 2.869]],
        ],
    };
    /// Aluminium.
    ALUMINIUM = Metal {
        symbol: "Al",
        name: "aluminium",
        eta: [1.3352, 1.0109, 0.689_55],
        k: [7.3398, 6.6157, 5.6471],
        source: "Rakic 1995",
        published: [
            [[563.57, 1.0728, 6.7839], [619.93, 1.3660, 7.4052]],
            [[516.60, 0.8734, 6.2418], [563.57, 1.0728, 6.7839]],
            [[442.80, 0.6079, 5.3676], [476.87, 0.7278, 5.7781]],
        ],
    };
    /// Gold.
    GOLD = Metal {
        symbol: "Au",
        name: "gold",
        eta: [0.216_46, 0.428_33, 1.3284],
        k: [3.2390, 2.4599, 1.8661],
        source: "Johnson & Christy 1972",
        published: [
            [[582.1, 0.29, 2.863], [616.8, 0.21, 3.272]],
            [[548.6, 0.43, 2.455], [582.1, 0.29, 2.863]],
            [[450.9, 1.38, 1.914], [471.4, 1.31, 1.849]],
        ],
    };
    /// Copper.
    COPPER = Metal {
        symbol: "Cu",
        name: "copper",
        eta: [0.332_28, 1.0162, 1.2474],
        k: [3.1646, 2.5785, 2.4603],
        source: "Johnson & Christy 1972",
        published: [
            [[582.1, 0.70, 2.704], [616.8, 0.30, 3.205]],
            [[548.6, 1.02, 2.577], [582.1, 0.70, 2.704]],
            [[450.9, 1.24, 2.397], [471.4, 1.25, 2.483]],
        ],
    };
    /// Iron.
    IRON = Metal {
        symbol: "Fe",
        name: "iron",
        eta: [2.8851, 2.9500, 2.6500],
        k: [3.0449, 2.9300, 2.8095],
        source: "second report, Table 1 (within 0.002 of Johnson & Christy 1974)",
        published: [
            [[582.0, 2.94, 2.99], [617.0, 2.88, 3.05]],
            [[549.0, 2.95, 2.93], [582.0, 2.94, 2.99]],
            [[451.0, 2.59, 2.77], [471.0, 2.67, 2.82]],
        ],
    };
}

/// Looks a metal up by symbol or name, in any case.
pub fn by_name(name: &str) -> Option<&'static Metal> {
    METALS.iter().copied().find(|m| m.symbol.eq_ignore_ascii_case(name) || m.name.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductor::normal_reflectance;

    #[test]
    fn every_metal_is_named_and_absorbs_and_reflects_like_a_metal() {
        assert!(METALS.is_sorted_by_key(|metal| metal.symbol));
        for metal in METALS {
            assert!(!metal.source.is_empty(), "{}", metal.symbol);
            assert_eq!([by_name(metal.symbol), by_name(metal.name)], [Some(*metal); 2]);
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

    #[test]
    fn the_indices_are_those_of_the_published_tables() {
        for metal in METALS {
            let [low, high] = metal.published[0];
            assert!((low[0]..=high[0]).contains(&D_LINE_NM), "{}: the d line is not between these rows", metal.name);
            for (channel, [low, high]) in metal.published.into_iter().enumerate() {
                let nm = WAVELENGTHS_NM[channel];
                assert!((low[0]..=high[0]).contains(&nm), "{} {channel}: not between these wavelengths", metal.name);
                let [eta, k] = interpolated([low, high], nm);
                // Iron, as the second report has it, differs from the published table in one number.
                let tolerance = if (metal.symbol, channel) == ("Fe", 2) { 2.1e-3 } else { 6e-5 };
                let (off_eta, off_k) = ((metal.eta[channel] - eta).abs(), (metal.k[channel] - k).abs());
                assert!(off_eta < 6e-5 && off_k < tolerance, "{} {channel}: {eta} {k}", metal.name);
            }
        }
    }
}
