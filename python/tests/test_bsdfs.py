"""Whole BSDFs: right ones, planted faults, the same findings as by the program."""

from __future__ import annotations

import dataclasses
import re
import sys

import numpy as np
import pytest

import etalon_bench as eb


def diffuse_sample(wo, u):
    r, phi = np.sqrt(u[:, 1]), 2 * np.pi * u[:, 2]
    wi = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 1])], axis=1)
    return eb.BsdfSamples(wi, np.full(len(wi), 0.5), diffuse_pdf(wo, wi), valid=(wo[:, 2] > 0) & (wi[:, 2] > 0))


def diffuse_eval(wo, wi):
    return np.where((wo[:, 2] > 0) & (wi[:, 2] > 0), 0.5 / np.pi, 0)


def diffuse_pdf(wo, wi):
    return np.where((wo[:, 2] > 0) & (wi[:, 2] > 0), wi[:, 2] / np.pi, 0)


DIFFUSE = eb.Bsdf(diffuse_sample, diffuse_eval, diffuse_pdf, map=(1, 2))


def test_a_diffuse_surface_is_accepted():
    result = eb.check_bsdf(DIFFUSE)
    assert result, str(result)
    names = {check.name.split("/")[1] for check in result.checks}
    assert names >= {"values", "formula", "reciprocity", "jacobian", "energy", "albedo", "sampling"}
    assert all(result.checks) and result.p > 1e-4 and len(result.table["name"]) == len(result.checks)
    assert result._repr_svg_().startswith("<svg") and "accepted" in str(result)


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        ({"eval": lambda wo, wi: 1.1 * diffuse_eval(wo, wi)}, "formula"),
        ({"eval": lambda wo, wi: diffuse_eval(wo, wi) * (1 + wo[:, 2])}, "reciprocity"),
        ({"eval": lambda wo, wi: -diffuse_eval(wo, wi)}, "values"),
        ({"pdf": lambda wo, wi: 1.05 * diffuse_pdf(wo, wi)}, "formula"),
        ({"energy": "conserved:0.001"}, "energy"),
    ],
)
def test_planted_faults_are_rejected(fault, check):
    result = eb.check_bsdf(dataclasses.replace(DIFFUSE, **fault))
    assert result.verdict == "reject" and not result
    rejected = {found.name.split("/")[1] for found in result.checks if found.verdict == "reject"}
    assert check in rejected, rejected
    assert result.places and result.reason
    with pytest.raises(AssertionError, match=check):
        eb.assert_bsdf(dataclasses.replace(DIFFUSE, **fault))


def mirror(reflectance):
    """A mirror of three channels above a surface that absorbs what passes."""

    def reflected(wo):
        return wo * [-1, -1, 1]

    def sample(wo, u):
        n = len(wo)
        weight = np.tile(reflectance, (n, 1))
        return eb.BsdfSamples(reflected(wo), weight, np.ones(n), delta=np.ones(n, bool), valid=wo[:, 2] > 0)

    def lobes(wo):
        up = (wo[:, 2] > 0).astype(float)
        return reflected(wo)[:, None, :], up[:, None], np.tile(reflectance, (len(wo), 1, 1))

    def black(wo, wi):
        return np.zeros((len(wo), 3))

    return eb.Bsdf(sample, black, lambda wo, wi: np.zeros(len(wo)), lobes, channels=3)


def test_delta_lobes():
    assert eb.check_bsdf(mirror([0.9, 0.5, 0.1])), str(eb.check_bsdf(mirror([0.9, 0.5, 0.1])))
    right = mirror([0.9, 0.5, 0.1])
    halved = dataclasses.replace(right, lobes=lambda wo: (lambda w, p, t: (w, p, 0.5 * t))(*right.lobes(wo)))
    assert eb.check_bsdf(halved).verdict == "reject"


def test_stochastic_values():
    def noisy(wo, wi, u):
        return diffuse_eval(wo, wi) * (0.5 + u[:, 0])

    bsdf = dataclasses.replace(DIFFUSE, eval=noisy, stochastic=1)
    assert eb.check_bsdf(bsdf), str(eb.check_bsdf(bsdf))
    biased = dataclasses.replace(bsdf, eval=lambda wo, wi, u: 1.1 * noisy(wo, wi, u))
    assert eb.check_bsdf(biased).verdict == "reject"


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        ({"eval": lambda wo, wi: np.zeros((len(wo), 3))}, ValueError, r"eval: shape \(\d+, 3\); wanted \(\d+,\) or \(\d+, 1\)"),
        ({"pdf": lambda wo, wi: "x"}, TypeError, "pdf: str of dtype"),
        ({"sample": lambda wo, u: wo}, TypeError, "wanted BsdfSamples"),
        ({"sample": lambda wo, u: eb.BsdfSamples(wo, None)}, TypeError, "sample: no weight"),
        ({"sample": lambda wo, u: eb.BsdfSamples(wo.T, wo[:, 0])}, ValueError, r"sample.wi: shape \(3, \d+\)"),
        ({"lobes": lambda wo: (wo, wo, wo)}, ValueError, r"lobes.wi: shape \(1, 3\); wanted \(1, k, 3\)"),
        ({"channels": 2}, ValueError, "channels: 2 has no meaning"),
        ({"map": (0, 3)}, ValueError, "map: wanted two different"),
        ({"eta": -1}, ValueError, "eta: -1.0 has no meaning"),
        ({"energy": "all"}, ValueError, "energy: all has no meaning"),
        ({"dimension": 0}, ValueError, "dimension: 0 has no meaning"),
    ],
)
def test_errors_name_what_is_wrong(change, kind, message):
    with pytest.raises(kind, match=message):
        eb.check_bsdf(dataclasses.replace(DIFFUSE, **change))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"eval": lambda wo, wi: np.where(wi[:, 2] > 0.99, np.nan, diffuse_eval(wo, wi))}, r"f = \[NaN\]"),
        ({"pdf": lambda wo, wi: np.where(wi[:, 2] > 0.99, np.nan, np.maximum(wi[:, 2], 0) / np.pi)}, "pdf = NaN"),
    ],
)
def test_nan_is_a_finding(change, reason):
    result = eb.check_bsdf(dataclasses.replace(DIFFUSE, **change))
    assert result.verdict == "reject" and any(re.search(reason, str(check)) for check in result.checks), str(result)


def test_exceptions_at_some_directions_are_a_finding():
    def eval(wo, wi):
        if ((wi[:, 2] > 0.7) & (wi[:, 2] < 0.71)).any():
            raise ZeroDivisionError("at 45 degrees")
        return diffuse_eval(wo, wi)

    result = eb.check_bsdf(dataclasses.replace(DIFFUSE, eval=eval))
    assert result.verdict == "reject" and re.match(r"eval raises ZeroDivisionError: at 45 degrees, for wo = \[.*, wi = \[.*, 0\.70\d*\]", result.reason), result.reason


def test_functions_are_wanted():
    with pytest.raises(TypeError, match="eval: wanted a function, not NoneType"):
        eb.Bsdf(diffuse_sample, None)
    with pytest.raises(TypeError, match="bsdf: wanted a Bsdf, not str"):
        eb.check_bsdf("ggx")


def client(examples, name, *arguments):
    """The functions of an example, without its loop over requests."""
    source = (examples / name).read_text().split("\nfor request in sys.stdin")[0]
    functions: dict = {}
    argv, sys.argv = sys.argv, [name, *arguments]
    try:
        exec(source, functions)
    finally:
        sys.argv = argv
    return functions


@pytest.mark.parametrize("arguments", [[], ["wrong"]])
def test_the_result_is_that_of_the_program(validate_exec, examples, arguments):
    found = validate_exec([sys.executable, str(examples / "bsdf_numpy.py"), *arguments], "--seed", "3", "--detect", "0.1")
    own = client(examples, "bsdf_numpy.py", *arguments)

    def lines(*columns):
        """As the example has them: where numbers lie in memory decides how NumPy rounds."""
        joined = np.hstack(columns)
        return joined[:, :3], joined[:, 3:]

    def sample(wo, u):
        wo, u = lines(wo, u)
        wi, weight = own["sample"](wo, u)
        pdf = own["evaluate"](wo, wi)[1]
        return eb.BsdfSamples(wi, weight, pdf, valid=pdf > 0)

    def evaluate(wo, wi):
        return own["evaluate"](*lines(wo, wi))

    bsdf = eb.Bsdf(sample, lambda wo, wi: evaluate(wo, wi)[0], lambda wo, wi: evaluate(wo, wi)[1], map=(1, 2))
    with np.errstate(all="ignore"):
        result = eb.check_bsdf(bsdf, name="ggx-numpy", seed=3, detect=0.1)
    assert bool(result) == (not arguments)
    assert [check.name for check in result.checks] == [test["name"] for test in found["tests"]]
    for check, test in zip(result.checks, found["tests"]):
        keys = ["verdict", "p", "detectable"] + (["samples"] if check.p is not None else [])  # exact checks count parameters, too
        assert [getattr(check, key) for key in keys] == [test[key] for key in keys], check.name


def test_furnace_of_functions():
    def make(albedo):
        def sample(wo, u):
            return diffuse_sample(wo, u)._replace(weight=np.full(len(wo), albedo))

        return dataclasses.replace(DIFFUSE, sample=sample, eval=lambda wo, wi: 2 * albedo * diffuse_eval(wo, wi))

    result = eb.furnace(make, parameters={"albedo": (0.5, 0.0, 1.0)}, size=(4, 5))
    table = result.table
    assert result and len(table["albedo"]) == 20
    np.testing.assert_allclose(table["albedo"], table["parameter"], atol=0.01)
    assert result.detectable <= 0.01 and "largest albedo" in str(result) and result._repr_svg_().startswith("<svg")
    # More light than arrives
    bright = eb.furnace(make, parameters={"albedo": (0.5, 0.0, 1.1)}, size=(4, 5))
    assert bright.verdict == "reject" and "1.1" in bright.places[0]
    with pytest.raises(AssertionError, match="VIOLATIONS"):
        eb.assert_furnace(make, parameters={"albedo": (0.5, 0.0, 1.1)}, size=(4, 5))
    np.testing.assert_allclose(eb.furnace(DIFFUSE, size=(4, 1)).table["albedo"], 0.5, atol=0.01)


def test_furnace_of_the_programs_bsdfs():
    result = eb.furnace("ggx", size=(4, 3), set={"eta": 0.2, "k": 3.0})
    assert result.verdict == "accept" and result.name == "ggx"
    for options, message in [
        ({"bsdf": "velvet"}, "bsdf: there is no \"velvet\", but"),
        ({"bsdf": "ggx", "set": {"width": 1.0}}, "no parameter \"width\""),
        ({"bsdf": "ggx", "size": (0, 3)}, "size: 0 x 3 cells"),
        ({"bsdf": "ggx", "error": 2.0}, "error: an error of 2"),
        ({"bsdf": "ggx", "parameters": {}}, "parameters"),
        ({"bsdf": DIFFUSE, "parameters": {"a": (1, 0, 2)}}, "parameters"),
        ({"bsdf": lambda a: DIFFUSE, "parameters": {"a": (3, 0, 2)}}, "parameters: a = 3"),
    ]:
        with pytest.raises(ValueError, match=message):
            eb.furnace(**options)
