//! Spaces visit what they say.
use super::*;
use crate::bsdf::*;
use crate::examine::{Protocol,SampleCount};
struct Mirror;
impl Bsdf for Mirror {
    fn properties(&self) -> Properties { Properties { delta: true, map: None, ..Properties::default() } }
    fn eval(&self, _: Direction, _: Direction, _: &[f64]) -> Spectrum { [0.0; 3] }
    fn pdf(&self, _: Direction, _: Direction) -> f64 { 0.0 }
    fn sample(&self, wo: Direction, _: &[f64]) -> Option<BsdfSample> { Some(BsdfSample::new([-wo[0], -wo[1], wo[2]], [0.5; 3], Density::Delta(1.0))) }
    fn delta_lobes(&self, wo: Direction) -> Vec<DeltaLobe> { vec![DeltaLobe { wi: [-wo[0], -wo[1], wo[2]], probability: 1.0, throughput: [0.5; 3] }] }
}
#[test]
fn tmp_mirror() {
    use rayon::prelude::*;
    let w = ALL.iter().find(|c| c.name == "weights").unwrap();
    let mut p: Vec<(f64, u64)> = (0..20000u64).into_par_iter().map(|i| {
        let wo = crate::sweep::Configuration { values: vec![], wo: [(i % 890) as f64 * 0.1, (i % 3600) as f64 * 0.1], seed: i }.direction(1e-7);
        let protocol = Protocol { seed: crate::hash::mix64(i) >> 32, samples: SampleCount::Fixed(16384), level: 1e-3, tests: 1, cells: 50, cancelled: || false };
        (w.examine(&Mirror, wo, &protocol, 0).unwrap().unwrap().p.unwrap(), i)
    }).collect();
    p.sort_by(|a, b| a.0.total_cmp(&b.0));
    for f in [0.5, 0.1, 0.01, 1e-3, 1e-4, 1e-5] { println!("below {f}: {} expected {}", p.iter().filter(|p| p.0 < f).count(), 20000.0 * f); }
    println!("{:?}", &p[..10]);
}
