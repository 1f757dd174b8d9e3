"""How the pdfs of Mitsuba 3's BSDFs integrate, and how many samples fail: with numpy alone, to compare with what etalon reports.

`python3 examples/mitsuba_pdf.py PLUGIN DISTRIBUTION ANGLE... [NAME=VALUE...]` takes plugins and parameters of `bsdf_mitsuba.py`
and angles of `wo` with the normal in degrees.
"""
import sys

import numpy as np

import bsdf_mitsuba as client

THETAS, PHIS, SAMPLES, BATCHES = 512, 1024, 1 << 19, 8


def integral(wo, side):
    """The pdf over the hemisphere above (1) or below (-1): Gauss-Legendre quadrature over theta, equal steps of phi."""
    nodes, weights = np.polynomial.legendre.leggauss(THETAS)
    theta, weights = np.pi / 4 * (nodes + 1), np.pi / 4 * weights
    phi = 2 * np.pi * (np.arange(PHIS) + 0.5) / PHIS
    sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
    wi = np.stack([sin * np.cos(phi), sin * np.sin(phi), side * cos + 0 * phi], axis=-1).reshape(-1, 3)
    _, pdf = client.evaluate(np.tile(wo, (len(wi), 1)), wi)
    return 2 * np.pi / PHIS * np.sum(pdf.reshape(THETAS, PHIS) * sin * weights[:, None])


def failed(wo):
    random = np.random.default_rng(1)
    batch = lambda: client.sample(np.tile(wo, (SAMPLES, 1)), random.random((SAMPLES, 3)))[-1]
    return 1 - np.mean([np.mean(batch()) for _ in range(BATCHES)])


chosen = dict(argument.split("=") for argument in sys.argv[3:] if "=" in argument)
client.bsdf = client.load([float(chosen.get(name, default)) for name, (default, _, _) in client.PARAMETERS.items()])
print("angle  pdf above  pdf below  failed samples")
for angle in (float(argument) for argument in sys.argv[3:] if "=" not in argument):
    wo = np.array([np.sin(np.radians(angle)), 0, np.cos(np.radians(angle))])
    print(f"{angle:5g}  {integral(wo, 1):9.6f}  {integral(wo, -1):9.6f}  {failed(wo):14.6f}", flush=True)
