//! A render that doubles its samples step by step, timed without its preparation.

use cpu_time::ProcessTime;
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_core::raster::{Image, Metadata};
use etalon_core::scene::{Request, Scene};
use etalon_render::film::Part;
use etalon_render::{Control, Dropped, Job, Settings};
use std::time::{Duration, Instant};

/// The end of a study: at a time, or as soon as the process is asked to stop.
#[derive(Debug, Clone, Copy)]
pub struct Deadline(Instant);

impl Deadline {
    /// That many seconds from now.
    pub fn after(seconds: f64) -> Self {
        Self(Instant::now() + Duration::from_secs_f64(seconds))
    }

    /// The moment when `share` of the time left will have passed.
    pub fn share(&self, share: f64) -> Self {
        Self::after(self.left() * share)
    }

    /// Seconds until then, at least 0.
    pub fn left(&self) -> f64 {
        if self.is_over() { 0.0 } else { self.0.saturating_duration_since(Instant::now()).as_secs_f64() }
    }

    pub fn is_over(&self) -> bool {
        interrupt::requested() || Instant::now() >= self.0
    }
}

impl Control for Deadline {
    fn done(&self, _samples: u64) {}

    fn stop(&self) -> bool {
        self.is_over()
    }
}

/// Time that something took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Times {
    /// Wall-clock seconds.
    pub wall: f64,
    /// Processor seconds, all threads together.
    pub cpu: f64,
}

impl Times {
    /// Runs `work` and adds its times. Where the system does not measure processor time, wall-clock time counts instead.
    pub fn of<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now());
        let result = work();
        let elapsed = wall.elapsed();
        self.wall += elapsed.as_secs_f64();
        self.cpu += cpu.and_then(|cpu| cpu.try_elapsed()).unwrap_or(elapsed).as_secs_f64();
        result
    }
}

/// A render that grows.
pub struct Doubling<'a> {
    job: Job<'a>,
    part: Part,
    spp: u32,
    /// Time of all samples so far, without the preparation.
    pub times: Times,
    /// Time of the preparation: tables, trees.
    pub preparation: Times,
}

impl<'a> Doubling<'a> {
    /// Prepares the render; `request.spp` is where it ends.
    pub fn new(scene: &'a Scene, request: &Request, settings: &Settings) -> Result<Self> {
        let mut preparation = Times::default();
        let job = preparation.of(|| Job::new(scene, request, settings))?;
        let part = job.part(Metadata::default())?;
        Ok(Self { job, part, spp: 0, times: Times::default(), preparation })
    }

    /// The settings, with what was chosen for the scene.
    pub fn settings(&self) -> &Settings {
        self.job.settings()
    }

    /// Samples per pixel so far.
    pub fn spp(&self) -> u32 {
        self.spp
    }

    /// Estimate of the next step's wall-clock seconds: as many as those of all samples so far.
    pub fn next_step(&self) -> f64 {
        self.times.wall
    }

    /// Doubles the samples (from none to one). If the deadline comes first, returns false, and the render is unusable.
    pub fn double(&mut self, deadline: &Deadline) -> bool {
        let next = (2 * self.spp).max(1);
        self.times.of(|| self.job.run(&mut self.part, self.spp..next, deadline));
        self.spp = next;
        self.part.ranges().have(&(0..next))
    }

    /// The samples so far that were dropped.
    pub fn dropped(&self) -> Dropped {
        self.part.film.dropped()
    }

    /// The image so far.
    pub fn image(&self) -> Image {
        self.part.film.image()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;
    use etalon_render::{Silent, render};

    #[test]
    fn step_by_step_gives_the_same_image() {
        let (scene, request) = builtin::cornell_lambert();
        let request = Request { width: 24, height: 18, spp: 8, ..request };
        let mut doubling = Doubling::new(&scene, &request, &Settings::default()).unwrap();
        let deadline = Deadline::after(60.0);
        let mut before = Times::default();
        for spp in [1, 2, 4, 8] {
            assert!(doubling.double(&deadline) && doubling.spp() == spp);
            assert!(doubling.times.wall > before.wall && doubling.times.cpu >= before.cpu);
            before = doubling.times;
        }
        assert_eq!(doubling.image(), render(&scene, &request, &Settings::default(), &Silent).unwrap().image);
        assert!(!doubling.double(&Deadline::after(0.0)), "the deadline is over");
    }
}
