# /// script
# dependencies = ["scipy==1.17.1"]
# ///
"""SciPy: every frozen distribution of scipy.stats by `rvs`, many by `ppf`; directions, mixtures, scipy.stats.sampling, quasi-Monte Carlo."""

import warnings

import etalon_bench as eb
import numpy as np
from scipy import stats
from scipy.integrate import quad
from scipy.spatial.transform import Rotation
from scipy.stats import qmc, sampling
from scipy.stats._distr_params import distcont, distdiscrete

from entry import run, sampler

warnings.filterwarnings("ignore")
# By numerical integration or a search for each value: minutes an entry.
SLOW = {
    "levy_stable", "studentized_range", "kstwo", "ksone", "geninvgauss", "genhyperbolic", "norminvgauss", "tukeylambda", "nchypergeom_fisher",
    "nchypergeom_wallenius", "dpareto_lognorm", "gausshyper", "vonmises", "rel_breitwigner",
}  # fmt: skip
FAST_PPF = {
    "alpha", "anglit", "arcsine", "beta", "bradford", "burr", "cauchy", "chi", "chi2", "dgamma", "dweibull", "erlang", "expon", "exponpow", "exponweib", "f", "fatiguelife",
    "fisk", "gamma", "genextreme", "gengamma", "genlogistic", "gennorm", "genpareto", "gompertz", "gumbel_l", "gumbel_r", "halfcauchy", "halflogistic",
    "halfnorm", "hypsecant", "invgamma", "invgauss", "invweibull", "johnsonsb", "kappa3", "laplace", "levy", "logistic", "loggamma", "lognorm", "lomax", "maxwell",
    "moyal", "nakagami", "norm", "pareto", "powerlaw", "rayleigh", "reciprocal", "t", "triang", "truncexpon", "truncnorm", "uniform", "weibull_max",
    "weibull_min", "wrapcauchy", "crystalball", "johnsonsu", "loglaplace", "laplace_asymmetric",
}  # fmt: skip
CORNERS = [
    ("gamma", (0.05,)), ("gamma", (0.9,)), ("gamma", (1e5,)), ("beta", (0.5, 0.5)), ("beta", (0.3, 8)), ("beta", (2000, 3000)), ("t", (0.5,)), ("t", (100,)),
    ("chi2", (0.4,)), ("f", (0.6, 1.5)), ("invgamma", (0.4,)), ("weibull_min", (0.3,)), ("lognorm", (3,)), ("pareto", (0.4,)), ("genpareto", (-0.4,)),
    ("genpareto", (1e-9,)), ("genextreme", (0.3,)), ("genextreme", (1e-9,)), ("truncnorm", (3, 3.5)), ("truncnorm", (-40, -39)), ("truncnorm", (8, np.inf)), ("truncexpon", (1e-3,)),
    ("truncpareto", (0.5, 100)), ("skewnorm", (-20,)), ("exponnorm", (0.01,)), ("exponnorm", (50,)), ("gengamma", (0.3, -2)), ("invgauss", (100,)), ("invgauss", (1e-3,)),
    ("nct", (2, -3)), ("ncx2", (0.3, 50)), ("rice", (0.01,)), ("rice", (40,)), ("loguniform", (1e-6, 1e6)), ("triang", (0,)), ("triang", (1,)), ("alpha", (0.3,)),
    ("betaprime", (0.5, 0.7)), ("johnsonsu", (-3, 0.6)), ("powerlaw", (0.2,)), ("pearson3", (-2.5,)), ("pearson3", (1e-6,)), ("moyal", ()), ("kappa3", (0.3,)), ("wrapcauchy", (0.97,)),
    ("arcsine", ()), ("cosine", ()), ("argus", (1e-4,)), ("argus", (30,)), ("burr", (0.5, 0.4)), ("fatiguelife", (6,)), ("halfgennorm", (0.4,)), ("gennorm", (0.3,)), ("exponpow", (0.4,)),
]  # fmt: skip
CORNERS_DISCRETE = [
    ("binom", (1000, 0.001)), ("binom", (5000, 0.7)), ("poisson", (0.1,)), ("poisson", (1e4,)), ("nbinom", (0.1, 0.02)), ("geom", (0.003,)), ("logser", (0.99,)),
    ("skellam", (0.2, 30)), ("betabinom", (60, 0.3, 0.2)), ("dlaplace", (0.1,)), ("boltzmann", (0.01, 500)), ("hypergeom", (5000, 20, 3000)), ("nhypergeom", (60, 20, 10)),
    ("zipfian", (0.5, 300)), ("planck", (0.005,)), ("randint", (-5, 400)), ("betanbinom", (5, 9.3, 1)),
]  # fmt: skip
# zipf and yulesimon have tails without an end of integers; the bench has 2^20.
LONG_TAILS = {"zipf", "yulesimon"}


def frozen(by, parameters, skipped=SLOW):
    titles = {f"{name}({', '.join(f'{x:.6g}' if np.isscalar(x) else str(x) for x in args)}) {by}": (name, args) for name, args in parameters}
    for title, (name, args) in titles.items():
        if isinstance(name, str) and name not in skipped:
            yield sampler(title, **eb.of_scipy(getattr(stats, name)(*args), by))


def new(name, distribution):
    """A distribution of the infrastructure of 2024 (stats.Normal, Mixture, truncate …)."""
    low, high = (float(x) for x in distribution.support())
    quartile = distribution.icdf([0.25, 0.5, 0.75])
    domain = f"interval:{low},{high}" if high < np.inf else f"half-line:{low},{quartile[1] - low}" if low > -np.inf else f"real:{quartile[1]},{quartile[2] - quartile[0]}"
    return sampler(name, lambda n, seed: distribution.sample(n, rng=np.random.default_rng(seed)), distribution.pdf, domain, dimension=0)


def own(name, sample, pdf, domain):
    return sampler(name, lambda n, seed: sample(n, np.random.default_rng(seed)), pdf, domain, dimension=0)


class Bump:
    """exp(-x²/2 - x⁴/4) with its normalisation, and what the generators of scipy.stats.sampling ask for."""

    area = quad(lambda x: np.exp(-(x**2) / 2 - x**4 / 4), -np.inf, np.inf, epsabs=1e-13)[0]
    pdf = staticmethod(lambda x: np.exp(-(x**2) / 2 - x**4 / 4) / Bump.area)
    dpdf = staticmethod(lambda x: -(x + x**3) * Bump.pdf(x))
    logpdf = staticmethod(lambda x: -(x**2) / 2 - x**4 / 4 - np.log(Bump.area))


def generator(name, make, **options):
    """A method of scipy.stats.sampling; each batch has a generator with random numbers of its own."""
    return own(f"sampling/{name}", lambda n, rng: make(random_state=rng, **options).rvs(n), Bump.pdf, "real")


class Numbers(qmc.QMCEngine):
    """An engine of independent numbers: what is tested is what SciPy makes of them."""

    def __init__(self, d, *, rng=None):
        super().__init__(d, rng=rng)

    def _random(self, n=1, *, workers=1):
        return self.rng.random((n, self.d))


COVARIANCE = [[2, 1.2], [1.2, 1]]
WEIGHTS = np.array([1, 0, 3, 7, 1e-3, 12])
KDE = stats.gaussian_kde(np.array([-1.0, 0.2, 0.5, 3.0]), weights=[1, 2, 3, 4])
HISTOGRAM = stats.rv_histogram(np.histogram([1, 2, 2, 3, 5, 5, 5, 9.0], bins=[0, 1.5, 2.5, 6, 10]), density=False)
KAPPAS = ((1e-3, "uniform"), (1, "broad"), (50, "narrow"), (5000, "very narrow"))
POLE, AXIS = [0.0, 0.0, 1.0], [0.6, 0.0, -0.8]
ENTRIES = [
    sampler("control/norm", **eb.of_scipy(stats.norm()), control="right"),
    sampler("control/norm of scale 1.05", **{**eb.of_scipy(stats.norm()), "pdf": stats.norm(0, 1.05).pdf}, control="wrong"),
    *frozen("rvs", distcont + CORNERS),
    *frozen("ppf", [each for each in distcont if each[0] in FAST_PPF]),
    *frozen("rvs", distdiscrete + CORNERS_DISCRETE, SLOW | LONG_TAILS),
    *(sampler(f"vonmises({k})", lambda n, seed, k=k: (lambda a: np.stack([np.cos(a), np.sin(a)], 1))(stats.vonmises(k, 0.5).rvs(n, random_state=seed)),
              lambda x, k=k: stats.vonmises(k, 0.5).pdf(np.arctan2(x[:, 1], x[:, 0])), "circle", dimension=0) for k in (1e-4, 0.5, 4, 80, 3000)),
    *(own(f"vonmises_fisher {name} {axis}", stats.vonmises_fisher(axis, k).rvs, stats.vonmises_fisher(axis, k).pdf, "sphere") for k, name in KAPPAS for axis in (POLE, AXIS)),
    own("uniform_direction", lambda n, rng: stats.uniform_direction(3).rvs(n, random_state=rng), lambda w: np.full(len(w), 0.25 / np.pi), "sphere"),
    own("Rotation.random", lambda n, rng: Rotation.random(n, rng=rng).apply(AXIS), lambda w: np.full(len(w), 0.25 / np.pi), "sphere"),
    own("special_ortho_group", lambda n, rng: stats.special_ortho_group(3).rvs(n, random_state=rng).reshape(n, 3, 3)[:, :, 2], lambda w: np.full(len(w), 0.25 / np.pi), "sphere"),
    own("ortho_group", lambda n, rng: stats.ortho_group(3).rvs(n, random_state=rng).reshape(n, 3, 3)[:, :, 0], lambda w: np.full(len(w), 0.25 / np.pi), "sphere"),
    own("multivariate_normal", stats.multivariate_normal([1, 2], COVARIANCE).rvs, stats.multivariate_normal([1, 2], COVARIANCE).pdf, "plane:3"),
    *(own(f"multivariate_t({df})", lambda n, rng, df=df: stats.multivariate_t([1, 2], COVARIANCE, df).rvs(n, random_state=rng), stats.multivariate_t([1, 2], COVARIANCE, df).pdf, "plane:3") for df in (1, 5)),
    *(own(f"dirichlet{a}", lambda n, rng, a=a: stats.dirichlet(a).rvs(n, random_state=rng), lambda x, a=a: stats.dirichlet.pdf((x / x.sum(1, keepdims=True)).T, a), "simplex") for a in ((1, 1, 1), (2, 3, 4), (0.6, 0.8, 5))),
    own("gaussian_kde", lambda n, rng: KDE.resample(n, seed=rng)[0], KDE.pdf, "real"),
    own("rv_histogram", lambda n, rng: HISTOGRAM.rvs(size=n, random_state=rng), HISTOGRAM.pdf, "interval:0,10"),
    own("rv_discrete", lambda n, rng: stats.rv_discrete(values=(range(6), WEIGHTS / WEIGHTS.sum())).rvs(size=n, random_state=rng), lambda i: (WEIGHTS / WEIGHTS.sum())[i], "discrete:6"),
    *(new(f"new/{name}", make) for name, make in {
        "Normal": stats.Normal(mu=3, sigma=0.2), "Uniform": stats.Uniform(a=-2, b=5), "Logistic": stats.Logistic(), "truncate": stats.truncate(stats.Normal(), -1, 3),
        "Mixture": stats.Mixture([stats.Normal(), stats.Normal(mu=4, sigma=0.3)], weights=[0.3, 0.7]), "exp": stats.exp(stats.Normal()), "abs": stats.abs(stats.Normal(mu=0.5)),
        "log": stats.log(stats.Uniform(a=1, b=9)), "order_statistic": stats.order_statistic(stats.Normal(), r=2, n=5), "gamma": stats.make_distribution(stats.gamma)(a=0.7),
        "square": stats.Normal(mu=0, sigma=1) ** 2, "shifted": 3 - 2 * stats.Normal(),
    }.items()),
    *(generator(name, lambda random_state, make=make: make(random_state)) for name, make in {
        "NumericalInversePolynomial": lambda rng: sampling.NumericalInversePolynomial(Bump(), random_state=rng),
        "TransformedDensityRejection": lambda rng: sampling.TransformedDensityRejection(Bump(), random_state=rng),
        "SimpleRatioUniforms": lambda rng: sampling.SimpleRatioUniforms(Bump(), mode=0, pdf_area=1, random_state=rng),
        "RatioUniforms": lambda rng: sampling.RatioUniforms(Bump.pdf, umax=Bump.pdf(0) ** 0.5, vmin=-0.5, vmax=0.5, random_state=rng),
    }.items()),
    *(own(f"sampling/FastGeneratorInversion {d.dist.name}{d.args}", lambda n, rng, d=d: sampling.FastGeneratorInversion(d, random_state=rng).rvs(n), d.pdf, eb.of_scipy(d)["domain"])
      for d in (stats.gamma(0.7), stats.gamma(5), stats.t(3), stats.beta(2, 0.8), stats.norm(), stats.invgauss(2), stats.argus(2), stats.weibull_min(1.5))),
    own("sampling/NumericalInverseHermite", lambda n, rng: sampling.NumericalInverseHermite(stats.gamma(2.5), random_state=rng).rvs(n), stats.gamma(2.5).pdf, "half-line"),
    *(own(f"sampling/{m.__name__}", lambda n, rng, m=m: m(WEIGHTS / WEIGHTS.sum(), random_state=rng).rvs(n), lambda i: (WEIGHTS / WEIGHTS.sum())[i], "discrete:6")
      for m in (sampling.DiscreteAliasUrn, sampling.DiscreteGuideTable)),
    *(own(f"qmc/MultivariateNormalQMC inv_transform={inv}", lambda n, rng, inv=inv: qmc.MultivariateNormalQMC([1, 2], COVARIANCE, engine=Numbers(2, rng=rng), inv_transform=inv).random(n),
          stats.multivariate_normal([1, 2], COVARIANCE).pdf, "plane:3") for inv in (True, False)),
]  # fmt: skip

run(ENTRIES)
