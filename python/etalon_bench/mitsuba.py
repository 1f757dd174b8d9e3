"""Mitsuba 3's plugins, warps and distributions as the tests of this package take them.

>>> import mitsuba as mi, etalon_bench as eb
>>> mi.set_variant("scalar_rgb")
>>> from etalon_bench import mitsuba
>>> bool(eb.check_bsdf(mitsuba.bsdf({"type": "roughdielectric", "alpha": 0.3}), detect=0.1))
True
>>> bool(eb.check_sampler(**mitsuba.phase({"type": "hg", "g": 0.5}, wi=(0.6, 0, 0.8))))
True

`bsdf` makes a `Bsdf`; the others make the arguments of `check_sampler`. All work in scalar and in vectorized variants, in single and
in double precision; the variant is that which is set when they are called. A plugin is an object of Mitsuba, or a dictionary as
`mi.load_dict` takes it.

Random numbers are rounded down, as those next to 1 must not become 1 in single precision. They are at least 2⁻²³: some of Mitsuba's
samplers return NaN for 0. `zero=True` tests that, too.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._bsdfs import Bsdf, BsdfSamples
from ._samplers import Samples

mi: Any = importlib.import_module("mitsuba")
dr: Any = importlib.import_module("drjit")

Array = NDArray[Any]
Sampler = dict[str, Any]

# A sample's pdf may differ by so much from what `pdf` returns for its rounded direction
ROUNDING = 1e-2
# In nanometres, where a spectral variant is tested
WAVELENGTHS = (450.0, 550.0, 650.0, 550.0)


def bsdf(plugin: Any, *, zero: bool = False, **declared: Any) -> Bsdf:
    """A BSDF. Sides, delta lobes, eta, channels and precision are those of the plugin.

    Mitsuba's `wi` is the direction to the camera, `wo` of this package; its values include the cosine, and a weight of 0 says that
    sampling failed. Values are those of radiance; polarized ones are reduced to what unpolarized light sees.

    Args:
        plugin: the plugin, or its dictionary.
        zero: whether random numbers may be 0.
        declared: what else `Bsdf` declares, such as `map`, `energy`, `reciprocal`; it replaces what the plugin says.
    """
    plugin = _loaded(plugin)
    flags, context = mi.BSDFFlags, mi.BSDFContext()
    sides = [mi.has_flag(plugin.flags(), side) for side in (flags.Reflection, flags.Transmission)]

    def surface(wo: Any) -> Any:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi, si.uv, si.n = wo, mi.Point2f(0.5, 0.5), mi.Normal3f(0, 0, 1)
        si.dp_du, si.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
        si.sh_frame = mi.Frame3f(si.dp_du, si.dp_dv, si.n)
        return _coloured(si)

    def evaluate(wo: Array, wi: Array) -> Array:
        value = _rows(lambda o, i: [mi.unpolarized_spectrum(plugin.eval(context, surface(o), i))], wo, wi)[0]
        cos = np.abs(wi[:, 2:])
        return _channels(np.divide(value, cos, out=np.zeros_like(value), where=cos > 0))

    def pdf(wo: Array, wi: Array) -> Array:
        return _rows(lambda o, i: [plugin.pdf(context, surface(o), i)], wo, wi)[0]

    def drawn(wo: Array, u: Array) -> list[Array]:
        def one(o: Any, lobe: Any, u: Any) -> list[Any]:
            bs, weight = plugin.sample(context, surface(o), lobe, mi.Point2f(u))
            asked = plugin.pdf(context, surface(o), bs.wo)
            # A plugin in Python need not set eta
            eta = bs.eta if dr.width(bs.eta) else 1.0
            return [bs.wo, mi.unpolarized_spectrum(weight), bs.pdf, asked, bs.sampled_type, eta]

        return _rows(one, wo, u[:, 0], u[:, 1:])

    def sample(wo: Array, u: Array) -> BsdfSamples:
        wi, weight, carried, asked, kind, _ = drawn(wo, _inside(u, zero))
        delta = kind.astype(int) & int(flags.Delta) != 0
        return BsdfSamples(wi, _channels(weight), np.where(delta, carried, _agreed(carried, asked)), delta, (weight != 0).any(axis=1))

    def lobes(wo: Array) -> tuple[Array, Array, Array]:
        """Found by numbers that choose the lobe."""
        tries = 1024
        u = np.full((tries, 3), 0.5)
        u[:, 0] = (np.arange(tries) + 0.5) / tries
        found = []
        for w in wo:
            wi, weight, probability, delta, valid = sample(np.tile(w, (tries, 1)), u)[:5]
            first = np.unique(wi[delta & valid], axis=0, return_index=True)[1]
            found.append([column[delta & valid][first] for column in (wi, probability, weight)])
        most = max(1, *(len(directions) for directions, _, _ in found))
        wi, probability, weight = (
            np.stack([np.pad(lobe[i], [(0, most - len(lobe[i]))] + [(0, 0)] * (lobe[i].ndim - 1)) for lobe in found]) for i in range(3)
        )
        factor = weight * (probability if weight.ndim == 2 else probability[..., None])
        return wi, probability, factor

    def eta() -> float:
        """As samples from above that are transmitted say."""
        u = np.random.default_rng(1).random((1024, 3))
        wi, weight, *_, etas = drawn(np.tile([0.48, 0.36, 0.8], (1024, 1)), _inside(u, False))
        below = (wi[:, 2] < 0) & (weight > 0).any(axis=1)
        return float(etas[below][0]) if below.any() else 1.0

    own = {
        "lobes": lobes if mi.has_flag(plugin.flags(), flags.Delta) else None,
        "channels": 1 if mi.is_monochromatic else 3,
        "scatters": {(True, True): "both", (False, True): "transmission"}.get((sides[0], sides[1]), "reflection"),
        "eta": eta() if sides[1] else 1.0,
        "precision": "single" if _is_single() else "double",
    }
    return Bsdf(sample, evaluate, pdf, **{**own, **declared})


def phase(plugin: Any, wi: Sequence[float], *, zero: bool = False) -> Sampler:
    """Directions of a phase function, for light that comes from `wi`, as Mitsuba's integrators have it: away from the point."""
    plugin, context = _loaded(plugin), mi.PhaseFunctionContext()
    at = dr.zeros(mi.MediumInteraction3f)
    at.wi = mi.Vector3f(_unit(wi))
    at.sh_frame = mi.Frame3f(at.wi)
    at = _coloured(at)

    def sample(u: Any) -> tuple[Any, Any]:
        wo, _, pdf = plugin.sample(context, at, u.x, mi.Point2f(u.y, u.z))
        return wo, pdf

    return sampler(sample, lambda wo: plugin.eval_pdf(context, at, wo)[1], "sphere", dimension=3, zero=zero)


def microfacets(distribution: Any, wi: Sequence[float], *, zero: bool = False) -> Sampler:
    """Normals of an `mi.MicrofacetDistribution` seen from `wi`."""
    seen = mi.Vector3f(_unit(wi))
    return sampler(lambda u: distribution.sample(seen, u), lambda m: distribution.pdf(seen, m), "hemisphere", zero=zero)


def emitter(light: Any, at: Sequence[float] = (0, 0, 0), *, zero: bool = False) -> Sampler:
    """Directions from a point to an emitter, which is a plugin, its dictionary, or that of a shape with one.

    The pdf of a direction is that of the first point that its ray meets: shapes are to be convex.
    """
    if isinstance(light, Mapping):
        light = mi.load_dict({"type": "scene", "light": dict(light)})
    scene = light if isinstance(light, mi.Scene) else mi.load_dict({"type": "scene", "light": light})
    source, middle = scene.emitters()[0], scene.bbox().center()

    def reference() -> Any:
        it = dr.zeros(mi.SurfaceInteraction3f)
        it.p = mi.Point3f(*at)
        return _coloured(it)

    def sample(u: Any) -> tuple[Any, Any, Any]:
        ds, weight = source.sample_direction(reference(), u)
        return ds.d, ds.pdf, mi.unpolarized_spectrum(weight)

    def pdf(w: Any) -> Any:
        it = reference()
        # A sample on the outline must not miss by rounding
        inwards = dr.normalize(w + 1e-5 * dr.normalize(middle - it.p)) if scene.shapes() else w
        hit = scene.ray_intersect(mi.Ray3f(it.p, inwards, it.time, it.wavelengths))
        towards = mi.DirectionSample3f(scene, hit, it)
        towards.d = w
        return dr.select(hit.is_valid() | source.is_environment(), source.pdf_direction(it, towards), 0)

    return sampler(sample, pdf, "sphere", zero=zero)


def texture(plugin: Any, *, zero: bool = False) -> Sampler:
    """Positions of a texture, sampled in proportion to its values."""
    plugin = _loaded(plugin)
    return sampler(plugin.sample_position, plugin.pdf_position, "square", zero=zero)


def warp(name: str, *arguments: Any, domain: str = "sphere", dimension: int = 2, zero: bool = False) -> Sampler:
    """A function of `mi.warp`, such as `square_to_cosine_hemisphere`, and its pdf; both get the same further arguments."""
    function, density = getattr(mi.warp, name), getattr(mi.warp, f"{name}_pdf")
    return sampler(lambda u: function(u, *arguments), lambda x: density(x, *arguments), domain, dimension=dimension, zero=zero)


def sampler(
    sample: Callable[[Any], Any],
    pdf: Callable[[Any], Any],
    domain: str,
    *,
    dimension: int = 2,
    mass: float | str | None = None,
    zero: bool = False,
) -> Sampler:
    """The arguments of `check_sampler` for functions of Mitsuba's numbers and points.

    Args:
        sample: maps `mi.Float`, `mi.Point2f` or `mi.Vector3f` to a point, or to a point, the pdf that comes with it and, where
            sampling may fail, a weight that is 0 then. A pdf of 0 says that, too.
        pdf: the pdf at a point.
        domain: that of `check_sampler`.
        dimension: random numbers of a sample, 1 to 3.
        mass: what the pdf integrates to: 1, or at most 1 if a weight comes with a sample.
        zero: whether random numbers may be 0.
    """

    def ask(x: Array) -> Array:
        return _rows(lambda x: [pdf(x)], x)[0]

    def one(u: Any) -> Sequence[Any]:
        drawn = sample(u)
        return drawn if isinstance(drawn, tuple) else (drawn,)

    def draw(u: Array) -> Array | Samples:
        x, *rest = _rows(one, _inside(u, zero))
        if not rest:
            return x
        valid = (rest[-1].reshape(len(x), -1) != 0).any(axis=1) & (rest[0] != 0)
        return Samples(x, _agreed(rest[0], ask(x)), valid)

    may_fail = mass is None and len(_rows(one, np.full((1, dimension), 0.4))) == 3
    mass = ("at-most-1" if may_fail else 1.0) if mass is None else mass
    return {"sample": draw, "pdf": ask, "domain": domain, "dimension": dimension, "mass": mass}


def _loaded(plugin: Any) -> Any:
    return mi.load_dict(dict(plugin)) if isinstance(plugin, Mapping) else plugin


def _unit(w: Sequence[float]) -> list[float]:
    length = math.hypot(*w)
    return [x / length for x in w]


def _is_single() -> bool:
    return bool(dr.type_v(mi.Vector3f) == dr.VarType.Float32)


def _coloured(interaction: Any) -> Any:
    if mi.is_spectral:
        interaction.wavelengths = mi.Spectrum(*WAVELENGTHS)
    return interaction


def _channels(values: Array) -> Array:
    """One channel, or three: red, green and blue or the first three wavelengths."""
    return values[:, 0] if values.shape[1] == 1 else values[:, :3]


def _inside(u: Array, zero: bool) -> Array:
    return np.asarray(np.clip(u, 0 if zero else 2**-23, 1 - 2**-24))


def _agreed(carried: Array, asked: Array) -> Array:
    """The pdf that comes with a sample; where it differs by rounding from the one that `pdf` returns, the latter."""
    return np.asarray(np.where(np.abs(carried - asked) <= ROUNDING * np.abs(asked), asked, carried))


def _rows(function: Callable[..., Sequence[Any]], *arguments: Array) -> list[Array]:
    """What a function of Mitsuba's numbers and points returns, with a row for each row of the arguments."""
    count = len(arguments[0])
    arrays = [a.reshape(count, -1) for a in arguments]
    kinds = [(mi.Float, mi.Point2f, mi.Vector3f)[a.shape[1] - 1] for a in arrays]
    if not dr.is_jit_v(mi.Vector3f):
        rows = zip(*([kind(*row) for row in a.tolist()] for kind, a in zip(kinds, arrays, strict=True)), strict=True)
        return [np.array(column, float) for column in zip(*(function(*row) for row in rows), strict=True)]
    dtype = np.float32 if _is_single() else np.float64
    results = function(*(kind(*a.T.astype(dtype)) for kind, a in zip(kinds, arrays, strict=True)))
    dr.eval(results)
    columns = [np.asarray(result, float).T for result in results]
    # What is equal for all rows may be one number
    return [np.array(np.broadcast_to(column, (count, *column.shape[1:]))) for column in columns]
