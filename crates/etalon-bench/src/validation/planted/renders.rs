//! Mistakes of an integrator, detected in its images.

use super::super::case::Case;
use super::super::suite::plant::Plant;
use super::super::suite::renders::{RenderTest, Truth, inside, lit_sphere, metal};
use super::super::suite::techniques::{adaptive_image, many_lights};
use super::fault::PlantedFault;
use etalon_core::envmap::samplers::MapSampling;
use etalon_render::{Sampling, Settings};
use etalon_stats::welch::Mean;
use etalon_stats::{Protocol, SampleCount};

/// The test of an image, and what is done to its tiles.
type Spoiled = (RenderTest, fn(&mut [[Mean; 2]]));

/// Both tests find biases of 0.5 % of the whole image, unless the number of samples is given.
fn planted(name: &'static str, faulty: Spoiled, sound: RenderTest) -> PlantedFault {
    let case = |kind: &str, (test, spoil): Spoiled| {
        Case::new(format!("{kind}/{name}"), move |protocol, round| {
            let samples = match protocol.samples {
                SampleCount::Detect(w) => SampleCount::Detect(w.min(0.005)),
                count @ SampleCount::Fixed(_) => count,
            };
            test.examine(&Protocol { samples, ..*protocol }, round, spoil)
        })
    };
    PlantedFault { name, mistake: "", faulty: case("planted", faulty), sound: case("sound", (sound, |_| ())) }
}

fn brighten(tile: &mut [Mean; 2], factor: f64) {
    tile[0].value *= factor;
    tile[0].variance *= factor * factor;
}

pub fn faults() -> Vec<PlantedFault> {
    let settings = Settings { sampling: Sampling::Mis, density: Some(MapSampling::MAP), ..Settings::default() };
    let bsdf = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
    let hemisphere = Settings { sampling: Sampling::Hemisphere, ..Settings::default() };
    let mut shadowing = bsdf;
    shadowing.model.metal.lambda_with_pi = true;
    let adaptive = || adaptive_image(many_lights());
    let series = inside(1000, hemisphere);
    let cut = RenderTest { truth: Truth::Uniform(2.0), ..inside(5, hemisphere) };
    vec![
        planted(
            "render/one-percent-more",
            (lit_sphere(settings), |tiles| tiles.iter_mut().for_each(|tile| brighten(tile, 1.01))),
            lit_sphere(settings),
        )
        .mistake("an image with one percent more light everywhere: a pdf wrong by a constant factor"),
        planted(
            "render/one-dark-tile",
            (lit_sphere(settings), |tiles| {
                if let Some(tile) = tiles.get_mut(10) {
                    brighten(tile, 0.9);
                }
            }),
            lit_sphere(settings),
        )
        .mistake("one tile of the image a tenth too dark: a worker thread that lost part of its samples"),
        planted(
            "render/divided-by-the-mean-number",
            (RenderTest { plant: Some(Plant::MeanNumber), ..adaptive() }, |_| ()),
            adaptive(),
        )
        .mistake("adaptive sampling: the sum of a pixel's paths divided by the mean number of paths, not by its own"),
        planted("render/paths-cut-short", (cut, |_| ()), series).mistake(
            "paths ended after five scatterings where all light is asked for: no roulette that makes up for it",
        ),
        planted("render/shadowing-with-pi", (metal(shadowing), |_| ()), metal(bsdf))
            .mistake("Λ of Beckmann's distribution with π for √π: the second report's course; here 7 % too much light"),
    ]
}
