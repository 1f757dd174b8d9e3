# Uniform rotations as unit quaternions x, y, z, w (Shoemake 1992); the pdf is a density per share of all rotations
from math import cos, pi, sin, sqrt

domain = "rotations"


def sample(u0, u1, u2):
    a, b = sqrt(1 - u0), sqrt(u0)
    return a * sin(2 * pi * u1), a * cos(2 * pi * u1), b * sin(2 * pi * u2), b * cos(2 * pi * u2)


def pdf(x, y, z, w):
    return 1.0
