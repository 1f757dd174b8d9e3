//! The command `sweep`, and `merge` of its parts.

use crate::program::{etalon, json};

#[test]
fn parts_of_a_sweep_merge_to_what_one_machine_finds() {
    let dir = tempfile::tempdir().unwrap();
    let sweep = ["sweep", "mirror", "--configurations", "9"];
    let whole = json(dir.path(), &[&sweep[..], &["-o", "whole.csv"]].concat());
    assert_eq!((&whole["configurations"], &whole["rejected"]), (&9.into(), &0.into()));
    for (shard, threads) in [("1/2", "1"), ("2/2", "2")] {
        let out = format!("part-{}.csv", &shard[..1]);
        let part = json(dir.path(), &[&sweep[..], &["--shard", shard, "-t", threads, "-o", &out]].concat());
        assert_eq!(part["interrupted"], false);
    }
    let merged = json(dir.path(), &["merge", "part-2.csv", "part-1.csv", "-o", "all.csv"]);
    assert_eq!(merged["groups"], whole["groups"]);
    let rows = |name: &str| -> Vec<String> {
        let text = std::fs::read_to_string(dir.path().join(name)).unwrap();
        text.lines().skip(2).map(str::to_owned).collect()
    };
    let mut both = [rows("part-1.csv"), rows("part-2.csv")].concat();
    both.sort();
    assert_eq!(both, rows("whole.csv"));
    let damaged = std::fs::read_to_string(dir.path().join("part-1.csv")).unwrap().replace("\"mirror\"", "\"mirr1r\"");
    std::fs::write(dir.path().join("damaged.csv"), damaged).unwrap();
    for (args, expected) in [
        (&["merge", "part-1.csv"][..], "the parts 2/2 are missing"),
        (&["merge", "part-1.csv", "part-1.csv"], "part 1 of 2, as part-1.csv"),
        (&["merge", "part-1.csv", "whole.csv"], "part 1 of 1, but part-1.csv is one of 2"),
        (&["merge", "damaged.csv", "part-2.csv"], "damaged.csv: there is no family \"mirr1r\""),
        (&["sweep", "mirror", "--configurations", "3", "--shard", "4/4"], "--shard"),
        (&["sweep", "mirror", "--resume", "part-1.csv"], "another sweep (configurations: 100 here, 9 there)"),
        (&["sweep", "miror"], "there is no family \"miror\""),
        (&["sweep", "mirror", "--configurations", "0"], "--configurations"),
        (&["sweep", "mirror", "--detect", "2"], "--detect"),
        (&["sweep", "--replay", "mirror wo=90"], "--replay"),
        (&["sweep", "--replay", "mirror check=x"], "there is no check \"x\""),
    ] {
        let ran = etalon(dir.path(), args);
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{args:?}: {}", ran.stderr);
    }
}

#[test]
fn replays_run_one_configuration() {
    let dir = tempfile::tempdir().unwrap();
    let found = json(dir.path(), &["sweep", "--replay", "ggx alpha_x=0.001 wo=75,30 seed=7 check=formula"]);
    assert_eq!(found["configuration"], "ggx alpha_x=0.001 alpha_y=0.3 eta=0.5 k=2.5 wo=75,30 seed=7");
    assert_eq!((&found["checks"][0]["verdict"], &found["checks"][1]), (&"accept".into(), &serde_json::Value::Null));
    let list = json(dir.path(), &["sweep", "diffuse", "--list"]);
    assert_eq!(list["families"][0]["parameters"][0][0], "albedo");
}
