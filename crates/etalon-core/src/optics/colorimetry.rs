//! Spectra as linear sRGB: the CIE 1931 observer, daylight, black bodies, and chromaticities of standard illuminants.
//!
//! The matching functions are the analytic fit of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ
//! Color Matching Functions", JCGT 2(2), 2013. Integrals are sums over whole nanometres from 380 to 780.

use std::sync::OnceLock;

/// First and last wavelength of the integrals in nanometres.
const RANGE_NM: [u32; 2] = [380, 780];

/// XYZ to linear sRGB, white D65 (IEC 61966-2-1).
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// Relative power of daylight D65 from 380 to 780 nm in steps of 10 nm (CIE 15:2004, table T.1).
const D65: [f64; 41] = [
    49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354,
    107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886,
    83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604, 69.8856, 75.087, 63.5927, 46.4182,
    66.8054, 63.3828,
];

/// Name and chromaticity x, y of standard illuminants for the observer of 1931 (CIE 15:2004, tables T.3 and T.8.1; the
/// last by the Academy, TB-2018-001). The names are pbrt-v4's.
pub const ILLUMINANTS: &[(&str, [f64; 2])] = &[
    ("stdillum-A", [0.447_58, 0.407_45]),
    ("stdillum-D50", [0.345_67, 0.358_51]),
    ("stdillum-D65", [0.312_72, 0.329_03]),
    ("stdillum-F1", [0.3131, 0.3371]),
    ("stdillum-F2", [0.3721, 0.3751]),
    ("stdillum-F3", [0.4091, 0.3941]),
    ("stdillum-F4", [0.4402, 0.4031]),
    ("stdillum-F5", [0.3138, 0.3452]),
    ("stdillum-F6", [0.3779, 0.3882]),
    ("stdillum-F7", [0.3129, 0.3292]),
    ("stdillum-F8", [0.3458, 0.3586]),
    ("stdillum-F9", [0.3741, 0.3727]),
    ("stdillum-F10", [0.3458, 0.3588]),
    ("stdillum-F11", [0.3805, 0.3769]),
    ("stdillum-F12", [0.4370, 0.4042]),
    ("illum-acesD60", [0.321_68, 0.337_67]),
];

/// The matching functions x̄, ȳ, z̄ at a wavelength in nanometres.
pub fn matching(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let t = (nm - centre) / if nm < centre { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// Relative power of D65 at a wavelength in nanometres, interpolated linearly.
pub fn d65(nm: f64) -> f64 {
    let place = ((nm - f64::from(RANGE_NM[0])) / 10.0).clamp(0.0, 40.0);
    let below = (place as usize).min(39);
    D65[below] + (place - below as f64) * (D65[below + 1] - D65[below])
}

/// Relative power of a black body of `kelvin` at a wavelength in nanometres (Planck's law); 1 at 560 nm.
pub fn black_body(kelvin: f64, nm: f64) -> f64 {
    // The second radiation constant in nm K (CODATA 2018).
    const C2: f64 = 1.438_776_877e7;
    const REFERENCE_NM: f64 = 560.0;
    (REFERENCE_NM / nm).powi(5) * (C2 / (REFERENCE_NM * kelvin)).exp_m1() / (C2 / (nm * kelvin)).exp_m1()
}

/// Linear sRGB of light of the chromaticity x, y and of luminance 1.
pub fn rgb_of_chromaticity([x, y]: [f64; 2]) -> [f64; 3] {
    to_rgb([x / y, 1.0, (1.0 - x - y) / y])
}

/// Linear sRGB of light with the relative power `spectrum` (of nanometres), scaled to luminance 1; channels outside of
/// sRGB's gamut are negative. `None` where it has no luminance.
///
/// Each channel is divided by that of D65, so that D65 is exactly white in spite of the fitted matching functions.
pub fn light_rgb(spectrum: impl Fn(f64) -> f64) -> Option<[f64; 3]> {
    let (rgb, luminance) = relative_to_white(spectrum);
    (luminance > 0.0 && luminance.is_finite()).then(|| rgb.map(|channel| channel / luminance))
}

/// Linear sRGB of a reflectance (a function of nanometres) in daylight D65: a constant becomes that grey.
pub fn reflectance_rgb(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    relative_to_white(|nm| spectrum(nm) * d65(nm)).0
}

/// Linear sRGB of the spectrum, each channel divided by that of D65, and the luminance over D65's.
fn relative_to_white(spectrum: impl Fn(f64) -> f64) -> ([f64; 3], f64) {
    static WHITE: OnceLock<[f64; 3]> = OnceLock::new();
    let white_xyz = WHITE.get_or_init(|| xyz(d65));
    let xyz = xyz(spectrum);
    let (rgb, white) = (to_rgb(xyz), to_rgb(*white_xyz));
    ([0, 1, 2].map(|channel| rgb[channel] / white[channel]), xyz[1] / white_xyz[1])
}

fn xyz(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
    (RANGE_NM[0]..=RANGE_NM[1]).map(f64::from).fold([0.0; 3], |sum, nm| {
        let (power, matching) = (spectrum(nm), matching(nm));
        [0, 1, 2].map(|i| sum[i] + power * matching[i])
    })
}

fn to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    XYZ_TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    #[test]
    fn the_observer_and_daylight_are_the_published_ones() {
        // Values of the CIE's table at 450, 555 and 600 nm; the fit's error is below 0.02.
        for (nm, table) in
            [(450.0, [0.3362, 0.038, 1.7721]), (555.0, [0.5121, 1.0, 0.0057]), (600.0, [1.0622, 0.631, 0.0008])]
        {
            assert!(close(matching(nm), table, 0.02), "{nm}: {:?}", matching(nm));
        }
        assert_eq!([d65(380.0), d65(555.0), d65(560.0), d65(780.0)], [49.9755, 102.023, 100.0, 63.3828]);
        // Its chromaticity.
        let [x, y, z] = xyz(d65);
        let sum = x + y + z;
        assert!((x / sum - 0.3127).abs() < 2e-3 && (y / sum - 0.3290).abs() < 2e-3, "{} {}", x / sum, y / sum);
    }

    #[test]
    fn white_is_white() {
        assert!(close(light_rgb(d65).unwrap(), [1.0; 3], 1e-7));
        assert!(close(reflectance_rgb(|_| 0.25), [0.25; 3], 1e-15));
        let named = |name: &str| ILLUMINANTS.iter().find(|(known, _)| *known == name).unwrap().1;
        assert!(close(rgb_of_chromaticity(named("stdillum-D65")), [1.0; 3], 4e-4));
        for (name, chromaticity) in ILLUMINANTS {
            let rgb = rgb_of_chromaticity(*chromaticity);
            let luminance = 0.212_672_9 * rgb[0] + 0.715_152_2 * rgb[1] + 0.072_175 * rgb[2];
            assert!((luminance - 1.0).abs() < 1e-6 && rgb.iter().all(|&channel| channel > 0.0), "{name}: {rgb:?}");
        }
    }

    /// Illuminant A is a black body of 2855.5 K: its published chromaticity against Planck's law and the matching functions.
    #[test]
    fn black_bodies_have_their_colour() {
        let a = rgb_of_chromaticity(ILLUMINANTS[0].1);
        let planck = light_rgb(|nm| black_body(2855.5, nm)).unwrap();
        assert!(close(a, planck, 0.02), "{a:?} {planck:?}");
        assert!(!close(a, light_rgb(|nm| black_body(3000.0, nm)).unwrap(), 0.02), "5 % hotter is seen");
        // The chromaticity of a black body of 6500 K is 0.3135, 0.3237.
        let (expected, got) = (rgb_of_chromaticity([0.3135, 0.3237]), light_rgb(|nm| black_body(6500.0, nm)).unwrap());
        assert!(close(expected, got, 0.02), "{expected:?} {got:?}");
        // The limit of great heat: λ⁻⁴.
        assert!((black_body(1e9, 400.0) / (560.0f64 / 400.0).powi(4) - 1.0).abs() < 1e-4);
        // Below 1000 K, light is at the end of the range, where the fit is poor: its red is 6 % less than that of the
        // chromaticity 0.6528, 0.3444 there.
        let coldest = light_rgb(|nm| black_body(1000.0, nm)).unwrap();
        assert!(close(rgb_of_chromaticity([0.6528, 0.3444]), coldest, 0.3), "{coldest:?}");
        assert_eq!(light_rgb(|_| 0.0), None);
    }
}
