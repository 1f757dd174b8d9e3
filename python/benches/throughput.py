"""Samples per second through NumPy callbacks, beside the callbacks' own time, on one core.

`taskset -c 0 python benches/throughput.py`. The functions do next to nothing, and their time is measured and taken off; what is left is
the test: random numbers, arrays there and back, cells, finer parts, exact checks.
"""

from __future__ import annotations

import time

import numpy as np

import etalon_bench as eb

SAMPLES = 20_000_000


class Timed:
    """A function that adds up its own time and the entries that it was asked for."""

    def __init__(self, function):
        self.function, self.seconds, self.entries = function, 0.0, 0

    def __call__(self, x):
        start = time.perf_counter()
        y = self.function(x)
        self.seconds += time.perf_counter() - start
        self.entries += len(x)
        return y


def cosine(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)


CASES = {
    "line": (lambda u: u[:, 0], np.ones_like),
    "square": (lambda u: u, lambda x: np.ones(len(x))),
    "hemisphere": (cosine, lambda w: w[:, 2] / np.pi),
}

for domain, functions in CASES.items():
    sample, pdf = map(Timed, functions)
    start = time.perf_counter()
    result = eb.check_sampler(sample, pdf, domain, samples=SAMPLES)
    seconds = time.perf_counter() - start
    own = seconds - sample.seconds - pdf.seconds
    print(
        f"{domain:<10} {result.verdict}: {sample.entries / own / 1e6:.1f} M samples/s beside the functions "
        f"({seconds:.2f} s, of which {sample.seconds + pdf.seconds:.2f} s in them)"
    )
