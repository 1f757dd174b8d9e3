"""The table results.csv, and the findings that explain its rejections: used by `run`, `page`, `browse` and the test of these."""

import csv
import tomllib
from fnmatch import fnmatchcase
from pathlib import Path

HERE = Path(__file__).parent
COLUMNS = [
    "package", "version", "entry", "domain", "seeds", "verdict", "rejected", "inconclusive", "p", "detectable", "words", "seconds",
    "class", "weight", "confirmed_by", "tracker",
]  # fmt: skip


def figure(package: str, entry: str) -> Path:
    """Where the figure of an entry that is not accepted is drawn."""
    return HERE / ".env/figures" / package / f"{entry.replace('/', '-').replace(' ', '_')}.png"


def read() -> list[dict[str, str]]:
    path = HERE / "results.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[dict[str, str]]) -> None:
    """Writes the rows by package, each with what the findings say of it."""
    known = findings()
    for row in rows:
        finding = next((finding for finding in known if explains(finding, row)), {})
        row |= {"class": finding.get("class", "convention" if row["words"] and row["verdict"] == "accept" else "")}
        row |= {"weight": finding.get("weight", ""), "confirmed_by": finding.get("confirm", ""), "tracker": finding.get("tracker", "")}
    with (HERE / "results.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(sorted(rows, key=lambda row: row["package"]))


def findings() -> list[dict[str, str]]:
    """All findings, by package: files findings/PACKAGE.toml with a table [[finding]] each."""
    return [
        {"package": path.stem, **finding}
        for path in sorted((HERE / "findings").glob("*.toml"))
        for finding in tomllib.loads(path.read_text())["finding"]
    ]


def explains(finding: dict[str, str], row: dict[str, str]) -> bool:
    return finding["package"] == row["package"] and row["verdict"] != "accept" and fnmatchcase(row["entry"], finding["entry"])


def row(package: str, version: str, found: dict) -> dict[str, str]:
    """The row of an entry: its runs with all seeds in one, the least p, the largest detectable error, the words of the first rejection."""
    runs = found["runs"]
    verdicts = [run["verdict"] for run in runs]
    worst = next((run for run in runs if run["verdict"] == "reject"), next((run for run in runs if run["verdict"] != "accept"), None))
    least = min((run["p"] for run in runs if run["p"] is not None), default=None)
    detectable = max((run["detectable"] for run in runs if run["detectable"] is not None), default=None)
    return {
        "package": package, "version": version, "entry": found["entry"], "domain": found["domain"],
        "seeds": " ".join(str(run["seed"]) for run in runs),
        "verdict": verdicts[0] if len(set(verdicts)) == 1 else "mixed",
        "rejected": str(verdicts.count("reject")), "inconclusive": str(verdicts.count("inconclusive")),
        "p": "" if least is None else f"{least:.3g}", "detectable": "" if detectable is None else f"{detectable:.3g}",
        "words": " ".join(worst["words"].split()) if worst else found["convention"],
        "seconds": f"{sum(run['seconds'] for run in runs):.1f}",
    }  # fmt: skip
