"""Images of two renderers: one expectation, a planted bias, one image with known noise."""

from __future__ import annotations

import numpy as np
import pytest

import etalon_bench as eb


def renders(seed, count, bias=1.0, size=(48, 64)):
    """Noisy images whose expectation is a gradient."""
    mean = bias * np.linspace(0.2, 1.0, size[1])[None, None, :, None]
    noise = np.random.default_rng(seed).gamma(4.0, 0.25, (count, *size, 3))
    return mean * noise


def test_one_expectation():
    result = eb.compare_images(renders(1, 16), renders(2, 16), detect=0.02)
    assert result, str(result)
    assert result.detectable < 0.02 and result.p > 1e-3 and result.samples == 32
    assert result._repr_svg_().startswith("<svg") and set(result.table) >= {"functional", "channel", "p", "adjusted_p"}


def test_a_bias_is_found():
    result = eb.compare_images(renders(1, 16), renders(2, 16, bias=1.05))
    assert result.verdict == "reject" and result.p < 0.01 and result.places
    spot = renders(2, 16)
    spot[:, 16:24, 16:24] *= 1.3
    local = eb.compare_images(renders(1, 16), spot)
    assert local.verdict == "reject" and any("tile" in place for place in local.places), local.places
    with pytest.raises(AssertionError, match="different"):
        eb.assert_images(renders(1, 16), spot)


def test_masked_pixels_do_not_count():
    a = np.ma.masked_array(renders(1, 16), mask=False)
    a[:, :4] = 1000.0
    assert eb.compare_images(a, renders(2, 16)).verdict == "reject"
    a[:, :4] = np.ma.masked
    assert eb.compare_images(a, renders(2, 16), detect=0.03)


def test_a_noisy_image_is_not_exact_and_seeds_that_overlap_are_seen():
    assert "noise" not in str(eb.compare_images(renders(1, 16), renders(2, 4000).mean(axis=0), exact=True))
    noisy = eb.compare_images(renders(1, 16), renders(2, 1)[0], exact=True)
    assert noisy.verdict != "reject", str(noisy)
    overlapping = renders(1, 17)
    overlapping = 0.5 * (overlapping[:16] + overlapping[1:])
    result = eb.compare_images(overlapping, renders(2, 16))
    assert result.verdict == "inconclusive" and "not independent" in result.reason, str(result)


def test_too_few_images_are_inconclusive():
    result = eb.compare_images(renders(1, 2), renders(2, 2), detect=1e-4)
    assert result.verdict == "inconclusive" and "cannot tell" in result.reason


def test_one_image_with_known_noise():
    expectation = np.broadcast_to(np.linspace(0.2, 1.0, 64)[None, :, None], (48, 64, 3))
    one = renders(1, 1)[0]
    error = 0.5 * expectation
    assert eb.compare_images(one, expectation, a_error=error, exact=True, detect=0.05)
    assert eb.compare_images(one, 1.1 * expectation, a_error=error, exact=True, detect=0.05).verdict == "reject"
    assert eb.compare_images(renders(3, 8), expectation, exact=True, detect=0.05)


@pytest.mark.parametrize(
    ("a", "b", "options", "kind", "message"),
    [
        (np.ones((4, 5, 3)), renders(1, 2), {}, ValueError, "a: one image says nothing of its noise"),
        (np.ones((1, 4, 5, 3)), renders(1, 2), {}, ValueError, "a: one image says nothing of its noise"),
        (np.ones((4, 5)), renders(1, 2), {}, ValueError, r"a: shape \(4, 5\); wanted \(h, w, 3\) or \(n, h, w, 3\)"),
        (np.ones((2, 4, 5, 4)), renders(1, 2), {}, ValueError, r"a: shape \(2, 4, 5, 4\)"),
        (np.ones((2, 0, 5, 3)), renders(1, 2), {}, ValueError, r"a: shape \(2, 0, 5, 3\)"),
        (renders(1, 2), renders(2, 2, size=(8, 8)), {}, ValueError, "sizes differ"),
        (renders(1, 2), renders(1, 2), {}, ValueError, "same image to the last bit"),
        (renders(1, 2), renders(2, 2), {"exact": True}, ValueError, "b: standard errors and exact are for one image"),
        (renders(1, 2), renders(2, 2), {"level": 1.5}, ValueError, "level: 1.5"),
        (renders(1, 2), renders(2, 2), {"detect": 0}, ValueError, "detect: 0"),
        (renders(1, 1)[0], renders(2, 2), {"a_error": np.ones((2, 2, 3))}, ValueError, "a: the image and its standard errors"),
        (np.full((2, 4, 4, 3), "x"), renders(2, 2), {}, TypeError, "a: ndarray of dtype <U1"),
    ],
)
def test_errors_name_what_is_wrong(a, b, options, kind, message):
    with pytest.raises(kind, match=message):
        eb.compare_images(a, b, **options)
