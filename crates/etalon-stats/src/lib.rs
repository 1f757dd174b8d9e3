//! Statistical tests of samplers against their pdfs, with stated power: a dev-dependency for whoever writes code that
//! importance-samples something.
//!
//! A [`Domain`] is the set in which samples lie: [`Directions`], the unit [`Square`], a [`Line`], a [`Discrete`] set. A
//! [`Sampler`] maps uniform random numbers to its points. A [`Density`] is the pdf with respect to the domain's measure (solid
//! angle, area, length, count); it may have atoms (the one direction of a mirror) and a mass below 1 ("no sample").
//!
//! Directions, a cosine-weighted hemisphere:
//!
//! ```
//! use etalon_stats::prelude::*;
//! use std::f64::consts::{PI, TAU};
//!
//! let cosine = sampler(2, |u| {
//!     let (r, phi) = (u[0].sqrt(), TAU * u[1]);
//!     let w = [r * phi.cos(), r * phi.sin(), (1.0 - u[0]).sqrt()];
//!     Some(Sample::with_pdf(w, w[2] / PI))
//! });
//! assert_samples_follow_pdf(&Directions::hemisphere(Pole::Z), &cosine, &density(|w: [f64; 3]| w[2] / PI));
//! ```
//!
//! The unit square, with the inverse tested too:
//!
//! ```
//! use etalon_stats::prelude::*;
//!
//! // p(x, y) = 2x
//! let ramp = sampler(2, |u| Some(Sample::new([u[0].sqrt(), u[1]])));
//! let ramp = ramp.with_inverse(|[x, y]: [f64; 2]| vec![x * x, y]);
//! assert_samples_follow_pdf(&Square, &ramp, &density(|[x, _]: [f64; 2]| 2.0 * x));
//! ```
//!
//! A discrete distribution. This one is wrong, and the message says where:
//!
//! ```should_panic
//! use etalon_stats::prelude::*;
//!
//! let weights = [0.1, 0.2, 0.3, 0.4];
//! let choice = sampler(1, |u| Some(Sample::new((4.0 * u[0]) as usize)));
//! assert_samples_follow_pdf(&Discrete { outcomes: 4 }, &choice, &density(|i: usize| weights[i]));
//! ```
//!
//! ```text
//! samples do not follow the pdf
//! verdict: reject, chi-square = 25034.6 with 3 degrees of freedom, p = 0.00e0, 77354 samples
//! where counts differ most from what the pdf predicts:
//!   region      observed     expected     error    sigma
//!   outcome 0       9720       3867.7  +151.3 %    +94.1
//!   outcome 3       9661      15470.8   -37.6 %    -46.7
//! ...
//! ```
//!
//! # How a test works
//!
//! [`validate`] starts with deterministic checks. The pdf is the same when asked again, finite and not negative. Samples are
//! inside the domain, also for random numbers at the edges of the unit cube. The pdf that a sample carries equals the
//! density's, to the last bit. An inverse returns the random numbers.
//!
//! Then it counts samples in cells and compares the counts with the density's integrals over the cells by Pearson's
//! chi-square ([`chi_square`]). "No sample" and every atom have cells of their own, so that all samples are counted. The
//! number of samples is chosen such that an error of the stated size is detected with 90 % probability ([`power`]). A verdict
//! may be [`Verdict::Inconclusive`]: too few samples never pass.
//!
//! The pdf must also integrate to its declared mass. The [`Integral`] has a bound of its error. The bound is rigorous where
//! the density is declared piecewise constant. Otherwise it is statistical: quadrature alone has no bound, because any rule
//! misses a lobe between its nodes. Random points show what quadrature misses where the pdf is about as high as its nodes
//! predict. The samples themselves fall into every narrow lobe and show the rest.
//!
//! [`decide`] gives the verdicts on many tests of one run at a common level ([`multiple`]). [`welch`] compares noisy images
//! tile by tile, [`kolmogorov`] tests uniformity, [`estimate`] has confidence intervals of means.
//!
//! # Features
//!
//! `serde`: results implement `Serialize`.

mod assertion;
mod bounded;
pub mod chi_square;
mod counting;
pub mod cubature;
mod density;
mod domain;
mod error;
pub mod estimate;
mod exact;
mod examine;
mod fixed;
mod grid;
pub mod hash;
pub mod kolmogorov;
mod mass;
pub mod multiple;
mod outcome;
pub mod power;
pub mod prelude;
mod sampler;
pub mod stream;
mod tally;
mod text;
pub mod warp;
pub mod welch;

pub use assertion::{assert_samples_follow_pdf, assert_samples_follow_pdf_by, explain};
pub use density::{Atom, Density, DensityFn, Mass, density};
pub use domain::{Directions, Discrete, Domain, Line, Pole, Square};
pub use error::{Error, Result};
pub use examine::{Protocol, SampleCount, examine, validate};
pub use grid::{Cell, Grid};
pub use mass::{Bound, Integral};
pub use outcome::{Counts, Outcome, Verdict, decide};
pub use sampler::{NoInverse, Sample, Sampler, SamplerFn, sampler};

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
