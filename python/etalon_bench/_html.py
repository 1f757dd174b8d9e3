"""The report of a run of pytest: one HTML file with everything in it."""

from __future__ import annotations

import html
import os
import tempfile
from pathlib import Path
from typing import Any

from ._result import LEAST, Result, image

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #222 }
table { border-collapse: collapse; width: 100% } th { text-align: right } th:nth-child(-n + 2) { text-align: left } td, th { padding: .3rem .6rem; border-bottom: 1px solid #ddd }
td.number { text-align: right; font-variant-numeric: tabular-nums } pre { white-space: pre-wrap; background: #f6f6f6; padding: .8rem }
.accept { color: #1a6e32 } .reject { color: #b3202c; font-weight: bold } .inconclusive { color: #8a5a00; font-weight: bold }
a { color: inherit } h2 { overflow-wrap: anywhere }
"""


def record(test: str, result: Result, with_figures: bool) -> dict[str, Any]:
    """What the report shows of a check, as plain values."""
    return {
        "test": test,
        "name": result.name,
        "verdict": result.verdict,
        "p": result.p,
        "detectable": result.detectable,
        "samples": result.samples,
        "seconds": result.seconds,
        "text": str(result),
        "figures": _figures(result) if with_figures else [],
    }


def _figures(result: Result) -> list[str]:
    """The figure of a result, and those of the single checks that it is rejected for."""
    return [result._repr_svg_(), *(check._repr_svg_() for check in result.checks if check.verdict == "reject")]


def counted(checks: list[dict[str, Any]]) -> str:
    """How many checks have which verdict."""
    of = [check["verdict"] for check in checks]
    return f"{of.count('accept')} accepted, {of.count('reject')} rejected, {of.count('inconclusive')} inconclusive"


def write(path: str, checks: list[dict[str, Any]], level: float) -> None:
    """Writes the report, whole or not at all."""
    order = ["reject", "inconclusive", "accept"]
    ranked = sorted(enumerate(checks), key=lambda entry: order.index(entry[1]["verdict"]))
    rows = "".join(_row(i, check) for i, check in ranked)
    details = "".join(_details(i, check) for i, check in ranked)
    page = (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>etalon</title><style>{STYLE}</style>'
        f"<h1>Checks of samplers, BSDFs and images</h1><p>{len(checks)} checks at level {level:g} together: {counted(checks)}.</p>"
        "<table><tr><th>check</th><th>verdict</th><th>p</th><th>detects</th><th>samples</th><th>seconds</th></tr>"
        f"{rows}</table>{details}</html>\n"
    )
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=target.parent, prefix=".etalon-", suffix=".part")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(page)
        os.chmod(part, 0o666 & ~_umask())
        os.replace(part, target)
    except BaseException:
        os.unlink(part)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _row(i: int, check: dict[str, Any]) -> str:
    p = "" if check["p"] is None else f"{check['p']:.3g}" if check["p"] >= LEAST else f"&lt; {LEAST}"
    detects = "" if check["detectable"] is None else f"{100 * check['detectable']:.3g} %"
    numbers = [p, detects, f"{check['samples']:,}" if check["samples"] else "", f"{check['seconds']:.2f}"]
    cells = "".join(f'<td class="number">{number}</td>' for number in numbers)
    verdict = check["verdict"]
    return f'<tr><td><a href="#{i}">{html.escape(check["name"])}</a></td><td class="{verdict}">{verdict}</td>{cells}</tr>'


def _details(i: int, check: dict[str, Any]) -> str:
    figures = "".join(map(image, check["figures"]))
    heading = f'<h2 id="{i}">{html.escape(check["name"])}: <span class="{check["verdict"]}">{check["verdict"]}</span></h2>'
    return f"{heading}<p>{html.escape(check['test'])}</p><pre>{html.escape(check['text'])}</pre>{figures}"
