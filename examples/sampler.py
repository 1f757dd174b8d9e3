"""A client for `etalon validate --exec 'python3 examples/sampler.py'`: cosine-weighted directions, plain Python.

With the argument `wrong` its density is that of uniform directions.
"""
import sys
from math import cos, pi, sin, sqrt, tau

WRONG = "wrong" in sys.argv[1:]


def sample(u):
    r, phi = sqrt(u[0]), tau * u[1]
    return [r * cos(phi), r * sin(phi), sqrt(1.0 - u[0])]


def pdf(w):
    return 1 / tau if WRONG else max(w[2], 0.0) / pi


def numbers(count):
    """The next lines of the input, as lists of numbers."""
    return [[float(word) for word in sys.stdin.readline().split()] for _ in range(count)]


for request in sys.stdin:
    verb, *arguments = request.split()
    if verb == "etalon":
        print("etalon 1 name=cosine-python domain=hemisphere dimension=2")
    elif verb == "sample":
        for u in numbers(int(arguments[0])):
            w = sample(u)
            print(*w, pdf(w))
    elif verb == "pdf":
        for w in numbers(int(arguments[0])):
            print(pdf(w))
    elif verb == "quit":
        break
    print("end", flush=True)
