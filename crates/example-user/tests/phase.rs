//! The sampler against its pdf, and how wrong pdfs are reported.

use etalon_stats::prelude::*;
use example_user::HenyeyGreenstein;

const FOG: HenyeyGreenstein = HenyeyGreenstein { g: 0.7 };

fn assert_follows(pdf: impl Fn([f64; 3]) -> f64 + Sync) {
    let fog = sampler(2, |u| Some(Sample::new(FOG.sample([u[0], u[1]]))));
    assert_samples_follow_pdf(&Directions::sphere(Pole::Z), &fog, &density(pdf));
}

#[test]
fn samples_follow_the_pdf() {
    assert_follows(|w| FOG.pdf(w));
}

/// The sign of g depends on whether directions point along the light or away from the surface.
#[test]
#[should_panic(expected = "theta 0.00°..36.87°, phi 0.00°..360.00°")]
fn the_other_sign_of_g_is_found_and_located() {
    assert_follows(|w| HenyeyGreenstein { g: -FOG.g }.pdf(w));
}

/// An error of 2 % in g, which no image shows.
#[test]
#[should_panic(expected = "theta 0.00°..36.87°")]
fn a_slightly_different_g_is_found_and_located() {
    assert_follows(|w| HenyeyGreenstein { g: 1.02 * FOG.g }.pdf(w));
}

#[test]
#[should_panic(expected = "the pdf integrates to 12.566")]
fn a_missing_normalization_is_found() {
    assert_follows(|w| 4.0 * std::f64::consts::PI * FOG.pdf(w));
}
