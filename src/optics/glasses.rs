//! Indices of refraction of optical glasses, by Sellmeier's formula.

/// A glass of the catalogue of Schott.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glass {
    /// pbrt-v4's name of the spectrum.
    pub name: &'static str,
    /// Schott's name.
    pub schott: &'static str,
    /// B of the three terms.
    pub b: [f64; 3],
    /// C of the three terms, in µm².
    pub c: [f64; 3],
    /// The catalogue's index at [`D_LINE_NM`].
    pub index_d: f64,
}

/// The line of helium at which catalogues state the index, in nanometres.
pub const D_LINE_NM: f64 = 587.5618;

/// Every glass known by name. Source: Schott's data sheets.
pub const GLASSES: &[Glass] = &[
    Glass {
        name: "glass-BK7",
        schott: "N-BK7",
        b: [1.039_612_12, 0.231_792_344, 1.010_469_45],
        c: [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
        index_d: 1.5168,
    },
    Glass {
        name: "glass-BAF10",
        schott: "N-BAF10",
        b: [1.585_149_5, 0.143_559_385, 1.085_212_69],
        c: [0.009_266_812_82, 0.042_448_980_5, 105.613_573],
        index_d: 1.670_03,
    },
    Glass {
        name: "glass-FK51A",
        schott: "N-FK51A",
        b: [0.971_247_817, 0.216_901_417, 0.904_651_666],
        c: [0.004_723_019_95, 0.015_357_561_2, 168.681_33],
        index_d: 1.486_56,
    },
    Glass {
        name: "glass-LASF9",
        schott: "N-LASF9",
        b: [2.000_295_47, 0.298_926_886, 1.806_918_43],
        c: [0.012_142_601_7, 0.053_873_623_6, 156.530_829],
        index_d: 1.850_25,
    },
    Glass {
        name: "glass-F5",
        schott: "N-SF5",
        b: [1.524_818_89, 0.187_085_527, 1.427_290_15],
        c: [0.011_254_756, 0.058_899_539_2, 129.141_675],
        index_d: 1.672_71,
    },
    Glass {
        name: "glass-F10",
        schott: "N-SF10",
        b: [1.621_539_02, 0.256_287_842, 1.644_475_52],
        c: [0.012_224_145_7, 0.059_573_677_5, 147.468_793],
        index_d: 1.728_28,
    },
    Glass {
        name: "glass-F11",
        schott: "N-SF11",
        b: [1.737_596_95, 0.313_747_346, 1.898_781_01],
        c: [0.013_188_707, 0.062_306_814_2, 155.236_29],
        index_d: 1.784_72,
    },
];

impl Glass {
    /// n at a wavelength in nanometres: n² − 1 = Σ Bᵢ λ² / (λ² − Cᵢ), λ in µm (Sellmeier 1871).
    #[must_use]
    pub fn index(&self, nm: f64) -> f64 {
        let squared = (nm / 1e3).powi(2);
        let terms = self.b.iter().zip(self.c).map(|(b, c)| b * squared / (squared - c));
        (1.0 + terms.sum::<f64>()).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wrong digit in a coefficient moves the index of the d line or the dispersion.
    #[test]
    fn the_indices_are_the_catalogues() {
        // Abbe numbers (n_d − 1) / (n_F − n_C) of the data sheets.
        let abbe = [64.17, 47.11, 84.47, 32.17, 32.25, 28.53, 25.68];
        for (glass, abbe) in GLASSES.iter().zip(abbe) {
            let index = glass.index(D_LINE_NM);
            assert!((index - glass.index_d).abs() < 1.1e-5, "{}: {index}", glass.name);
            let got = (index - 1.0) / (glass.index(486.1327) - glass.index(656.2725));
            assert!((got - abbe).abs() < 0.02, "{}: {got}", glass.name);
        }
    }
}
