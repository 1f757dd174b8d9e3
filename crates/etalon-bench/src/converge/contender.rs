//! What is measured, a contender: a sampling strategy of ours, a renderer in another program, or runs of an earlier day.
//!
//! A replicate of any of them gives images of more and more samples per pixel, each with the time that it took.

use super::doubling::{Deadline, Doubling, Times};
use super::recorded::Recorded;
use super::strategy::Strategy;
use crate::protocol::renderer::{Renderer, RunFailure};
use etalon_core::error::Result;
use etalon_core::raster::Image;
use etalon_core::scene::{Request, Scene};
use etalon_render::Settings;
use etalon_stats::Extremes;
use serde::Serialize;
use std::time::Duration;

/// One of the methods that are compared.
#[derive(Debug, Clone)]
pub enum Contender {
    /// Our renderer with a sampling strategy.
    Strategy(Strategy),
    /// Another program.
    Renderer(Renderer),
    /// Images and times that were kept.
    Recorded(Recorded),
}

impl From<Strategy> for Contender {
    fn from(strategy: Strategy) -> Self {
        Self::Strategy(strategy)
    }
}

/// What a replicate did when it was asked for more samples.
pub enum Step {
    /// The image, and the time of all of its samples.
    Done(Image, Times),
    /// The deadline came first.
    Stopped,
    /// There are no more images.
    End,
    Failed(RunFailure),
}

/// A run of a renderer that gave no image which can be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    pub strategy: String,
    /// From 1.
    pub replicate: u32,
    pub seed: u64,
    pub spp: u32,
    pub message: String,
}

impl Contender {
    pub fn of(strategies: &[Strategy]) -> Vec<Self> {
        strategies.iter().cloned().map(Self::from).collect()
    }

    pub fn name(&self) -> &str {
        match self {
            Self::Strategy(strategy) => &strategy.name,
            Self::Renderer(renderer) => renderer.name(),
            Self::Recorded(recorded) => recorded.name(),
        }
    }

    /// Whether its times are those of whole processes, with what they do before the first sample.
    pub fn is_timed_from_outside(&self) -> bool {
        !matches!(self, Self::Strategy(_))
    }

    /// Whether it is the strategy of `etalon render`.
    pub fn is_default(&self) -> bool {
        matches!(self, Self::Strategy(strategy) if strategy.is_default())
    }

    /// Whether our random numbers are independent.
    pub fn is_independent(&self) -> bool {
        matches!(self, Self::Strategy(strategy) if strategy.is_independent())
    }

    pub fn has_fixed_lights(&self) -> bool {
        matches!(self, Self::Strategy(strategy) if strategy.has_fixed_lights())
    }

    /// Starts a replicate; `None` if no more were recorded. `index` counts from 0, `request.spp` is the end.
    pub fn start<'a>(
        &'a self,
        scene: &'a Scene,
        request: &Request,
        seed: u64,
        index: u32,
    ) -> Result<Option<Replicate<'a>>> {
        let size = [request.width, request.height];
        let source = match self {
            Self::Strategy(strategy) => {
                return Replicate::ours(scene, request, &strategy.settings(seed)).map(Some);
            }
            Self::Renderer(renderer) => Source::Renderer { renderer, size },
            Self::Recorded(recorded) => {
                let Some(seed) = recorded.seed(index) else { return Ok(None) };
                return Ok(Some(Replicate::new(Source::Recorded { recorded, size }, seed)));
            }
        };
        Ok(Some(Replicate::new(source, seed)))
    }
}

enum Source<'a> {
    Ours(Box<Doubling<'a>>),
    Renderer { renderer: &'a Renderer, size: [usize; 2] },
    Recorded { recorded: &'a Recorded, size: [usize; 2] },
}

/// The most that a renderer may take of the time that is left, for the first image of a replicate.
const FIRST_IMAGE: f64 = 1.0 / 3.0;

/// A replicate while it is rendered.
pub struct Replicate<'a> {
    source: Source<'a>,
    pub seed: u64,
    /// Samples per pixel of the last image, 0 before the first.
    pub spp: u32,
    /// Wall-clock seconds before the first sample, as far as they are known.
    pub preparation: f64,
    pub chosen: Option<Strategy>,
    /// Wall-clock seconds of all images so far, with the preparation.
    spent: f64,
    /// Samples and wall-clock seconds of the last two images.
    last: [(u32, f64); 2],
}

/// Factor between the samples of a renderer's images: every one of them is rendered anew.
const APART: u32 = 4;

impl<'a> Replicate<'a> {
    fn new(source: Source<'a>, seed: u64) -> Self {
        Self { source, seed, spp: 0, preparation: 0.0, chosen: None, spent: 0.0, last: Default::default() }
    }

    pub fn ours(scene: &'a Scene, request: &Request, settings: &Settings) -> Result<Self> {
        let render = Doubling::new(scene, request, settings)?;
        let (preparation, chosen) = (render.preparation.wall, Strategy::of(render.settings(), scene));
        let new = Self::new(Source::Ours(Box::new(render)), settings.seed);
        Ok(Self { preparation, chosen, spent: preparation, ..new })
    }

    /// Samples per pixel of the next image; `None` at the end of what was recorded.
    pub fn next_spp(&self) -> Option<u32> {
        let times = |factor: u32| if self.spp == 0 { Some(1) } else { self.spp.checked_mul(factor) };
        match &self.source {
            Source::Ours(_) => times(2),
            Source::Renderer { .. } => times(APART),
            Source::Recorded { recorded, .. } => recorded.next_spp(self.seed, self.spp),
        }
    }

    /// Estimate of the wall-clock seconds of the next image: by a straight line through the last two.
    pub fn next_step(&self) -> f64 {
        match &self.source {
            Source::Ours(render) => render.next_step(),
            Source::Recorded { .. } => 0.0,
            Source::Renderer { .. } => {
                let [(spp0, t0), (spp1, t1)] = self.last;
                let per_sample = (t1 - t0).at_least(0.0) / f64::from(spp1.saturating_sub(spp0).max(1));
                t1 + per_sample * f64::from(spp1) * f64::from(APART - 1)
            }
        }
    }

    /// The wall-clock seconds that the replicate will have taken with the next image.
    pub fn total_with_next(&self) -> f64 {
        self.spent + self.next_step()
    }

    /// Renders, or reads, the next image. After anything but an image the replicate is unusable.
    pub fn advance(&mut self, deadline: &Deadline) -> Step {
        let Some(spp) = self.next_spp() else { return Step::End };
        let made = match &mut self.source {
            Source::Ours(render) => {
                if !render.double(deadline) {
                    return Step::Stopped;
                }
                let dropped = render.dropped();
                if dropped.total() > 0 {
                    return Step::Failed(RunFailure { message: dropped.to_string(), is_final: true });
                }
                self.spent = self.preparation + render.times.wall;
                self.spp = spp;
                return Step::Done(render.image(), render.times);
            }
            Source::Renderer { renderer, size } => {
                let left = deadline.left();
                if left <= 0.0 {
                    return Step::Stopped;
                }
                // A first image that takes longer leaves no time for a curve, or its program hangs.
                let most = if self.spp == 0 { left * FIRST_IMAGE } else { left };
                let run = renderer.run(spp, self.seed, *size, Duration::from_secs_f64(most));
                // What the end of the budget stops is no fault of the program.
                if run.is_err() && deadline.is_over() {
                    return Step::Stopped;
                }
                run.map(|run| (run.image, Times { wall: run.wall, cpu: run.cpu }))
            }
            Source::Recorded { recorded, size } => {
                let read = recorded.image(self.seed, spp, *size);
                read.map_err(|message| RunFailure { message, is_final: true })
            }
        };
        match made {
            Err(failure) => Step::Failed(failure),
            Ok((image, times)) => {
                self.spp = spp;
                self.spent += times.wall;
                self.last = [self.last[1], (spp, times.wall)];
                Step::Done(image, times)
            }
        }
    }
}
