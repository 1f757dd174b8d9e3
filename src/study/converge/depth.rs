//! Light that is missing in a render that ends at some depth, and the time that ending saves.

use super::doubling::{Deadline, Doubling};
use crate::error::Result;
use crate::raster::Image;
use crate::render::Settings;
use crate::scene::{Request, Scene};
use etalon_stats::estimate::Estimate;

/// DepthCurve that are measured; the last one stands for all light.
pub const DEPTHS: [u32; 9] = [0, 1, 2, 3, 4, 5, 7, 10, 100];

/// One depth of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthLevel {
    /// Largest number of scatterings of a path.
    pub depth: u32,
    /// 1 − mean of the image over mean of the deepest image with the same random numbers.
    pub missing: Estimate,
    /// Mean over the replicates.
    pub cpu_seconds: Estimate,
    /// Processor time over that of the deepest image.
    pub time_share: f64,
}

/// A scene's depths.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthCurve {
    /// Its name.
    pub scene: String,
    /// Renders of each depth.
    pub replicates: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// One for each of [`DEPTHS`].
    pub levels: Vec<DepthLevel>,
}

/// Renders a scene to every depth, `replicates` times with different seeds, all depths alternating. The paths of a shallow
/// image are the beginnings of those of a deep one (see [`truncation`](crate::study::depth::truncation)): their noise is
/// the same, so that the difference is known far better than either of them. Without levels if the deadline comes first.
pub fn measure(
    scene: &Scene,
    request: &Request,
    replicates: u32,
    seed: u64,
    deadline: &Deadline,
) -> Result<DepthCurve> {
    let mut light: Vec<Vec<f64>> = vec![Vec::new(); DEPTHS.len()];
    let mut times = light.clone();
    for replicate in 0..replicates {
        let settings = Settings { seed: seed.wrapping_add(u64::from(replicate)), ..Settings::default() };
        let renders = DEPTHS.map(|max_depth| Doubling::new(scene, &Request { max_depth, ..*request }, &settings));
        let mut renders = renders.into_iter().collect::<Result<Vec<_>>>()?;
        // Double the samples of all depths, alternating.
        while renders[0].spp() <= request.spp / 2 {
            for render in &mut renders {
                render.double(deadline);
            }
        }
        if deadline.is_over() {
            break;
        }
        for ((render, light), times) in renders.iter().zip(&mut light).zip(&mut times) {
            light.push(mean(&render.image()));
            times.push(render.times.cpu);
        }
    }
    let deepest = DEPTHS.len() - 1;
    let all_time: f64 = times[deepest].iter().sum();
    let level = |i: usize| {
        let missing = light[i].iter().zip(&light[deepest]).map(|(some, all)| 1.0 - some / all);
        DepthLevel {
            depth: DEPTHS[i],
            missing: Estimate::mean(&missing.collect::<Vec<_>>()),
            cpu_seconds: Estimate::mean(&times[i]),
            time_share: times[i].iter().sum::<f64>() / all_time,
        }
    };
    let count = if light[0].is_empty() { 0 } else { DEPTHS.len() };
    Ok(DepthCurve {
        scene: scene.name.clone(),
        replicates: light[0].len() as u32,
        spp: request.spp,
        levels: (0..count).map(level).collect(),
    })
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels().iter().map(|p| p.as_dvec3().element_sum()).sum();
    sum / (3.0 * image.pixels().len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn each_depth_has_more_light() {
        let (scene, request) = builtin::cornell_spheres();
        let request = Request { width: 40, height: 30, spp: 16, light_samples: 1, ..request };
        let depths = measure(&scene, &request, 3, 1, &Deadline::after(60.0)).unwrap();
        let missing: Vec<f64> = depths.levels.iter().map(|l| l.missing.value).collect();
        assert!(missing.windows(2).all(|pair| pair[0] > pair[1]), "{missing:?}");
        assert_eq!((missing[DEPTHS.len() - 1], depths.levels[DEPTHS.len() - 1].time_share), (0.0, 1.0));
        let none = measure(&scene, &request, 3, 1, &Deadline::after(0.0)).unwrap();
        assert!(none.levels.is_empty() && none.replicates == 0);
    }
}
