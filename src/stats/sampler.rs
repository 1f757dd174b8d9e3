//! What draws samples: the thing under test.

use crate::error::{Error, Result};

/// A sample as its sampler hands it out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw<P> {
    pub point: P,
    /// The density that the sampler claims for it, if it claims one. It must be the one that the density returns for
    /// `point`, to the last bit.
    pub pdf: Option<f64>,
    /// Whether the point is one of finitely many (a mirror's direction): it is then counted at the density's atoms.
    pub atom: bool,
}

impl<P> Draw<P> {
    /// A sample without a claim.
    pub fn new(point: P) -> Self {
        Self { point, pdf: None, atom: false }
    }

    /// A sample that carries its density.
    pub fn with_pdf(point: P, pdf: f64) -> Self {
        Self { point, pdf: Some(pdf), atom: false }
    }

    /// A sample at an atom.
    pub fn atom(point: P) -> Self {
        Self { point, pdf: None, atom: true }
    }
}

/// Samples in the order of their numbers; `None` is the outcome "no sample".
pub type Drawn<P> = Vec<Option<Draw<P>>>;

/// Draws points of a domain from uniform numbers.
pub trait Sampler<P>: Sync {
    /// Uniform numbers that one sample takes; 0 for a sampler with random numbers of its own, which is then asked by
    /// [`draw_seeded`](Self::draw_seeded) alone.
    fn dimension(&self) -> usize;

    /// Appends one entry to `out` for every [`dimension`](Self::dimension) numbers of `u`, which are in \[0, 1).
    ///
    /// Fails only where sampling itself can: in another process.
    fn draw(&self, u: &[f64], out: &mut Drawn<P>) -> Result<()>;

    /// Appends `count` entries to `out`, from random numbers of its own that `seed` starts: the same seed gives the same
    /// samples. All batches of a run have different seeds.
    fn draw_seeded(&self, _count: usize, _seed: u32, _out: &mut Drawn<P>) -> Result<()> {
        Err(Error::parameter("dimension", "a sampler without uniform numbers has to implement draw_seeded"))
    }

    /// How many samples are left, of a sampler that only has so many: a file. All of them are then
    /// used, once, whatever the protocol says, and the uniform numbers mean nothing.
    fn supply(&self) -> Option<u64> {
        None
    }

    /// The numbers that are mapped to `point`, for samplers that have an inverse; fails where [`draw`](Self::draw) can.
    fn invert(&self, _point: P) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }
}

/// A [`Sampler`] of a function from numbers to a sample; see [`sampler`].
pub struct SamplerFn<F, I> {
    dimension: usize,
    draw: F,
    inverse: I,
}

/// The absence of an inverse.
type NoInverse<P> = fn(P) -> Option<Vec<f64>>;

/// The sampler that draws one point from `dimension` numbers by calling `draw`.
pub fn sampler<P, F>(dimension: usize, draw: F) -> SamplerFn<F, NoInverse<P>>
where
    F: Fn(&[f64]) -> Option<Draw<P>> + Sync,
{
    SamplerFn { dimension, draw, inverse: |_| None }
}

impl<F, I> SamplerFn<F, I> {
    /// Adds the inverse: the numbers from which a point is drawn. It is then tested too.
    pub fn with_inverse<P, J>(self, invert: J) -> SamplerFn<F, impl Fn(P) -> Option<Vec<f64>> + Sync>
    where
        J: Fn(P) -> Vec<f64> + Sync,
    {
        SamplerFn { dimension: self.dimension, draw: self.draw, inverse: move |point| Some(invert(point)) }
    }
}

impl<P, F, I> Sampler<P> for SamplerFn<F, I>
where
    F: Fn(&[f64]) -> Option<Draw<P>> + Sync,
    I: Fn(P) -> Option<Vec<f64>> + Sync,
{
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn draw(&self, u: &[f64], out: &mut Drawn<P>) -> Result<()> {
        out.extend(u.chunks_exact(self.dimension).map(&self.draw));
        Ok(())
    }

    fn invert(&self, point: P) -> Result<Option<Vec<f64>>> {
        Ok((self.inverse)(point))
    }
}
