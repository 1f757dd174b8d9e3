"""Tests of whole BSDFs, phase functions and lights, and furnace tests."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from . import _native
from ._plan import function, plan
from ._result import Result, asserting
from ._samplers import ranges


class BsdfSamples(NamedTuple):
    """What `sample` of a `Bsdf` returns.

    Attributes:
        wi: directions to the light, shape (n, 3).
        weight: f |cos| / pdf, shape (n,) or (n, channels); of a delta lobe, what it does to radiance over its probability.
        pdf: per sr, shape (n,), as `Bsdf.pdf` returns it, to the last bit; of a delta lobe, its probability.
        delta: bool, shape (n,): True where `wi` is the direction of a delta lobe.
        valid: bool, shape (n,): False where no light is scattered. Other values of such a row do not count, NaN included.
        point: of a light, the sampled points, shape (n, 3).
    """

    wi: Any
    weight: Any
    pdf: Any = None
    delta: Any = None
    valid: Any = None
    point: Any = None


@dataclass(frozen=True)
class Bsdf:
    """A BSDF under test: its functions, and what it declares of itself.

    Directions are unit vectors, shape (n, 3), in the local frame with the normal at +z, and point away from the surface.

    Attributes:
        sample: maps wo and uniform random numbers, shape (n, dimension), to `BsdfSamples`.
        eval: f(wo, wi) without the cosine, in 1/sr, shape (n,) or (n, channels), of all lobes but delta lobes. A stochastic one gets
            random numbers, shape (n, stochastic), as a third argument and returns values whose mean is f.
        pdf: pdf(wo, wi) of the samples per sr, shape (n,), delta lobes left out; None if there is none.
        lobes: the delta lobes for wo: directions, shape (n, k, 3), probabilities, shape (n, k), and the factors of radiance, shape
            (n, k) or (n, k, channels). A lobe of probability 0 is none.
        channels: 1 or 3.
        scatters: to which sides.
        eta: the index of refraction below the surface over that above it.
        reciprocal: whether f(wi, wo) = f(wo, wi), with the factor eta² of refracted radiance.
        energy: "at-most-1", "any", or "conserved:E": all light is scattered, within E.
        approximate_pdf: whether samples follow `pdf` only about.
        dimension: random numbers of a sample, 1 to 64.
        map: the two of them, counted from 0, that a lobe maps to directions one to one; the first of the others chooses the lobe.
        stochastic: random numbers of `eval`.
        precision: of the arithmetic: exact checks allow for its rounding.
    """

    sample: Callable[..., Any]
    eval: Callable[..., Any]
    pdf: Callable[..., Any] | None = None
    lobes: Callable[..., Any] | None = None
    channels: Literal[1, 3] = 1
    scatters: Literal["reflection", "transmission", "both"] = "reflection"
    eta: float = 1.0
    reciprocal: bool = True
    energy: str = "at-most-1"
    approximate_pdf: bool = False
    dimension: int = 3
    map: tuple[int, int] | None = None
    stochastic: int = 0
    precision: Literal["single", "double"] = "double"

    hit = None

    def __post_init__(self) -> None:
        for name in ("sample", "eval", "pdf", "lobes"):
            if name in ("sample", "eval") or getattr(self, name) is not None:
                function(getattr(self, name), name)

    @property
    def properties(self) -> list[tuple[str, str]]:
        """What it declares, by the keys of the protocol for external programs."""
        kind = "none" if self.pdf is None else "approximate" if self.approximate_pdf else "exact"
        # The map refers to the dimension, which comes first
        declared = {
            "kind": "bsdf",
            "channels": self.channels,
            "scatters": self.scatters,
            "delta": "no" if self.lobes is None else "yes",
            "eta": float(self.eta),
            "reciprocal": "yes" if self.reciprocal else "no",
            "energy": self.energy,
            "pdf": kind,
            "dimension": self.dimension,
            "stochastic": self.stochastic,
            "precision": self.precision,
        } | ({} if self.map is None else {"map": f"{self.map[0]},{self.map[1]}"})
        return [(key, str(value)) for key, value in declared.items()]


@dataclass(frozen=True)
class _Bsdfs:
    """BSDFs over their parameters as the extension takes them."""

    name: str
    make: Callable[..., Bsdf | Phase | Light]
    parameters: list[tuple[str, float, float, float]]


def check_bsdf(
    bsdf: Bsdf,
    *,
    like: str | None = None,
    set: Mapping[str, float] | None = None,
    name: str = "bsdf",
    level: float = 0.01,
    detect: float = 0.02,
    samples: int | None = None,
    seed: int = 1,
) -> Result:
    """Tests a whole BSDF, values, weights, pdf, delta lobes and energy, each against the others, for six directions wo.

    The checks are those of `etalon validate --exec` for BSDFs, with the same result for the same functions and seed. Each is one of
    the result's `checks`.

    Args:
        bsdf: the functions.
        like: a BSDF of the program, by its name in `etalon furnace --list`, whose values and delta lobes it must have; what differs is
            told in words, with the known variant that it is.
        set: parameters of `like`; `alpha` means both widths. Without eta and k a metal has Schlick's reflectance, which is fitted.
        name: of the test, in messages and figures.
        level: the probability that any check rejects a BSDF that is right.
        detect: the relative error to be detected with a probability of 90 %.
        samples: the number of samples of each statistical check, in place of what `detect` asks for.
        seed: of all random numbers.

    Raises:
        ValueError: for an argument out of range, and for an array of a wrong shape or with NaN from a function.
        TypeError: for an array of something else than real numbers.
        Exception: whatever a function raises, unchanged.
    """
    wanted(bsdf, "bsdf", Bsdf)
    if like is None and set:
        raise ValueError("set: parameters of a model, and no model is given by like")
    model = None if like is None else (like, [(key, float(value)) for key, value in (set or {}).items()])
    return _tested(bsdf, name, plan(level, detect, samples, seed), model)


assert_bsdf = asserting(check_bsdf, "assert_bsdf")


def _tested(subject: Any, name: str, how: Any, model: Any = None) -> Result:
    """All checks of a BSDF, a phase function or a light."""
    return Result(_native.check_bsdf(_Bsdfs(name, lambda: subject, []), how, model))


def wanted(value: object, name: str, kind: type) -> None:
    if not isinstance(value, kind):
        raise TypeError(f"{name}: wanted a {kind.__name__}, not {type(value).__name__}")


@dataclass(frozen=True)
class Phase:
    """A phase function under test. Directions are unit vectors, shape (n, 3); wi points away from the place of scattering.

    Attributes:
        sample: maps wo and uniform random numbers, shape (n, dimension), to `BsdfSamples`, whose weights are value / pdf.
        eval: the value for wo and wi in 1/sr, shape (n,) or (n, channels), which integrates to 1 over all wi.
        pdf: of the samples per sr; None: the value.
        wo: "away" if wo points away from the place, too, so that -wo is forward (pbrt, Mitsuba); "along": it is the direction of the light.
        mean_cosine: of the angle between light before and after; None: not tested.
        reciprocal: whether its value is the same for light that goes the other way.
        energy: "conserved:E": the value integrates to 1, within E; "at-most-1", "any".
        channels: 1 or 3.
        dimension: random numbers of a sample, 1 to 64.
        precision: of the arithmetic: exact checks allow for its rounding.
    """

    sample: Callable[..., Any]
    eval: Callable[..., Any]
    pdf: Callable[..., Any] | None = None
    wo: Literal["away", "along"] = "away"
    mean_cosine: float | None = None
    reciprocal: bool = True
    energy: str = "conserved:0"
    channels: Literal[1, 3] = 1
    dimension: int = 2
    precision: Literal["single", "double"] = "double"

    hit = lobes = None

    def __post_init__(self) -> None:
        if self.pdf is None:
            object.__setattr__(self, "pdf", self.eval)
        for name in ("sample", "eval", "pdf"):
            function(getattr(self, name), name)

    @property
    def properties(self) -> list[tuple[str, str]]:
        """What it declares, by the keys of the protocol for external programs."""
        declared = {
            "kind": "phase",
            "channels": self.channels,
            "wo": self.wo,
            "reciprocal": "yes" if self.reciprocal else "no",
            "energy": self.energy,
            "dimension": self.dimension,
            "precision": self.precision,
        } | ({} if self.mean_cosine is None else {"mean_cosine": float(self.mean_cosine)})
        return [(key, str(value)) for key, value in declared.items()]


@dataclass(frozen=True)
class Light:
    """A light under test, as a renderer samples it from reference points, shape (n, 3).

    Attributes:
        sample: maps points and uniform random numbers, shape (n, dimension), to `BsdfSamples`: unit directions to the light, radiance / pdf,
            the pdf per sr, and the sampled points, if they are known. Those of a light without `radiance`, a point or a direction, have
            as weight its radiant intensity over r², or its irradiance.
        radiance: from directions wi to points, shape (n,) or (n, channels).
        pdf: pdf(point, wi) of the samples per sr, shape (n,).
        hit: where rays meet the light: distances, shape (n,), inf where they do not, unit normals, shape (n, 3), and the pdf per area, shape
            (n,), or None.
        one_sided: whether it emits to the side alone to which its normals point.
        reference_points: by default, six points near and far on all sides.
        channels: 1 or 3.
        dimension: random numbers of a sample, 1 to 64.
        precision: of the arithmetic: exact checks allow for its rounding.
    """

    sample: Callable[..., Any]
    radiance: Callable[..., Any] | None = None
    pdf: Callable[..., Any] | None = None
    hit: Callable[..., Any] | None = None
    one_sided: bool = False
    reference_points: Sequence[tuple[float, float, float]] = ()
    channels: Literal[1, 3] = 1
    dimension: int = 2
    precision: Literal["single", "double"] = "double"

    def __post_init__(self) -> None:
        given = [name for name in ("radiance", "pdf") if getattr(self, name) is not None]
        if len(given) == 1:
            raise TypeError(f"Light: {given[0]} without {'pdf' if given[0] == 'radiance' else 'radiance'}")
        for name in ("sample", *given, *(["hit"] if self.hit else [])):
            function(getattr(self, name), name)

    def eval(self, point: Any, wi: Any) -> Any:
        """The radiance; 0 of a light that no ray meets."""
        if self.radiance is not None:
            return self.radiance(point, wi)
        return [[0.0] * self.channels] * len(point) if self.channels > 1 else [0.0] * len(point)

    @property
    def lobes(self) -> Callable[..., Any] | None:
        """The direction of a light that no ray meets."""
        return None if self.radiance is not None else self._direction

    def _direction(self, point: Any) -> Any:
        import numpy as np

        found = self.sample(point, np.full((len(point), self.dimension), 0.5))
        pdf = np.ones(len(point)) if found.pdf is None else np.asarray(found.pdf, float)
        sampled = np.where(True if found.valid is None else found.valid, pdf, 0.0)
        weight = np.asarray(found.weight, float)
        throughput = (weight.T * pdf).T
        return np.asarray(found.wi)[:, None], sampled[:, None], throughput[:, None]

    @property
    def properties(self) -> list[tuple[str, str]]:
        """What it declares, by the keys of the protocol for external programs."""
        declared = {
            "kind": "light",
            "channels": self.channels,
            "delta": "yes" if self.radiance is None else "no",
            "hits": "no" if self.hit is None else "yes",
            "one_sided": "yes" if self.one_sided else "no",
            "dimension": self.dimension,
            "precision": self.precision,
        }
        points = ",".join(str(float(x)) for point in self.reference_points for x in point)
        return [(key, str(value)) for key, value in (declared | ({"reference_points": points} if points else {})).items()]


def check_phase(
    phase: Phase,
    *,
    name: str = "phase",
    level: float = 0.01,
    detect: float = 0.05,
    samples: int | None = None,
    seed: int = 1,
) -> Result:
    """Tests a phase function, value, pdf, weights and mean cosine, each against the others, for three oblique directions wo.

    Arguments and errors are those of `check_bsdf`.
    """
    wanted(phase, "phase", Phase)
    return _tested(phase, name, plan(level, detect, samples, seed))


def check_light(
    light: Light,
    *,
    name: str = "light",
    level: float = 0.01,
    detect: float = 0.09,
    samples: int | None = None,
    seed: int = 1,
) -> Result:
    """Tests a light, radiance, pdf, weights, points and normals, each against the others, from several reference points.

    Arguments and errors are those of `check_bsdf`.
    """
    wanted(light, "light", Light)
    return _tested(light, name, plan(level, detect, samples, seed))


assert_phase = asserting(check_phase, "assert_phase")
assert_light = asserting(check_light, "assert_light")


@dataclass(frozen=True)
class _Tabulated:
    """What a furnace test tabulates, as the extension takes it."""

    over: list[str]
    set: list[tuple[str, float]]
    size: tuple[int, int]
    error: float
    seed: int


def furnace(
    bsdf: Bsdf | Callable[..., Bsdf] | str,
    *,
    parameters: Mapping[str, tuple[float, float, float]] | None = None,
    over: Sequence[str] = (),
    set: Mapping[str, float] | None = None,
    size: tuple[int, int] = (32, 32),
    error: float | None = None,
    name: str = "bsdf",
    seed: int = 1,
) -> Result:
    """Tabulates the directional albedo over the angle and a parameter, and tests that no light is created.

    Args:
        bsdf: a BSDF; a function that makes one for values of its `parameters`, given by name; or a BSDF of the program (see
            `etalon furnace --list`).
        parameters: the usual value, the lower and the upper end of each parameter of a function.
        over: the parameters that vary together; by default the first.
        set: values of others, in place of their usual ones.
        size: numbers of angles and of values of the parameter, 1 to 4096 of each.
        error: the largest error of an albedo; 0.01 by default, 0.0001 for a BSDF of the program.
        name: of the BSDF, in messages and figures.
        seed: of all random numbers.

    Raises:
        ValueError: for an argument out of range, and for an array of a wrong shape or with NaN from a function.
        TypeError: for an array of something else than real numbers.
        Exception: whatever a function raises, unchanged.
    """
    tabulated = _Tabulated(
        list(over),
        [(key, float(value)) for key, value in (set or {}).items()],
        size,
        error if error is not None else 1e-4 if isinstance(bsdf, str) else 0.01,
        seed,
    )
    if isinstance(bsdf, str):
        if parameters is not None:
            raise ValueError(f'parameters: "{bsdf}" is a BSDF of the program, which has its own')
        return Result(_native.furnace(bsdf, tabulated))
    if isinstance(bsdf, Bsdf):
        one = bsdf
        if parameters:
            raise ValueError("parameters: wanted a function that makes the BSDF for their values")
        return Result(_native.furnace(_Bsdfs(name, lambda: one, []), tabulated))
    function(bsdf, "bsdf")
    return Result(_native.furnace(_Bsdfs(name, bsdf, ranges(parameters)), tabulated))


assert_furnace = asserting(furnace, "assert_furnace")
