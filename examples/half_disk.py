# Points of the upper half of the unit disk, by a chart of its own: radius and angle
from math import atan2, cos, hypot, pi, sin, sqrt


def sample(u0, u1):
    return sqrt(u0) * cos(pi * u1), sqrt(u0) * sin(pi * u1)


def pdf(x, y):
    return 2 / pi


def to_cube(x, y):
    return hypot(x, y), atan2(y, x) / pi


def from_cube(r, turn):
    return r * cos(pi * turn), r * sin(pi * turn)


def jacobian(r, turn):
    return pi * r
