# The phase function of Henyey and Greenstein; wo and wi point away from the place of scattering
from math import cos, sin, sqrt, tau

g = 0.6
parameters = {"g": (0.6, -0.95, 0.95)}


def mean_cosine():
    return g


def phase(wo, wi):
    towards = sum(a * b for a, b in zip(wo, wi))
    return (1 - g * g) / (2 * tau * (1 + g * g + 2 * g * towards) ** 1.5)


pdf = phase


def sample(wo, u0, u1):
    if abs(g) < 1e-3:
        forward = 1 - 2 * u0
    else:
        forward = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u0)) ** 2) / (2 * g)
    across, phi = sqrt(max(0, 1 - forward * forward)), tau * u1
    x, y, z = wo
    # Two directions at right angles to wo (Duff et al. 2017)
    sign = 1 if z >= 0 else -1
    a = -1 / (sign + z)
    b = x * y * a
    s, t = (1 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y)
    wi = [across * (cos(phi) * i + sin(phi) * j) - forward * k for i, j, k in zip(s, t, wo)]
    value = phase(wo, wi)
    return wi, 1, value
