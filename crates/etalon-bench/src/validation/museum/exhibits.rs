//! The faults, one entry each.

use super::super::planted::bsdf::compensated::Compensated;
use super::super::planted::bsdf::faulty::{Change, planted};
use super::super::planted::bsdf::mixture::Mixture;
use super::super::planted::bsdf::rough::{Facets, Rough};
use super::super::planted::bsdf::smooth::{Lambertian, cosine};
use super::super::planted::maps;
use super::super::planted::warps::polar;
use super::super::planted::{self, PlantedFault};
use super::Exhibit;
use super::Seen::{self, Diff, Thread, Title};
use super::models::{SIZE, images, means, scene};
use crate::validation::case::{direction_density, direction_sampler};
use etalon_core::optics::microfacet::Ggx;
use etalon_core::raster::srgb_from_linear;
use etalon_core::sampling::normals::SampleNormals;
use etalon_stats::bsdf::Bsdf;
use etalon_stats::{Directions, Discrete, Disk, Mass, Plane, Pole, RealLine, Sample, density, sampler};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_6, PI, TAU};

/// The kinds, which names begin with.
#[cfg(test)]
pub const KINDS: [&str; 8] = ["energy", "image", "light", "map", "numerics", "pdf", "value", "weight"];

const SPHERE: Directions = Directions { pole: Pole::Z, half: false };
const HEMISPHERE: Directions = Directions { pole: Pole::Z, half: true };

/// Angles of `wo` in degrees.
const WOS: &[f64] = &[30.0, 60.0];

fn metal() -> Rough {
    Rough { alpha: [0.4; 2], facets: Facets::Conductor(0.7) }
}

fn glass() -> Rough {
    Rough { alpha: [0.3; 2], facets: Facets::Dielectric(1.5) }
}

fn cosine_weighted(u: [f64; 2]) -> Option<DVec3> {
    Some(DVec3::from_array(cosine(u)))
}

/// Henyey and Greenstein's phase function by the cosine of the angle to the forward direction.
fn henyey_greenstein(cos: f64, g: f64) -> f64 {
    (1.0 - g * g) / (2.0 * TAU * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

/// Faults that a planted one models already: name, planted fault, source, what was read, story.
pub const AGAIN: &[(&str, &str, &str, Seen, &str)] = &[
    (
        "pdf/alias-index",
        "table/alias-off-by-one",
        "pytorch/pytorch#21324",
        Diff,
        "multinomial sampling by an alias table decrements the index of the owner: its neighbour is returned",
    ),
    (
        "value/refraction-scaled-twice",
        "whole/dielectric/radiance-scaled-twice",
        "mmp/pbrt-v4#30",
        Diff,
        "the BTDF of rough glass lacks the η² that cancels the scaling of radiance",
    ),
    (
        "weight/light-choice",
        "light/choice-forgotten",
        "BachiLi/redner#56",
        Diff,
        "the pdf of a light sample of the environment map lacks the probability of choosing the map",
    ),
    (
        "energy/lambert-without-pi",
        "whole/diffuse/pi-left-out",
        "godotengine/godot#11694",
        Thread,
        "the Lambertian BRDF is not divided by π: a surface reflects more light than it receives",
    ),
    (
        "energy/layers-added",
        "whole/mixture/lobes-not-weighted",
        "google/filament#1563",
        Thread,
        "the diffuse lobe is not attenuated by what the specular layer reflects: more light than arrives",
    ),
    (
        "light/aperture-without-root",
        "warp/domain/disk-without-root",
        "erichlof/THREE.js-PathTracing-Renderer#36",
        Diff,
        "points of the aperture are sampled at the radius u in place of √u, and crowd its centre",
    ),
];

pub fn all() -> Vec<Exhibit> {
    let again = |fault: PlantedFault| {
        let (name, _, source, seen, story) = AGAIN.iter().find(|(_, of, ..)| *of == fault.name)?;
        Some(Exhibit::new(source, *seen, PlantedFault { name, mistake: story, ..fault }))
    };
    let again = planted::all().into_iter().filter_map(again);
    [pdfs(), bsdfs(), weights(), lights(), pictures(), environments(), numerics()]
        .into_iter()
        .flatten()
        .chain(again)
        .collect()
}

fn pdfs() -> Vec<Exhibit> {
    /// Weights of a table, and of two reservoirs of four.
    const WEIGHTS: [f64; 8] = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
    vec![
        Exhibit::new(
            "RayTracing/TheRestOfYourLife#8",
            Thread,
            PlantedFault::of("pdf/cosine-lobe-doubled", HEMISPHERE, |faulty| {
                let double = DVec3::new(2.0, 2.0, 1.0);
                let draw = move |u| cosine_weighted(u).map(|w| if faulty { w * double } else { w });
                (direction_sampler(draw), direction_density(|w: DVec3| w.z / PI))
            })
            .mistake("a cosine-weighted direction has x and y times 2: it is no unit vector, and leans to the horizon"),
        ),
        Exhibit::new(
            "RayTracing/raytracing.github.io#145",
            Thread,
            PlantedFault::of("pdf/cosine-cubed", HEMISPHERE, |faulty| {
                let draw = move |u: &[f64]| {
                    let radius = if faulty { u[2].cbrt() } else { 1.0 };
                    Some(Sample::new((DVec3::Z + radius * polar(1.0 - 2.0 * u[0], u[1])).normalize().to_array()))
                };
                (sampler(3, draw), direction_density(|w: DVec3| w.z / PI))
            })
            .mistake("the normal plus a point in the unit ball, not on its surface, is said to be cosine-weighted"),
        ),
        Exhibit::new(
            "RayTracing/raytracing.github.io#933",
            Diff,
            PlantedFault::of("pdf/uniform-for-cosine", HEMISPHERE, |faulty| {
                let pdf = move |w: DVec3| if faulty { 1.0 / TAU } else { w.z / PI };
                (direction_sampler(cosine_weighted), direction_density(pdf))
            })
            .mistake(
                "directions are cosine-weighted, the pdf is that of uniform ones; a wrong BRDF cancels it in the image",
            ),
        ),
        Exhibit::new(
            "mitsuba-renderer/mitsuba3#455",
            Diff,
            PlantedFault::of("pdf/hg-negative-g", SPHERE, |faulty| {
                const G: f64 = -0.5;
                let draw = move |u: [f64; 2]| {
                    let term = (1.0 - G * G) / (1.0 - G + 2.0 * G * u[0]);
                    let cos = (1.0 + G * G - term * term) / (2.0 * G);
                    Some(polar(if faulty && G < 1e-3 { 1.0 - 2.0 * u[0] } else { cos }, u[1]))
                };
                (direction_sampler(draw), direction_density(|w: DVec3| henyey_greenstein(w.z, G)))
            })
            .mistake(
                "the sign of g is ignored where g is compared with ε: for every negative g directions are uniform",
            ),
        ),
        Exhibit::new(
            "idaholab/mytrim#21",
            Thread,
            PlantedFault::of("pdf/points-of-a-cube", SPHERE, |faulty| {
                let draw = move |u: &[f64]| {
                    let point = 2.0 * DVec3::new(u[0], u[1], u[2]) - 1.0;
                    let w = if faulty { point } else { polar(point.x, u[1]) };
                    (w.length_squared() > 0.0).then(|| Sample::new(w.normalize().to_array()))
                };
                (sampler(3, draw), direction_density(|_: DVec3| 0.5 / TAU))
            })
            .mistake("points of a cube are normalised without rejecting those outside of the ball"),
        ),
        Exhibit::new(
            "RadioAstronomySoftwareGroup/pyuvsim#329",
            Thread,
            PlantedFault::of("pdf/uniform-altitude", SPHERE, |faulty| {
                let z = move |u: f64| if faulty { (PI * (u - 0.5)).sin() } else { 2.0 * u - 1.0 };
                (direction_sampler(move |u| Some(polar(z(u[0]), u[1]))), direction_density(|_: DVec3| 0.5 / TAU))
            })
            .mistake("the altitude of sources is uniform in place of its sine, which crowds them at the zenith"),
        ),
        Exhibit::new(
            "bashtage/ng-numpy-randomstate#67",
            Thread,
            PlantedFault::of("pdf/ziggurat-sign", RealLine::UNIT, |faulty| {
                let draw = move |u: &[f64]| {
                    let x = (-2.0 * (1.0 - u[0]).ln()).sqrt() * (TAU * u[1]).cos();
                    Some(Sample::new(if faulty && x.abs() < 3.65 { x.abs() } else { x }))
                };
                (sampler(2, draw), density(|x: f64| (-0.5 * x * x).exp() / TAU.sqrt()))
            })
            .mistake("a ziggurat for the normal distribution gives no negative numbers but in its tail"),
        ),
        Exhibit::new(
            "NVIDIAGameWorks/Falcor#212",
            Diff,
            PlantedFault::of("pdf/alpha-squared-again", HEMISPHERE, |faulty| {
                let (right, sampled) = (Ggx::new(0.4), Ggx::new(if faulty { 0.4 * 0.4 } else { 0.4 }));
                let draw = move |u: &[f64]| Some(Sample::new(sampled.sample_ndf([u[0], u[1]])));
                (sampler(2, draw), direction_density(move |m: DVec3| right.pdf_ndf(m.to_array())))
            })
            .mistake("GGX normals are sampled with α², where α is the square of the roughness already"),
        ),
        Exhibit::new(
            "nrc-cnrc/EGSnrc#557",
            Thread,
            PlantedFault::of("pdf/alias-weights", Discrete { outcomes: 4 }, |faulty| {
                let shares = if faulty { [10.0, 5.5, 1.0, 5.5] } else { [10.0, 10.0, 1.0, 1.0] };
                let ends = ends(&shares);
                let draw = move |u: &[f64]| Some(Sample::new(ends.partition_point(|end| *end <= u[0]).min(3)));
                (sampler(1, draw), density(|i: usize| [10.0, 10.0, 1.0, 1.0][i] / 22.0))
            })
            .mistake("an alias table samples 10 : 5.5 : 1 : 5.5 for some orders of weights such as 10 : 10 : 1 : 1"),
        ),
        Exhibit::new(
            "mmp/pbrt-v4#250",
            Diff,
            PlantedFault::of("pdf/reservoir-merge", Discrete { outcomes: 8 }, |faulty| {
                let (ends, sum) = (ends(&WEIGHTS), WEIGHTS.iter().sum::<f64>());
                let draw = move |u: &[f64]| {
                    let i = ends.partition_point(|end| *end <= u[0]).min(7);
                    // A merged sample keeps the sum of its reservoir for its own weight.
                    let weight = if faulty { WEIGHTS[i / 4 * 4..][..4].iter().sum() } else { WEIGHTS[i] };
                    Some(Sample::with_pdf(i, weight / sum))
                };
                (sampler(1, draw), density(move |i: usize| WEIGHTS[i] / sum))
            })
            .mistake("after a merge of reservoirs the weight of the sample is that of all of its former reservoir"),
        ),
        Exhibit::new(
            "apache/spark#16129",
            Thread,
            PlantedFault::of("pdf/reservoir-replacement", Discrete { outcomes: 6 }, |faulty| {
                let draw = move |u: &[f64]| {
                    let mut kept = [0, 1];
                    for (i, u) in (2..6).zip(u) {
                        // Probability 2/(i + 1), i + 1 elements so far
                        let slot = (u * (i + usize::from(!faulty)) as f64) as usize;
                        if let Some(kept) = kept.get_mut(slot) {
                            *kept = i;
                        }
                    }
                    Some(Sample::new(kept[usize::from(u[4] >= 0.5)]))
                };
                (sampler(5, draw), density(|_: usize| 1.0 / 6.0))
            })
            .mistake("a reservoir of k takes the l-th element with probability k/(l − 1), not k/l: later ones prevail"),
        ),
        Exhibit::new(
            "numpy/numpy#14777",
            Diff,
            PlantedFault::of("pdf/bounded-bytes", Discrete { outcomes: 31 }, |faulty| {
                let draw = move |u: &[f64]| {
                    let mut scaled = u.iter().map(|u| 31 * (256.0 * u) as u32);
                    let kept = |scaled: &u32| faulty || scaled % 256 >= 256 % 31;
                    scaled
                        .clone()
                        .find(kept)
                        .or_else(|| scaled.next_back())
                        .map(|scaled| Sample::new((scaled / 256) as usize))
                };
                (sampler(4, draw), density(|_: usize| 1.0 / 31.0))
            })
            .mistake("the threshold of rejection is 0 for integers of 8 and 16 bits: some numbers are more frequent"),
        ),
    ]
}

/// The ends of shares of \[0, 1).
fn ends(shares: &[f64]) -> Vec<f64> {
    let total: f64 = shares.iter().sum();
    (1..=shares.len()).map(|n| shares[..n].iter().sum::<f64>() / total).collect()
}

fn bsdfs() -> Vec<Exhibit> {
    use Change::{CarriedPdf, Pdf, ValueAndWeight};
    let two_lobes = || Mixture {
        diffuse: Lambertian { albedo: 0.8 },
        glossy: Rough { alpha: [0.2; 2], facets: Facets::Conductor(0.9) },
        probability: 0.3,
    };
    const BOTH_SIDES: &[f64] = &[30.0, 150.0, 125.0];
    vec![
        Exhibit::new(
            "mmp/pbrt-v4#215",
            Thread,
            planted(
                "pdf/measured-exchanged",
                metal,
                WOS,
                Pdf(|m, o, i| m.pdf(i, o)),
                "the pdf of a measured BRDF has wo and wi exchanged, its samples have not",
            ),
        ),
        Exhibit::new(
            "gkjohnson/three-gpu-pathtracer#847",
            Diff,
            planted(
                "pdf/lobe-weights",
                two_lobes,
                WOS,
                CarriedPdf(|m, o, i| Mixture { probability: 0.4, ..*m }.pdf(o, i)),
                "samples carry a pdf by other probabilities of the lobes than the one that MIS asks for",
            ),
        ),
        Exhibit::new(
            "mmp/pbrt-v3#254",
            Thread,
            planted(
                "value/total-reflection-lost",
                glass,
                BOTH_SIDES,
                ValueAndWeight(|m, o, i| {
                    let outside = |p| m.fresnel(p, m.index());
                    m.pair(o, i).map_or(0.0, |p| {
                        let is_lost = p.is_reflection && o[2] < 0.0;
                        let share = if is_lost { outside(p.cos_o.min(1.0)) } else { m.share(&p) };
                        m.value(o, i, &p, m.g2(o, i), share)
                    })
                }),
                "inside rough glass the half vector points inwards, and F is that of the other side: no total reflection",
            ),
        )
        .missed("a comparison with the model ggx-dielectric; a declared energy of conserved:0.3, which bounds the albedo from below"),
        Exhibit::new(
            "adobe/openpbr-bsdf#15",
            Thread,
            planted(
                "value/refraction-masked",
                glass,
                WOS,
                ValueAndWeight(|m, o, i| if o[2] * i[2] < 0.0 { 0.0 } else { m.eval(o, i, &[])[0] }),
                "an early exit of Smith's G₁ is 0 for directions below the surface: glass does not transmit",
            ),
        )
        .missed("a comparison with the model ggx-dielectric; a declared energy of conserved:0.3, which bounds the albedo from below"),
        Exhibit::new(
            "bevyengine/bevy#23203",
            Thread,
            planted(
                "energy/compensation-of-mixed-f0",
                Compensated::new,
                WOS,
                ValueAndWeight(|m, o, i| 0.88 * m.eval(o, i, &[])[0]),
                "multiple scattering is computed for the mean F₀ of metal and dielectric: half-metals lose light",
            ),
        ),
        Exhibit::new(
            "nvpro-samples/vk_raytracing_tutorial_KHR#56",
            Thread,
            planted(
                "weight/cosine-twice",
                || Lambertian { albedo: 0.6 },
                WOS,
                Change::Weight(|m: &Lambertian, _, s| m.albedo * s.wi[2]),
                "cosine-weighted directions are weighted by 1/π for their pdf: the cosine counts twice",
            ),
        ),
    ]
}

fn weights() -> Vec<Exhibit> {
    /// A square of side 1 at height 1: its pdf per solid angle, where a direction hits it.
    fn square(w: DVec3) -> Option<f64> {
        (w.x.abs() <= 0.5 * w.z && w.y.abs() <= 0.5 * w.z).then(|| w.z.powi(-3))
    }
    vec![
        Exhibit::new(
            "bevyengine/bevy#24671",
            Thread,
            means("weight/mis-of-two-measures", |faulty, [point, u, _]| {
                let w = DVec3::new(point[0] - 0.5, point[1] - 0.5, 1.0).normalize();
                let cosine_pdf = |w: DVec3| w.z / PI;
                let by_light = square(w).map_or(0.0, |pdf| cosine_pdf(w) / (pdf + cosine_pdf(w)));
                let w = DVec3::from_array(cosine(u));
                let by_bsdf = square(w).map_or(0.0, |pdf| {
                    let pdf = if faulty { 1.0 } else { pdf };
                    cosine_pdf(w) / (cosine_pdf(w) + pdf)
                });
                by_light + by_bsdf
            })
            .mistake("MIS weighs light that is hit by a pdf per area, and light samples by one per solid angle"),
        )
        .by("means"),
        Exhibit::new(
            "nvpro-samples/vk_raytrace#13",
            Thread,
            means("weight/mis-of-point-lights", |faulty, [place, ..]| {
                let w = DVec3::from_array(cosine(place));
                w.z * if faulty { 1.0 / (1.0 + w.z / PI) } else { 1.0 }
            })
            .mistake("point lights have a MIS weight below 1, though no ray can hit them"),
        )
        .by("means"),
        Exhibit::new(
            "nvpro-samples/vk_raytrace#13",
            Thread,
            means("weight/light-after-roulette", |faulty, [place, choice, _]| {
                let direct = cosine(place)[2];
                if faulty && choice[0] < 0.3 { 0.0 } else { direct }
            })
            .mistake("direct light is added after Russian roulette: a path that ends lacks that of its last vertex"),
        )
        .by("means"),
        Exhibit::new(
            "mitsuba-renderer/mitsuba3#863",
            Thread,
            means("weight/phase-in-light-sample", |faulty, [light, phase, _]| {
                let uniform = |u: [f64; 2]| henyey_greenstein(1.0 - 2.0 * u[0], 0.5);
                uniform(light) * if faulty { 2.0 * TAU * uniform(phase) } else { 1.0 }
            })
            .mistake("light samples have the weight of the sampled phase function: of mean 1, so that noise grows"),
        )
        .by("means")
        .missed("the variance of the weights: nothing is biased in this model"),
        Exhibit::new(
            "raysect/source#200",
            Thread,
            PlantedFault::of("weight/fibre-solid-angle", HEMISPHERE, |faulty| {
                const COS: f64 = 0.8;
                let solid_angle = TAU * if faulty { 1.0 } else { 1.0 - COS };
                let pdf = move |w: DVec3| if w.z > COS { 1.0 / solid_angle } else { 0.0 };
                let steps = [vec![1.0 - COS], Vec::new()];
                let draw = |u: [f64; 2]| Some(polar(1.0 - u[0] * (1.0 - COS), u[1]));
                (direction_sampler(draw), direction_density(pdf).with_steps(steps))
            })
            .mistake("rays within the acceptance angle of a fibre are weighted by the solid angle of a hemisphere"),
        ),
    ]
}

fn lights() -> Vec<Exhibit> {
    vec![
        Exhibit::new(
            "gkjohnson/three-gpu-pathtracer#184",
            Diff,
            PlantedFault::on(
                "light/disk-radius",
                || Disk::UNIT,
                |faulty| {
                    let draw = move |u: &[f64]| {
                        let (r, (sin, cos)) = (u[0].sqrt() * if faulty { 4.0 } else { 1.0 }, (TAU * u[1]).sin_cos());
                        Some(Sample::new([r * cos, r * sin]))
                    };
                    (sampler(2, draw), density(|_: [f64; 2]| 1.0 / PI))
                },
            )
            .mistake("points of a circular light have the radius 2√u, where its width is 1: most lie outside"),
        ),
        Exhibit::new(
            "google/filament#2339",
            Thread,
            PlantedFault::of("light/spot-angle-halved", HEMISPHERE, |faulty| {
                let outer = 2.0 * FRAC_PI_6;
                let whole = if faulty { 0.5 * outer } else { outer };
                let pdf = move |w: DVec3| if w.z > outer.cos() { 1.0 / (TAU * (1.0 - whole.cos())) } else { 0.0 };
                let steps = [vec![1.0 - outer.cos()], Vec::new()];
                let draw = move |u: [f64; 2]| Some(polar(1.0 - u[0] * (1.0 - outer.cos()), u[1]));
                (direction_sampler(draw), direction_density(pdf).with_steps(steps))
            })
            .mistake("the intensity of a spot light is computed for half of its half angle"),
        ),
        Exhibit::new(
            "GPUOpen-LibrariesAndSDKs/RadeonProRenderUSD#38",
            Thread,
            PlantedFault::of("light/ellipsoid-area", SPHERE, |faulty| {
                // Thomsen's formula for three equal axes of length 1
                const P: f64 = 1.6075;
                let mean = if faulty { 3f64.powf(1.0 / P) / 3.0 } else { 1.0 };
                let draw = |u: [f64; 2]| Some(polar(1.0 - 2.0 * u[0], u[1]));
                (direction_sampler(draw), direction_density(move |_: DVec3| 0.5 / (TAU * mean)))
            })
            .mistake("the area of a sphere light is divided by 3 outside of the root of Thomsen's formula, not inside"),
        ),
        Exhibit::new(
            "MilchRatchet/Luminary#29",
            Thread,
            PlantedFault::of("light/overlapping-lights", HEMISPHERE, |faulty| {
                const COS: f64 = 0.8;
                let axes = [DVec3::Z, polar(20f64.to_radians().cos(), 0.0)];
                let of = move |w: DVec3, light: usize| {
                    if w.dot(axes[light]) > COS { 0.5 / (TAU * (1.0 - COS)) } else { 0.0 }
                };
                let draw = move |u: &[f64]| {
                    let light = usize::from(u[2] >= 0.5);
                    let (side, local) = (axes[light].cross(DVec3::Y), polar(1.0 - u[0] * (1.0 - COS), u[1]));
                    let w = (local.x * side + local.y * DVec3::Y + local.z * axes[light]).normalize();
                    let both = of(w, 0) + of(w, 1);
                    Some(Sample::with_pdf(w.to_array(), if faulty { of(w, light) } else { both }))
                };
                (sampler(3, draw), direction_density(move |w: DVec3| of(w, 0) + of(w, 1)))
            })
            .mistake("where two lights overlap, a sample has the pdf of its own light alone: the light counts twice"),
        ),
    ]
}

fn pictures() -> Vec<Exhibit> {
    fn grey(weights: [f64; 3], at: [f64; 2]) -> [f64; 3] {
        [scene(at).into_iter().zip(weights).map(|(value, weight)| value * weight).sum(); 3]
    }
    let all = [
        (
            "unibas-gravis/scalismo-faces#25",
            Thread,
            images("image/encoded-twice", |faulty, at| {
                scene(at).map(|value| if faulty { f64::from(srgb_from_linear(value as f32)) } else { value })
            })
            .mistake("sRGB colours of meshes are taken for linear ones, and encoded again: images are too bright"),
        ),
        (
            "Unity-Technologies/ScriptableRenderPipeline#4479",
            Title,
            images("image/half-a-pixel", |faulty, at| scene(at.map(|x| if faulty { x - 0.5 } else { x })))
                .mistake("an image of half the resolution is read half a pixel away"),
        ),
        (
            "NVIDIA-RTX/Donut#24",
            Diff,
            images("image/jitter-off-centre", |faulty, [x, y]| scene([x, y - if faulty { 0.125 / 8.0 } else { 0.0 }]))
                .mistake(
                    "one sign among eight jitter offsets is wrong: their mean is 1/64 of a pixel, and the image moves",
                ),
        ),
        (
            "donatj/mpo#28",
            Diff,
            images("image/luma-swapped", |faulty, at| {
                grey(if faulty { [0.229, 0.587, 0.144] } else { [0.299, 0.587, 0.114] }, at)
            })
            .mistake("the luma weights 0.299 and 0.114 are written 0.229 and 0.144"),
        ),
        (
            "image-rs/image#506",
            Thread,
            images("image/luma-rounded", |faulty, at| {
                grey(if faulty { [0.2125, 0.7154, 0.0721] } else { [0.2126, 0.7152, 0.0722] }, at)
            })
            .mistake("the luma weights are those of an older recommendation, different in the fourth decimal"),
        ),
    ];
    let would_find = |name| match name {
        "image/jitter-off-centre" => Some("the offsets as a sampler of eight rows of the pixel"),
        "image/luma-rounded" => Some("images of pure colours without noise, with a limit of their largest difference"),
        _ => None,
    };
    let exhibit = |(source, seen, fault): (_, _, PlantedFault)| Exhibit {
        would_find: would_find(fault.name),
        ..Exhibit::new(source, seen, fault).by("compare")
    };
    all.map(exhibit).into()
}

fn environments() -> Vec<Exhibit> {
    vec![
        Exhibit::new(
            "google/filament#7636",
            Thread,
            images("map/mirrored", |faulty, [x, y]| scene([if faulty { SIZE[0] as f64 - x } else { x }, y]))
                .mistake("one of two programs that prefilter environment maps mirrors them, the other does not"),
        )
        .by("compare"),
        Exhibit::new(
            "matrix-org/thirdroom#347",
            Thread,
            images("map/upside-down", |faulty, [x, y]| scene([x, if faulty { SIZE[1] as f64 - y } else { y }]))
                .mistake("an environment map is read upside down: the sky is below"),
        )
        .by("compare"),
        Exhibit::new(
            "vga-group/tauray#5",
            Thread,
            maps::planted("map/pdf-without-sine", |scheme| {
                scheme.solid_angle = |map, _| TAU * PI / (map.width() * map.height()) as f64;
            })
            .mistake("the pdf of a map's texel lacks sin θ: the poles are too dark"),
        ),
        Exhibit::new(
            "BachiLi/redner#28",
            Diff,
            PlantedFault::of("map/zero-over-zero", SPHERE, |faulty| {
                // Radiance sin² θ: cos θ by the inverse of its cumulative distribution, a cubic
                let draw = |u: [f64; 2]| {
                    Some(polar((2.0 * (0.5 - ((1.0 - 2.0 * u[0]).asin() / 3.0).sin()) - 1.0).clamp(-1.0, 1.0), u[1]))
                };
                let pdf = move |w: DVec3| {
                    let (radiance, sin) = (w.truncate().length_squared(), w.truncate().length());
                    0.375 / PI * if faulty { radiance * sin / sin } else { radiance }
                };
                (direction_sampler(draw), direction_density(pdf))
            })
            .mistake("the pdf of a map is 0/0 where texels are black and sin θ is 0"),
        )
        .missed(
            "the pdf at the poles themselves: no random number is mapped there, and no node of the cubature lies there",
        ),
    ]
}

fn numerics() -> Vec<Exhibit> {
    vec![
        Exhibit::new(
            "godotengine/godot#74248",
            Diff,
            PlantedFault::of("numerics/logarithm-of-zero", RealLine::UNIT, |faulty| {
                let draw = move |u: &[f64]| {
                    let r = (-2.0 * if faulty { u[0] } else { 1.0 - u[0] }.ln()).sqrt();
                    Some(Sample::new((TAU * u[1]).cos() * r))
                };
                (sampler(2, draw), density(|x: f64| (-0.5 * x * x).exp() / TAU.sqrt()))
            })
            .mistake("normal numbers by Box and Muller from ln u, which is infinite for u = 0"),
        )
        .missed("a bounded domain, such as interval:-40,40: unbounded ones accept an infinite sample as a limit of their points"),
        Exhibit::new(
            "mmp/pbrt-v4#481",
            Diff,
            PlantedFault::on(
                "numerics/root-of-negative",
                || Plane::UNIT,
                |faulty| {
                    let draw = move |u: &[f64]| {
                        let (r2, (sin, cos)) = (-2.0 * (1.0 - u[0]).ln(), (TAU * u[1]).sin_cos());
                        Some(Sample::new([cos, sin].map(|x| if faulty { (r2 * x).sqrt() } else { r2.sqrt() * x })))
                    };
                    (sampler(2, draw), density(|[x, y]: [f64; 2]| (-0.5 * (x * x + y * y)).exp() / TAU))
                },
            )
            .mistake("Box and Muller's root is taken after the multiplication by cos φ and sin φ: NaN for half of all"),
        ),
        Exhibit::new(
            "JuliaStats/Distributions.jl#2018",
            Thread,
            PlantedFault::of("numerics/frame-of-the-axis", SPHERE, |faulty| {
                const KAPPA: f64 = 5.0;
                let axis = DVec3::X;
                let draw = move |u: [f64; 2]| {
                    let cos = 1.0 + (u[0] + (1.0 - u[0]) * (-2.0 * KAPPA).exp()).ln() / KAPPA;
                    let local = polar(cos.max(-1.0), u[1]);
                    let (w, between) = (DVec3::new(local.z, local.x, local.y), DVec3::X - axis);
                    // Householder's reflection of x to the axis
                    let is_needed = faulty || between.length_squared() > 0.0;
                    let h = between.normalize();
                    Some(if is_needed { w - 2.0 * w.dot(h) * h } else { w })
                };
                let norm = KAPPA / (TAU * (1.0 - (-2.0 * KAPPA).exp()));
                (direction_sampler(draw), direction_density(move |w: DVec3| norm * (KAPPA * (w.x - 1.0)).exp()))
            })
            .mistake("von Mises–Fisher samples are reflected to the mean direction: NaN where that is the first axis"),
        ),
        Exhibit::new(
            "arrayfire/arrayfire#1610",
            Thread,
            PlantedFault::of("numerics/one-is-included", Discrete { outcomes: 8 }, |faulty| {
                let draw = move |u: &[f64]| {
                    let u = if faulty { u[0] as f32 } else { (u[0] as f32).min(1f32.next_down()) };
                    Some(Sample::new((u * 8.0) as usize))
                };
                (sampler(1, draw), density(|_: usize| 0.125))
            })
            .mistake("a uniform number is rounded to 1 in single precision: an index past the end of a table"),
        ),
        Exhibit::new(
            "RayTracing/raytracing.github.io#1616",
            Thread,
            PlantedFault::of("numerics/vector-of-length-zero", SPHERE, |faulty| {
                let draw = move |u: &[f64]| {
                    let point = 2.0 * DVec3::new(u[0], u[1], u[2]) - 1.0;
                    let least = if faulty { -1.0 } else { 1e-160 };
                    let is_kept = point.length_squared() <= 1.0 && point.length_squared() > least;
                    is_kept.then(|| Sample::new((point / point.length()).to_array()))
                };
                (sampler(3, draw), direction_density(|_: DVec3| 1.0 / 24.0).with_mass(Mass::AtMostOne))
            })
            .mistake("a random vector in the ball is normalised even where its length is 0"),
        ),
        Exhibit::new(
            "NVIDIA/VisRTX#334",
            Thread,
            images("numerics/far-sphere", |faulty, [x, y]| {
                const FAR: f64 = 2000.0;
                let [x, y] = [x / SIZE[0] as f64 - 0.5, y / SIZE[1] as f64 - 0.5].map(|v| 1.8 * v);
                let apart = FAR * FAR + x * x + y * y;
                let quarter =
                    if faulty { f64::from((FAR * FAR) as f32 - (apart as f32 - 1.0)) } else { 1.0 - x * x - y * y };
                // Light from the side of the camera, 0.6 to the right
                let z = quarter.max(0.0).sqrt();
                [(0.6 * x + 0.8 * z).max(0.0) + 0.1; 3]
            })
            .mistake("the discriminant of a far sphere is the difference of two large numbers in single precision"),
        )
        .by("compare"),
    ]
}
