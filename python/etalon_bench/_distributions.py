"""Distributions of SciPy and PyTorch as arguments of `check_sampler`."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any, Literal

import numpy as np

Arguments = dict[str, Any]


def of_scipy(distribution: Any, by: Literal["rvs", "ppf"] = "rvs") -> Arguments:
    """A frozen distribution of one variable of `scipy.stats`, as arguments: `check_sampler(**of_scipy(stats.gamma(2.0)))`.

    The domain is that of the support. Outcomes of a discrete distribution are counted from the 10⁻⁹ quantile on; what lies further out
    belongs to the first and the last outcome, by `cdf` and `sf`.

    Args:
        distribution: such as `scipy.stats.gamma(2.0)`.
        by: what draws samples: `rvs`, with a generator of its own, or `ppf` of a random number.
    """
    place: Callable[[Any], Any]
    pdf: Callable[[Any], Any]
    if hasattr(distribution, "pmf"):
        first, last = int(distribution.ppf(1e-9)), int(distribution.isf(1e-9))

        def probability(i: Any) -> Any:
            x = i + first
            inner = distribution.pmf(x)
            return np.where(i == 0, distribution.cdf(first), np.where(x == last, distribution.sf(last - 1), inner))

        domain, pdf = f"discrete:{last - first + 1}", probability
        place = lambda x: np.clip(x, first, last) - first  # noqa: E731
    else:
        domain, pdf = _domain(*distribution.support(), *distribution.ppf([0.25, 0.5, 0.75])), distribution.pdf
        place = lambda x: x  # noqa: E731
    if by == "ppf":
        return {"sample": lambda u: place(distribution.ppf(u)), "pdf": pdf, "domain": domain, "dimension": 1}
    return {"sample": lambda n, seed: place(distribution.rvs(n, random_state=seed)), "pdf": pdf, "domain": domain, "dimension": 0}


def of_torch(distribution: Any) -> Arguments:
    """A distribution of one real or integer variable of `torch.distributions`, as arguments: `check_sampler(**of_torch(Gamma(2.0, 1.0)))`.

    Make the parameters tensors of double precision, so that samples are: single precision repeats values, which is found.
    """
    torch: Any = importlib.import_module("torch")
    example = distribution.sample((1 << 12,))
    support = distribution.support

    def samples(n: int, seed: int) -> Any:
        torch.manual_seed(seed)
        return distribution.sample((n,))

    def density(x: Any) -> Any:
        return distribution.log_prob(torch.as_tensor(x, dtype=example.dtype)).exp()

    if support.is_discrete:
        last = 1 if support is torch.distributions.constraints.boolean else getattr(support, "upper_bound", 4 * int(example.max()) + 16)
        return {"sample": samples, "pdf": density, "domain": f"discrete:{int(last) + 1}", "dimension": 0}
    low, high = (float(getattr(support, name, end)) for name, end in (("lower_bound", -np.inf), ("upper_bound", np.inf)))
    domain = _domain(low, high, *np.quantile(np.asarray(example, dtype=float), [0.25, 0.5, 0.75]))
    return {"sample": samples, "pdf": density, "domain": domain, "dimension": 0}


def _domain(low: float, high: float, lower: float, median: float, upper: float) -> str:
    """The name of the domain from low to high, where half of all values lie between two quartiles."""
    low, high, lower, median, upper = (float(x) for x in (low, high, lower, median, upper))
    if np.isfinite(low) and np.isfinite(high):
        return f"interval:{low!r},{high!r}"
    if np.isfinite(low):
        return f"half-line:{low!r},{median - low!r}"
    if np.isfinite(high):
        return f"half-line:{high!r},{median - high!r}"
    return f"real:{median!r},{upper - lower!r}"
