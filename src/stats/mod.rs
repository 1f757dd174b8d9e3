//! Statistics: does a sampler draw what its density says, and does a picture show what it should?
//!
//! Three nouns. A [`Domain`] is where samples lie: a [`Line`], the unit [`Square`], [`Directions`], a [`Discrete`] set. A
//! [`Sampler`] turns uniform numbers into its points. A [`Density`] says how likely they are, with respect to the domain's
//! measure; it may have atoms (a mirror's one direction) and fall short of 1 (no sample).
//!
//! [`validate`] first does the deterministic checks: the pdf is the same when asked again, finite and
//! not negative; samples are inside the domain, also for
//! random numbers at the edges of the unit cube; the pdf that a sample carries is the one that the density returns, to the last
//! bit; an inverse gives back the random numbers. Then it counts samples in cells and compares the counts with the density's
//! integrals over them by Pearson's chi-square. "No sample" and every atom have cells of their own, so that all samples are
//! counted. The verdict may be that nothing can be said: too few samples never pass.
//!
//! The pdf must also integrate to its declared mass. The [`Integral`] has a bound of its error. It is rigorous where the density
//! declares lines between which it is constant. Otherwise it is statistical: quadrature alone has no bound, because any
//! rule misses a lobe between its nodes. Random places show what quadrature misses where the density is about as high as its
//! nodes say; the samples themselves fall into every narrow lobe and show the rest.
//!
//! ```
//! use etalon::stats::{Directions, Draw, Pole, Protocol, density, sampler, validate};
//! use glam::DVec3;
//! use std::f64::consts::{PI, TAU};
//!
//! let pdf = |w: DVec3| w.z / PI;
//! let cosine = sampler(2, |u| {
//!     let (r, phi) = (u[0].sqrt(), TAU * u[1]);
//!     let w = DVec3::new(r * phi.cos(), r * phi.sin(), (1.0 - u[0]).sqrt());
//!     Some(Draw::with_pdf(w, w.z / PI))
//! });
//! let hemisphere = Directions::hemisphere(Pole::Z);
//! let outcome = validate(&hemisphere, &cosine, &density(pdf), &Protocol::default())?;
//! assert!(outcome.is_accepted(), "{outcome}");
//!
//! // The same sampler is rejected as a uniform one.
//! let cosine = sampler(2, |u| {
//!     let (r, phi) = (u[0].sqrt(), TAU * u[1]);
//!     Some(Draw::new(DVec3::new(r * phi.cos(), r * phi.sin(), (1.0 - u[0]).sqrt())))
//! });
//! let outcome = validate(&hemisphere, &cosine, &density(|_| 1.0 / TAU), &Protocol::default())?;
//! assert!(!outcome.is_accepted());
//! # Ok::<(), etalon::Error>(())
//! ```

mod bounded;
pub mod chi_square;
mod counting;
pub mod cubature;
mod density;
mod domain;
mod draws;
pub mod estimate;
mod examine;
pub mod fit;
mod fixed;
mod grid;
pub mod kolmogorov;
mod mass;
pub mod multiple;
mod outcome;
pub mod power;
mod repeatable;
mod sampler;
pub mod welch;

pub use density::{Atom, Density, DensityFn, Mass, density};
pub use domain::{Directions, Discrete, Domain, Line, Pole, Square};
pub use examine::{Protocol, Samples, examine, validate};
pub use grid::{Cell, Grid};
pub use mass::{Bound, Integral};
pub use outcome::{Counts, Outcome, Verdict, decide};
pub use sampler::{Draw, Drawn, Sampler, SamplerFn, sampler};

#[cfg(test)]
mod tests;
