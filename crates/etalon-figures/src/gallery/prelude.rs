//! What every file of figures uses.

pub use super::check::Check;
pub use super::figure::{Content, Printed};
pub use super::figures::{Maker, maker};
pub use super::inputs::{Inputs, Studies};
pub use etalon_core::error::Result;
pub use std::rc::Rc;
