"""A Phong lobe beside a diffuse one, plain Python: a file for `etalon validate examples/bsdf.py`, and a program for `--exec 'python3 examples/bsdf.py'`.

With the argument `wrong` the weights of the program's samples lack the cosine.
"""
import sys
from math import cos, hypot, pi, sin, sqrt, tau

WRONG = "wrong" in sys.argv[1:]
diffuse, exponent = 0.5, 20.0
parameters = {"diffuse": (0.5, 0, 1), "exponent": (20, 1, 1000)}  # value, range
reciprocal, energy = True, "at-most-1"


def phong(wo, wi):
    """The cosine between wi and the mirror direction of wo, to the power of the exponent."""
    return max(0.0, -wo[0] * wi[0] - wo[1] * wi[1] + wo[2] * wi[2]) ** exponent


def value(wo, wi):
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    return diffuse / pi + (1 - diffuse) * (exponent + 2) / tau * phong(wo, wi)


def pdf(wo, wi):
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    return diffuse * wi[2] / pi + (1 - diffuse) * (exponent + 1) / tau * phong(wo, wi)


def sample(wo, u):
    is_diffuse = u[0] < diffuse
    z = sqrt(1 - u[1]) if is_diffuse else (1 - u[1]) ** (1 / (exponent + 1))
    r, phi = sqrt(1 - z * z), tau * u[2]
    x, y = r * cos(phi), r * sin(phi)
    if is_diffuse:
        return [x, y, z]
    # Turn the pole to the mirror direction of wo.
    a, b, c = -wo[0], -wo[1], wo[2]
    flat = hypot(a, b)
    s, t = (a / flat, b / flat) if flat else (1.0, 0.0)
    along = x * c + z * flat
    return [along * s - y * t, along * t + y * s, z * c - x * flat]


def answer(verb, numbers):
    wo, rest = numbers[:3], numbers[3:]
    if verb == "eval":
        return [value(wo, rest)]
    if verb == "pdf":
        return [pdf(wo, rest)]
    wi = sample(wo, rest)
    p = pdf(wo, wi)
    return [*wi, value(wo, wi) * (1 if WRONG else wi[2]) / p, p] if p > 0 else ["none"]


def serve():
    global diffuse, exponent
    for request in sys.stdin:
        verb, *words = request.split()
        if verb == "etalon":
            print("etalon 1 kind=bsdf name=phong-python reciprocal=yes energy=at-most-1 dimension=3")
            for name, (default, low, high) in parameters.items():
                print(name, default, low, high)
        elif verb == "set":
            diffuse, exponent = map(float, words)
        elif verb == "quit":
            break
        else:
            for _ in range(int(words[0])):
                print(*answer(verb, [float(word) for word in sys.stdin.readline().split()]))
        print("end", flush=True)


if __name__ == "__main__":
    serve()
