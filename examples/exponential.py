# Free-flight distances in a medium of extinction 2; domain could also be given by --domain
from math import exp, log

domain = "half-line"


def sample(u):
    return -log(1 - u) / 2


def pdf(t):
    return 2 * exp(-2 * t)
