//! OpenEXR files. The `exr` crate parses headers and holds the compression codecs; which bytes are given to them, and
//! how much memory they may ask for, is decided here from the file alone.

mod choose;
mod decode;
mod encode;
mod file;

pub(super) use self::decode::decode;
pub use self::encode::{Channel, Layer, Precision, Samples, write_exr, write_exr_channels};
pub use decode::ExrFile;
