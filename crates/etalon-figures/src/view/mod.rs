//! Views: the result of a study as a drawing, as rows of a table or as text. They compute nothing but layout.
//!
//! A view has rows of its own only where the result is nested, which CSV cannot hold; other results are serialized as they are.

pub mod appearance;
pub mod checks;
pub mod compare;
pub mod converge;
pub mod depth;
pub mod fresnel;
pub mod furnace;
pub mod map;
pub mod proposal;
pub mod stability;
pub mod sweep;
pub mod text;
pub mod validation;
pub mod validation_cells;
