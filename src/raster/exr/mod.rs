//! OpenEXR files. The `exr` crate parses headers and holds the compression codecs; which bytes are given to them, and
//! how much memory they may ask for, is decided here from the file alone.

mod choose;
mod chunks;
mod decode;
mod encode;

pub(super) use self::decode::decode;
pub use self::encode::{Layer, Precision, write_exr};
