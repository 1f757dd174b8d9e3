//! The primaries of a file's colours.

/// CIE x and y of red, green, blue and white in Rec. 709 (and sRGB).
const REC_709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];

/// Files round them to three or four digits.
const TOLERANCE: f32 = 1e-3;

/// A note on an image with these primaries and white point (CIE x and y of R, G, B, W), from the field `name`, unless they
/// are those of Rec. 709: colours are not converted. Some programs (HDR Shop) write zeros for unknown primaries.
pub(super) fn note(name: &str, found: [f32; 8]) -> Option<String> {
    let is_equal = found.iter().zip(REC_709).all(|(a, b)| (a - b).abs() <= TOLERANCE);
    (!is_equal && found != [0.0; 8])
        .then(|| format!("{name} {found:?} are not those of Rec. 709; R, G and B are taken as linear Rec. 709 anyway"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_primaries_are_told_from_rec_709() {
        assert_eq!(note("chromaticities", REC_709), None);
        assert_eq!(note("PRIMARIES", [0.0; 8]), None);
        assert_eq!(note("chromaticities", [0.6401, 0.33, 0.3, 0.6, 0.15, 0.06, 0.31271, 0.32902]), None);
        // AP0 of ACES, CIE XYZ, and what is no number.
        for other in [
            [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767],
            [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0],
            [f32::NAN; 8],
        ] {
            assert!(note("chromaticities", other).unwrap().contains("Rec. 709"));
        }
    }
}
