//! Images of two renderers.

use crate::arrays::numbers;
use crate::caller::run;
use crate::found::Found;
use etalon::raster::Image;
use etalon::study::compare::{Plan, Side, compare};
use glam::Vec3;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::time::Instant;

/// The images of one renderer and what is known of their noise.
#[derive(FromPyObject)]
pub struct Images<'py> {
    /// What it is called in messages.
    name: String,
    /// (n, h, w, 3) or (h, w, 3).
    images: Bound<'py, PyAny>,
    /// (h, w, 3), of one image.
    error: Option<Bound<'py, PyAny>>,
    /// Whether one image has no noise.
    exact: bool,
}

/// Tests whether images of two renderers have one expectation.
#[pyfunction]
pub fn compare_images(
    py: Python<'_>,
    name: &str,
    a: Images<'_>,
    b: Images<'_>,
    level: f64,
    detect: f64,
) -> PyResult<Found> {
    for (name, value) in [("level", level), ("detect", detect)] {
        if !(value > 0.0 && value < 1.0) {
            return Err(PyValueError::new_err(format!("{name}: {value} is not between 0 and 1")));
        }
    }
    let start = Instant::now();
    let (a, b) = (side(&a)?, side(&b)?);
    let compared = run(py, name, move |_| compare(a, b, Plan { level, detect }))?;
    Ok(Found::of_comparison(name, compared, start.elapsed().as_secs_f64()))
}

fn side(images: &Images<'_>) -> PyResult<Side> {
    let Images { name, error, exact, .. } = images;
    let refuse = |message: &str| Err(PyValueError::new_err(format!("{name}: {message}")));
    let (mut read, is_list) = arrays(&images.images, name)?;
    let error = error.as_ref().map(|error| arrays(error, &format!("{name}_error"))).transpose()?;
    match (error, is_list, read.len()) {
        (Some(_), _, _) if *exact => refuse("an image without noise has no standard errors"),
        (None, true, 2..) if !exact => Ok(Side::replicates(read)),
        (error, _, 1) => {
            let image = read.swap_remove(0);
            match error {
                _ if *exact => Ok(Side::exact(image)),
                Some((mut errors, false)) => {
                    let error = errors.swap_remove(0);
                    if (error.width(), error.height()) != (image.width(), image.height()) {
                        return refuse("the image and its standard errors differ in size");
                    }
                    Ok(Side::with_error(image, error))
                }
                _ => refuse(
                    "one image says nothing of its noise: give replicates (n, h, w, 3), standard errors, or exact=True",
                ),
            }
        }
        _ => refuse("standard errors and exact are for one image, not for replicates"),
    }
}

/// Images of an array, and whether it has a dimension for several.
fn arrays(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<Image>, bool)> {
    let array = value.py().import("numpy")?.call_method1("asanyarray", (value,))?;
    if array.getattr("dtype")?.getattr("kind")?.extract::<String>()? == "u" {
        return Err(PyTypeError::new_err(format!(
            "{name}: unsigned integers are values of a display, rounded, clipped and encoded, not radiance; give floats"
        )));
    }
    let array = numbers::<f32>(value, name)?;
    let (w, h, is_list) = match array.shape[..] {
        [n, h, w, 3] if n * h * w > 0 => (w, h, true),
        [h, w, 3] if h * w > 0 => (w, h, false),
        _ => return Err(array.wrong_shape("(h, w, 3) or (n, h, w, 3)")),
    };
    let pixels: Vec<Vec3> = array.values.chunks_exact(3).map(Vec3::from_slice).collect();
    Ok((pixels.chunks_exact(w * h).map(|image| Image::from_pixels(w, h, image.to_vec())).collect(), is_list))
}
