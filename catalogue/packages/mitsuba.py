# /// script
# dependencies = ["mitsuba==3.9.1"]
# ///
"""Mitsuba 3: BSDFs, phase functions, emitters, textures, warps, microfacet normals, distributions and spectra, in two variants each.

The vectorized variants want LLVM 16 or newer (DRJIT_LIBLLVM_PATH). Names begin with the variant: scalar_rgb, llvm_ad_rgb and, for
spectra, scalar_spectral, llvm_ad_spectral. BSDFs run in llvm_ad_rgb, for the time of it: `confirm/mitsuba.py variants` compares the samples
of equal random numbers, values and pdfs of all of them with those of scalar_rgb. Not subjects: emitters in delta directions or at points (point,
spot, directional, directionalarea, projector), BSDFs of polarized light, and `measured`, whose data are not part of the package.
"""

import importlib
import os
import sys

os.environ.setdefault("DRJIT_NUM_THREADS", "1")

import mitsuba as mi
import numpy as np

from entry import Entry, bsdf, run, sampler
from plugins import BSDFS, bitmap, noise

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")
OBLIQUE, GRAZING = (0.48, 0.36, 0.8), (-0.7, 0.68, 0.218)
mi.set_variant("scalar_rgb")
etalon = importlib.import_module("etalon_bench.mitsuba")


def lazily(variant, name, domain, make, wrap, control="", convention="", **options):
    """An entry whose objects are made in its variant when it runs."""

    def check(seed, figure):
        mi.set_variant(variant)
        return wrap(name, make, options).check(seed, figure)

    return Entry(f"{variant} {name}", domain, check, control, convention)


def samplers(name, domain, make, variants=VARIANTS, **options):
    wrap = lambda name, make, options: sampler(name, **{**make(), **options})
    # A scalar variant takes one sample after the other
    return [lazily(variant, name, domain, make, wrap, **({"detect": 0.1} if variant.startswith("scalar") else {}) | options) for variant in variants]


def bsdfs(name, make, variants=VARIANTS[1:], control="", **declared):
    wrap = lambda name, make, options: bsdf(name, etalon.bsdf(make(), **declared), **options)
    return [lazily(variant, name, "bsdf", make, wrap, control, detect=0.1) for variant in variants]


SGGX = {"round": (0.5, 0.5, 0.5, 0, 0, 0), "flat": (0.05, 0.3, 1.0, 0.02, 0.05, 0.1), "fibre": (1.0, 1.0, 0.05, 0, 0, 0)}
sggx = lambda s: {"type": "sggx", "S": {"type": "gridvolume", "grid": mi.VolumeGrid(np.tile(np.array(SGGX[s], np.float32), (2, 2, 2, 1)))}}
PHASES = {
    "isotropic": lambda: {"type": "isotropic"},
    "rayleigh": lambda: {"type": "rayleigh"},
    **{f"hg {g}": lambda g=g: {"type": "hg", "g": g} for g in (-0.8, 0.0, 0.3, 0.95)},
    "tabphase": lambda: {"type": "tabphase", "values": "0.2, 0.1, 0.3, 0.7, 2.0"},
    "tabphase with zeros": lambda: {"type": "tabphase", "values": "0, 0, 1, 0.2, 0"},
    "blendphase": lambda: {"type": "blendphase", "weight": 0.3, "a": {"type": "hg", "g": 0.7}, "b": {"type": "rayleigh"}},
    **{f"sggx {s}": lambda s=s: sggx(s) for s in SGGX},
}


def microfacets(kind, alpha, visible, wi):
    return lambda: etalon.microfacets(mi.MicrofacetDistribution(getattr(mi.MicrofacetType, kind), *alpha, visible), wi)


def placed(shape, **light):
    turned = mi.ScalarTransform4f().translate([0.3, 0.5, 2]).rotate([0.96, 0.28, 0], 160)
    return {"type": shape, "to_world": turned, "emitter": {"type": "area"} | light}


def sky(**options):
    return {"type": "sunsky", "sun_direction": [0.5, 0.3, 0.7], "turbidity": 4.0} | options


def envmap(width, height, power, **options):
    turned = mi.ScalarTransform4f().rotate([0.48, 0.6, 0.64], 50)
    return {"type": "envmap", "bitmap": mi.Bitmap(noise((height, width, 3), power=power)), "to_world": turned} | options


EMITTERS = {
    "constant": lambda: {"type": "constant"},
    "envmap 32x16": lambda: envmap(32, 16, 3),
    "envmap 9x7": lambda: envmap(9, 7, 8),
    "envmap 32x16, compensated": lambda: envmap(32, 16, 3, mis_compensation=True),
    "sunsky, sky": lambda: sky(sun_scale=0.0),
    "sunsky, wide sun": lambda: sky(sun_aperture=30.0),
    "sunsky, turbidity 9": lambda: sky(sun_scale=0.0, turbidity=9.0),
    "timed_sunsky, sky": lambda: {"type": "timed_sunsky", "sun_scale": 0.0},
    **{f"area, {shape}": lambda shape=shape: placed(shape) for shape in ("rectangle", "disk", "cube", "cylinder")},
    "area, textured rectangle": lambda: placed("rectangle", radiance=bitmap(3)),
    "area, sphere": lambda: {"type": "sphere", "center": [1, 2, 3], "emitter": {"type": "area"}},
    "area, sphere from within": lambda: {"type": "sphere", "center": [0.3, 0.2, 0.1], "flip_normals": True, "emitter": {"type": "area"}},
}

N1, N2 = (0.0, 0.6, 0.8), (0.6, 0.0, 0.8)
WARPS = [
    ("uniform_disk", "disk"), ("uniform_disk_concentric", "disk"), ("uniform_sphere", "sphere"), ("uniform_hemisphere", "hemisphere"),
    ("cosine_hemisphere", "hemisphere"), *(("beckmann", "hemisphere", a) for a in (0.05, 0.5, 1.0)), ("std_normal", "plane"),
    *(("von_mises_fisher", "sphere", k) for k in (0.1, 3.0, 20.0, 1000.0)), ("tent", "box:-1,1,-1,1"), ("uniform_triangle", "triangle"),
]  # fmt: skip


ASKED = "the pdf does not ask whether the direction is inside: the caller does, and so does the entry"


def cone(cos):
    return etalon.sampler(lambda u: mi.warp.square_to_uniform_cone(u, cos), lambda w: dr_select(w.z >= cos, mi.warp.square_to_uniform_cone_pdf(w, cos)), "sphere")


def dr_select(condition, value):
    return importlib.import_module("drjit").select(condition, value, 0)


def lune():
    normals = [mi.Normal3f(n) for n in (N1, N2)]
    return etalon.sampler(lambda u: mi.warp.square_to_uniform_spherical_lune(u, *normals), lambda w: dr_select(mi.Bool(w @ normals[0] > 0) ^ mi.Bool(w @ normals[1] > 0), mi.warp.square_to_uniform_spherical_lune_pdf(w, *normals)), "sphere")


def fibre(kappa, wi):
    directions = [mi.Vector3f(wi), mi.Vector3f(1, 0, 0)]
    return etalon.sampler(lambda u: mi.warp.square_to_rough_fiber(mi.Point3f(u), *directions, kappa), lambda w: mi.warp.square_to_rough_fiber_pdf(w, *directions, kappa), "sphere", dimension=3)


def bilinear(*corners):
    mean = sum(corners) / 4
    return etalon.sampler(lambda u: mi.warp.square_to_bilinear(*corners, u)[0], lambda x: mi.warp.square_to_bilinear_pdf(*corners, x) / mean, "square")


def tabulated(kind, levels=0):
    """A distribution over the square by a table, for a parameter between two of its tables."""
    values = noise((*(3,) * levels, 5, 6), power=3)
    made = getattr(mi, f"{kind}2D{levels}")(values, *([[[0.0, 1.0, 3.0]] * levels] if levels else []))
    at = [[0.3, 2.2][:levels]] if levels else []
    return etalon.sampler(lambda u: made.sample(u, *at), lambda x: made.eval(x, *at), "square")


def line(kind):
    low, high, values = 1.0, 4.0, [0.3, 2.0, 0.0, 1.0, 0.1]
    made = mi.ContinuousDistribution([low, high], values) if kind == "regular" else mi.IrregularContinuousDistribution([1, 1.2, 2.5, 2.6, 4], values)
    return etalon.sampler(lambda u: made.sample_pdf(u), made.eval_pdf_normalized, f"interval:{low},{high}", dimension=1)


def discrete():
    made = mi.DiscreteDistribution([0.3, 2.0, 0.0, 1.0, 0.1])
    return etalon.sampler(lambda u: made.sample_pmf(u), lambda i: made.eval_pmf_normalized(mi.UInt32(i)), "discrete:5", dimension=1)


def spectrum(plugin):
    made = mi.load_dict(plugin)

    def sample(u):
        si = importlib.import_module("drjit").zeros(mi.SurfaceInteraction3f)
        wavelengths, weight = made.sample_spectrum(si, mi.Spectrum(u))
        si.wavelengths = wavelengths
        return wavelengths[0], made.pdf_spectrum(si)[0]

    def pdf(x):
        si = importlib.import_module("drjit").zeros(mi.SurfaceInteraction3f)
        si.wavelengths = mi.Spectrum(x)
        return made.pdf_spectrum(si)[0]

    return etalon.sampler(sample, pdf, "interval:360,830", dimension=1)


SPECTRA = {  # without `uniform`, which has no pdf
    "regular": {"type": "regular", "wavelength_min": 400, "wavelength_max": 700, "values": "0.1, 1, 0.3, 0.7"},
    "irregular": {"type": "irregular", "wavelengths": "380, 400, 550, 800", "values": "0.1, 1, 0.3, 0.7"},
    "blackbody": {"type": "blackbody", "temperature": 3000.0},
    "d65": {"type": "d65"},
}


def wrong_cosine():
    right = etalon.warp("square_to_cosine_hemisphere", domain="hemisphere")
    return right | {"pdf": lambda w: 0.5 / np.pi + 0 * w[:, 2]}


ENTRIES = [
    *samplers("control/cosine", "hemisphere", lambda: etalon.warp("square_to_cosine_hemisphere", domain="hemisphere"), control="right"),
    *samplers("control/cosine with a uniform pdf", "hemisphere", wrong_cosine, control="wrong"),
    *bsdfs("diffuse, control", lambda: {"type": "diffuse"}, control="right"),
    *bsdfs("diffuse, control, said to be white", lambda: {"type": "diffuse"}, control="wrong", energy="conserved:0.01"),
    *(samplers(f"warp {name} {' '.join(map(str, a))}".strip(), domain, lambda name=name, domain=domain, a=a: etalon.warp(f"square_to_{name}", *a, domain=domain)) for name, domain, *a in WARPS),
    *(samplers(f"warp uniform_cone {c}", "sphere", lambda c=c: cone(c), convention=ASKED) for c in (0.3, 0.99)),
    samplers("warp uniform_spherical_lune", "sphere", lune, convention=ASKED),
    *(samplers(f"warp rough_fiber {k}, {w}", "sphere", lambda k=k, w=w: fibre(k, w)) for k in (3.0, 50.0) for w in (OBLIQUE, GRAZING)),
    samplers("warp bilinear", "square", lambda: bilinear(0.1, 2.0, 0.7, 1.2)),
    samplers("warp interval_to_linear", "line", lambda: etalon.sampler(lambda u: mi.warp.interval_to_linear(0.2, 1.8, u), lambda x: 0.2 + 1.6 * x, "line", dimension=1)),
    samplers("warp interval_to_tent", "interval:-1,1", lambda: etalon.sampler(mi.warp.interval_to_tent, lambda x: 1 - abs(x), "interval:-1,1", dimension=1)),
    *(samplers(f"microfacets {k} {a} {'visible' if v else 'all'} {w}", "hemisphere", microfacets(k, a, v, w))
      for k in ("GGX", "Beckmann") for a in ((0.1,), (0.5,), (0.1, 0.6)) for v in (True, False) for w in (OBLIQUE, GRAZING)),
    samplers("microfacets GGX visible, with 0", "hemisphere", lambda: etalon.microfacets(mi.MicrofacetDistribution(mi.MicrofacetType.GGX, 0.3), OBLIQUE, zero=True)),
    *(samplers(f"phase {name} {w}", "sphere", lambda make=make, w=w: etalon.phase(make(), w)) for name, make in PHASES.items() for w in ((0, 0, 1), OBLIQUE)),
    *(samplers(f"emitter {name}", "sphere", lambda make=make: etalon.emitter(make()), VARIANTS[not name.startswith(("constant", "envmap 9")):], detect=0.05) for name, make in EMITTERS.items()),
    *(samplers(f"texture bitmap {f} {w}", "square", lambda f=f, w=w: etalon.texture(bitmap(filter_type=f, wrap_mode=w)))
      for f in ("bilinear", "nearest") for w in ("repeat", "mirror", "clamp")),
    samplers("texture checkerboard", "square", lambda: etalon.texture({"type": "checkerboard"})),
    *(samplers(f"{kind}2D{levels}", "square", lambda kind=kind, levels=levels: tabulated(kind, levels))
      for kind in ("Hierarchical", "MarginalContinuous", "MarginalDiscrete") for levels in (0, 1, 2)),
    *(samplers(f"{kind} distribution", "interval:1,4", lambda kind=kind: line(kind)) for kind in ("regular", "irregular")),
    samplers("DiscreteDistribution", "discrete:5", discrete),
    *(samplers(f"spectrum {name}", "interval:360,830", lambda plugin=plugin: spectrum(plugin), ("scalar_spectral", "llvm_ad_spectral")) for name, plugin in SPECTRA.items()),
    *(bsdfs(each.name, each.make, **each.declared) for each in BSDFS),
]  # fmt: skip

# What Mitsuba's own code prints goes to standard error
sys.stdout = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
run([entry for item in ENTRIES for entry in (item if isinstance(item, list) else [item])])
