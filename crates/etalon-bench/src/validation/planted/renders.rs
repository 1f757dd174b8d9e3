//! Mistakes that images show: of an integrator, of a camera's importance, of pixel filters.

use super::super::case::Case;
use super::super::suite::camera::{CAMERA, FILTER, FilterPdf, WIDE, camera, positions};
use super::super::suite::renders::{Plant, RenderTest, Truth, inside, lit_sphere, metal};
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

pub fn images() -> Vec<PlantedFault> {
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

pub fn importance() -> Vec<PlantedFault> {
    let name = "camera/missing-cosine";
    let [faulty, sound] = [("planted", (|_, area| 1.0 / area) as fn(f64, f64) -> f64), ("sound", CAMERA)]
        .map(|(kind, pdf)| camera(format!("{kind}/{name}"), WIDE, pdf));
    let mistake =
        "the importance of a pinhole camera without the cosine at the film: towards the edges the image is too bright";
    vec![PlantedFault { name, mistake, faulty, sound }]
}

/// The case of the suite with a wrong pdf, and with the right one.
fn filter(name: &'static str, filter: &'static str, wrong: FilterPdf) -> PlantedFault {
    let [faulty, sound] =
        [("planted", wrong), ("sound", FILTER)].map(|(kind, pdf)| positions(format!("{kind}/{name}"), filter, pdf));
    PlantedFault { name, mistake: "", faulty, sound }
}

/// exp(−x²/(2σ²)) for σ ½ within ±1, where it has the integral σ √(2π) erf(1/(σ√2)).
fn cut_off(x: f32) -> f64 {
    let integral = 0.5 * std::f64::consts::TAU.sqrt() * libm::erf(2f64.sqrt());
    (-2.0 * f64::from(x).powi(2)).exp() / integral
}

pub fn filters() -> Vec<PlantedFault> {
    vec![
        filter("filter/cut-off", "gaussian:1,0.5", |_, [x, y]| cut_off(x) * cut_off(y)).mistake(
            "light paths weighted by a Gaussian that is cut off, camera rays by one that falls to 0 at the radius",
        ),
        filter("filter/width-for-radius", "triangle:2", |prepared, [x, y]| 4.0 * FILTER(prepared, [2.0 * x, 2.0 * y]))
            .mistake("the radius of a triangle taken for its whole width by light paths"),
    ]
}
