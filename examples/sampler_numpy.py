"""A client for `etalon validate --exec 'python3 examples/sampler_numpy.py ALPHA'`: normals of a Beckmann surface, numpy.

Its density per solid angle is D(wm) cos θ with D = exp(-tan² θ/α²) / (π α² cos⁴ θ).
"""
import sys
from itertools import islice

import numpy as np

ALPHA = float(sys.argv[1]) if len(sys.argv) > 1 else 0.3


def sample(u):
    tan2 = -(ALPHA**2) * np.log1p(-u[:, 0])
    z, phi = 1 / np.sqrt(1 + tan2), 2 * np.pi * u[:, 1]
    r = np.sqrt(tan2) * z
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)


def pdf(w):
    z2 = np.maximum(w[:, 2], 1e-9) ** 2
    tan2 = (w[:, 0] ** 2 + w[:, 1] ** 2) / z2
    return np.exp(-tan2 / ALPHA**2) / (np.pi * ALPHA**2 * z2**1.5)


def numbers(count):
    """The next lines of the input, as an array with a row for each."""
    return np.array("".join(islice(sys.stdin, count)).split(), dtype=float).reshape(count, -1)


def answer(rows):
    """Prints rows of numbers in hexadecimal, which is exact and faster than decimal."""
    words = map(float.hex, rows.ravel().tolist())
    print("\n".join(map(" ".join, zip(*[words] * rows.shape[1]))))


for line in sys.stdin:
    request = line.split()
    if request[0] == "etalon":
        print("etalon 1 name=beckmann-numpy domain=hemisphere dimension=2")
    elif request[0] == "sample":
        w = sample(numbers(int(request[1])))
        answer(np.column_stack([w, pdf(w)]))
    elif request[0] == "pdf":
        answer(pdf(numbers(int(request[1])))[:, None])
    elif request[0] == "quit":
        break
    print("end", flush=True)
