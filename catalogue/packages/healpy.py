# /// script
# dependencies = ["healpy==1.20.1"]
# ///
"""healpy: pixels of equal area by direction and back; random directions of pixels, and its synthetic maps by one pixel."""

import healpy as hp
import numpy as np

from entry import run, sampler


def pixels(nside, nest):
    """The pixel of a uniform direction: all have the same probability."""
    n = 12 * nside**2

    def sample(u):
        return hp.vec2pix(nside, *direction(u).T, nest=nest)

    return sampler(f"vec2pix nside={nside} nest={nest}", sample, lambda i: np.full(len(i), 1 / n), f"discrete:{n}", dimension=2)


def direction(u):
    z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
    return np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1)


def centres(nside, nest):
    """Centres of pixels of an order 12 higher than a table's: as even as uniform directions."""
    return lambda u: np.stack(hp.pix2vec(1 << 20, (u[:, 0] * 12 * (1 << 40)).astype(np.int64), nest=nest), axis=1)


uniform = lambda w: np.full(len(w), 0.25 / np.pi)  # noqa: E731
tilted = hp.Rotator(rot=[30, 40, 50])
ENTRIES = [
    sampler("control/uniform", direction, uniform, "sphere", control="right"),
    sampler("control/uniform in theta", lambda u: direction(np.stack([np.sin(np.pi / 2 * u[:, 0]) ** 2, u[:, 1]], axis=1)), uniform, "sphere", control="wrong"),
    *(pixels(nside, nest) for nside in (1, 8, 128) for nest in (False, True)),
    pixels(3, False),
    *(sampler(f"pix2vec nest={nest}", centres(1 << 20, nest), uniform, "sphere", dimension=1) for nest in (False, True)),
    sampler("Rotator", lambda u: tilted(direction(u).T).T, uniform, "sphere"),
    sampler("ang2vec", lambda u: hp.ang2vec(np.arccos(1 - 2 * u[:, 0]), 2 * np.pi * u[:, 1]), uniform, "sphere"),
]

run(ENTRIES)
