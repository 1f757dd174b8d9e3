# Cosine-weighted directions, with the pdf of uniform ones
from math import cos, pi, sin, sqrt, tau


def sample(u0, u1):
    r, phi = sqrt(u0), tau * u1
    return r * cos(phi), r * sin(phi), sqrt(1 - u0)


def pdf(w):
    return 1 / tau
