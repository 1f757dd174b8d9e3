"""NaN and infinities at every function of the package: an error, a rejection, or what the documentation says."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from test_bsdfs import DIFFUSE, diffuse_eval, diffuse_pdf, diffuse_sample

import etalon_bench as eb

VALUES = [np.nan, np.inf, -np.inf]


def some(x, right, value):
    """`right`, but `value` at one in a hundred places."""
    return np.where((x > 0.4) & (x < 0.41), value, right)


def sampler_of(value):
    return eb.check_sampler(lambda u: some(u, u, value), lambda x: np.ones(len(x)), "line", dimension=1)


def pdf_of(value):
    return eb.check_sampler(lambda u: u, lambda x: some(x, np.ones(len(x)), value), "line", dimension=1)


def carried_pdf_of(value):
    sample = lambda u: eb.Samples(u[:, 0], pdf=some(u[:, 0], np.ones(len(u)), value))  # noqa: E731
    return eb.check_sampler(sample, lambda x: np.ones(len(x)), "line", dimension=1)


def eval_of(value):
    return eb.check_bsdf(dataclasses.replace(DIFFUSE, eval=lambda wo, wi: some(wi[:, 0], diffuse_eval(wo, wi), value)))


def pdf_of_bsdf(value):
    return eb.check_bsdf(dataclasses.replace(DIFFUSE, pdf=lambda wo, wi: some(wi[:, 0], diffuse_pdf(wo, wi), value)))


def with_weights(value):
    def sample(wo, u):
        right = diffuse_sample(wo, u)
        return eb.BsdfSamples(right.wi, some(u[:, 1], right.weight, value), right.pdf, valid=right.valid)

    return dataclasses.replace(DIFFUSE, sample=sample)


def weights_of(value):
    return eb.check_bsdf(with_weights(value))


def furnace_of(value):
    return eb.furnace(with_weights(value), size=(4, 1))


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("of", [sampler_of, pdf_of, carried_pdf_of, eval_of, pdf_of_bsdf, weights_of, furnace_of])
def test_of_what_is_tested_they_are_findings(of, value):
    result = of(value)
    assert result.verdict == "reject" and not result, str(result)


@pytest.mark.parametrize("value", VALUES)
def test_of_images_they_reject_unless_all_of_a_side_have_them(value):
    a, b = np.random.default_rng(1).gamma(2, 1, (2, 8, 16, 16, 3))
    some_bad = a.copy()
    some_bad[2, 3, 4] = value
    result = eb.compare_images(some_bad, b, detect=0.5)
    assert result.verdict == "reject" and "column 4, row 3" in str(result), str(result)
    masked = a.copy()
    masked[:, 3, 4] = value
    result = eb.compare_images(masked, b, detect=0.5)
    assert result.verdict == "accept" and "1 pixel" in str(result), str(result)
    with pytest.raises(ValueError, match="finite"):
        eb.compare_images(np.full_like(a, value), b)


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("name", ["level", "detect"])
def test_of_the_plan_they_are_errors(name, value):
    for check in [
        lambda **plan: eb.check_sampler(lambda u: u, lambda x: np.ones(len(x)), "line", dimension=1, **plan),
        lambda **plan: eb.check_bsdf(DIFFUSE, **plan),
        lambda **plan: eb.compare_images(np.ones((2, 4, 4, 3)), np.ones((2, 4, 4, 3)), **plan),
    ]:
        with pytest.raises(ValueError, match=name):
            check(**{name: value})
    with pytest.raises(ValueError, match="error"):
        eb.furnace(DIFFUSE, error=value)
