"""rand_distr 0.4.3 and 0.6.0: what findings/rand_distr-0.4.3.toml says, by moments and counts of the clients' samples alone: `python3 rand_distr.py`, after `catalogue/run rand_distr rand_distr-0.4.3`."""

import subprocess
from collections import Counter
from math import comb
from pathlib import Path
from statistics import fmean, pvariance

N = 1_000_000


def draw(package, name):
    client = Path(__file__).parents[1] / ".env" / package / "client"
    answer = subprocess.run([client, name], input=f"sample {N} 7\nquit\n", capture_output=True, text=True, check=True).stdout
    return [float(line) for line in answer.split()[:N]]


for package in ("rand_distr-0.4.3", "rand_distr"):
    x = draw(package, "Pert(0.1, 0.7, 0.4)")
    print(f"{package}: Pert(0.1, 0.7, 0.4) has the variance {pvariance(x):.5f}, right {0.36 / 28:.5f}, of a uniform law {0.36 / 12:.5f}; {fmean(abs(y - 0.4) > 0.27 for y in x):.4f} of the samples are in its outer tenth, right {2 * sum(comb(5, k) * 0.05**k * 0.95 ** (5 - k) for k in (3, 4, 5)):.4f}")  # fmt: skip
    counts = Counter(draw(package, "Hypergeometric(100, 50, 49)"))
    right = {k: N * comb(50, k) * comb(50, 49 - k) / comb(100, 49) for k in range(50)}
    likely = [k for k in right if right[k] > 10]
    print(f"  Hypergeometric(100, 50, 49): chi-square {sum((counts[k] - right[k]) ** 2 / right[k] for k in likely):.0f} of {len(likely)} outcomes; " + ", ".join(f"{k} {counts[k] / right[k] - 1:+.1%}" for k in (22, 23, 24, 25, 26)))  # fmt: skip
    x = draw(package, "Poisson(1e16)")
    print(f"  Poisson(1e16): the variance is {pvariance([y - 1e16 for y in x]) / 1e16:.2f} λ, of {len(set(x))} values; the farthest is {max(abs(y - 1e16) for y in x) / 1e8:.1f} standard deviations off")
