"""Mitsuba's BSDFs that packages/mitsuba.py tests and of which confirm/mitsuba.py compares the variants."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mitsuba as mi
import numpy as np


@dataclass(frozen=True)
class Plugin:
    """`make` gives the dictionary in the variant that is set; `declared` is for etalon_bench.mitsuba.bsdf."""

    name: str
    make: Callable[[], dict[str, Any]]
    declared: dict[str, Any]


def plugin(name, dictionary, **declared):
    """The type is the name up to the comma, unless the dictionary is made by a function."""
    return Plugin(name, dictionary if callable(dictionary) else lambda: {"type": name.split(",")[0]} | dictionary, declared)


def rgb(value):
    return {"type": "rgb", "value": value}


GLASS, DIFFUSE = {"int_ior": 1.5, "ext_ior": 1.0}, {"type": "diffuse", "reflectance": rgb([0.2, 0.5, 0.8])}
METAL = {"type": "roughconductor", "alpha": 0.3, "distribution": "ggx"}
SHEET = {"base_color": rgb([0.2, 0.5, 0.8]), "roughness": 0.4}


def noise(shape, seed=1, power=1.0):
    return (np.random.default_rng(seed).random(shape) ** power).astype(np.float32)


def bitmap(channels=1, **options):
    return {"type": "bitmap", "bitmap": mi.Bitmap(noise((5, 7, channels))), "raw": True} | options


def tilted(name):
    return lambda: {
        "bumpmap": {"type": "bumpmap", "arbitrary": bitmap(wrap_mode="clamp"), "scale": 0.1, "bsdf": DIFFUSE},
        "normalmap": {"type": "normalmap", "normalmap": {"type": "bitmap", "raw": True, "bitmap": mi.Bitmap(np.full((2, 2, 3), [0.65, 0.55, 0.95], np.float32))}, "bsdf": DIFFUSE},
    }[name]  # fmt: skip


BSDFS = [
    plugin("diffuse", {"reflectance": rgb([0.2, 0.5, 0.8])}),
    *(plugin(f"roughconductor, {d}, alpha {a}", {"distribution": d, "alpha": a}) for d in ("ggx", "beckmann") for a in (0.05, 0.3, 0.7)),
    *(plugin(f"roughconductor, {d}, all normals", {"distribution": d, "alpha": 0.3, "sample_visible": False}) for d in ("ggx", "beckmann")),
    plugin("roughconductor, ggx, alpha 0.1 0.5", {"distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.5}),
    plugin("roughconductor, ggx, with 0", {"distribution": "ggx", "alpha": 0.3}, zero=True),
    *(plugin(f"roughdielectric, {d}, alpha {a}", {"distribution": d, "alpha": a, **GLASS}) for d in ("ggx", "beckmann") for a in (0.1, 0.4)),
    plugin("roughdielectric, ggx, from dense", {"distribution": "ggx", "alpha": 0.3, "int_ior": 1.0, "ext_ior": 1.5}),
    plugin("roughdielectric, ggx, all normals", {"distribution": "ggx", "alpha": 0.3, "sample_visible": False, **GLASS}),
    plugin("roughdielectric, ggx, alpha 0.1 0.5", {"distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.5, **GLASS}),
    plugin("roughdielectric, tinted", {"distribution": "ggx", "alpha": 0.3, "specular_reflectance": 0.3, "specular_transmittance": 0.9, **GLASS}),
    *(plugin(f"roughplastic, {d}", {"distribution": d, "alpha": 0.3, **GLASS}) for d in ("ggx", "beckmann")),
    plugin("roughplastic, nonlinear", {"distribution": "beckmann", "alpha": 0.1, "nonlinear": True, "diffuse_reflectance": rgb([0.2, 0.5, 0.8]), **GLASS}),
    plugin("plastic", GLASS),
    plugin("plastic, nonlinear", {"nonlinear": True, "diffuse_reflectance": rgb([0.2, 0.5, 0.8]), **GLASS}),
    plugin("dielectric", GLASS),
    plugin("dielectric, tinted", {"specular_reflectance": 0.3, "specular_transmittance": 0.9, **GLASS}),
    plugin("thindielectric", GLASS),
    plugin("conductor", {}),
    plugin("null", {}),
    plugin("principled, opaque", SHEET),
    plugin("principled, metallic anisotropic", SHEET | {"metallic": 0.7, "anisotropic": 0.6, "spec_tint": 0.3}),
    plugin("principled, transmission", SHEET | {"spec_trans": 0.6, "eta": 1.5}),
    plugin("principled, clearcoat sheen", SHEET | {"clearcoat": 0.8, "clearcoat_gloss": 0.3, "sheen": 0.6, "sheen_tint": 0.4, "flatness": 0.5}),
    plugin("principledthin", SHEET | {"spec_trans": 0.4, "diff_trans": 0.7, "eta": 1.5}),
    plugin("principledthin, flat sheen", SHEET | {"diff_trans": 1.2, "flatness": 0.5, "sheen": 0.6, "anisotropic": 0.5}),
    plugin("blendbsdf, diffuse and metal", {"weight": 0.3, "a": DIFFUSE, "b": METAL}),
    plugin("blendbsdf, diffuse and metal, with 0", {"weight": 0.3, "a": DIFFUSE, "b": METAL}, zero=True),
    plugin("blendbsdf, metal and mirror", {"weight": 0.4, "a": METAL, "b": {"type": "conductor"}}),
    plugin("blendbsdf, diffuse and glass", {"weight": 0.4, "a": DIFFUSE, "b": {"type": "dielectric", **GLASS}}, eta=1.5),
    plugin("mask, diffuse", {"opacity": 0.3, "nested": DIFFUSE}),
    plugin("mask, metal", {"opacity": 0.7, "nested": METAL}),
    plugin("mask, plastic", {"opacity": 0.7, "nested": {"type": "plastic", **GLASS}}),
    plugin("twosided, two", {"front": DIFFUSE, "back": METAL}),
    plugin("twosided, plastic", {"front": {"type": "plastic", **GLASS}}),
    plugin("bumpmap", tilted("bumpmap"), reciprocal=False),
    plugin("normalmap", tilted("normalmap"), reciprocal=False),
    *(plugin(f"hair, {long} {azimuth} {tilt}", {"longitudinal_roughness": long, "azimuthal_roughness": azimuth, "scale_tilt": tilt}, reciprocal=False)
      for long, azimuth, tilt in ((0.3, 0.3, 2.0), (0.7, 0.5, 0.0), (0.2, 0.9, 5.0))),
]  # fmt: skip
