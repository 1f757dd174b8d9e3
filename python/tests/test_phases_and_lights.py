"""Phase functions and lights: right ones, mistakes, and what is named of them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import etalon_bench as eb

G = 0.6


def henyey_greenstein(wo, wi):
    return (1 - G * G) / (4 * np.pi * (1 + G * G + 2 * G * np.sum(wo * wi, axis=1)) ** 1.5)


def scatter(wo, u):
    cos = (1 + G * G - ((1 - G * G) / (1 - G + 2 * G * u[:, 0])) ** 2) / (2 * G)
    sin, phi = np.sqrt(np.maximum(0, 1 - cos * cos)), 2 * np.pi * u[:, 1]
    s = np.cross(wo, [0.36, 0.48, 0.8])
    s /= np.linalg.norm(s, axis=1, keepdims=True)
    sides = np.cos(phi)[:, None] * s + np.sin(phi)[:, None] * np.cross(wo, s)
    wi = sin[:, None] * sides - cos[:, None] * wo
    return eb.BsdfSamples(wi, np.ones(len(wi)), henyey_greenstein(wo, wi))


PHASE = eb.Phase(scatter, henyey_greenstein, mean_cosine=G)


def test_a_phase_function_is_accepted():
    result = eb.check_phase(PHASE)
    assert result, str(result)
    assert {check.name.split("/")[1] for check in result.checks} >= {"formula", "mean-cosine", "energy", "sampling"}


def scatter_around_z(wo, u):
    """The lobe around z in place of wo."""
    wi = scatter(np.tile([0.0, 0.0, 1.0], (len(wo), 1)), u).wi
    return eb.BsdfSamples(wi, np.ones(len(wi)), henyey_greenstein(wo, wi))


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"mean_cosine": -G}, "forward and backward are exchanged, as if wo pointed along the light"),
        ({"eval": lambda wo, wi: henyey_greenstein(-wo, wi)}, "the value at the opposite direction"),
        ({"sample": scatter_around_z}, "sampling"),
    ],
)
def test_mistakes_of_phase_functions_are_named(fault, words):
    # The pdf is the value by default; words are broken into lines
    with pytest.raises(AssertionError, match=words.replace(" ", r"\s+")):
        eb.assert_phase(dataclasses.replace(PHASE, **{"pdf": henyey_greenstein} | fault))


CORNER, SIDES, NORMAL = np.array([-0.5, -0.4, 2.0]), np.array([[1, 0, 0], [0, 0.8, 0.6]]), np.array([0, 0.6, -0.8])


def meet(point, wi):
    """A square of side 1: distances, inf where rays miss it, its normal, and the pdf per area."""
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (CORNER - point) @ NORMAL / (wi @ NORMAL)
        at = (point + distance[:, None] * wi - CORNER) @ SIDES.T
        is_met = (distance > 0) & np.all((at >= 0) & (at <= 1), axis=1)
    return np.where(is_met, distance, np.inf), np.tile(NORMAL, (len(wi), 1)), np.ones(len(wi))


def is_lit(point, wi):
    return np.isfinite(meet(point, wi)[0]) & (wi @ NORMAL < 0)


def radiance(point, wi):
    return np.where(is_lit(point, wi), 3.0, 0.0)


def density(point, wi):
    lit = is_lit(point, wi)
    return np.where(lit, np.where(lit, meet(point, wi)[0], 1) ** 2 / np.maximum(-wi @ NORMAL, 1e-300), 0)


def sample(point, u):
    there = CORNER + u @ SIDES
    to = there - point
    r = np.linalg.norm(to, axis=1)
    wi = to / r[:, None]
    cos = -wi @ NORMAL
    with np.errstate(divide="ignore"):
        pdf = r**2 / cos
    return eb.BsdfSamples(wi, 3 / pdf, pdf, valid=cos > 0, point=there)


LIGHT = eb.Light(sample, radiance, density, meet, one_sided=True)


def test_lights_are_accepted():
    result = eb.check_light(LIGHT)
    assert result, str(result)
    assert {check.name.split("/")[1] for check in result.checks} == {"values", "formula", "geometry", "sampling"}

    def sun(point, u):
        one = np.ones(len(point))
        return eb.BsdfSamples(np.tile([0.6, 0.0, 0.8], (len(point), 1)), one, one, delta=one > 0)

    eb.assert_light(eb.Light(sun))


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"pdf": lambda point, wi: is_lit(point, wi) * 1.0}, "per area"),
        ({"radiance": lambda point, wi: 3.0 * np.isfinite(meet(point, wi)[0])}, "where nothing is sampled"),
        ({"hit": lambda point, wi: (meet(point, wi)[0], -meet(point, wi)[1])}, "the normal is flipped"),
        ({"sample": lambda point, u: sample(point, u)._replace(point=sample(point, u[:, ::-1]).point)}, "aside of the ray"),
    ],
)
def test_mistakes_of_lights_are_named(fault, words):
    with pytest.raises(AssertionError, match=words):
        eb.assert_light(dataclasses.replace(LIGHT, **fault))
