//! Results of studies that several figures show: each is computed once per run of the gallery, when it is first needed.

use super::inputs::Inputs;
use crate::view::map::{Display, Look};
use etalon_core::envmap::info::Info;
use etalon_core::error::Result;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::rc::Rc;

/// The results so far, by type and name.
#[derive(Default)]
pub struct Studies(HashMap<(TypeId, String), Rc<dyn Any>>);

impl Studies {
    /// The result called `name`, computed by `run` if it is not yet known. Names distinguish results of one type.
    pub fn get<T: 'static>(&mut self, name: impl Into<String>, run: impl FnOnce() -> Result<T>) -> Result<Rc<T>> {
        let key = (TypeId::of::<T>(), name.into());
        if let Some(Ok(known)) = self.0.get(&key).map(|known| known.clone().downcast()) {
            return Ok(known);
        }
        let result = Rc::new(run()?);
        self.0.insert(key, result.clone());
        Ok(result)
    }

    pub fn map_info(&mut self, inputs: &Inputs) -> Result<Rc<Info>> {
        self.get("map", || Ok(Info::of(&inputs.map.map)))
    }

    /// The run's environment map, tone-mapped to draw on.
    pub fn map_display(&mut self, inputs: &Inputs) -> Result<Rc<Display>> {
        self.get("map", || Ok(Display::new(&inputs.map.map, Look::default())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_runs_once_for_each_name() {
        let (mut studies, mut runs) = (Studies::default(), 0);
        let results = [3, 4, 3, 3].map(|n: u32| {
            let square = studies.get(n.to_string(), || {
                runs += 1;
                Ok(n * n)
            });
            *square.unwrap()
        });
        assert_eq!((results, runs), ([9, 16, 9, 9], 2));
    }
}
