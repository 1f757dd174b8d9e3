//! The page of all figures: what runs leave behind, and what a browser makes of it.

use crate::program::{etalon, json};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Figures that cost little: charts, groups of pictures, a chart with a render inside, and one with panels.
const ONLY: &str = "fresnel-enter,fresnel-exit,median-cut-2,median-cut-4,sphere-8,audit";

fn page(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("figures/index.html")).unwrap()
}

#[test]
fn a_smaller_run_keeps_what_a_larger_one_left() {
    let dir = tempfile::tempdir().unwrap();
    let secret = dir.path().join("map & co.pfm");
    let run = |args: &[&str]| json(dir.path(), &[&["reproduce"], args].concat());
    run(&["--only", "fresnel-enter,median-cut-2"]);
    assert_eq!(etalon(dir.path(), &["envmap", "make", "sun", "-o", secret.to_str().unwrap()]).code, 0);
    run(&["--only", "median-cut-4", "--seed", "7", "--envmap", secret.to_str().unwrap()]);
    let text = page(dir.path());
    for id in ["fresnel-enter", "median-cut-2", "median-cut-4"] {
        assert!(text.contains(&format!("id=\"figure-{id}\"")), "{id}");
    }
    assert!(!text.contains("id=\"figure-iron\""), "was never made");
    assert!(text.contains("<code>etalon reproduce --only fresnel-enter</code>"));
    assert!(text.contains("etalon reproduce --only median-cut-4 --seed 7 --envmap 'map &amp; co.pfm'"));
    assert!(!text.contains(dir.path().to_str().unwrap()), "a folder of this machine is on the page");
    let checks = std::fs::read_to_string(dir.path().join("figures/checks.csv")).unwrap();
    assert!(checks.starts_with("figure,name,kind,expected,got,tolerance,pass,skipped\n"), "{checks}");
    assert!(checks.contains("fresnel-enter,") && checks.contains("median-cut-4,"));
    // A limit has no tolerance, and its kind says in which direction it holds.
    let limit = checks.lines().find(|line| line.starts_with("median-cut-4,")).unwrap();
    assert!(limit.contains(",at most,") && limit.ends_with(",,true,"), "{limit}");

    std::fs::write(dir.path().join("figures/reproduce.json"), "{\"iron\": 3}").unwrap();
    let ran = etalon(dir.path(), &["reproduce", "--only", "fresnel-enter"]);
    assert!(ran.code == 2 && ran.stderr.contains("reproduce.json") && ran.stderr.contains("hint: "), "{}", ran.stderr);
}

/// The page of all figures of the registry. Those that are not made are copies of `sphere-8`: a chart with two noisy renders.
fn page_of_all(folder: &Path, made: &str) -> String {
    json(folder, &["reproduce", "--quick", "--only", made]);
    let figures = folder.join("figures");
    let records = figures.join("reproduce.json");
    let mut all: serde_json::Value = serde_json::from_slice(&std::fs::read(&records).unwrap()).unwrap();
    for figure in json(folder, &["reproduce", "--list"])["figures"].as_array().unwrap() {
        let id = figure["id"].as_str().unwrap();
        if all.get(id).is_none() {
            all[id] = all["sphere-8"].clone();
            for extension in ["svg", "png"] {
                let name = |id: &str| figures.join(format!("{id}.{extension}"));
                std::fs::copy(name("sphere-8"), name(id)).unwrap();
            }
        }
    }
    std::fs::write(&records, all.to_string()).unwrap();
    json(folder, &["reproduce", "--only", "fresnel-enter"]);
    page(folder)
}

#[test]
fn a_page_of_all_figures_is_small_enough_to_be_sent() {
    let dir = tempfile::tempdir().unwrap();
    let bytes = page_of_all(dir.path(), "fresnel-enter,sphere-8").len();
    assert!(bytes < 6_000_000, "{bytes} bytes");
}

/// The page with a script that uses everything and tells what is wrong; among that what axe-core finds, if `ETALON_AXE` is the path
/// of its `axe.min.js`.
fn probed(page: &str) -> String {
    let axe = axe().map_or(String::new(), |path| std::fs::read_to_string(path).unwrap());
    let probe = include_str!("page_files/probe.js");
    let scripts = [axe.as_str(), probe].map(|script| format!("<script>//<![CDATA[\n{script}\n//]]></script>"));
    page.replacen("</head>", &format!("{}</head>", scripts.concat()), 1)
}

/// The path of axe-core, which looks for what keeps people from using a page.
fn axe() -> Option<std::ffi::OsString> {
    std::env::var_os("ETALON_AXE").filter(|path| !path.is_empty())
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn a_browser_finds_nothing_missing_or_broken() {
    let Some(browser) = browser() else {
        eprintln!("SKIPPED: there is no chromium here; the page was opened in no browser");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let text = page_of_all(dir.path(), ONLY);
    let file = dir.path().join("figures/probed.html");
    // Beside its figures and alone, at the widths of a desktop, a tablet and a phone.
    std::fs::write(&file, probed(&text)).unwrap();
    let alone = dir.path().join("alone.html");
    std::fs::copy(&file, &alone).unwrap();
    for (path, width) in [(&file, 1280), (&file, 820), (&file, 390), (&alone, 1280)] {
        let found = title(browser, dir.path(), path, width);
        // Away from its figures the page looks for the full ones in vain, and shows its own.
        let found = if path == &alone {
            missing(dir.path()).iter().fold(found, |all, one| all.replace(one, ""))
        } else {
            found
        };
        let good = found
            .strip_prefix("PROBED")
            .and_then(|rest| rest.split_once('['))
            .is_some_and(|(_, wrong)| wrong.trim_matches([';', ' ', ']']).is_empty());
        assert!(good, "at {width} pixels: {found}");
    }
    // The probe can fail: an image that is none, and a link that leads nowhere.
    // Nor may a table be wider than a phone, a slider that is stuck go unnoticed, or the page be endless.
    let damaged = text.replacen("base64,", "base64,AAAA", 1).replacen("href=\"#figure-", "href=\"#lost-", 1);
    for (damaged, width, expected) in [
        (damaged.clone(), 1280, "no picture: "),
        (damaged, 1280, "leads nowhere: #lost-"),
        (text.replace(".cards td { display: block;", ".cards td { min-width: 60rem;"), 390, "wider than"),
        (text.replace("nameOf(other) !== nameOf(figure)", "false"), 1280, "the slider does not show"),
        (text.replace("share.oninput = divide", "share.onchange = divide"), 1280, "the slider does not move the edge"),
        (text.replace("stage.onwheel", "stage.onscroll"), 1280, "the wheel does not enlarge"),
        (text.replace("row.hidden = matching", "row.hidden = false && matching"), 1280, "rows match"),
        (text.replace("max-height: 16.5rem", "max-height: 40rem"), 1280, "pixels tall"),
        (text.replace("<details class=\"about\"", "<details open=\"open\" class=\"about\""), 1280, "tab stops"),
        (text.replace(" alt=\"", " data-alt=\""), 1280, "axe: image-alt"),
    ] {
        if expected.starts_with("axe") && axe().is_none() {
            eprintln!("skipped: ETALON_AXE is no path of axe-core; nothing was said of accessibility");
            continue;
        }
        std::fs::write(&file, probed(&damaged)).unwrap();
        let found = title(browser, dir.path(), &file, width);
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

/// What the browser reports of the figures that the page alone holds compressed.
fn missing(folder: &Path) -> [String; 2] {
    ["median-cut-2.svg", "median-cut-4.svg"].map(|name| format!("error: file://{}", folder.join(name).display()))
}

/// The browser's name, if there is one that starts.
fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))
}

/// What the probe finds in a page of that width. Windows are at least 500 pixels wide, so that the page is in a frame, whose page
/// has what is found as its title.
fn title(browser: &str, folder: &Path, page: &Path, width: u32) -> String {
    let (output, frame) = (folder.join("dom.html"), page.with_file_name("frame.html"));
    let name = page.file_name().unwrap().to_str().unwrap();
    let text = format!(
        "<!DOCTYPE html><title>nothing was found</title><iframe src=\"{name}\" width=\"{width}\" height=\"900\"></iframe>\
         <script>onmessage = (event) => {{ document.title = event.data; }}</script>"
    );
    std::fs::write(&frame, text).unwrap();
    let mut child = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--dump-dom"])
        .args(["--timeout=60000", "--virtual-time-budget=30000"])
        .arg("--window-size=1500,1000")
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", frame.display()))
        .stdout(std::fs::File::create(&output).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
            panic!("{browser} hangs on {}", page.display());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let dom = std::fs::read_to_string(&output).unwrap();
    let title = dom.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    title.unwrap_or_else(|| panic!("no title in {} bytes", dom.len())).0.to_owned()
}
