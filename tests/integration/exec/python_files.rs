//! Python files with the functions of a sampler or a BSDF: right ones, a wrong one whose mistake is named, wrong shapes, exceptions.

use super::has;
use crate::program::{Ran, etalon};
use tempfile::tempdir;

/// Runs `etalon WORDS` in a folder with the file `mine.py`; `None` where there is no Python, or no NumPy that it imports.
fn run(file: &str, words: &[&str]) -> Option<Ran> {
    let needed = if file.contains("import numpy") { "import numpy" } else { "" };
    if !has("python3", &["-c", needed]) {
        return None;
    }
    let folder = tempdir().unwrap();
    std::fs::write(folder.path().join("mine.py"), file).unwrap();
    Some(etalon(folder.path(), words))
}

fn validate(file: &str, more: &[&str]) -> Option<Ran> {
    run(file, &[&["validate", "mine.py"], more].concat())
}

/// Cosine-weighted directions in plain Python; `PDF` is to be filled in.
const PLAIN: &str = "
from math import cos, pi, sin, sqrt, tau
print('etalon 1')

def sample(u0, u1):
    print('end')
    r, phi = sqrt(u0), tau * u1
    return r * cos(phi), r * sin(phi), sqrt(1 - u0)

def pdf(w):
    return PDF
";

/// The same with NumPy; `ROWS` and `PDF` are to be filled in.
const ARRAYS: &str = "
import numpy as np

def sample(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return ROWS

def pdf(w):
    return PDF
";
const STACK: &str = "np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)";

fn arrays(rows: &str, pdf: &str) -> String {
    ARRAYS.replace("ROWS", rows).replace("PDF", pdf)
}

#[test]
fn samplers_of_files_are_tested_and_mistakes_named() {
    let few = ["--samples", "20000"];
    for right in [PLAIN.replace("PDF", "w[2] / pi"), arrays(STACK, "w[:, 2] / np.pi")] {
        let Some(ran) = validate(&right, &few) else { continue };
        assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains("the domain is hemisphere"), "{}", ran.stderr);
    }
    let page = include_str!("../../../docs/src/external-samplers.md");
    let of_book = page.split("```python\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap().to_owned();
    for wrong in [PLAIN.replace("PDF", "1 / tau"), of_book, arrays(STACK, "np.full(len(w), 0.5 / np.pi)")] {
        let Some(ran) = validate(&wrong, &[]) else { continue };
        let first = ran.stdout.lines().nth(2).unwrap_or_default();
        assert!(ran.code == 1 && first.contains("samples follow cos θ/π, not the pdf"), "{}", ran.stdout);
        assert!(ran.stdout.contains("\n  stopped after 8192 samples\n"), "{}", ran.stdout);
    }
}

#[test]
fn domains_come_from_the_file_the_flag_or_the_samples() {
    let uniform = "def sample(u):\n    return u\n\ndef pdf(x):\n    return 1.0\n";
    let die = "domain = 'discrete:6'\n\ndef sample(u):\n    return int(6 * u)\n\ndef pdf(i):\n    return 1 / 6\n";
    let sphere = "from math import *\ndef sample(u0, u1):\n    z = 2 * u0 - 1\n    r = sqrt(1 - z * z)\n    return r * cos(u1 * tau), r * sin(u1 * tau), z\n\n\
                  def pdf(x, y, z):\n    return 1 / (4 * pi)\n";
    let disc = "def sample(u0, u1):\n    return 2 * u0 - 1, u1\n\ndef pdf(p):\n    return 1.0\n";
    for (file, more, code, said) in [
        (uniform, &[][..], 0, "the domain is square"),
        (uniform, &["--domain", "line"], 0, ""),
        (sphere, &[], 0, "the domain is sphere"),
        (die, &[], 0, "the domain is discrete:6"),
        (die, &["--domain", "line"], 2, "its domain is discrete:6"),
        (disc, &[], 2, "coordinates are from 0 to 1 unless the file declares a domain"),
        (disc, &["--domain", "line"], 2, "sample returns 2 coordinates; a point of the domain line has 1"),
    ] {
        let Some(ran) = validate(file, &[&["--samples", "20000"], more].concat()) else { return };
        assert!(ran.code == code && ran.stderr.contains(said), "{file}: {} {}", ran.stdout, ran.stderr);
    }
}

#[test]
fn files_have_domains_by_name_and_charts_of_their_own() {
    let half_disk = include_str!("../../../examples/half_disk.py");
    let exponential = include_str!("../../../examples/exponential.py");
    let rotations = include_str!("../../../examples/rotations.py");
    // A pyramid whose side is 3z at the height z
    let cone = "def sample(u0, u1, u2):\n    z = u2 ** (1 / 3)\n    return 3 * z * u0, z * u1, z\n\ndef pdf(x, y, z):\n    return 1\n\n\
        def to_cube(x, y, z):\n    return (x / (3 * z), y / z, z) if z > 0 else (0, 0, 0)\n\n\
        def from_cube(a, b, z):\n    return 3 * z * a, z * b, z\n\ndef jacobian(a, b, z):\n    return 3 * z * z\n";
    let indexed = "domain = '3*interval:0,2'\n\ndef sample(u0, u1):\n    return int(3 * u0), 2 * u1\n\ndef pdf(i, x):\n    return 1 / 6\n";
    let cases = [
        (half_disk.to_owned(), 0, ""),
        (half_disk.replace("sqrt(u0)", "u0"), 1, ""),
        (half_disk.replace("return pi * r", "return r"), 2, "3.141593 = π times as much"),
        (half_disk.replace("atan2(y, x)", "atan2(x, y)"), 2, "do not invert each other"),
        (half_disk.replace("return pi * r", "return -r"), 2, "must be positive and finite"),
        (half_disk.replace("def jacobian", "def other"), 2, "functions of a chart and no function jacobian"),
        (exponential.to_owned(), 0, ""),
        (exponential.replace("/ 2", "* 2"), 1, ""),
        (exponential.replace("half-line", "half_line"), 2, "unknown domain"),
        (indexed.to_owned(), 0, ""),
        (rotations.to_owned(), 0, ""),
        (rotations.replace("sqrt(u0)", "u0"), 1, ""),
        (rotations.replace("return 1.0", "return 2 * (z * z + w * w)"), 1, ""),
        (cone.to_owned(), 0, ""),
        (cone.replace("u2 ** (1 / 3)", "u2"), 1, ""),
        (cone.replace("return 3 * z * z", "return z * z"), 2, "the volume per volume of the unit cube"),
    ];
    for (file, code, said) in cases {
        let Some(ran) = validate(&file, &["--detect", "0.2"]) else { return };
        assert!(ran.code == code && ran.stderr.contains(said), "{file}: {} {}", ran.stdout, ran.stderr);
    }
}

#[test]
fn weights_and_parameters_of_files_are_tested() {
    let resampled = include_str!("../../../examples/resampled.py");
    let power = "domain = 'line'\nparameters = {'g': (0, 4)}\ng = 1\n\ndef sample(u):\n    return u ** (1 / (g + 1))\n\n\
        def pdf(x):\n    return (g + 1) * x ** g\n";
    // A pdf that leaves out a factor where g is large
    let wrong = power.replace("return (g", "return (0.9 if g > 2 else 1) * (g");
    let declared = "stochastic = True\nnarrow = [(0.5, 0.25), (0.1, 0.1, 0.2, 0.3)]\n";
    let random = declared.to_owned() + &power.replace("return (g", "return 2 * (79190 * x % 1) * (g");
    let of_target = "def target(x, y):\n    return importance(x, y)\n".to_owned();
    let weighed = resampled.replace(" / (8 * importance(*chosen))", " / 8") + &of_target;
    let few = ["--samples", "10000"];
    let cases = [
        (resampled.to_owned(), &few[..], 0, "the variance of the weights is 0.4"),
        (weighed.clone(), &few, 0, "the variance of the weights"),
        (weighed.replace("return importance(x, y)", "return 1"), &few, 1, "weight"),
        (resampled.replace("(8 *", "(7 *"), &few, 1, "the mean of all weights is 1.1"),
        (resampled.replace("total / (8", "1e400 * total / (8"), &few, 1, "is inf"),
        (resampled.to_owned(), &["--samples", "500"], 3, "too few samples"),
        (power.to_owned(), &["--detect", "0.1"], 0, "corners of their ranges"),
        (wrong.clone(), &["--detect", "0.1"], 1, "fails for g ≥ 2"),
        (wrong.clone(), &["--detect", "0.1", "--set", "g=0.3"], 0, "accept"),
        (wrong, &["--detect", "0.1", "--set", "g=3"], 1, "integrates to 0.9"),
        (random, &["--detect", "0.05", "--set", "g=0.3"], 0, "accept"),
        (power.to_owned(), &["--set", "h=0.3"], 2, "has no parameter \"h\""),
        (power.to_owned(), &["--set", "g=5"], 2, "is not from 0 to 4"),
        (power.replace("(0, 4)", "(4, 0)"), &[], 2, "is not \"NAME VALUE FROM TO\""),
        (format!("narrow = [(2, 3)]\n{power}"), &[], 2, "which has no meaning"),
    ];
    for (file, more, code, said) in cases {
        let Some(ran) = validate(&file, &[more, &["-v"]].concat()) else { return };
        let all = ran.stdout + &ran.stderr;
        assert!(ran.code == code && all.contains(said), "{said}: {} {file}: {all}", ran.code);
    }
}

#[test]
fn functions_of_a_wrong_shape_are_told_the_right_one() {
    let pdf = "w[:, 2] / np.pi";
    for (file, said) in [
        (
            arrays(&STACK.replace("stack", "array").replace(", axis=1", ""), pdf),
            "shape (3, 11) for 11 samples; wanted (11, 3)",
        ),
        (arrays(&STACK.replace("np.stack([", "").replace("], axis=1)", ""), pdf), "a tuple of 3 arrays"),
        (
            arrays(STACK, "w[:, 2:] / np.pi"),
            "pdf returned an array of shape (11, 1) for 11 samples; wanted (11,): take",
        ),
        (arrays(STACK, "w[:, 2].mean()"), "pdf returned one number for 11 samples"),
        (
            PLAIN.replace(", sqrt(1 - u0)", "").replace("PDF", "w[2] / pi"),
            "and pdf takes 3; sample should return 3 coordinates, the x, y and z of a unit vector",
        ),
        (arrays(&STACK.replace(", np.sqrt(1 - u[:, 0])", ""), pdf), "sample returns 2 coordinates, such as (0."),
        (
            PLAIN.replace("pdf(w)", "pdf(x, y)").replace("PDF", "1 / pi"),
            "pdf takes 2 coordinates, and sample returns 3, such as (0.",
        ),
        (PLAIN.replace("pdf(w)", "pdf(w, q)"), "pdf takes 2 arguments; wanted 1, or one for each of 3 coordinates"),
        (format!("domain = \"disc\"\n{}", PLAIN.replace("PDF", "w[2] / pi")), "unknown domain \"disc\""),
        (PLAIN.replace("sample(u0, u1)", "sample()"), "sample takes no argument; wanted sample(u)"),
        (format!("{PLAIN}\ndimension = 0\n"), "dimension is 0; wanted sample(u)"),
        (PLAIN.replace("    return PDF", "    pass"), "pdf returned None for one sample; wanted a number"),
        (PLAIN.replace("pdf(w)", "density(w)"), "it has no function pdf; wanted sample(u) and pdf(w)"),
        (
            PLAIN.replace("PDF", "w[2] / 0"),
            "line 11, in pdf: ZeroDivisionError: float division by zero (return w[2] / 0), for (",
        ),
        (PLAIN.replace("PDF", "w[2"), "SyntaxError"),
        (PLAIN.replace("print('etalon 1')", "raise SystemExit(0)"), "line 3: SystemExit: 0"),
    ] {
        let Some(ran) = validate(&file, &[]) else { continue };
        assert_eq!(ran.code, 2, "{file}: {} {}", ran.stdout, ran.stderr);
        assert!(ran.stderr.starts_with("error: mine.py: ") && ran.stderr.contains(said), "{file}: {}", ran.stderr);
    }
    let folder = tempdir().unwrap();
    for (words, said) in [
        (&["validate", "nothing.py"][..], "nothing.py: there is no such file"),
        (&["furnace", "nothing.py"], "nothing.py: there is no such file"),
        (&["validate", "a.py", "b.py"], "a.py is not the only one"),
        (&["furnace", "a.py", "ggx"], "a.py is not the only one"),
        (&["validate", "a.py", "--exec", "true"], "is given, too"),
        (&["validate", "warp", "--set", "alpha=1"], "--set"),
    ] {
        let ran = etalon(folder.path(), words);
        assert!(ran.code == 2 && ran.stderr.contains(said), "{words:?}: {}", ran.stderr);
    }
}

/// A diffuse BSDF; `WEIGHT` is to be filled in.
const DIFFUSE: &str = "
from math import cos, pi, sin, sqrt, tau

albedo = 0.5
parameters = {'albedo': (0.5, 0, 1)}

def value(wo, wi):
    return albedo / pi if wo[2] > 0 and wi[2] > 0 else 0.0

def pdf(wo, wi):
    return wi[2] / pi if wo[2] > 0 and wi[2] > 0 else 0.0

def sample(wo, u):
    u0, u1 = u
    wi = sqrt(u0) * cos(tau * u1), sqrt(u0) * sin(tau * u1), sqrt(1 - u0)
    return (wi, WEIGHT) if wo[2] > 0 else None
";

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn bsdfs_of_files_are_tested() {
    let (right, wrong) = (DIFFUSE.replace("WEIGHT", "albedo"), DIFFUSE.replace("WEIGHT", "albedo / wi[2]"));
    let Some(ran) = validate(&right, &["--detect", "0.2", "--set", "albedo=0.9"]) else { return };
    assert_eq!(ran.code, 0, "{} {}", ran.stdout, ran.stderr);
    let rejected = validate(&wrong, &["--samples", "10000"]).unwrap();
    // The verdict and why come first, and accepted tests are folded.
    let lines: Vec<&str> = rejected.stdout.lines().collect();
    let first =
        lines[0].contains(" accepted, ") && lines[2].trim_start().starts_with("mine/formula/0: reject: weight · pdf");
    assert!(rejected.code == 1 && first, "{}", rejected.stdout);
    assert!(rejected.stdout.contains("accepted: values 6, ") && !rejected.stdout.contains("mine/values/30"));
    let chosen = |more: &[&str]| validate(&wrong, &[more, &["--samples", "10000", "-v"]].concat()).unwrap();
    let formula = chosen(&["formula", "mine/values/60"]);
    assert!(formula.code == 1 && formula.stdout.contains("mine/values/60   accept"), "{}", formula.stdout);
    let unknown = chosen(&["formla"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("there is no test \"mine/formla\""), "{}", unknown.stderr);
    assert_eq!(chosen(&["partition"]).code, 2, "no test applies");
}

/// A diffuse BSDF for arrays; `Z` is to be filled in, the cosine of wo.
const DIFFUSE_ARRAYS: &str = "
import numpy as np

def value(wo, wi):
    return np.where((Z > 0) & (wi[:, 2] > 0), 0.5 / np.pi, 0.0)

def pdf(wo, wi):
    return np.where((Z > 0) & (wi[:, 2] > 0), wi[:, 2] / np.pi, 0.0)

def sample(wo, u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    wi = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)
    return np.where(SAMPLED, wi, 0.0)
";

#[test]
fn bsdfs_of_files_are_written_for_arrays_of_wo_or_for_one() {
    let few = ["--samples", "10000", "--json", "reciprocity", "mine/sampling/30"];
    let found = |z: &str, sampled: &str| {
        validate(&DIFFUSE_ARRAYS.replace('Z', z).replace("SAMPLED", sampled), &few).map(|ran| {
            let mut value: serde_json::Value = serde_json::from_str(&ran.stdout).expect(&ran.stderr);
            let tests = value["tests"].as_array_mut().unwrap();
            tests.iter_mut().for_each(|test| test["seconds"] = 0.into());
            (ran.code, value["tests"].clone())
        })
    };
    let Some(of_arrays) = found("wo[:, 2]", "wo[:, 2:] > 0") else { return };
    assert_eq!(of_arrays.0, 0, "{}", of_arrays.1);
    // The last is also a value for arrays of wo: of the third wo, coordinate by coordinate.
    for sampled in ["wo[2] > 0", "(wi[:, 2:3] > 1e-6) & (wo[2] > 1e-6)"] {
        assert_eq!(found("wo[2]", sampled).unwrap(), of_arrays, "{sampled}");
    }
}

#[test]
fn a_file_is_compared_with_the_model_that_it_claims_to_be() {
    let right = DIFFUSE.replace("WEIGHT", "albedo");
    let bright = right.replace("return albedo / pi", "return 1.02 * albedo / pi");
    assert_ne!(right, bright);
    let like = |file: &str, more: &[&str]| validate(file, &[&["like", "--like"], more].concat());
    let (Some(same), Some(other)) = (like(&right, &["diffuse"]), like(&bright, &["diffuse"])) else { return };
    assert!(same.code == 0 && same.stdout.contains("mine/like/diffuse  accept"), "{} {}", same.stdout, same.stderr);
    assert!(other.code == 1 && other.stdout.contains("2.0 % too bright everywhere"), "{}", other.stdout);
    for (args, said) in [(&["lambert"][..], "there is no BSDF \"lambert\""), (&["ggx"], "ggx needs alpha_x")] {
        let refused = like(&right, args).unwrap();
        assert!(refused.code == 2 && refused.stderr.contains(said), "{}", refused.stderr);
    }
    let sampler = run(&PLAIN.replace("PDF", "w[2] / pi"), &["validate", "mine.py", "--like", "ggx"]).unwrap();
    assert!(sampler.code == 2 && sampler.stderr.contains("a model is a BSDF"), "{}", sampler.stderr);
}

#[test]
fn a_furnace_tests_a_file() {
    let (right, wrong) = (DIFFUSE.replace("WEIGHT", "albedo"), DIFFUSE.replace("WEIGHT", "albedo / wi[2]"));
    let furnace = |file: &str| run(file, &["furnace", "mine.py", "--size", "2x2", "--error", "0.05"]);
    let (Some(right), Some(wrong)) = (furnace(&right), furnace(&wrong)) else { return };
    assert!(right.code == 0 && right.stdout.contains("albedo = 1.0000"), "{} {}", right.stdout, right.stderr);
    assert!(wrong.code == 1 && wrong.stdout.contains("VIOLATIONS"), "{} {}", wrong.stdout, wrong.stderr);
    let sampler = run(&PLAIN.replace("PDF", "w[2] / pi"), &["furnace", "mine.py"]).unwrap();
    assert!(sampler.code == 2 && sampler.stderr.contains("no BSDF"), "{}", sampler.stderr);
}
