"""What a test found."""

from __future__ import annotations

import base64
import csv
import functools
import html
import io
import os
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, ParamSpec

import numpy as np
from numpy.typing import NDArray

from ._native import Found

Verdict = Literal["accept", "reject", "inconclusive"]


LEAST = 1e-300
"""Smaller p-values are not told apart: they are near the smallest number that there is."""


class Result:
    """What a test found. True in a condition if the verdict is "accept".

    In a notebook, a result shows its text and its figure.
    """

    def __init__(self, found: Found) -> None:
        self._found = found

    @property
    def name(self) -> str:
        """The name of the test."""
        return self._found.name

    @property
    def verdict(self) -> Verdict:
        """"accept", "reject" or "inconclusive".

        A test that accepts would have detected an error of the size `detectable` with a probability of 90 %. An inconclusive one
        has too few samples, or an integral too uncertain, to say anything: it is not a pass.
        """
        return self._found.verdict

    @property
    def p(self) -> float | None:
        """Probability of findings at least this bad if what is tested is right; of a run of several tests, of its worst one."""
        return self._found.p

    @property
    def detectable(self) -> float | None:
        """The smallest error that is detected with a probability of 90 %.

        Of a sampler: the relative error of the pdf, root mean square over the cells. Of a BSDF: the largest of all its statistical
        tests. Of images: the relative bias of a whole image. Of a furnace test: the largest error of an albedo.
        """
        return self._found.detectable

    @property
    def statistic(self) -> float | None:
        """Pearson's chi-square, of a sampler."""
        return self._found.statistic

    @property
    def degrees_of_freedom(self) -> int | None:
        """Those of `statistic`."""
        return self._found.dof

    @property
    def integral(self) -> float | None:
        """What the pdf integrates to, atoms included."""
        return self._found.integral

    @property
    def samples(self) -> int:
        """Samples that were taken; of a comparison of images, their number."""
        return self._found.samples

    @property
    def seconds(self) -> float:
        """Wall-clock time of the test."""
        return self._found.seconds

    @property
    def reason(self) -> str | None:
        """Why the test does not accept: the usual mistake that explains it, then what is wrong, how much and where."""
        return self._found.reason

    @property
    def places(self) -> list[str]:
        """Where it fails, in words: "17 % too few within 2.0° of the horizon"."""
        return self._found.places

    @cached_property
    def checks(self) -> list[Result]:
        """The single tests of a BSDF, which share its level."""
        return [Result(check) for check in self._found.checks]

    @cached_property
    def table(self) -> dict[str, NDArray[Any]]:
        """The numbers behind the result: columns by name, as in the program's CSV files.

        Of a sampler, a row for each cell (`x_from`, `x_to`, … in the domain's chart, `observed`, `expected`, `residual`); of a BSDF,
        for each test; of images, for each functional and channel; of a furnace test, for each albedo. Missing numbers are NaN.
        """
        text = self._found.csv()
        if text is None:
            return {}
        header, *rows = csv.reader(io.StringIO(text))
        return {name: _column([row[i] for row in rows]) for i, name in enumerate(header)}

    def __bool__(self) -> bool:
        return self.verdict == "accept"

    def __str__(self) -> str:
        return self._found.text.rstrip()

    def __repr__(self) -> str:
        p = "" if self.p is None else f", p={self.p:.3g}" if self.p >= LEAST else f", p<{LEAST}"
        detectable = "" if self.detectable is None else f", detectable={self.detectable:.3g}"
        reason = "" if self.reason is None else f": {self.reason}"
        return f"<Result {self.name}: {self.verdict}{p}{detectable}{reason}>"

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        style: Literal["screen", "slide", "column"] = "screen",
        theme: Literal["light", "dark"] = "light",
        title: str = "",
        width: float | None = None,
    ) -> list[Path]:
        """Writes the figure as SVG, PNG or PDF, by the extension of `path`, and returns the paths of its pages.

        Styles are those of the program: "slide" is 16:9, of several pages if there must be, "column" is 84 mm wide. `title`
        takes the place of the figure's, and `width` is in millimetres.

        Raises:
            ValueError: for another format, style or theme, and a width into which the figure does not fit.
            OSError: if a file cannot be written.
        """
        return self._found.save(os.fspath(path), style, theme, title, width)

    def _repr_svg_(self) -> str:
        return self._found.svg()

    def _repr_html_(self) -> str:
        return f'<pre style="white-space: pre-wrap">{html.escape(str(self))}</pre>{image(self._repr_svg_())}'

    def check(self) -> Result:
        """Returns the result itself if it accepts.

        Raises:
            AssertionError: with all that the test found, otherwise.
        """
        __tracebackhide__ = True
        if not self:
            raise AssertionError(f"{self.name}: {self.verdict}\n{self}")
        return self


Parameters = ParamSpec("Parameters")


def asserting(check: Callable[Parameters, Result], name: str) -> Callable[Parameters, Result]:
    """The function `name` that does what `check` does and raises AssertionError unless the result accepts."""

    @functools.wraps(check)
    def asserted(*args: Parameters.args, **options: Parameters.kwargs) -> Result:
        __tracebackhide__ = True
        return check(*args, **options).check()

    asserted.__name__ = asserted.__qualname__ = name
    asserted.__doc__ = (
        f"As `{check.__name__}`, for tests: raises AssertionError, with all that was found, unless the result accepts.\n\n"
        f"    {check.__doc__}"
    )
    return asserted


def image(svg: str) -> str:
    """A figure as an element of HTML that shares no names with others of its page."""
    style = "max-width: 100%; background: white"
    return f'<img alt="figure" style="{style}" src="data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}">'


def _column(texts: list[str]) -> NDArray[Any]:
    """Numbers or truth values if all texts are, else the texts."""
    if texts and all(text in ("true", "false") for text in texts):
        return np.array([text == "true" for text in texts])
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts)
