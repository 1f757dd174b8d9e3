//! The gallery: every figure with its checks and its texts (`figures.json`), the run that makes them, and the page that shows them.
//!
//! A figure calls a study, a view and checks; it computes nothing itself. Its file in `figures` calls them, `figures.json` has its
//! texts, and [`registry()`] lists all.

mod check;
mod figure;
mod figures;
mod inputs;
pub mod page;
mod reproduce;

pub use check::{Check, skipped};
pub use figure::FORMATS;
pub use figures::registry;
pub use inputs::{Effort, Inputs, Originals};
pub use reproduce::{Reproduced, Step, reproduce, selected};

/// What every file of figures uses.
mod prelude {
    pub use super::check::Check;
    pub use super::figure::{Content, Printed};
    pub use super::figures::{Maker, maker};
    pub use super::inputs::{Inputs, Studies};
    pub use etalon_core::error::Result;
    pub use std::rc::Rc;
}

#[cfg(test)]
mod readme;

/// What tests of the gallery start from: the smallest inputs, and a record with a failed check.
#[cfg(test)]
mod tests {
    use super::check::Check;
    use super::figure::Numbers;
    use super::inputs::{Effort, Inputs};
    use super::page::{Record, Setup};
    use crate::figure::Style;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::envmap::{EnvMap, NamedMap};
    use std::sync::Arc;

    /// The smallest inputs.
    pub fn inputs() -> Inputs {
        let map = NamedMap { map: Arc::new(EnvMap::new(Synthetic::Onehot.make())), name: "onehot".into() };
        Inputs { map, originals: None, seed: 1, effort: Effort::Quick, style: Style::default(), scale: 1 }
    }

    /// A record with one good and one bad check.
    pub fn record() -> Record {
        Record {
            seconds: 0.25,
            input: "the map onehot".into(),
            checks: vec![Check::equal("good", 1.0, 1.0), Check::within("a <bad> one", 1.0, f64::NAN, 0.5)],
            errata: Vec::new(),
            claims: Vec::new(),
            printed: Vec::new(),
            numbers: Numbers::default(),
            setup: Setup::of(&inputs(), "--quick"),
        }
    }
}
