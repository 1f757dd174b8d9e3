# /// script
# dependencies = ["torch==2.15.0"]
# ///
"""PyTorch: torch.distributions and the random functions of tensors, on the CPU, in double and single precision."""

import etalon_bench as eb
import numpy as np
import torch
from torch import distributions as D
from torch import nn

from entry import run, sampler


def both(*parameters):
    """Parameters in double and in single precision."""
    return [(kind, [torch.tensor(x, dtype=kind) for x in parameters]) for kind in (torch.float64, torch.float32)]


def entries():
    for make, *all_parameters in [
        (D.Beta, (0.5, 0.5), (2, 5), (0.3, 8), (200, 300)), (D.Cauchy, (0, 1), (100, 0.1)), (D.Chi2, (0.5,), (3,), (60,)), (D.Exponential, (1,), (1e-4,)),
        (D.FisherSnedecor, (3, 5), (0.8, 2)), (D.Gamma, (0.1, 1), (0.9, 2), (3, 0.2), (1000, 1)), (D.Gumbel, (0, 1), (5, 0.2)), (D.HalfCauchy, (1,)),
        (D.HalfNormal, (1,)), (D.InverseGamma, (0.7, 1), (4, 2)), (D.Kumaraswamy, (0.5, 0.5), (2, 5)), (D.Laplace, (0, 1),), (D.LogNormal, (0, 0.3), (0, 2)),
        (D.Normal, (0, 1), (1000, 0.1)), (D.Pareto, (1, 0.5), (2, 4)), (D.StudentT, (0.7,), (3,), (100,)), (D.Uniform, (-1, 3)), (D.Weibull, (1, 0.4), (2, 5)),
        (D.GeneralizedPareto, (0, 1, 0.3), (0, 1, -0.3), (0, 1, 0)), (D.ContinuousBernoulli, (0.2,), (0.4999,), (0.97,)),
    ]:  # fmt: skip
        for parameters in all_parameters:
            for kind, tensors in both(*parameters):
                yield sampler(f"{make.__name__}{parameters} {str(kind)[6:]}", **eb.of_torch(make(*tensors)))
    for name, distribution in {
        "Bernoulli(0.3)": D.Bernoulli(0.3), "Binomial(10, 0.3)": D.Binomial(10, torch.tensor(0.3)), "Binomial(1000, 0.7)": D.Binomial(1000, torch.tensor(0.7)),
        "Geometric(0.2)": D.Geometric(0.2), "Geometric(0.9)": D.Geometric(0.9), "NegativeBinomial(2.5, 0.6)": D.NegativeBinomial(2.5, torch.tensor(0.6)),
        "Poisson(0.3)": D.Poisson(0.3), "Poisson(9.9)": D.Poisson(9.9), "Poisson(400)": D.Poisson(400.0), "Categorical": D.Categorical(torch.arange(7.0)),
    }.items():  # fmt: skip
        yield sampler(name, **eb.of_torch(distribution))
    for name, distribution, domain in [
        ("MixtureSameFamily", D.MixtureSameFamily(D.Categorical(torch.tensor([0.3, 0.7])), D.Normal(*both([0.0, 4.0], [1.0, 0.3])[0][1])), "real:3"),
        ("LogisticNormal 2", D.TransformedDistribution(D.Normal(*both(0.0, 1.0)[0][1]), [D.transforms.SigmoidTransform()]), "line"),
        ("AffineTransform", D.TransformedDistribution(D.Normal(*both(0.0, 1.0)[0][1]), [D.transforms.AffineTransform(3, -2)]), "real:3"),
        ("PowerTransform", D.TransformedDistribution(D.Exponential(both(1.0)[0][1][0]), [D.transforms.PowerTransform(torch.tensor(0.5))]), "half-line"),
        ("SoftplusTransform", D.TransformedDistribution(D.Normal(*both(0.0, 1.0)[0][1]), [D.transforms.SoftplusTransform()]), "half-line"),
        ("TanhTransform", D.TransformedDistribution(D.Normal(*both(0.0, 0.7)[0][1]), [D.transforms.TanhTransform()]), "interval:-1,1"),
        ("MultivariateNormal", D.MultivariateNormal(*both([1.0, 2.0], [[2.0, 1.2], [1.2, 1.0]])[0][1]), "plane:3"),
        ("LowRankMultivariateNormal", D.LowRankMultivariateNormal(*both([1.0, 2.0], [[2.0], [1.2]], [0.2, 0.5])[0][1]), "plane:3"),
        *((f"Dirichlet{a}", D.Dirichlet(torch.tensor(a, dtype=torch.float64)), "simplex") for a in ((1, 1, 1), (2, 3, 4), (0.6, 0.8, 5))),
        *((f"RelaxedBernoulli({t})", D.RelaxedBernoulli(*both(t, 0.3)[0][1]), "line") for t in (0.7, 3)),
    ]:  # fmt: skip
        yield sampler(name, **{**eb.of_torch(distribution), "domain": domain})
    for k in (0.01, 0.5, 4, 300, 20000):
        for kind, (mean, kappa) in both(0.5, k):
            law = D.VonMises(mean, kappa)
            sample = eb.of_torch(law)["sample"]
            yield sampler(
                f"VonMises({k}) {str(kind)[6:]}", lambda n, seed, sample=sample: (lambda a: np.stack([np.cos(a), np.sin(a)], 1))(sample(n, seed).double()),
                lambda x, law=law: law.log_prob(torch.as_tensor(np.arctan2(x[:, 1], x[:, 0]))).exp(), "circle", dimension=0,
            )  # fmt: skip
    for name, fill, domain, pdf in [
        ("rand", lambda n: torch.rand(n, dtype=torch.float64), "line", lambda x: np.ones(len(x))),
        ("randn", lambda n: torch.randn(n, dtype=torch.float64), "real", lambda x: np.exp(-x * x / 2) / np.sqrt(2 * np.pi)),
        ("randint", lambda n: torch.randint(0, 1000, (n,)), "discrete:1000", lambda x: np.full(len(x), 1e-3)),
        ("multinomial", lambda n: torch.multinomial(torch.tensor([1.0, 2, 0, 7]), n, replacement=True), "discrete:4", lambda i: np.array([0.1, 0.2, 0, 0.7])[i]),
        ("geometric_", lambda n: torch.empty(n).geometric_(0.3).long().clamp(max=100), "discrete:101", lambda i: np.where(i == 0, 0, 0.3 * 0.7 ** (i - 1.0))),
        ("trunc_normal_", lambda n: nn.init.trunc_normal_(torch.empty(n, dtype=torch.float64), 0, 1, -1, 2), "interval:-1,2", lambda x: np.exp(-x * x / 2) / 2.0519303),
        ("trunc_normal_ tail", lambda n: nn.init.trunc_normal_(torch.empty(n), 0, 1, 3, 4), "interval:3,4", lambda x: np.exp(-x * x / 2) / 0.0033043),
    ]:  # fmt: skip
        yield sampler(name, lambda n, seed, fill=fill: (torch.manual_seed(seed), fill(n))[1], pdf, domain, dimension=0)
    normal = eb.of_torch(D.Normal(*both(0.0, 1.0)[0][1]))
    yield sampler("control/Normal", **normal, control="right")
    yield sampler("control/Normal of scale 1.05", **{**normal, "sample": eb.of_torch(D.Normal(*both(0.0, 1.05)[0][1]))["sample"]}, control="wrong")


run(list(entries()))
