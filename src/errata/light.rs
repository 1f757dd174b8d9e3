//! Area lights: the second report's course divides by the length of a vector that it takes for a unit vector.

use crate::math::Real;

/// The factor by which the light of a rectangle at that distance is wrong: the distance itself, so that light falls off
/// with 1/d, not 1/d².
///
/// In the second report's Cornell box that is 0.9 to 1.8 times the light.
#[inline(always)]
#[must_use]
pub fn falloff_error<T: Real>(distance: T) -> T {
    distance
}
