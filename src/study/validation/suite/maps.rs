//! Environment maps: the built-in ones and small ones that find bugs, by every sampler.

use super::super::shared::Shared;
use super::Case;
use crate::envmap::EnvMap;
use crate::envmap::cosine::CosineSampler;
use crate::envmap::sampler::{AliasSampler, CdfSampler, CompensatedSampler, DirectionSampler, SurfaceSampler};
use crate::envmap::synthetic::Synthetic;
use crate::raster::{Image, Rgb};
use crate::sampling::alias::AliasTable;
use crate::sampling::direction_density;
use etalon_stats::{Directions, Mass, Pole, Sample, sampler};
use glam::DVec3;
use std::sync::Arc;

/// A map that is made when it is first needed.
struct Lazy {
    map: Shared<EnvMap>,
    make: Box<dyn Fn() -> Image + Send + Sync>,
}

impl Lazy {
    fn get(&self) -> Arc<EnvMap> {
        self.map.get(|| EnvMap::new((self.make)()))
    }
}

/// A map's name, and how it is got.
type Source = (String, Arc<Lazy>);

fn source(name: impl Into<String>, make: impl Fn() -> Image + Send + Sync + 'static) -> Source {
    (name.into(), Arc::new(Lazy { map: Shared::new(), make: Box::new(make) }))
}

pub fn cases() -> Vec<Case> {
    let mut sources: Vec<Source> = Synthetic::ALL.map(|map| source(map.name(), move || map.make())).into();
    for [width, height] in [[1, 1], [2, 1], [3, 2], [10, 10]] {
        sources.push(source(format!("{width}x{height}"), move || Image::from_fn(width, height, contrasts)));
    }
    for (place, hot) in [("corner", [0, 0]), ("seam", [15, 4]), ("pole", [7, 7]), ("centre", [8, 4])] {
        sources.push(source(format!("onehot-{place}"), move || one_hot(hot)));
    }
    let mut cases: Vec<Case> = sources.iter().flat_map(of).collect();
    // Larger than the finest level of the pyramid, whose blocks are then of several texels.
    let large = source("1024x1024", || Image::from_fn(1024, 1024, contrasts));
    cases.push(cosine(&large, "up", DVec3::Y));
    cases
}

/// The cases of a map of the user's own.
#[must_use]
pub fn of_map(name: &str, map: Arc<EnvMap>) -> Vec<Case> {
    let texels = map.image().pixels().len();
    let known = Lazy { map: Shared::from(map), make: Box::new(|| Image::new(1, 1)) };
    let cases = of(&(name.to_owned(), Arc::new(known)));
    // No sampler's table takes more than the alias table.
    cases.into_iter().map(|case| case.with_memory(texels * AliasTable::BYTES)).collect()
}

/// Dark texels beside bright ones, and one that outshines all.
fn contrasts(x: usize, y: usize) -> Rgb {
    match (x * 7 + y * 13) % 5 {
        _ if (x, y) == (2, 1) => Rgb::splat(1e5),
        1 => Rgb::ZERO,
        k => Rgb::new(k as f32 + 1.0, 0.5, 0.1),
    }
}

fn one_hot([x, y]: [usize; 2]) -> Image {
    let mut image = Image::new(16, 8);
    image.set(x, y, Rgb::new(1000.0, 500.0, 250.0));
    image
}

fn of(source: &Source) -> Vec<Case> {
    let (name, lazy) = source;
    let sphere = Directions::sphere(Pole::Y);
    let inverting = {
        let lazy = lazy.clone();
        Case::of(format!("map/{name}/cdf"), sphere, move || {
            let cdf = Arc::new(CdfSampler::new(lazy.get()));
            let (of, back) = (cdf.clone(), cdf.clone());
            let draw = move |u: &[f64]| cdf.sample([u[0], u[1]]).map(|s| Sample::with_pdf(s.wi.to_array(), s.pdf));
            let sampler = sampler(2, draw).with_inverse(move |wi: [f64; 3]| back.invert(wi.into()).to_vec());
            (
                sampler,
                direction_density(move |wi| of.pdf(wi))
                    .with_mass(mass(&lazy.get()))
                    .with_steps(lazy.get().geometry().edges()),
            )
        })
    };
    let slanted = DVec3::new(0.48, -0.6, 0.64);
    vec![
        inverting.with_preparation(preparing(lazy)),
        by_light(source, "alias", AliasSampler::new),
        by_light(source, "compensated", CompensatedSampler::new),
        cosine(source, "up", DVec3::Y),
        cosine(source, "down", -DVec3::Y),
        cosine(source, "slanted", slanted),
    ]
}

fn preparing(lazy: &Arc<Lazy>) -> impl Fn() + Send + Sync + use<> {
    let lazy = lazy.clone();
    move || drop(lazy.get())
}

/// A black map has nothing to draw.
fn mass(map: &EnvMap) -> Mass {
    Mass::Exactly(if map.image().pixels().iter().any(|p| *p != Rgb::ZERO) { 1.0 } else { 0.0 })
}

fn by_light<S: DirectionSampler + 'static>(source: &Source, how: &str, new: fn(Arc<EnvMap>) -> S) -> Case {
    let (name, lazy) = source;
    let preparation = preparing(lazy);
    let lazy = lazy.clone();
    let case = Case::of(format!("map/{name}/{how}"), Directions::sphere(Pole::Y), move || {
        let by = Arc::new(new(lazy.get()));
        let of = by.clone();
        let draw = move |u: &[f64]| by.sample([u[0], u[1]]).map(|s| Sample::with_pdf(s.wi.to_array(), s.pdf));
        let density = direction_density(move |wi| of.pdf(wi)).with_mass(mass(&lazy.get()));
        (sampler(2, draw), density.with_steps(lazy.get().geometry().edges()))
    });
    case.with_preparation(preparation)
}

/// Radiance × cosine, for a surface of that normal. Where its estimate of a block promises light that its parts do not
/// hold there is no sample.
fn cosine(source: &Source, towards: &str, normal: DVec3) -> Case {
    let (name, lazy) = source;
    let preparation = preparing(lazy);
    let lazy = lazy.clone();
    let case = Case::of(format!("map/{name}/cosine-{towards}"), Directions::sphere(Pole::Y), move || {
        let by = Arc::new(CosineSampler::new(lazy.get()));
        let of = by.clone();
        let draw =
            move |u: &[f64]| by.sample_for([u[0], u[1]], normal).map(|s| Sample::with_pdf(s.wi.to_array(), s.pdf));
        let density = direction_density(move |wi| of.pdf_for(wi, normal)).with_mass(Mass::AtMostOne);
        (sampler(2, draw), density.with_steps(lazy.get().geometry().edges()))
    });
    case.with_preparation(preparation)
}
