//! Float images: the buffer, the file formats, tone mapping.

mod image;

pub use self::image::{Image, Rgb};
