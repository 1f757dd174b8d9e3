# Directions of Henyey and Greenstein's phase function, over the range of its mean cosine
from math import cos, pi, sin, sqrt, tau

domain = "sphere"
parameters = {"g": (-0.95, 0.95)}
g = 0.0


def sample(u0, u1):
    s = (1 - g * g) / (1 - g + 2 * g * u0)
    z = 2 * u0 - 1 if abs(g) < 1e-6 else (1 + g * g - s * s) / (2 * g)
    r, phi = sqrt(max(0.0, 1 - z * z)), tau * u1
    return r * cos(phi), r * sin(phi), z


def pdf(x, y, z):
    return (1 - g * g) / (4 * pi * (1 + g * g - 2 * g * z) ** 1.5)
