//! False alarms and planted biases: estimators of one expectation, and of expectations that differ by a known amount.

mod levels;

use super::*;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{Request, Scene, builtin};
use etalon_render::{Sampling, Settings, Silent, render};

/// Diffuse spheres in a few hundred pixels, in which BSDF sampling alone finds the light rarely.
fn scene() -> (Scene, Request) {
    small(builtin::cornell_lambert())
}

/// The same with a mirror and glass: caustics, which light tracing finds and BSDF sampling rarely.
fn caustics() -> (Scene, Request) {
    small(builtin::cornell_spheres())
}

fn small((scene, request): (Scene, Request)) -> (Scene, Request) {
    (scene, Request { width: 32, height: 24, spp: 16, light_samples: 1, ..request })
}

fn image(scene: &Scene, request: &Request, sampling: Sampling, seed: u64) -> Image {
    let settings = Settings { sampling, seed, stream: StreamKind::Independent, ..Settings::default() };
    render(scene, request, &settings, &Silent).unwrap().image
}

fn replicates(sampling: Sampling, first: u64, n: u64) -> Vec<Image> {
    replicates_of(&scene(), sampling, first, n)
}

fn replicates_of((scene, request): &(Scene, Request), sampling: Sampling, first: u64, n: u64) -> Vec<Image> {
    (first..first + n).map(|seed| image(scene, request, sampling, seed)).collect()
}

const PLAN: Plan = Plan { level: 0.01, detect: 0.01 };

/// False alarms of `pairs` pairs of sides, which have seeds of their own.
fn false_alarms(pairs: u64, side: impl Fn(usize, u64) -> Side) -> Vec<Compared> {
    let pair = |k: u64| compare(side(0, 1_000_000 + 16 * k), side(1, 2_000_000 + 16 * k), PLAN).unwrap();
    (0..pairs).map(pair).filter(is_different).collect()
}

/// 16 replicates from a first seed.
fn of_replicates(scene: &(Scene, Request), sampling: Sampling, first: u64) -> Side {
    Side::replicates(replicates_of(scene, sampling, first, 16))
}

/// One image of as many samples, with the standard errors of its pixels.
fn of_pixels((scene, request): &(Scene, Request), sampling: Sampling, seed: u64) -> Side {
    let settings = Settings { sampling, seed, stream: StreamKind::Independent, ..Settings::default() };
    let film = render(scene, &Request { spp: 16 * request.spp, ..*request }, &settings, &Silent).unwrap().part.film;
    Side::with_error(film.image(), film.standard_error())
}

fn show(alarms: &[Compared]) -> String {
    let family = |f: &FamilyResult| {
        let worst = f.worst.map(|w| format!("{} t {:.1} dof {:.0}", w.functional, w.difference.t(), w.difference.dof));
        format!("{} p {:?} {worst:?}; ", f.family.name(), f.adjusted_p)
    };
    alarms.iter().map(|c| c.families.iter().map(family).collect::<String>() + "\n").collect()
}

/// Whether 16 replicates a side are called different, the images of A changed by `change`.
fn finds(change: impl Fn(&Image) -> Image, round: u64) -> Compared {
    let a = replicates(Sampling::Mis, 500_000 + 16 * round, 16).iter().map(change).collect();
    let b = replicates(Sampling::Mis, 600_000 + 16 * round, 16);
    compare(Side::replicates(a), Side::replicates(b), PLAN).unwrap()
}

fn is_different(compared: &Compared) -> bool {
    compared.answer == Answer::Different
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn estimators_of_one_expectation_are_rarely_called_different() {
    // More than 2 of 12 at 1 % have a probability of 0.02 %; the ignored test counts the alarms of 1000.
    for (scene, other) in [(scene(), Sampling::Mis), (caustics(), Sampling::MisLt)] {
        let alarms = false_alarms(12, |i, first| of_replicates(&scene, [Sampling::Bsdf, other][i], first));
        assert!(alarms.len() <= 2, "{}", show(&alarms));
    }
    for (scene, other) in [(scene(), Sampling::Mis), (caustics(), Sampling::MisLt)] {
        let alarms = false_alarms(12, |i, seed| of_pixels(&scene, [Sampling::Bsdf, other][i], seed));
        assert!(alarms.len() <= 2, "{}", show(&alarms));
    }
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_uniform_bias_is_found_as_often_as_stated() {
    const ROUNDS: u64 = 20;
    let biased = |round: u64| {
        let stated = finds(Image::clone, round).uniform_bias.unwrap();
        finds(|image| image.map(|p| p * (1.0 + stated as f32)), ROUNDS + round)
    };
    let found = (0..ROUNDS).filter(|round| is_different(&biased(*round))).count();
    // Fewer than 14 of 20 at 90 % have a probability of 0.24 %.
    assert!(found >= 14, "{found} of {ROUNDS}");
}

#[test]
fn planted_biases_are_found_where_they_are() {
    let plain = finds(Image::clone, 0);
    assert!(!is_different(&plain), "{}", show(&[plain]));
    // A light 10 % too bright, fireflies clamped at the level of the lit walls, and half a pixel of shift.
    let bright = finds(|image| image.map(|p| p * 1.1), 0);
    let clamped = finds(|image| image.map(|p| p.min(Rgb::splat(0.8))), 0);
    let shifted = finds(
        |image| {
            let (width, height) = (image.width(), image.height());
            Image::from_fn(width, height, |x, y| 0.5 * (image.get(x, y) + image.get((x + 1).min(width - 1), y)))
        },
        0,
    );
    // Paths that end too early.
    let (scene, request) = scene();
    let short = (scene, Request { max_depth: 2, ..request });
    let a = Side::replicates(replicates_of(&short, Sampling::Mis, 500_000, 16));
    let short = compare(a, Side::replicates(replicates(Sampling::Mis, 600_000, 16)), PLAN).unwrap();
    let found = [bright, clamped, shifted, short];
    assert!(found.iter().all(is_different), "{}", show(&found));
    // One tile alone.
    let spot = finds(
        |image| {
            let mut image = image.clone();
            (0..4).for_each(|i| image.set(16 + i % 2, 20 + i / 2, 2.0 * image.get(16 + i % 2, 20 + i / 2)));
            image
        },
        0,
    );
    let worst = spot.families[2].worst.unwrap();
    // In parts of the tile's own mean
    let bias = spot.bias(&spot.families[2], &worst).unwrap();
    assert!(bias.low < 1.0 && 1.0 < bias.high && 0.5 < bias.value, "{bias:?}");
    assert!(is_different(&spot) && matches!(worst.functional, Functional::Tile([16, 20, ..])), "{}", show(&[spot]));
}

#[test]
fn a_firefly_in_one_replicate_is_inconclusive() {
    let mut a = replicates(Sampling::Mis, 1, 16);
    a[5].set(9, 9, Rgb::splat(1e6));
    let compared = compare(Side::replicates(a), Side::replicates(replicates(Sampling::Mis, 101, 16)), PLAN).unwrap();
    assert_eq!(compared.answer, Answer::CannotTell, "{}", show(std::slice::from_ref(&compared)));
    assert_eq!((compared.families[0].dominated, compared.uniform_bias), (3, None));
    assert!((3..30).contains(&compared.families[2].dominated));
}

#[test]
fn noise_that_is_the_same_in_all_replicates_is_counted() {
    let (mut a, b) = (replicates(Sampling::Mis, 1, 16), replicates(Sampling::Mis, 101, 16));
    let count = |a: &[Image]| {
        let sides = [a, &b].map(|images| Side::replicates(images.to_vec()));
        let [a, b] = sides;
        compare(a, b, PLAN).unwrap().constant_tiles
    };
    assert_eq!(count(&a), [0, 0]);
    // The seed does not reach the lower half: 6 rows of 16 tiles.
    let first = a[0].clone();
    a.iter_mut()
        .for_each(|image| (0..12 * 32).for_each(|i| image.set(i % 32, 12 + i / 32, first.get(i % 32, 12 + i / 32))));
    assert_eq!(count(&a), [96, 0]);
    // The same values in other pixels have the same mean
    let mut swapped = replicates(Sampling::Mis, 1, 16);
    let pixels = [[0, 0], [1, 0], [0, 1], [1, 1]];
    let values = pixels.map(|[x, y]| swapped[0].get(x, y));
    for (i, image) in swapped.iter_mut().enumerate() {
        (0..4).for_each(|k| image.set(pixels[k][0], pixels[k][1], values[if i % 2 == 0 { k } else { 3 - k }]));
    }
    assert_eq!(count(&swapped), [0, 0]);
}

#[test]
fn a_pixel_that_is_not_finite_rejects_and_is_named() {
    let (mut a, b) = (replicates(Sampling::Mis, 1, 16), replicates(Sampling::Mis, 101, 16));
    a[3].set(7, 5, Rgb::NAN);
    let compared = compare(Side::replicates(a), Side::replicates(b), PLAN).unwrap();
    assert_eq!((compared.answer, compared.non_finite), (Answer::NotFinite, 1));
    let place = NotFinite { image: "image 4 of A".into(), column: 7, row: 5, pixels: 1, images: 1 };
    assert_eq!(compared.not_finite, Some(place));
    // What all images of a side have is a mask.
    let (mut a, b) = (replicates(Sampling::Mis, 1, 16), replicates(Sampling::Mis, 101, 16));
    a.iter_mut().for_each(|image| image.set(7, 5, Rgb::NAN));
    let compared = compare(Side::replicates(a), Side::replicates(b), PLAN).unwrap();
    assert_eq!((compared.not_finite, compared.non_finite), (None, 1));
}

#[test]
fn errors_by_pixel_stand_in_for_replicates() {
    let (scene, request) = scene();
    let side = |seed: u64, scale: f32| {
        let settings =
            Settings { sampling: Sampling::Mis, seed, stream: StreamKind::Independent, ..Settings::default() };
        let film = render(&scene, &Request { spp: 64, ..request }, &settings, &Silent).unwrap().part.film;
        Side::with_error(film.image().map(|p| p * scale), film.standard_error())
    };
    let plain = compare(side(1, 1.0), side(2, 1.0), PLAN).unwrap();
    assert_ne!(plain.answer, Answer::Different, "{}", show(std::slice::from_ref(&plain)));
    let bias = 1.0 + 1.5 * plain.uniform_bias.unwrap() as f32;
    assert!(is_different(&compare(side(1, bias), side(2, 1.0), PLAN).unwrap()));
    let exact = compare(side(1, 1.0), Side::exact(side(3, bias).images.remove(0)), PLAN).unwrap();
    assert!(exact.uniform_bias.unwrap() < plain.uniform_bias.unwrap());
}

#[test]
fn bad_sides_are_refused() {
    let images = replicates(Sampling::Mis, 1, 3);
    let side = |images: &[Image]| Side::replicates(images.to_vec());
    let refused = |a: Side, b: Side| compare(a, b, PLAN).unwrap_err().to_string();
    assert!(refused(side(&images[..2]), side(&images[1..])).contains("image 2 of A and image 1 of B are the same"));
    let doubled = refused(side(&[images[0].clone(), images[0].clone()]), side(&images[1..]));
    assert!(doubled.contains("image 1 of A and image 2 of A are the same"), "{doubled}");
    assert!(refused(side(&images[..2]), Side::exact(Image::new(2, 2))).contains("sizes"));
    let exact = || Side::exact(images[0].clone());
    assert!(refused(exact(), Side::exact(images[1].clone())).contains("noise"));
    let black = images[0].map(|_| Rgb::NAN);
    assert!(refused(side(&images[..2]), Side::exact(black)).contains("finite"));
    // Two replicates are enough for the mean, not for tiles.
    let few = compare(side(&images[..2]), Side::exact(images[2].clone()), PLAN).unwrap();
    assert!(few.families[2].untested.is_some() && few.families[0].adjusted_p.is_some());
}

#[test]
#[ignore = "takes minutes: cargo test --lib compare::tests -- --ignored --nocapture"]
fn twenty_false_alarms_of_a_thousand_at_most() {
    // Not `mis` with `mis+lt` of diffuse spheres: no light is traced there, and both are one estimator.
    type MakeSide = fn(&(Scene, Request), Sampling, u64) -> Side;
    for (kind, side) in [("replicates", of_replicates as MakeSide), ("errors by pixel", of_pixels)] {
        for (scene, samplings) in [
            (scene(), [Sampling::Bsdf, Sampling::Mis]),
            (scene(), [Sampling::Mis; 2]),
            (caustics(), [Sampling::Bsdf, Sampling::Mis]),
            (caustics(), [Sampling::Bsdf, Sampling::MisLt]),
            (caustics(), [Sampling::Mis, Sampling::MisLt]),
        ] {
            let alarms = false_alarms(1000, |i, first| side(&scene, samplings[i], first));
            println!("{kind}, {} {samplings:?}: {} of 1000\n{}", scene.0.name, alarms.len(), show(&alarms));
            assert!(alarms.len() <= 20, "{kind}, {samplings:?}: {}", alarms.len());
        }
    }
}
