"""Tests of samplers against their pdfs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, NamedTuple

from . import _native
from ._plan import function, plan
from ._result import Result, asserting


class Samples(NamedTuple):
    """What `sample` returns where an array of points does not say all.

    Attributes:
        x: the points, shape (n, d).
        pdf: the pdf that the sampler returns with each point, shape (n,): it must be what `pdf` returns, to the last bit.
        valid: bool, shape (n,): False where there is no sample, such as a direction below the horizon. The probability of that is
            1 minus the integral of the pdf. Other values of such a row do not count, NaN included.
        atom: bool, shape (n,): True where the point is one of the `atoms`.
        weight: in place of a pdf, an estimate of 1/pdf, or of target/pdf, shape (n,): of resampling and of reservoirs.
    """

    x: Any
    pdf: Any = None
    valid: Any = None
    atom: Any = None
    weight: Any = None


@dataclass(frozen=True)
class Chart:
    """A domain by the functions of its chart: they map the domain one to one to the unit square, or to another cube of 1 to 6 dimensions.

    All three are tested first: they must invert each other, and the Jacobian must agree with differences of `from_cube`.

    Attributes:
        to_cube: points, shape (n, d) or (n,), to coordinates of the cube, shape (n, dimension), or (n,) of the interval; other
            numbers, or NaN, where a point is not in the domain.
        from_cube: the inverse.
        jacobian: the area (length, volume) of the domain per area of the cube, at coordinates of the cube; shape (n,).
        dimension: of the cube: 2 for the square, 1 for the interval, at most 6.
        names: of the coordinates of the cube, in messages and figures.
    """

    to_cube: Callable[..., Any]
    from_cube: Callable[..., Any]
    jacobian: Callable[..., Any]
    dimension: int = 2
    names: Sequence[str] = ()

    def __post_init__(self) -> None:
        for name in ("to_cube", "from_cube", "jacobian"):
            function(getattr(self, name), name)
        if self.dimension not in range(1, 7):
            raise ValueError(f"dimension: {self.dimension}; wanted 1 to 6")
        names = list(self.names) or [f"u{axis}" for axis in range(self.dimension)]
        if len(names) != self.dimension:
            raise ValueError(f"names: {self.names}; wanted one for each coordinate")
        object.__setattr__(self, "names", names)


@dataclass(frozen=True)
class _Sampler:
    """A sampler as the extension takes it."""

    name: str
    sample: Callable[..., Any]
    pdf: Callable[..., Any] | None
    invert: Callable[..., Any] | None
    dimension: int | None
    mass: float | str
    table: tuple[int, int] | None
    precision: float
    atoms: list[tuple[list[float], float]]
    weighted: bool
    stochastic: bool
    narrow: list[list[float]]
    parameters: list[tuple[str, float, float, float]]
    # The functions sample, pdf and invert for values of the parameters
    at: Callable[..., tuple[Any, Any, Any]]


def ranges(parameters: Mapping[str, Sequence[float]] | None) -> list[tuple[str, float, float, float]]:
    """Names, values, and the ends of their ranges."""
    found = []
    for name, ends in (parameters or {}).items():
        if len(ends) not in (2, 3):
            raise ValueError(f"parameters: {name} = {ends}; wanted (from, to) or (value, from, to)")
        *own, low, high = map(float, ends)
        middle = math.sqrt(low * high) if 0 < 10 * low < high else 0.5 * (low + high)
        value = own[0] if own else middle
        if not (low <= value <= high and math.isfinite(low) and math.isfinite(high)):
            raise ValueError(f"parameters: {name} = {value} is not from {low} to {high}, or these are not finite")
        found.append((name, value, low, high))
    return found


def check_sampler(
    sample: Callable[..., Any],
    pdf: Callable[..., Any] | None,
    domain: str | Chart,
    *,
    target: Callable[..., Any] | None = None,
    parameters: Mapping[str, Sequence[float]] | None = None,
    stochastic: bool = False,
    narrow: Sequence[Sequence[float]] = (),
    dimension: int | None = None,
    mass: float | Literal["at-most-1", "unknown"] = 1.0,
    table: tuple[int, int] | None = None,
    precision: float | Literal["exact", "single"] = "exact",
    atoms: Sequence[tuple[Sequence[float] | float, float]] = (),
    invert: Callable[..., Any] | None = None,
    name: str = "sampler",
    level: float = 0.01,
    detect: float = 0.02,
    samples: int | None = None,
    seed: int = 1,
) -> Result:
    """Tests whether samples follow their pdf: exact checks first, then Pearson's chi-square over cells and finer parts.

    The functions get and return arrays of float64; whatever `numpy.asarray` takes may be returned. They run in the thread that calls
    this function, one at a time, for some thousand samples each time. With equal functions, `seed` and `name`, the result is
    that of `etalon validate --exec`.

    Args:
        sample: maps uniform random numbers from [0, 1), shape (n, dimension), to points, shape (n, d), or to `Samples`. With
            dimension 0, it is called as sample(n, seed) and has random numbers of its own; equal seeds give equal samples.
        pdf: the pdf at points, shape (n, d), in the domain's measure; shape (n,). With None, `sample` returns `Samples` with weights:
            their mean over the samples in a cell must be the size of the cell, or the integral of `target` over it.
        domain: the name of one of `domains()`, such as "sphere" (unit vectors, d = 3, per sr), "hemisphere" (those with z >= 0),
            "square" (d = 2, from 0 to 1), "line" (from 0 to 1), "real" (any number) or "discrete:N" (the integers below N); or a
            `Chart`. Points with one coordinate have the shape (n,).
        target: of samples with weights, a function of points like `pdf`: what their weights estimate, times 1/pdf. 1 by default; 0 where
            the sampler has no samples.
        parameters: of the functions, which get their values by name: (from, to), or (value, from, to) with a default value. The corners
            of the ranges and values inside are tested at the one level; the reason says where it fails.
        stochastic: whether values of `pdf`, and the pdfs in `Samples`, are random with the pdf as their mean.
        narrow: where the pdf is narrow, in coordinates of the domain's chart from 0 to 1: points (x, y) or boxes (x, y, x, y).
        dimension: random numbers of a sample, 0 to 64; by default 2, and 1 where points have one coordinate.
        mass: what the pdf integrates to, atoms included; below 1 where there may be no sample, "at-most-1" if it is not known. With
            "unknown" only the shape of the pdf is tested.
        table: rows and columns of a table in whose cells the pdf is constant, as `etalon validate --pdf` reads it: equal steps of θ
            and φ on sphere and hemisphere, of y and x on the square, of x (and 1 column) on the line. Integrals are then exact.
        precision: the relative difference that the pdfs in `Samples` may have from those of `pdf`: none, to the last bit, that of
            roundings in "single" precision, or a number up to 0.01.
        atoms: points that are sampled with a probability of their own, such as the direction of a mirror, and the probability.
        invert: the inverse of `sample`, to be tested too: points, shape (1, d), to random numbers, shape (1, dimension).
        name: of the test, in messages and figures. The random numbers depend on it.
        level: the probability of rejecting a sampler that is right.
        detect: the relative error of the pdf (root mean square over 200 cells) that is detected with a probability of 90 %: it
            decides on the number of samples.
        samples: the number of samples, in place of what `detect` asks for.
        seed: of all random numbers.

    Raises:
        ValueError: for an argument out of range, and for an array of a wrong shape from a function.
        TypeError: for an array of something else than real numbers.
        Exception: whatever a function raises that works for no input, unchanged. (One that raises for some inputs is rejected.)
    """
    function(sample, "sample")
    if pdf is not None:
        function(pdf, "pdf")
        if target is not None:
            raise ValueError("target: weights have one, and then pdf is None")
    if target is not None:
        function(target, "target")
    density = target if pdf is None else pdf
    if not all(len(place) in (1, 2, 4) and all(0 <= x <= 1 for x in place) for place in narrow):
        raise ValueError(f"narrow: {narrow}; wanted points (x, y) or boxes (x, y, x, y) of numbers from 0 to 1")
    if invert is not None:
        function(invert, "invert")
    if dimension is not None and not 0 <= dimension <= 64:
        raise ValueError(f"dimension: {dimension}; wanted 0 to 64 random numbers")
    if not (mass in ("at-most-1", "unknown") or 0 <= float(mass) <= 1):
        raise ValueError(f'mass: {mass}; wanted a number from 0 to 1, "at-most-1" or "unknown"')
    if table is not None and not all(1 <= side <= 1 << 16 for side in table):
        raise ValueError(f"table: {table}; wanted two numbers from 1 to 65536")
    if not (precision in ("exact", "single") or 0 <= float(precision) <= 0.01):
        raise ValueError(f'precision: {precision}; wanted "exact", "single" or a number from 0 to 0.01')
    relative = {"exact": 0.0, "single": -1.0}[precision] if isinstance(precision, str) else float(precision)
    share = mass if isinstance(mass, str) else float(mass)
    points = [([float(x) for x in (at if isinstance(at, Sequence) else [at])], float(share)) for at, share in atoms]
    known = ranges(parameters)

    def at(*values: float) -> tuple[Any, Any, Any]:
        given = dict(zip((name for name, *_ in known), values))
        sample_at, density_at, invert_at = (f and partial(f, **given) for f in (sample, density, invert))
        return sample_at, density_at, invert_at

    boxes = [[float(x) for x in place] for place in narrow]
    sampler = _Sampler(
        name, sample, density, invert, dimension, share, table, relative, points, pdf is None, stochastic, boxes, known, at
    )
    return Result(_native.check_sampler(sampler, domain, plan(level, detect, samples, seed)))


def domains() -> str:
    """The names of all domains, with their parameters."""
    return _native.domains()


assert_sampler = asserting(check_sampler, "assert_sampler")


def min_discrepancy_of_pdfs_detectable(samples: int, *, level: float = 0.01) -> float:
    """The smallest relative error of a pdf (root mean square over 200 cells) that so many samples detect with a probability of 90 %.

    Raises:
        ValueError: for a number of samples below 1 and a level that is not between 0 and 1.
    """
    return _native.detectable(samples, level)


def min_num_samples_for_sampler_test(discrepancy: float, *, level: float = 0.01) -> int:
    """The number of samples that detect a relative error of a pdf with a probability of 90 %.

    Raises:
        ValueError: for a discrepancy that is not above 0 and at most 1, and a level that is not between 0 and 1.
    """
    return _native.samples_for(discrepancy, level)
