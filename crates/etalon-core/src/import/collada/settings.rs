//! The settings file in which the course's renderer keeps a camera: 30 numbers, row by row
//!
//! ```text
//! hFov vFov aspect near far              degrees
//! position (3) target (3)
//! phi theta r min-r max-r                radians
//! camera to world, row by row (9): its columns point right, up and back
//! screen width, height, distance
//! focal distance, lens radius
//! ```
//!
//! Fields of view, position and matrix are used; the others follow from them or have no effect.

use crate::error::Result;
use crate::files::{read_bounded, without_bom};
use crate::import::place::{At, finite};
use crate::import::transform::in_range;
use crate::scene::{Camera, PixelFilter, Projection};
use glam::{DMat3, DVec3};
use std::path::Path;

/// How far the matrix may be from orthonormal: files print six digits.
const TOLERANCE: f64 = 1e-3;
const MAX_BYTES: u64 = 1 << 16;
const MAX_SIDE: f64 = 65536.0;

/// Reads the camera at `path`, and the size of the window that it was kept from.
pub fn read(path: &Path) -> Result<(Camera, [usize; 2])> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = String::from_utf8_lossy(without_bom(&bytes));
    let whole = At::file(path.into());
    if text.trim_ascii().is_empty() {
        return Err(whole.input("the file is empty"));
    }
    let mut numbers = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for word in line.split_ascii_whitespace() {
            let column = line[..word.as_ptr() as usize - line.as_ptr() as usize].chars().count() + 1;
            numbers.push(finite(word).map_err(|wrong| At::new(path.into(), i + 1, column).input(wrong))?);
        }
    }
    let Ok(numbers) = <[f64; 30]>::try_from(numbers.as_slice()) else {
        return Err(whole.input(format!("camera settings are 30 numbers, not {}", numbers.len())));
    };
    let fields = [numbers[0], numbers[1]];
    if !fields.iter().all(|&degrees| degrees > 0.0 && degrees < 180.0) {
        return Err(whole.input(format!("the fields of view must be between 0 and 180 degrees, not {fields:?}")));
    }
    let position = DVec3::from_slice(&numbers[5..8]);
    let matrix = DMat3::from_cols_slice(&numbers[16..25]).transpose();
    let error = (matrix.transpose() * matrix - DMat3::IDENTITY).to_cols_array();
    if !in_range(position) || error.iter().any(|x| x.abs() > TOLERANCE) || matrix.determinant() < 0.0 {
        return Err(whole.input("the camera's position is out of range, or its matrix is no rotation"));
    }
    let screen = [numbers[25], numbers[26]];
    if !screen.iter().all(|&side| (1.0..=MAX_SIDE).contains(&side)) {
        return Err(whole.input(format!("the screen's sides must be from 1 to {MAX_SIDE}, not {screen:?}")));
    }
    let [tan_half_width, tan_half_height] = fields.map(|degrees| (degrees.to_radians() * 0.5).tan());
    let forward = -matrix.z_axis.normalize();
    let right = forward.cross(matrix.y_axis).normalize();
    let projection = Projection::Perspective { tan_half_width, tan_half_height };
    let filter = PixelFilter::default();
    let camera = Camera { position, right, up: right.cross(forward), forward, projection, filter };
    Ok((camera, screen.map(|side| side as usize)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: &str =
        "50 35 1.33 0.1 1000\n0 0.5 5 0 0.5 0\n0 0 5 0.1 100\n1 0 0\n0 1 0\n0 0 1\n800 600 500\n4.5 0\n";

    fn read_text(text: &str) -> std::result::Result<(Camera, [usize; 2]), String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("camera.txt");
        std::fs::write(&path, text).unwrap();
        read(&path).map_err(|e| e.to_string())
    }

    #[test]
    fn a_byte_order_mark_and_crlf_are_read() {
        let (camera, size) = read_text(SETTINGS).unwrap();
        assert_eq!(size, [800, 600]);
        assert_eq!(read_text(&format!("\u{feff}{}", SETTINGS.replace('\n', "\r\n"))), Ok((camera, size)));
    }

    #[test]
    fn other_than_30_numbers_are_refused() {
        for (text, expected) in [
            ("", "camera.txt: the file is empty"),
            ("\u{feff}\r\n", "camera.txt: the file is empty"),
            (&format!("{SETTINGS} 7"), "camera settings are 30 numbers, not 31"),
            (&SETTINGS.replace("800", "800,"), "camera.txt:7:1: \"800,\" is not a finite number"),
        ] {
            let error = read_text(text).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
