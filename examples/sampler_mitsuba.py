"""Mitsuba 3's microfacet normals, for `etalon validate --exec 'python3 examples/sampler_mitsuba.py TYPE ALPHA ANGLE KIND'`.

TYPE is beckmann or ggx, ANGLE is that of wi in degrees, KIND is visible or all. Needs `pip install mitsuba numpy`.
"""
import sys
from itertools import islice

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
TYPE, ALPHA, ANGLE, KIND = sys.argv[1], float(sys.argv[2]), np.radians(float(sys.argv[3])), sys.argv[4]
NORMALS = mi.MicrofacetDistribution(
    {"beckmann": mi.MicrofacetType.Beckmann, "ggx": mi.MicrofacetType.GGX}[TYPE], ALPHA, KIND == "visible"
)
WI = mi.Vector3f(float(np.sin(ANGLE)), 0, float(np.cos(ANGLE)))


def numbers(count):
    """The next lines of the input, a column of single-precision numbers for each."""
    rows = np.array("".join(islice(sys.stdin, count)).split(), dtype=float).reshape(count, -1)
    return rows.astype(np.float32).T


def answer(columns):
    """Prints columns of numbers in hexadecimal, which is exact."""
    columns = [map(float.hex, np.asarray(column, dtype=float).tolist()) for column in columns]
    print("\n".join(map(" ".join, zip(*columns))))


for line in sys.stdin:
    request = line.split()
    if request[0] == "etalon":
        print(f"etalon 1 name=mitsuba/{TYPE}/{KIND} domain=sphere dimension=2")
    elif request[0] == "sample":
        # A number next to 1 must not become 1 in single precision.
        u = np.minimum(numbers(int(request[1])), np.float32(1 - 2**-24))
        m, _ = NORMALS.sample(WI, mi.Point2f(u))
        answer([m.x, m.y, m.z])
    elif request[0] == "pdf":
        answer([NORMALS.pdf(WI, mi.Vector3f(numbers(int(request[1]))))])
    elif request[0] == "quit":
        break
    print("end", flush=True)
