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


REAL = [stats.norm(1000, 0.1), stats.cauchy(), stats.t(1.5), stats.truncnorm(-1, 2.5), stats.uniform(2, 3), stats.arcsine()]
POSITIVE = [stats.lognorm(3), stats.pareto(0.5), stats.levy(), stats.gamma(0.2), stats.weibull_min(0.4), stats.truncpareto(1.8, 5.3)]


@pytest.mark.parametrize("distribution, domain", [(d, "real") for d in REAL] + [(d, "half-line") for d in POSITIVE])
def test_distributions_as_they_are(distribution, domain):
    with np.errstate(all="ignore"):
        assert eb.check_sampler(distribution.ppf, distribution.pdf, domain, dimension=1)
        # A pdf that is wrong by 4 % (root mean square)
        wrong = eb.check_sampler(lambda u: distribution.ppf(u**1.04), distribution.pdf, domain, dimension=1)
        assert wrong.verdict == "reject"
