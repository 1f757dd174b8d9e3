"""Tests whether the images of two renderers have one expectation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from . import _native
from ._result import Result, asserting


@dataclass(frozen=True)
class _Images:
    """The images of one renderer as the extension takes them."""

    name: str
    images: Any
    error: Any
    exact: bool


def compare_images(
    a: Any,
    b: Any,
    *,
    a_error: Any = None,
    b_error: Any = None,
    exact: bool = False,
    name: str = "images",
    level: float = 0.01,
    detect: float = 0.01,
) -> Result:
    """Tests by Welch's t-tests of the mean, of low-frequency modes and of tiles whether two renderers have one expectation.

    Images are linear RGB, row 0 at the top, whatever `numpy.asarray` takes; they are compared in single precision. A pixel that
    is NaN or infinite rejects, unless it is so in all of several images of a side, as masked ones are; the others are tested.
    It is the test of `etalon compare --against`.

    Args:
        a, b: independent images of the same size of each renderer, shape (n, h, w, 3) with n of at least 2 (of at least 16 for tests
            of tiles); or one image, shape (h, w, 3), whose noise `a_error`, `b_error` or `exact` tells.
        a_error, b_error: standard errors of one image with independent pixels, shape (h, w, 3).
        exact: whether `b` is the expectation itself, without noise.
        name: of the test, in messages and figures.
        level: the probability of calling images of one expectation different.
        detect: the relative bias of the whole image to be found with a probability of 90 %; a test that may miss it is inconclusive.

    Raises:
        ValueError: for arrays of a wrong shape or of different sizes, for one image without a word of its noise, for images that are
            equal to the last bit, and for arguments out of range.
        TypeError: for an array of something else than real numbers.
    """
    of_a, of_b = _Images("a", a, a_error, False), _Images("b", b, b_error, exact)
    return Result(_native.compare_images(name, of_a, of_b, float(level), float(detect)))


assert_images = asserting(compare_images, "assert_images")
