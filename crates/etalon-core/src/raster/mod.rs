//! Float images: the buffer, the file formats, tone mapping, metrics.
//!
//! [`read`] takes OpenEXR, Radiance HDR and PFM files (and clipped 8- or 16-bit images if asked to), detected by
//! their content; [`write`](write()) picks the format by the extension; [`ExrFile`] has all layers of an OpenEXR file.
//! Values are linear RGB and are returned as they stand in the file: negative and non-finite ones included.

mod decoded;
mod exr;
mod file;
mod image;
mod ldr;
mod metrics;
mod pfm;
mod rgbe;
mod tone;

pub use self::exr::{Channel, ExrFile, Layer, Precision, Samples, write_exr, write_exr_channels};
pub use self::image::Image;
pub use self::metrics::{Comparison, DisplayMetrics, compare, compare_shown, compare_with_halves};
pub use self::tone::{ToneMap, auto_exposure, linear_from_srgb, srgb_from_linear, to_rgb8};
pub use file::{ReadOptions, WriteOptions, decode_exr, read, read_lat_long, read_with_notes, write, write_with};
pub use image::{BUILD_NAME, Metadata};
