"""NumPy and SciPy: what findings/numpy.toml and scipy.toml say of gamma(0.05), run with `catalogue/.env/scipy/bin/python -P`, and findings/numpy-2.3.3.toml of wald, with `.env/numpy-2.3.3/bin/python -P`."""

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

x = np.random.default_rng(7).wald(1e8, 2.25, n)
counts = np.unique(x[x > 0], return_counts=True)[1]
print(f"NumPy {np.__version__}, wald(1e8, 2.25): 0 are {np.mean(x == 0):.4f} of {n} samples, negative {np.sum(x < 0)}, the most frequent other value {counts.max() / n:.4f}")
