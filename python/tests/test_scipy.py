"""Samplers of SciPy."""

from __future__ import annotations

import numpy as np
import pytest

import etalon_bench as eb

stats = pytest.importorskip("scipy.stats", reason="skipped: SciPy is not installed")


@pytest.mark.parametrize("kappa", [0.5, 20, 2000])
def test_von_mises_fisher(kappa):
    mean = np.array([0.6, 0.0, 0.8])
    lobe = stats.vonmises_fisher(mean, kappa)

    def sample(n, seed):
        return lobe.rvs(n, random_state=seed)

    assert eb.check_sampler(sample, lobe.pdf, "sphere", dimension=0)
    # A lobe that is 10 % too wide
    wide = stats.vonmises_fisher(mean, kappa / 1.1)
    assert eb.check_sampler(sample, wide.pdf, "sphere", dimension=0).verdict == "reject"


def test_beta():
    beta = stats.beta(2.5, 4)
    assert eb.check_sampler(beta.ppf, beta.pdf, "line")
    assert eb.check_sampler(beta.ppf, beta.pdf, "line", invert=lambda x: beta.cdf(x)[:, None])
    assert eb.check_sampler(beta.ppf, stats.beta(2.5, 4.1).pdf, "line").verdict == "reject"
    # The default generator of SciPy, as a sampler with random numbers of its own
    assert eb.check_sampler(lambda n, seed: beta.rvs(n, random_state=seed), beta.pdf, "line", dimension=0)
