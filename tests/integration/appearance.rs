//! BSDFs of Python files as images: what a fault does to them.

use crate::program::{etalon, json};

/// A diffuse BSDF of albedo 0.5, with a `FACTOR` on its values.
const DIFFUSE: &str = "
from math import cos, pi, sin, sqrt, tau

def value(wo, wi):
    return FACTOR * 0.5 / pi if wo[2] > 0 and wi[2] > 0 else 0.0

def pdf(wo, wi):
    return wi[2] / pi if wo[2] > 0 and wi[2] > 0 else 0.0

def sample(wo, u):
    return (sqrt(u[0]) * cos(tau * u[1]), sqrt(u[0]) * sin(tau * u[1]), sqrt(1 - u[0])), 0.5
";

#[test]
fn a_fault_is_shown_beside_the_closest_model() {
    if !crate::exec::has("python3", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mine = |factor: &str| {
        std::fs::write(folder.path().join("mine.py"), DIFFUSE.replace("FACTOR", factor)).unwrap();
        json(folder.path(), &["render", "sphere-env", "--bsdf", "mine.py", "-r", "24", "24", "-s", "16"])
    };
    let right = mine("1");
    let number = |value: &serde_json::Value, key: &str| value[key].as_f64().unwrap();
    assert!(right["model"]["name"] == "diffuse" && number(&right["model"], "difference") < 0.01, "{right}");
    let noise = number(&right, "standard_error_percent");
    assert!(noise < 2.0 && number(&right, "mean_difference_percent").abs() < 4.0 * noise + 0.1, "{right}");
    let [sampling, noise] =
        ["mean_difference_percent", "standard_error_percent"].map(|key| number(&right["sampling"], key));
    assert!(sampling.abs() < 4.0 * noise + 0.1 && noise < 5.0, "{right}");
    for file in ["mine.png", "mine.exr", "mine-values.exr", "mine-model.exr"].map(|end| format!("sphere-env-{end}")) {
        assert!(folder.path().join("out").join(&file).is_file(), "{file}");
    }
    // What is not found is no agreement
    let args = ["render", "sphere-env", "--bsdf", "mine.py", "-r", "12", "12", "-s", "4", "-o", "right"];
    let text = etalon(folder.path(), &args).stdout.replace("\n  ", " ");
    for said in ["mine: no difference found", "would have been found (with 90 %", "etalon validate mine.py"] {
        assert!(text.contains(said), "{text}");
    }
    let page = include_str!("../../docs/src/columns.md");
    for key in right.as_object().unwrap().keys().filter(|key| *key != "files") {
        assert!([format!("`{key}`"), format!("`{key}.")].iter().any(|name| page.contains(name)), "{key}");
    }
    // Weights that do not have the factor of the values: BSDF samples bring more light than the values say
    let wrong = mine("0.5");
    let [found, noise] = ["mean_difference_percent", "standard_error_percent"].map(|key| number(&wrong, key));
    assert!(found > 5.0 * noise && found > 10.0, "{wrong}");
    // By its values alone it is half as bright
    let [found, noise] =
        ["mean_difference_percent", "standard_error_percent"].map(|key| number(&wrong["sampling"], key));
    assert!(found > 5.0 * noise && found > 10.0, "{wrong}");
    let look = ["--style", "column", "--title", "Mine", "-r", "24", "24", "-s", "4"];
    let text =
        etalon(folder.path(), &[&["render", "sphere-env", "--bsdf", "mine.py", "-o", "look"], &look[..]].concat())
            .stdout;
    assert!(text.starts_with("mine: samples, pdf or weights change the image\n"), "{text}");
    // The errors of pixels are there to compare by
    let [own, values] = ["look/sphere-env-mine.exr", "look/sphere-env-mine-values.exr"];
    let compared = etalon(folder.path(), &["compare", own, "--against", values]);
    assert!([0, 1, 3].contains(&compared.code), "{} {}", compared.stdout, compared.stderr);
    for (args, said) in [
        (&["render", "sphere-env", "-r", "8", "8", "--title", "a"][..], "--title"),
        (&["render", "cornell-statue-au", "--bsdf", "mine.py"], "no sphere"),
        (&["render", "sphere-env", "--bsdf", "mine.py", "--kernel", "lanes"], "cannot be used"),
        (&["render", "sphere-env", "--bsdf", "mine.py", "-s", "1"], "at least 2"),
        (&["render", "sphere-env", "--bsdf", "nothing.py"], "no such file"),
        (&["render", "sphere-env", "--set", "a=1"], "required"),
    ] {
        let ran = etalon(folder.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains(said), "{args:?}: {}", ran.stderr);
    }
}
