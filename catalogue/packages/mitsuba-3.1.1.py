# /// script
# dependencies = ["mitsuba==3.1.1", "numpy==1.26.4"]
# ///
"""A version of Mitsuba 3 with a fault of `hg` that was fixed since, by entries as those of mitsuba.py, in the functions of that version."""

import math

import mitsuba as mi
import numpy as np
from etalon_bench import Samples

from entry import run, sampler

mi.set_variant("scalar_rgb")


def phase(name, plugin, wi, factor=1.0, **options):
    """Directions of a phase function, pdfs multiplied by `factor`; samples are a pair of direction and pdf, and values are pdfs."""
    plugin, context, at = mi.load_dict(plugin), mi.PhaseFunctionContext(None), mi.MediumInteraction3f()
    at.wi = mi.Vector3f([x / math.hypot(*wi) for x in wi])
    at.sh_frame = mi.Frame3f(at.wi)

    def pdf(wo):
        return np.array([factor * plugin.eval(context, at, mi.Vector3f(w)) for w in wo.tolist()])

    def sample(u):
        drawn = [plugin.sample(context, at, float(x), mi.Point2f(float(y), float(z))) for x, y, z in np.clip(u, 2**-23, 1 - 2**-24)]
        wo, carried = np.array([np.array(w) for w, _ in drawn]), factor * np.array([p for _, p in drawn])
        asked = pdf(wo)
        # A sample's pdf may differ by rounding from that of its rounded direction
        return Samples(wo, np.where(np.abs(carried - asked) <= 1e-2 * asked, asked, carried))

    return sampler(f"scalar_rgb {name}", sample, pdf, "sphere", dimension=3, detect=0.1, **options)


run([
    phase("control/isotropic", {"type": "isotropic"}, (0, 0, 1), control="right"),
    phase("control/isotropic with a pdf of 1.2", {"type": "isotropic"}, (0, 0, 1), 1.2, control="wrong"),
    *(phase(f"phase hg {g} {wi}", {"type": "hg", "g": g}, wi) for g in (-0.8, 0.0, 0.3, 0.95) for wi in ((0, 0, 1), (0.48, 0.36, 0.8))),
])  # fmt: skip
