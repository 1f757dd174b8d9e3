"""What the scripts in packages/ share: an entry is a test of one sampler or BSDF, by a name, and `run` runs all entries of a package.

A script declares a control that is right and one that is wrong: entries with control="right" and control="wrong". They test the
script's own way of calling the package; if one of them gets the other verdict, the client is at fault and nothing is written.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import etalon_bench as eb
import table

# What a package prints, from C too, goes to standard error: standard output is for the rows.
ANSWERS = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


@dataclass(frozen=True)
class Entry:
    """`check(seed, figure)` gives verdict, p, detectable and words; it saves a figure of what is not accepted at the path `figure`."""

    name: str
    domain: str
    check: Callable[[int, Path | None], dict[str, Any]]
    control: str = ""  # "right" or "wrong"
    convention: str = ""  # what the package means otherwise than the bench, in a sentence; the entry is declared accordingly


def sampler(name: str, sample: Any, pdf: Any, domain: Any, *, control: str = "", convention: str = "", **options: Any) -> Entry:
    """An entry for `eb.check_sampler`, with its options."""
    label = domain if isinstance(domain, str) else "chart"
    return Entry(name, label, lambda seed, figure: _of_result(eb.check_sampler(sample, pdf, domain, name=name, seed=seed, **options), figure), control, convention)


def bsdf(name: str, bsdf: Any, *, control: str = "", convention: str = "", **options: Any) -> Entry:
    """An entry for `eb.check_bsdf`, with its options."""
    return Entry(name, "bsdf", lambda seed, figure: _of_result(eb.check_bsdf(bsdf, seed=seed, **options), figure), control, convention)


def program(name: str, command: Sequence[str], domain: str, convention: str = "", *, control: str = "") -> Entry:
    """An entry for a program that speaks the protocol; `domain` is for the table, the greeting says it."""
    detect = ["--detect", "0.1"] if domain == "bsdf" else []

    def check(seed: int, figure: Path | None) -> dict[str, Any]:
        with tempfile.TemporaryDirectory() as folder:
            line = " ".join("'" + word.replace("'", "'\\''") + "'" for word in command)
            done = subprocess.run(
                [sys.executable, "-m", "etalon_bench", "validate", "--exec", line, "--seed", str(seed), "--json", "-o", folder, *detect],
                capture_output=True, text=True,
            )
            if done.returncode not in (0, 1, 3):
                raise RuntimeError(done.stderr.strip().splitlines()[-1])
            tests = json.loads(done.stdout)["tests"]
            verdict = ("accept", "reject", "inconclusive")[min(done.returncode, 2)]
            # The figure of all tests has the shortest name
            drawn = min(Path(folder).glob("*.png"), key=lambda path: len(path.name), default=None)
            if drawn and figure and verdict != "accept":
                figure.write_bytes(drawn.read_bytes())
        failed = [test for test in tests if test["verdict"] == verdict != "accept"]
        words = [test[key] for test in failed[:1] for key in ("named", "violation", "inconclusive_reason", "diagnosis") if test[key]]
        least, most = ([test[key] for test in tests if test[key] is not None] for key in ("p", "detectable"))
        return {"verdict": verdict, "p": min(least, default=None), "detectable": max(most, default=None), "words": "; ".join(words[:2])}

    return Entry(name, domain, check, control, convention)


def library(serve: Sequence[str], control: str) -> list[Entry]:
    """The entries of a program that prints their names, domains and conventions for `list`, and serves one by its name; a second argument is a mistake."""
    listed = subprocess.run([*serve, "list"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [
        *(program(name, [*serve, name], *about) for name, *about in (line.split("\t") for line in listed)),
        program("control/right", [*serve, control], "real", control="right"),
        program("control/wrong", [*serve, control, "1.05"], "real", control="wrong"),
    ]


def _of_result(result: eb.Result, figure: Path | None) -> dict[str, Any]:
    if figure and result.verdict != "accept":
        result.save(figure)
    failed = [check for check in result.checks if check.verdict != "accept"]
    words = [f"{check.name}: {check.reason or '; '.join(check.places[:1])}" for check in failed[:3]]
    words = words or [result.reason or "; ".join(result.places[:1])]
    return {"verdict": result.verdict, "p": result.p, "detectable": result.detectable, "words": "; ".join(words)}


def _run(entry: Entry, seed: int, figure: Path | None) -> dict[str, Any]:
    start = time.perf_counter()
    try:
        found = entry.check(seed, figure)
    except Exception as error:  # a fault of the package or of its client: the table says so
        found = {"verdict": "error", "p": None, "detectable": None, "words": f"{type(error).__name__}: {error}"}
    return {"seed": seed, **found, "seconds": time.perf_counter() - start}


def run(entries: Sequence[Entry]) -> None:
    """Runs the entries and prints a line of JSON for each."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=lambda text: [int(seed) for seed in text.split(",")], default=[1, 2])
    parser.add_argument("--only", default="*", help="pattern of the names of entries; controls run in any case")
    parser.add_argument("--figures", type=Path, default=None, help="folder for figures of what is not accepted")
    options = parser.parse_args()
    names = [entry.name for entry in entries]
    if len(set(names)) < len(names) or {"right", "wrong"} - {entry.control for entry in entries}:
        sys.exit(f"the client is at fault: names {sorted(name for name in names if names.count(name) > 1)} are not unique, or a control that is right or one that is wrong is missing")
    for entry in sorted(entries, key=lambda entry: not entry.control):
        if not (entry.control or fnmatch(entry.name, options.only)):
            continue
        figure = None if options.figures is None or entry.control else options.figures / table.figure("", entry.name).name
        runs = []
        for seed in options.seeds:
            runs.append(_run(entry, seed, None if figure is None or any(run["verdict"] != "accept" for run in runs) else figure))
            wanted = {"right": "accept", "wrong": "reject"}.get(entry.control, runs[-1]["verdict"])
            if runs[-1]["verdict"] != wanted:
                sys.exit(f"the client is at fault: its control {entry.name} should {wanted}: {runs[-1]}")
        print(json.dumps({"entry": entry.name, "domain": entry.domain, "control": entry.control, "convention": entry.convention, "runs": runs}), file=ANSWERS, flush=True)
