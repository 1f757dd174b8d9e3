"""The Python examples of the book run as they stand there, as a file of tests for each page."""

from __future__ import annotations

from pathlib import Path

import pytest

BOOK = Path(__file__).resolve().parents[2] / "docs/src"
README = Path(__file__).resolve().parents[1] / "README.md"


def blocks(page: Path) -> str:
    """All blocks of Python, one after the other."""
    parts = page.read_text(encoding="utf-8").split("```python\n")[1:]
    return "\n".join(part.split("```\n")[0] for part in parts)


@pytest.mark.parametrize(
    ("page", "needs", "tests"),
    [(BOOK / "python.md", "scipy", 2), (BOOK / "mitsuba.md", "mitsuba", 3), (README, "numpy", 1)],
    ids=lambda value: getattr(value, "stem", None),
)
def test_examples_run(pytester: pytest.Pytester, page: Path, needs: str, tests: int) -> None:
    pytest.importorskip(needs, reason=f"skipped: {needs} is not installed")
    pytester.makepyfile(blocks(page))
    pytester.runpytest_subprocess(timeout=300).assert_outcomes(passed=tests)
