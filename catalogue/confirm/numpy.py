"""NumPy 2.4.6 and SciPy 1.17.1: what findings/numpy.toml and scipy.toml say of gamma(0.05). Run it with `catalogue/.env/scipy/bin/python -P`."""

import numpy as np
from scipy import stats

n, random = 2_000_000, np.random.default_rng(7)
law = stats.gamma(0.05, scale=2)
for name, samples in (("numpy gamma", random.gamma(0.05, 2, n)), ("scipy rvs", law.rvs(n, random_state=random))):
    x = np.sort(samples)
    print(f"{name}: the distance of {n} samples from the distribution function has p = {stats.kstest(x, law.cdf).pvalue:.3f}")
    for end in (1e-100, 1e-80, 1e-60, 1e-10, 1):
        share, right = np.searchsorted(x, end) / n, law.cdf(end)
        print(f"  below {end}: {share:.3e} of the samples, right {right:.3e} ± {np.sqrt(right / n):.1e}")
