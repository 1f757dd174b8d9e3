# /// script
# dependencies = ["mitsuba==3.1.1", "numpy==1.26.4"]
# ///
"""`hg` of Mitsuba 3.1.1, and of a present version: the mean cosine of samples and of the pdf. Run it with `python -P`."""

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
is_old = mi.__version__ == "3.1.1"  # before values and pdfs were told apart
random, context = np.random.default_rng(7), mi.PhaseFunctionContext(*[None][:is_old])
at = mi.MediumInteraction3f()
at.wi = mi.Vector3f(0, 0, 1)
at.sh_frame = mi.Frame3f(at.wi)
cos = (np.arange(2000) + 0.5) / 1000 - 1
print(f"Mitsuba {mi.__version__}")
for g in (-0.8, -0.3, 0.3, 0.8):
    plugin = mi.load_dict({"type": "hg", "g": g})
    drawn = [plugin.sample(context, at, x, mi.Point2f(y, z)) for x, y, z in random.random((50_000, 3)).tolist()]
    # With wi along z the cosine of the scattering angle is -z
    mean = -np.mean([np.array(wo)[2] for wo, *_ in drawn])
    directions = [mi.Vector3f((1 - c * c) ** 0.5, 0, c) for c in cos.tolist()]
    pdf = np.array([plugin.eval(context, at, w) if is_old else plugin.eval_pdf(context, at, w)[1] for w in directions])
    print(f"g {g}: mean cosine of samples {mean:.3f}, of the pdf {-np.sum(2 * np.pi * pdf * cos) / 1000:.3f}; the pdf integrates to {np.sum(2 * np.pi * pdf) / 1000:.4f}")
