//! What every file of figures uses.

pub use super::check::Check;
pub use super::figure::{Content, Figure, Printed, Report};
pub use super::inputs::Inputs;
pub use super::papers;
pub use super::studies::Studies;
pub use etalon_core::error::Result;
pub use std::rc::Rc;
