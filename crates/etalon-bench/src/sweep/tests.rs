//! Sweeps through files to a decision, with a planted fault and without; files that are damaged.

use super::*;
use crate::validation::families;
use etalon_core::build::Build;
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

/// Computes a sweep and writes its file.
fn run_of(folder: &Path, plan: &Plan) -> (Computed, PathBuf) {
    let path = folder.join("sweep.csv");
    let mut computed = Computed::new(plan);
    run(plan, &mut computed, &|_| (), &|computed| computed.write(&path)).unwrap();
    (computed, path)
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_planted_fault_is_rejected_and_its_replay_fails() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = plan(planted(0.2), 20, 1);
    let (computed, path) = run_of(folder.path(), &sweep);
    let found = conclude(&sweep, &computed, &|_, _| ()).unwrap();
    assert!((2..=6).contains(&found.rejected) && found.configurations == 20, "{found:?}");
    let failure = found.failures.iter().find(|failure| failure.check == "sampling").unwrap();
    assert!(failure.configurations == found.rejected && failure.p.unwrap() < 1e-6, "{failure:?}");
    assert!(failure.replay.contains(" wo=0,0 ") && failure.replay.ends_with(" check=sampling"), "{}", failure.replay);
    let families = planted(0.2);
    let (_, configuration, findings) = replay(&failure.replay, &families, 0.05).unwrap();
    assert!(configuration.values[0] < 0.2 && findings.len() == 1 && findings[0].p == failure.p, "{findings:?}");
    // From its file, and made again by one thread, it is the same.
    assert_eq!(conclude(&sweep, &Computed::read(&path).unwrap(), &|_, _| ()).unwrap(), found);
    let bytes = std::fs::read(&path).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| run_of(folder.path(), &sweep));
    assert!(std::fs::read(&path).unwrap() == bytes);
}

#[test]
fn what_is_right_is_accepted_and_its_part_reads_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(planted(-1.0), 6, 2);
    let (computed, path) = run_of(folder.path(), &plan);
    let found = conclude(&plan, &computed, &|_, _| ()).unwrap();
    assert!(found.rejected == 0 && found.inconclusive == 0 && found.failures.is_empty(), "{found:?}");
    let read = Computed::read(&path).unwrap();
    assert!(read.len() == 6 && read == computed && read.description() == &plan.description);
}

#[test]
fn damaged_files_and_those_of_other_sweeps_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let mirror = || -> Families {
        families::all().into_iter().filter(|f| f.name() == "mirror").map(|f| Box::new(f) as Box<dyn Family>).collect()
    };
    let sweep = plan(mirror(), 4, 1);
    let text = std::fs::read_to_string(run_of(folder.path(), &sweep).1).unwrap();
    let damaged = folder.path().join("damaged.csv");
    let read = |text: String| {
        std::fs::write(&damaged, text).unwrap();
        Computed::read(&damaged)
    };
    let row = text.lines().nth(2).unwrap();
    for (bad, expected) in [
        (text.replace(",ok,", ",ok"), "the table is damaged"),
        (format!("{text}{row}\n"), "is there twice"),
        (text.replace("\"sweep\":2", "\"sweep\":1"), "another version"),
        (String::new(), "no file of a sweep"),
    ] {
        let found = read(bad).unwrap_err().to_string();
        assert!(found.contains(expected) && found.contains("damaged.csv"), "{found}");
    }
    let other = plan(mirror(), 4, 2).description;
    assert_eq!(other.difference(&sweep.description).unwrap(), "seed: 1 here, 2 there");
    for (old, new, expected) in [
        (Build::current().id(), "0.1.0+9".to_owned(), "build: 0.1.0+9 here"),
        ("[0.0,1.0]".into(), "[0.0,2.0]".into(), "other parameters of the families"),
    ] {
        let found = sweep.description.difference(read(text.replace(&old, &new)).unwrap().description()).unwrap();
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn an_interrupted_part_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let families: Families = vec![Box::new(families::all().swap_remove(1))];
    let plan = plan(families, 5, 1);
    let whole = std::fs::read_to_string(run_of(folder.path(), &plan).1).unwrap();
    let path = folder.path().join("some.csv");
    let some: Vec<&str> =
        whole.lines().enumerate().filter(|(i, _)| ![2, 4].contains(i)).map(|(_, line)| line).collect();
    std::fs::write(&path, some.join("\n")).unwrap();
    let mut computed = Computed::read(&path).unwrap();
    assert!(computed.len() == 3 && !computed.has(0) && computed.has(1));
    run(&plan, &mut computed, &|_| (), &|computed| computed.write(&path)).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
}
