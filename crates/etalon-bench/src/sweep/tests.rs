//! Parts through files to a decision, with a planted fault and without; what does not belong together.

use super::*;
use crate::validation::families;
use etalon_core::build::Build;
use etalon_core::error::{Error, Result};
use etalon_stats::bsdf::{BatchBsdf, Bsdf, BsdfSample, Density, Direction, Family, Parameter, Properties, Spectrum};
use etalon_stats::sweep::Strategy;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

/// A Lambertian surface that samples another distribution below this share of its parameter.
struct Planted(f64);

struct Lambertian(f64);

impl Bsdf for Lambertian {
    fn properties(&self) -> Properties {
        // Without a map for the Jacobian, samples are a matter of statistics.
        Properties { map: None, ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [if wo[2] > 0.0 && wi[2] > 0.0 { 0.8 / PI } else { 0.0 }; 3]
    }

    fn pdf(&self, _: Direction, wi: Direction) -> f64 {
        wi[2].max(0.0) / PI
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let (u1, phi) = (u[1].powf(self.0), TAU * u[2]);
        let wi = [u1.sqrt() * phi.cos(), u1.sqrt() * phi.sin(), (1.0 - u1).sqrt()];
        let pdf = Bsdf::pdf(self, wo, wi);
        let weight = Bsdf::eval(self, wo, wi, &[])[0] * wi[2] / pdf;
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)))
    }
}

impl Family for Planted {
    fn name(&self) -> &str {
        "planted"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("alpha", 0.5, [0.0, 1.0])]
    }

    fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn BatchBsdf + '_>> {
        Ok(Box::new(Lambertian(if values[0] < self.0 { 1.3 } else { 1.0 })))
    }
}

fn planted(share: f64) -> Families {
    vec![Box::new(Planted(share))]
}

fn plan(families: Families, configurations: u64, seed: u64) -> Plan {
    let description = Description::new(&families, Strategy::Random, configurations, seed, [0.05, 0.01]).unwrap();
    Plan::new(description, families).unwrap()
}

/// Computes and writes the shares of a sweep; their files.
fn parts(folder: &Path, plan: &Plan, count: u32) -> Vec<PathBuf> {
    let one = |index: u32| {
        let path = folder.join(format!("part-{index}-of-{count}-seed-{}.csv", plan.description.seed()));
        let mut part = Part::new(plan, Shard { index, count });
        run(plan, &mut part, &|_| (), &|part| part.write(&path)).unwrap();
        path
    };
    (1..=count).map(one).collect()
}

fn merged(paths: &[PathBuf], families: Families) -> Result<Conclusion> {
    let all = |each: &mut dyn FnMut(&Plan, &Part)| merge(paths, |description| description.plan(families), each);
    conclude(all, &|_, _| ()).map(|(conclusion, _)| conclusion)
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_planted_fault_is_rejected_after_a_merge_and_its_replay_fails() {
    let folder = tempfile::tempdir().unwrap();
    let paths = parts(folder.path(), &plan(planted(0.2), 20, 1), 3);
    let found = merged(&paths, planted(0.2)).unwrap();
    assert!((2..=6).contains(&found.rejected) && found.configurations == 20, "{found:?}");
    let failure = found.failures.iter().find(|failure| failure.check == "sampling").unwrap();
    assert!(failure.configurations == found.rejected && failure.p.unwrap() < 1e-6, "{failure:?}");
    assert!(failure.replay.contains(" wo=0,0 ") && failure.replay.ends_with(" check=sampling"), "{}", failure.replay);
    let families = planted(0.2);
    let (_, configuration, findings) = replay(&failure.replay, &families, 0.05).unwrap();
    assert!(configuration.values[0] < 0.2 && findings.len() == 1 && findings[0].p == failure.p, "{findings:?}");
    // Any order, and any part made again, is the same.
    let again = merged(&[paths[2].clone(), paths[0].clone(), paths[1].clone()], planted(0.2)).unwrap();
    assert_eq!(again, found);
    let bytes = std::fs::read(&paths[1]).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| parts(folder.path(), &plan(planted(0.2), 20, 1), 3));
    assert!(std::fs::read(&paths[1]).unwrap() == bytes);
}

#[test]
fn what_is_right_is_accepted_and_its_part_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(planted(-1.0), 6, 2);
    let paths = parts(folder.path(), &plan, 1);
    let found = merged(&paths, planted(-1.0)).unwrap();
    assert!(found.rejected == 0 && found.inconclusive == 0 && found.failures.is_empty(), "{found:?}");
    let part = Part::read(&paths[0]).unwrap();
    assert!(part.len() == 6 && Part::is_at(&paths[0]) && part.description() == &plan.description);
    part.write(&folder.path().join("copy.csv")).unwrap();
    assert_eq!(std::fs::read(folder.path().join("copy.csv")).unwrap(), std::fs::read(&paths[0]).unwrap());
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mirror = || -> Families {
        families::all().into_iter().filter(|f| f.name() == "mirror").map(|f| Box::new(f) as Box<dyn Family>).collect()
    };
    let sweep = plan(mirror(), 4, 1);
    let [thirds, halves] = [3, 2].map(|count| parts(folder.path(), &sweep, count));
    let other = parts(folder.path(), &plan(mirror(), 4, 2), 3);
    let damaged = folder.path().join("damaged.csv");
    let text = std::fs::read_to_string(&thirds[1]).unwrap();
    let error = |paths: &[&PathBuf]| {
        let paths: Vec<PathBuf> = paths.iter().map(|path| (*path).clone()).collect();
        merged(&paths, mirror()).unwrap_err().to_string()
    };
    assert!(error(&[&thirds[0], &thirds[2]]).contains("the parts 2/3 are missing"));
    assert!(error(&[&thirds[0], &thirds[1], &thirds[1]]).contains("part 2 of 3, as"));
    assert!(error(&[&thirds[0], &halves[1]]).contains("part 2 of 2, but"));
    assert!(error(&[&thirds[0], &other[1]]).contains("seed: 2 here, 1 there"));
    assert!(matches!(merged(&[], mirror()), Err(Error::Parameter { .. })));
    // Interrupted, cut off, and not of this format.
    let rows: Vec<&str> = text.lines().collect();
    for (bad, expected) in [
        (rows[..2].join("\n"), "1 of 1 configurations are missing"),
        (text.replace(",ok,", ",ok"), "the table is damaged"),
        (format!("{text}{}\n", rows[2]), "is there twice"),
        (text.replace("\"sweep\":1", "\"sweep\":2"), "another version"),
        (text.replace(&Build::current().id(), "0.1.0+9"), "build: 0.1.0+9 here"),
        (text.replace("\"index\":2", "\"index\":4"), "makes no sense"),
        (text.replace("\"count\":3", "\"count\":4000000000"), "one of 4000000000 parts"),
        (text.replace("\"configurations\":4", "\"configurations\":99999999999"), "configurations of each family"),
        (text.replace("[0.0,1.0]", "[0.0,2.0]"), "parameters of the families"),
        (String::new(), "no part of a sweep"),
    ] {
        std::fs::write(&damaged, bad).unwrap();
        let found = error(&[&damaged]);
        assert!(found.contains(expected) && found.contains("damaged.csv"), "{found}");
    }
}

#[test]
fn an_interrupted_part_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let families: Families = vec![Box::new(families::all().swap_remove(1))];
    let plan = plan(families, 5, 1);
    let whole = std::fs::read_to_string(&parts(folder.path(), &plan, 1)[0]).unwrap();
    let path = folder.path().join("some.csv");
    let some: Vec<&str> =
        whole.lines().enumerate().filter(|(i, _)| ![2, 4].contains(i)).map(|(_, line)| line).collect();
    std::fs::write(&path, some.join("\n")).unwrap();
    let mut part = Part::read(&path).unwrap();
    assert!(part.len() == 3 && !part.has(0) && part.has(1));
    run(&plan, &mut part, &|_| (), &|part| part.write(&path)).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
}

#[test]
fn shares_are_all_configurations_once() {
    for count in [1, 2, 7] {
        let mut all: Vec<u64> = (1..=count).flat_map(|index| Shard { index, count }.numbers(20)).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..20), "{count}");
    }
}
