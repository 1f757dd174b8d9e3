//! Families: BSDFs of one kind over their parameters.

use super::batch::BatchBsdf;
use super::contract::Parameter;
use crate::error::Result;

/// BSDFs of one kind over their parameters: what sweeps and furnace tests visit.
pub trait Family: Sync {
    /// Its name.
    fn name(&self) -> &str;

    /// Its parameters with their ranges and default values.
    fn parameters(&self) -> Vec<Parameter>;

    /// Whether BSDFs with different parameters should be used one after the other: they share a state, and changing it takes time.
    fn is_sequential(&self) -> bool {
        false
    }

    /// The BSDF whose parameters have these values, in the order of [`parameters`](Self::parameters).
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) from a BSDF that another program makes.
    fn with(&self, values: &[f64]) -> Result<Box<dyn BatchBsdf + '_>>;
}
