//! The registry of media: dielectrics by their dispersion formulas, and the metals of [`metals`], by name.
//!
//! A new dielectric is one entry in [`DIELECTRICS`], a new metal one in the list of metals: the command line, scene files, the
//! documentation and the tests take their lists from there.

use super::D_LINE_NM;
use super::metals::{self, METALS, Metal};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    /// English name, lower case, or the name in the catalogue of glasses.
    pub name: &'static str,
    /// pbrt-v4's name of the spectrum, if it has one.
    pub spectrum: Option<&'static str>,
    /// The published index at [`D_LINE_NM`].
    pub index_d: f64,
    /// B and C (µm²) of each term of Sellmeier's formula; no term: the index is taken as constant.
    pub sellmeier: &'static [[f64; 2]],
    /// Where the numbers were published.
    pub source: &'static str,
}

const SCHOTT: &str = "Schott, data sheet";

/// Every dielectric known by name, by growing index; then the glasses that pbrt-v4 knows by name.
pub const DIELECTRICS: &[Dielectric] = &[
    Dielectric { name: "ice", spectrum: None, index_d: 1.31, sellmeier: &[], source: "Warren & Brandt 2008, rounded" },
    Dielectric {
        name: "water",
        spectrum: None,
        index_d: 1.3334,
        sellmeier: &[
            [0.568_402_756_5, 0.005_101_829_712],
            [0.172_617_739_1, 0.018_211_539_36],
            [0.020_861_895_78, 0.026_207_222_93],
            [0.113_074_868_8, 10.697_927_21],
        ],
        source: "Daimon & Masumura 2007, at 20 °C",
    },
    Dielectric {
        name: "fused-silica",
        spectrum: None,
        index_d: 1.458_46,
        sellmeier: &[
            [0.696_166_3, 0.068_404_3 * 0.068_404_3],
            [0.407_942_6, 0.116_241_4 * 0.116_241_4],
            [0.897_479_4, 9.896_161 * 9.896_161],
        ],
        source: "Malitson 1965",
    },
    Dielectric {
        name: "acrylic",
        spectrum: None,
        index_d: 1.4906,
        sellmeier: &[[1.1819, 0.011_313]],
        source: "Sultanova et al. 2009",
    },
    Dielectric {
        name: "glass",
        spectrum: None,
        index_d: 1.5234,
        sellmeier: &[],
        source: "soda-lime window glass, Rubin 1985",
    },
    Dielectric {
        name: "polycarbonate",
        spectrum: None,
        index_d: 1.5848,
        sellmeier: &[[1.4182, 0.021_304]],
        source: "Sultanova et al. 2009",
    },
    Dielectric {
        name: "sapphire",
        spectrum: None,
        index_d: 1.7682,
        sellmeier: &[
            [1.431_349_3, 0.072_663_1 * 0.072_663_1],
            [0.650_547_13, 0.119_324_2 * 0.119_324_2],
            [5.341_402_1, 18.028_251 * 18.028_251],
        ],
        source: "Malitson & Dodge 1972, ordinary ray",
    },
    Dielectric {
        name: "diamond",
        spectrum: None,
        index_d: 2.4175,
        sellmeier: &[[0.3306, 0.175 * 0.175], [4.3356, 0.106 * 0.106]],
        source: "Peter 1923",
    },
    Dielectric {
        name: "BK7",
        spectrum: Some("glass-BK7"),
        index_d: 1.5168,
        sellmeier: &[[1.039_612_12, 0.006_000_698_67], [0.231_792_344, 0.020_017_914_4], [1.010_469_45, 103.560_653]],
        source: SCHOTT,
    },
    Dielectric {
        name: "BAF10",
        spectrum: Some("glass-BAF10"),
        index_d: 1.670_03,
        sellmeier: &[[1.585_149_5, 0.009_266_812_82], [0.143_559_385, 0.042_448_980_5], [1.085_212_69, 105.613_573]],
        source: SCHOTT,
    },
    Dielectric {
        name: "FK51A",
        spectrum: Some("glass-FK51A"),
        index_d: 1.486_56,
        sellmeier: &[[0.971_247_817, 0.004_723_019_95], [0.216_901_417, 0.015_357_561_2], [0.904_651_666, 168.681_33]],
        source: SCHOTT,
    },
    Dielectric {
        name: "LASF9",
        spectrum: Some("glass-LASF9"),
        index_d: 1.850_25,
        sellmeier: &[[2.000_295_47, 0.012_142_601_7], [0.298_926_886, 0.053_873_623_6], [1.806_918_43, 156.530_829]],
        source: SCHOTT,
    },
    Dielectric {
        name: "SF5",
        spectrum: Some("glass-F5"),
        index_d: 1.672_71,
        sellmeier: &[[1.524_818_89, 0.011_254_756], [0.187_085_527, 0.058_899_539_2], [1.427_290_15, 129.141_675]],
        source: SCHOTT,
    },
    Dielectric {
        name: "SF10",
        spectrum: Some("glass-F10"),
        index_d: 1.728_28,
        sellmeier: &[[1.621_539_02, 0.012_224_145_7], [0.256_287_842, 0.059_573_677_5], [1.644_475_52, 147.468_793]],
        source: SCHOTT,
    },
    Dielectric {
        name: "SF11",
        spectrum: Some("glass-F11"),
        index_d: 1.784_72,
        sellmeier: &[[1.737_596_95, 0.013_188_707], [0.313_747_346, 0.062_306_814_2], [1.898_781_01, 155.236_29]],
        source: SCHOTT,
    },
];

impl Dielectric {
    /// n at a wavelength in nanometres: n² − 1 = Σ Bᵢ λ² / (λ² − Cᵢ), λ in µm (Sellmeier 1871); [`Dielectric::index_d`]
    /// where no formula is known.
    pub fn index(&self, nm: f64) -> f64 {
        if self.sellmeier.is_empty() {
            return self.index_d;
        }
        let squared = (nm / 1e3).powi(2);
        let terms = self.sellmeier.iter().map(|[b, c]| b * squared / (squared - c));
        (1.0 + terms.sum::<f64>()).sqrt()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Medium {
    /// A transparent one.
    Dielectric(&'static Dielectric),
    Metal(&'static Metal),
}

impl Medium {
    /// Its name; for a metal with the symbol, as "gold (Au)".
    pub fn name(&self) -> String {
        match self {
            Self::Dielectric(dielectric) => dielectric.name.to_owned(),
            Self::Metal(metal) => format!("{} ({})", metal.name, metal.symbol),
        }
    }

    /// n and k at [`D_LINE_NM`].
    pub fn index_d(&self) -> [f64; 2] {
        match self {
            Self::Dielectric(dielectric) => [dielectric.index(D_LINE_NM), 0.0],
            Self::Metal(metal) => metal.index_d(),
        }
    }

    pub fn source(&self) -> &'static str {
        match self {
            Self::Dielectric(dielectric) => dielectric.source,
            Self::Metal(metal) => metal.source,
        }
    }
}

/// All media: the dielectrics, then the metals.
pub fn all() -> impl Iterator<Item = Medium> {
    DIELECTRICS.iter().map(Medium::Dielectric).chain(METALS.iter().map(|metal| Medium::Metal(metal)))
}

/// Looks a medium up by name, or a metal by symbol, in any case.
pub fn by_name(name: &str) -> Option<Medium> {
    let dielectric = DIELECTRICS.iter().find(|medium| medium.name.eq_ignore_ascii_case(name));
    dielectric.map(Medium::Dielectric).or_else(|| metals::by_name(name).map(Medium::Metal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// A wrong digit in a coefficient moves the index of the d line or the dispersion.
    #[test]
    fn the_indices_are_the_published_ones() {
        for medium in DIELECTRICS {
            let index = medium.index(D_LINE_NM);
            // The data sheets have five digits behind the point, the papers four.
            let tolerance = if medium.source == SCHOTT { 1.1e-5 } else { 6e-5 };
            assert!((index - medium.index_d).abs() < tolerance, "{}: {index}", medium.name);
        }
        // Abbe numbers (n_d − 1) / (n_F − n_C): the data sheets'; of water and fused silica, the handbooks'.
        let published = [
            ("water", 55.76, 0.05),
            ("fused-silica", 67.82, 0.02),
            ("BK7", 64.17, 0.02),
            ("BAF10", 47.11, 0.02),
            ("FK51A", 84.47, 0.02),
            ("LASF9", 32.17, 0.02),
            ("SF5", 32.25, 0.02),
            ("SF10", 28.53, 0.02),
            ("SF11", 25.68, 0.02),
        ];
        for (name, abbe, tolerance) in published {
            let Some(Medium::Dielectric(medium)) = by_name(name) else { panic!("{name}") };
            let got = (medium.index(D_LINE_NM) - 1.0) / (medium.index(486.1327) - medium.index(656.2725));
            assert!((got - abbe).abs() < tolerance, "{name}: {got}");
        }
    }

    #[test]
    fn every_medium_has_one_name_and_a_source() {
        let names: BTreeSet<String> = all().map(|medium| medium.name().to_lowercase()).collect();
        assert_eq!(names.len(), all().count());
        for medium in all() {
            let [n, k] = medium.index_d();
            assert!(n > 0.0 && k >= 0.0 && !medium.source().is_empty(), "{}", medium.name());
            let short = medium.name();
            assert_eq!(by_name(short.split(' ').next().unwrap()), Some(medium));
        }
        assert_eq!(by_name("au"), by_name("Gold"));
        assert!(by_name("DIAMOND").is_some() && by_name("unobtainium").is_none());
    }
}
