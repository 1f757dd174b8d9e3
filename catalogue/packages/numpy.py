# /// script
# dependencies = ["numpy==2.4.6", "scipy==1.17.1"]
# ///
"""NumPy's Generator: distributions against the densities of scipy.stats."""

import etalon_bench as eb
import numpy as np
from scipy import stats
from scipy.stats import (
    beta, binom, cauchy, chi2, expon, f, gamma, geom, gumbel_r, hypergeom, laplace, logistic, lognorm, logser, nbinom, ncf, ncx2, norm, pareto,
    poisson, powerlaw, rayleigh, t, triang, vonmises, wald, weibull_min, zipf,
)  # fmt: skip

from entry import run, sampler


def entry(name, draw, dist, **options):
    """Samples of `draw` of a generator against a frozen distribution of SciPy."""
    declared = eb.of_scipy(dist)
    first = int(dist.ppf(1e-9)) if hasattr(dist, "pmf") else None

    def sample(n, seed):
        x = draw(np.random.default_rng(seed), n)
        return x if first is None else np.clip(x, first, int(dist.isf(1e-9))) - first

    return sampler(name, **{**declared, "sample": sample}, **options)


ENTRIES = [
    entry("control/normal", lambda g, n: g.normal(size=n), norm(), control="right"),
    entry("control/normal of scale 1.05", lambda g, n: g.normal(0, 1.05, n), norm(), control="wrong"),
    *(entry(f"random {t.__name__}", lambda g, n, t=t: g.random(n, dtype=t), stats.uniform()) for t in (np.float64, np.float32)),
    *(entry(f"standard_normal {t.__name__}", lambda g, n, t=t: g.standard_normal(n, dtype=t), norm()) for t in (np.float64, np.float32)),
    *(entry(f"standard_exponential {m} {t.__name__}", lambda g, n, m=m, t=t: g.standard_exponential(n, dtype=t, method=m), expon())
      for m in ("zig", "inv") for t in (np.float64, np.float32)),
    *(entry(f"standard_gamma({a}) {t.__name__}", lambda g, n, a=a, t=t: g.standard_gamma(a, n, dtype=t), gamma(a))
      for a in (0.2, 1, 30) for t in (np.float64, np.float32)),
    *(entry(f"gamma({a})", lambda g, n, a=a: g.gamma(a, 2, n), gamma(a, scale=2)) for a in (0.05, 0.5, 0.999, 2.5, 1000)),
    *(entry(f"beta{a}", lambda g, n, a=a: g.beta(*a, n), beta(*a)) for a in ((0.5, 0.5), (2, 5), (1, 1), (0.8, 3), (300, 700))),
    *(entry(f"chisquare({k})", lambda g, n, k=k: g.chisquare(k, n), chi2(k)) for k in (0.3, 1, 7)),
    *(entry(f"noncentral_chisquare{a}", lambda g, n, a=a: g.noncentral_chisquare(*a, n), ncx2(*a)) for a in ((0.7, 2), (3, 20), (1, 0.1))),
    *(entry(f"f{a}", lambda g, n, a=a: g.f(*a, n), f(*a)) for a in ((3, 5), (0.8, 2), (50, 80))),
    *(entry(f"noncentral_f{a}", lambda g, n, a=a: g.noncentral_f(*a, n), ncf(*a)) for a in ((3, 20, 3), (1.5, 6, 1))),
    *(entry(f"standard_t({k})", lambda g, n, k=k: g.standard_t(k, n), t(k)) for k in (0.7, 2, 30)),
    *(entry(f"wald{a}", lambda g, n, a=a: g.wald(*a, n), stats.invgauss(a[0] / a[1], scale=a[1])) for a in ((1, 1), (3, 0.5), (0.1, 40), (1e8, 2.25))),
    *(entry(f"weibull({k})", lambda g, n, k=k: g.weibull(k, n), weibull_min(k)) for k in (0.4, 1, 5)),
    *(entry(f"pareto({k})", lambda g, n, k=k: g.pareto(k, n), stats.lomax(k)) for k in (0.5, 3)),
    *(entry(f"power({k})", lambda g, n, k=k: g.power(k, n), powerlaw(k)) for k in (0.3, 4)),
    *(entry(f"triangular{a}", lambda g, n, a=a: g.triangular(*a, n), triang((a[1] - a[0]) / (a[2] - a[0]), a[0], a[2] - a[0]))
      for a in ((-1, 0, 3), (0, 0, 1), (0, 1, 1))),
    *(entry(f"lognormal({s})", lambda g, n, s=s: g.lognormal(0, s, n), lognorm(s)) for s in (0.2, 2)),
    entry("cauchy", lambda g, n: g.standard_cauchy(n), cauchy()),
    entry("gumbel", lambda g, n: g.gumbel(size=n), gumbel_r()),
    entry("laplace", lambda g, n: g.laplace(size=n), laplace()),
    entry("logistic", lambda g, n: g.logistic(size=n), logistic()),
    entry("rayleigh", lambda g, n: g.rayleigh(size=n), rayleigh()),
    *(entry(f"binomial{a}", lambda g, n, a=a: g.binomial(*a, n), binom(*a)) for a in ((10, 0.3), (1000, 0.02), (1000, 0.5), (100000, 0.9))),
    *(entry(f"poisson({m})", lambda g, n, m=m: g.poisson(m, n), poisson(m)) for m in (0.3, 5, 9.99, 10.01, 3000)),
    *(entry(f"negative_binomial{a}", lambda g, n, a=a: g.negative_binomial(*a, n), nbinom(*a)) for a in ((2.5, 0.3), (0.2, 0.05), (50, 0.5))),
    *(entry(f"geometric({p})", lambda g, n, p=p: g.geometric(p, n), geom(p)) for p in (0.01, 1 / 3, 0.34, 0.9)),
    *(entry(f"hypergeometric{a}", lambda g, n, a=a: g.hypergeometric(*a, n), hypergeom(a[0] + a[1], a[0], a[2]))
      for a in ((5, 9, 4), (300, 500, 60), (2000, 3000, 900))),
    *(entry(f"logseries({p})", lambda g, n, p=p: g.logseries(p, n), logser(p)) for p in (0.2, 0.9)),
    *(entry(f"zipf({a})", lambda g, n, a=a: g.zipf(a, n), zipf(a)) for a in (4, 8)),
    *(sampler(f"vonmises({k})", lambda n, seed, k=k: (lambda a: np.stack([np.cos(a), np.sin(a)], 1))(np.random.default_rng(seed).vonmises(0.5, k, n)),
              lambda x, k=k: vonmises(k).pdf(np.arctan2(x[:, 1], x[:, 0]) - 0.5), "circle", dimension=0) for k in (1e-6, 0.5, 4, 2000)),
    *(sampler(f"dirichlet{a}", lambda n, seed, a=a: np.random.default_rng(seed).dirichlet(a, n),
              lambda x, a=a: stats.dirichlet.pdf((x / x.sum(1, keepdims=True)).T, a), "simplex", dimension=0) for a in ((1, 1, 1), (2, 3, 4), (0.5, 0.7, 0.9))),
    *(sampler(f"multivariate_normal {m}", lambda n, seed, m=m: np.random.default_rng(seed).multivariate_normal([1, 2], [[2, 1.2], [1.2, 1]], n, method=m),
              stats.multivariate_normal([1, 2], [[2, 1.2], [1.2, 1]]).pdf, "plane:3", dimension=0) for m in ("svd", "eigh", "cholesky")),
    sampler("integers", lambda n, seed: np.random.default_rng(seed).integers(0, 1000, n), lambda i: np.full(len(i), 1e-3), "discrete:1000", dimension=0),
    sampler("choice p", lambda n, seed: np.random.default_rng(seed).choice(4, n, p=[0.1, 0.2, 0.3, 0.4]), lambda i: (i + 1) / 10, "discrete:4", dimension=0),
]  # fmt: skip

run(ENTRIES)
