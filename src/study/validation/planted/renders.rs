//! Mistakes of an integrator, seen in its pictures.

use super::super::suite::renders::{Picture, Truth, inside, lit_sphere, metal};
use super::Planted;
use crate::render::{LightDensity, Sampling, Settings};
use crate::stats::welch::Mean;

/// A picture, and what is done to its tiles.
type Spoiled = (Picture, fn(&mut [[Mean; 2]]));

fn planted(name: &'static str, mistake: &'static str, faulty: Spoiled, sound: Picture) -> Planted {
    Planted {
        name,
        mistake,
        faulty: faulty.0.case(format!("planted/{name}"), faulty.1),
        sound: sound.case(format!("sound/{name}"), |_| ()),
    }
}

/// Makes a tile brighter by that factor.
fn brighten(tile: &mut [Mean; 2], factor: f64) {
    tile[0].value *= factor;
    tile[0].variance *= factor * factor;
}

pub fn faults() -> Vec<Planted> {
    let settings = Settings { sampling: Sampling::Mis, density: LightDensity::Map, ..Settings::default() };
    let bsdf = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
    let blind = Settings { sampling: Sampling::Hemisphere, ..Settings::default() };
    let mut shadowing = bsdf;
    shadowing.model.scattering.report.lambda_pi = true;
    let series = inside(1000, blind);
    let cut = Picture { truth: Truth::Even(2.0), ..inside(5, blind) };
    vec![
        planted(
            "renders/five-percent-more",
            "a picture with five percent more light all over: a density off by a constant",
            (lit_sphere(settings), |tiles| tiles.iter_mut().for_each(|tile| brighten(tile, 1.05))),
            lit_sphere(settings),
        ),
        planted(
            "renders/one-dark-tile",
            "one tile of the picture a quarter too dark: a worker thread that lost part of its samples",
            (lit_sphere(settings), |tiles| {
                if let Some(tile) = tiles.get_mut(10) {
                    brighten(tile, 0.75);
                }
            }),
            lit_sphere(settings),
        ),
        planted(
            "renders/paths-cut-short",
            "paths ended after five scatterings where all light is asked for: no roulette that makes up for it",
            (cut, |_| ()),
            series,
        ),
        planted(
            "renders/shadowing-with-pi",
            "Λ of Beckmann's distribution with π for √π: the second report's course, 5 % too bright where it matters",
            (metal(shadowing), |_| ()),
            metal(bsdf),
        ),
    ]
}
