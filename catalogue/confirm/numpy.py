"""NumPy 2.4.6: what findings/numpy.toml says, by SciPy. Run it with `catalogue/.env/numpy/bin/python -P`."""

import numpy as np
from scipy import stats

n = 2_000_000
x = np.sort(np.random.default_rng(7).gamma(0.05, 2, n))
print(f"gamma(0.05, 2): the distance of {n} samples from the distribution function has p = {stats.kstest(x, stats.gamma(0.05, scale=2).cdf).pvalue:.3f}")
for end in (1e-100, 1e-80, 1e-60, 1e-10, 1):
    share, right = np.searchsorted(x, end) / n, stats.gamma(0.05, scale=2).cdf(end)
    print(f"  below {end}: {share:.3e} of the samples, right {right:.3e} ± {np.sqrt(right / n):.1e}")
