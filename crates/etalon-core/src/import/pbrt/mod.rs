//! Reads scenes in the formats of pbrt-v2, v3 and v4, as far as this renderer supports them.
//!
//! Everything in a file has its effect or is an error with file, line and column. Only directives that cannot change the
//! image (`Accelerator`, for example) are left out, and only missing values are filled in, both with a warning.
//!
//! | directive | supported |
//! |---|---|
//! | `Identity`, `Translate`, `Scale`, `Rotate`, `LookAt`, `Transform`, `ConcatTransform`, `CoordinateSystem`, `CoordSysTransform`, `ReverseOrientation` | all, as long as the matrix has an inverse |
//! | `AttributeBegin`, `TransformBegin`, `WorldBegin` and their ends, `Include`, `Import` | all; file names are relative to the first file |
//! | `Camera` | `orthographic`, `perspective`, without a lens |
//! | `Film` | `image`, `rgb`: size and file name |
//! | `PixelFilter` | `box`, `triangle`, `gaussian` |
//! | `Sampler` | the number of samples |
//! | `SurfaceIntegrator`, `Integrator` | `directlighting`, `path`, `volpath`; as `path` with a warning: `whitted`, `simplepath`, `simplevolpath`, `randomwalk`, `lightpath`, `bdpt`, `mlt`, `sppm` |
//! | `Material`, `MakeNamedMaterial`, `NamedMaterial` | `matte`, `diffuse`; `mirror`; `glass`, `dielectric`; `metal` (not pbrt-v2's), `conductor`, also by its `reflectance`, on both sides; rough ones, also anisotropic, with GGX or, as `"string distribution" "beckmann"`, Beckmann microfacets; `coateddiffuse` with a smooth coat that absorbs nothing, others as that with a warning; `mix` of two named materials |
//! | `Texture` | `constant`, `imagemap`, `checkerboard` (in two dimensions), `scale`, `mix`, with the mapping `uv`; for reflectance, transmittance and roughness |
//! | `Shape` | `sphere`, whole and round; `trianglemesh`, `plymesh`; `bilinearmesh` of parallelograms; whole `disk`, as a polygon of the same area |
//! | `Option` | those without an effect on the expected image |
//! | `ObjectBegin`, `ObjectEnd`, `ObjectInstance` | shapes that emit no light; each instance is a copy |
//! | `MakeNamedMedium`, `MediumInterface` | only media that no surface and no camera is in |
//! | `LightSource` | one `infinite`, constant, with a lat-long map, or with a square equal-area map, which is resampled; `distant`, `point`; pbrt-v4's `power` of points and `illuminance` of the others without a map |
//! | spectra | pbrt-v4's names, samples, files and `blackbody`, as RGB, or as indices of refraction at stated wavelengths (`spectrum.rs`) |
//!
//! Source: the format descriptions and sources of pbrt-v2 (2010), pbrt-v3 (2016) and pbrt-v4 (2020) at pbrt.org.

mod directives;
mod lexer;
mod light;
mod material;
mod params;
mod reader;
mod setup;
mod shape;
mod spectrum;
mod texture;

use super::{Imported, SceneOptions};
use crate::error::{Error, Result};
use std::path::Path;

/// Reads the scene at `path`.
///
/// # Errors
/// What is wrong or not supported in the file or in those that it includes, with its place (a map that cannot be opened is
/// reported where the file names it); [`Error::Parameter`] for camera settings, which are for COLLADA.
pub fn read(path: &Path, options: &SceneOptions) -> Result<Imported> {
    if options.camera.is_some() {
        return Err(Error::parameter("camera", "camera settings are for COLLADA scenes")
            .with_hint("a .pbrt file has its camera in itself"));
    }
    let Imported { scene, request, output, warnings } = reader::Reader::scene(path, options)?;
    let (scene, request) = match options.resolution {
        Some(size) => scene.resized(request, size),
        None => (scene, request),
    };
    Ok(Imported { scene, request, output, warnings })
}
