"""Mitsuba 3's BSDFs for `etalon validate --exec 'python3 examples/bsdf_mitsuba.py PLUGIN [DISTRIBUTION]'`.

PLUGIN is a key of PLUGINS; DISTRIBUTION of microfacets is ggx or beckmann. Needs `pip install mitsuba numpy`, and LLVM.
Mitsuba's `wi` is etalon's `wo`, its values include the cosine, and a weight of 0 says that sampling failed.
"""
import sys
from itertools import islice

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
PLUGIN, DISTRIBUTION = sys.argv[1], (sys.argv[2:] or ["ggx"])[0]
ALPHA, ALBEDO, ETA = (0.3, 0.01, 1), (0.5, 0, 1), (1.5, 1.05, 2.4)
SHARE, METAL = (0, 0, 1), {"eta": (0.2, 0.1, 4), "k": (3.9, 0, 10)}
# Parameters (default value, range), and how the names of the plugin's own follow from them.
PLUGINS = {
    "roughconductor": ({"alpha_u": ALPHA, "alpha_v": ALPHA, **METAL}, lambda p: p),
    "roughdielectric": ({"alpha": ALPHA, "eta": ETA}, lambda p: {"alpha": p["alpha"], "int_ior": p["eta"], "ext_ior": 1.0}),
    "roughplastic": (
        {"alpha": ALPHA, "eta": ETA, "albedo": ALBEDO},
        lambda p: {"alpha": p["alpha"], "int_ior": p["eta"], "ext_ior": 1.0, "diffuse_reflectance": grey(p["albedo"])},
    ),
    "principled": (
        {"base": ALBEDO, "roughness": (0.5, 0.1, 1), "anisotropic": SHARE, "metallic": SHARE, "spec_trans": SHARE, "eta": ETA}
        | {"sheen": SHARE, "clearcoat": SHARE, "clearcoat_gloss": SHARE, "flatness": SHARE},
        lambda p: {"base_color": grey(p["base"])} | {key: value for key, value in p.items() if key != "base"},
    ),
    "blendbsdf": (
        {"weight": (0.5, 0, 1), "albedo": ALBEDO, "alpha": ALPHA, **METAL},
        lambda p: {
            "weight": p["weight"],
            "a": {"type": "diffuse", "reflectance": grey(p["albedo"])},
            "b": {"type": "roughconductor", "distribution": DISTRIBUTION, **{k: p[k] for k in ("alpha", "eta", "k")}},
        },
    ),
    "thindielectric": ({"eta": ETA}, lambda p: {"int_ior": p["eta"], "ext_ior": 1.0}),
}
PARAMETERS, dictionary = PLUGINS[PLUGIN]
CONTEXT, FLAGS = mi.BSDFContext(), mi.BSDFFlags


def grey(value):
    return {"type": "rgb", "value": value}


def load(values):
    own = dictionary(dict(zip(PARAMETERS, values)))
    distribution = {"distribution": DISTRIBUTION} if PLUGIN in ("roughconductor", "roughdielectric", "roughplastic") else {}
    return mi.load_dict({"type": PLUGIN, **distribution, **own})


def array(values, like):
    """An array as long as another: Mitsuba may return one number for all."""
    return np.broadcast_to(np.array(values), len(like))


def surface(wo):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(wo.T)
    return si


def evaluate(wo, wi):
    f, pdf = bsdf.eval_pdf(CONTEXT, surface(wo), mi.Vector3f(wi.T))
    cos = np.abs(wi[:, 2])
    return np.where(cos > 0, array(f[0], wo) / np.where(cos > 0, cos, 1), 0), array(pdf, wo)


def sample(wo, u):
    """wi, weight, pdf or probability, whether it is a delta lobe, and whether there is a sample."""
    # A number next to 1 must not become 1 in single precision; next to 0, visible normals of GGX can be NaN.
    u = np.clip(u, 2**-23, 1 - 2**-24)
    bs, weight = bsdf.sample(CONTEXT, surface(wo), mi.Float(u[:, 0]), mi.Point2f(u[:, 1:].T))
    wi, weight = np.array(bs.wo).T, array(weight[0], wo)
    delta = array(mi.has_flag(bs.sampled_type, FLAGS.Delta), wo)
    # The pdf of a sample must be what `pdf` returns, to the last bit; the weight says if Mitsuba used another one.
    asked = array(bsdf.pdf(CONTEXT, surface(wo), bs.wo), wo)
    pdf = np.where(delta, array(bs.pdf, wo), asked)
    return wi, weight, pdf, delta, weight != 0


def lobes(wo):
    """Found by samples with 256 numbers that choose the lobe."""
    rows = []
    for w in wo:
        u = np.full((256, 3), 0.5)
        u[:, 0] = (np.arange(256) + 0.5) / 256
        wi, weight, pdf, delta, valid = sample(np.tile(w, (256, 1)), u)
        found = {tuple(wi[i]): [*wi[i], pdf[i], weight[i] * pdf[i]] for i in np.flatnonzero(delta & valid)}
        rows.append([number for lobe in found.values() for number in lobe])
    return rows


def answer(rows):
    for row in rows:
        print(*(x if isinstance(x, str) else float(x).hex() for x in row) if len(row) else ["none"])


def properties(values):
    flags = bsdf.flags()
    sides = [mi.has_flag(flags, FLAGS.Reflection), mi.has_flag(flags, FLAGS.Transmission)]
    scatters = {(1, 0): "reflection", (0, 1): "transmission", (1, 1): "both"}[tuple(map(int, sides))]
    eta = dict(zip(PARAMETERS, values)).get("eta", 1) if PLUGIN in ("roughdielectric", "principled") else 1
    return f"scatters={scatters} delta={'yes' if mi.has_flag(flags, FLAGS.Delta) else 'no'} eta={eta}"


bsdf = load([default for default, _, _ in PARAMETERS.values()])
if __name__ == "__main__":
    for request in sys.stdin:
        verb, *words = request.split()
        if verb == "etalon":
            print(f"etalon 1 kind=bsdf name=mitsuba-{PLUGIN} precision=single")
            for name, (default, start, end) in PARAMETERS.items():
                print(name, default, start, end)
        elif verb == "set":
            values = [float(word) for word in words]
            bsdf = load(values)
            print(properties(values))
        elif verb == "quit":
            break
        else:
            numbers = np.array([line.split() for line in islice(sys.stdin, int(words[0]))], float)
            wo, rest = numbers[:, :3], numbers[:, 3:]
            if verb == "lobes":
                answer(lobes(wo))
            elif verb == "sample":
                rows = zip(*sample(wo, rest))
                answer([*["delta"] * bool(d), *wi, w, pdf] if valid else [] for wi, w, pdf, d, valid in rows)
            else:
                f, pdf = evaluate(wo, rest)
                answer(zip(f if verb == "eval" else pdf))
        print("end", flush=True)
