//! Results of studies that several figures show: each study runs once per run of the gallery, when it is first needed.

use super::inputs::Inputs;
use crate::error::Result;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::hash::Hash;
use std::rc::Rc;

/// A study that several figures share, with the parameters that distinguish its results.
///
/// A figure's file defines a type for its study; no other file needs it.
pub trait Study: Copy + Eq + Hash + 'static {
    /// The study's plain result.
    type Output: 'static;

    /// Computes the result.
    ///
    /// # Errors
    /// Those of the study.
    fn run(self, inputs: &Inputs) -> Result<Self::Output>;
}

/// The results so far, by the type of the study and its parameters.
#[derive(Default)]
pub struct Studies(HashMap<TypeId, Box<dyn Any>>);

impl Studies {
    /// The result of `study`, computed now if it is not yet known. All calls must pass the same inputs.
    ///
    /// # Errors
    /// Those of the study.
    pub fn get<S: Study>(&mut self, study: S, inputs: &Inputs) -> Result<Rc<S::Output>> {
        type Known<S> = HashMap<S, Rc<<S as Study>::Output>>;
        let known = self.0.entry(TypeId::of::<S>()).or_insert_with(|| Box::new(Known::<S>::new()));
        // An entry under a study's type is a map of that type's results.
        let Some(known) = known.downcast_mut::<Known<S>>() else { return study.run(inputs).map(Rc::new) };
        if let Some(result) = known.get(&study) {
            return Ok(result.clone());
        }
        let result = Rc::new(study.run(inputs)?);
        known.insert(study, result.clone());
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::tests::inputs;
    use std::cell::Cell;

    thread_local!(static RUNS: Cell<u32> = const { Cell::new(0) });

    #[derive(Clone, Copy, PartialEq, Eq, Hash)]
    struct Square(u32);

    impl Study for Square {
        type Output = u32;

        fn run(self, _: &Inputs) -> Result<u32> {
            RUNS.set(RUNS.get() + 1);
            Ok(self.0 * self.0)
        }
    }

    #[test]
    fn a_study_runs_once_for_each_parameter() {
        let (inputs, mut studies) = (inputs(), Studies::default());
        let results = [3, 4, 3, 3].map(|n| *studies.get(Square(n), &inputs).unwrap());
        assert_eq!((results, RUNS.get()), ([9, 16, 9, 9], 2));
    }
}
