"""Mitsuba 3's microfacet normals, for `etalon validate --exec 'python3 examples/sampler_mitsuba.py TYPE ALPHA ANGLE KIND'`.

TYPE is beckmann or ggx, ANGLE is that of wi in degrees, KIND is visible or all. Needs `pip install mitsuba`.
"""
import math
import sys
from itertools import islice

import mitsuba as mi

mi.set_variant("scalar_rgb")
TYPE, ALPHA, ANGLE, KIND = sys.argv[1], float(sys.argv[2]), math.radians(float(sys.argv[3])), sys.argv[4]
NORMALS = mi.MicrofacetDistribution(
    {"beckmann": mi.MicrofacetType.Beckmann, "ggx": mi.MicrofacetType.GGX}[TYPE], ALPHA, KIND == "visible"
)
WI = mi.Vector3f(math.sin(ANGLE), 0, math.cos(ANGLE))


def points(count):
    """The next lines of the input as lists of numbers."""
    return [[float(word) for word in line.split()] for line in islice(sys.stdin, count)]


def answer(rows):
    """Prints rows of numbers in hexadecimal, which is exact."""
    print("\n".join(" ".join(float(x).hex() for x in row) for row in rows))


def sample(u):
    # A number next to 1 must not become 1 in single precision.
    m, _ = NORMALS.sample(WI, mi.Point2f([min(x, 1 - 2**-24) for x in u]))
    return m.x, m.y, m.z


for line in sys.stdin:
    request = line.split()
    if request[0] == "etalon":
        print(f"etalon 1 name=mitsuba/{TYPE}/{KIND} domain=sphere dimension=2")
    elif request[0] == "sample":
        answer(sample(u) for u in points(int(request[1])))
    elif request[0] == "pdf":
        answer([NORMALS.pdf(WI, mi.Vector3f(w))] for w in points(int(request[1])))
    elif request[0] == "quit":
        break
    print("end", flush=True)
