"""A BSDF for `etalon validate --exec 'python3 examples/bsdf_numpy.py'`: a rough metal with GGX facets, numpy.

The light has one channel and the metal reflects all of what its facets do not block. With the argument `wrong` the masking and
the shadowing of the facets are taken for independent where samples are weighted, and for correlated where f is evaluated.
"""
import sys

import numpy as np

WRONG = "wrong" in sys.argv[1:]
alpha = np.array([0.3, 0.3])  # the parameters


def unit(w):
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def smith(w):
    """Smith's Λ, and 1 in directions along the surface."""
    stretched = (alpha[0] * w[:, 0]) ** 2 + (alpha[1] * w[:, 1]) ** 2
    return 0.5 * (np.sqrt(1 + stretched / np.maximum(w[:, 2], 1e-30) ** 2) - 1)


def evaluate(wo, wi):
    """f and the pdf by visible normals (Heitz 2018)."""
    wm = unit(wo + wi + np.array([0, 0, 1e-300]))
    above = (wo[:, 2] > 0) & (wi[:, 2] > 0)
    root = (wm[:, 0] / alpha[0]) ** 2 + (wm[:, 1] / alpha[1]) ** 2 + wm[:, 2] ** 2
    d = 1 / (np.pi * alpha[0] * alpha[1] * root**2)
    with np.errstate(all="ignore"):
        f = d / (1 + smith(wo) + smith(wi)) / (4 * wo[:, 2] * wi[:, 2])
        pdf = d / (1 + smith(wo)) / (4 * wo[:, 2])
    return np.where(above, f, 0), np.where(above, pdf, 0)


def sample(wo, u):
    """Normals on the half sphere of the stretched surface, seen from wo (Dupuy and Benyoub 2023); the first number is unused."""
    stretch = np.array([*alpha, 1])
    z, phi = (1 - u[:, 1]) * (1 + unit(wo * stretch)[:, 2]) - unit(wo * stretch)[:, 2], 2 * np.pi * u[:, 2]
    r = np.sqrt(np.clip(1 - z * z, 0, 1))
    wm = unit((np.stack([r * np.cos(phi), r * np.sin(phi), z], 1) + unit(wo * stretch)) * stretch)
    wi = 2 * np.sum(wo * wm, 1, keepdims=True) * wm - wo
    weight = (1 + smith(wo)) / (1 + smith(wo) + smith(wi))
    if WRONG:
        weight = 1 / (1 + smith(wi))
    return wi, weight


def answer(rows):
    for row in rows:
        print(*(float(x).hex() for x in row))  # hexadecimal is exact and fast


for request in sys.stdin:
    verb, *words = request.split()
    if verb == "etalon":
        print("etalon 1 kind=bsdf name=ggx-numpy map=1,2")
        print("alpha_x 0.3 0.001 1\nalpha_y 0.3 0.001 1")
    elif verb == "set":
        alpha = np.array([float(word) for word in words])
    elif verb == "quit":
        break
    else:
        lines = np.array([sys.stdin.readline().split() for _ in range(int(words[0]))], float)
        wo, rest = lines[:, :3], lines[:, 3:]
        if verb == "sample":
            wi, weight = sample(wo, rest)
            pdf = evaluate(wo, wi)[1]
            for w, x, p in zip(wi, weight, pdf):
                answer([[*w, x, p]]) if p > 0 else print("none")
        else:
            f, pdf = evaluate(wo, rest)
            answer(zip(f if verb == "eval" else pdf))
    print("end", flush=True)
