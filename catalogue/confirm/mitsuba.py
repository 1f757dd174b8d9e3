# /// script
# dependencies = ["mitsuba==3.9.1", "numpy==2.4.6", "scipy==1.17.1"]
# ///
"""What the bench says of Mitsuba 3, by NumPy and SciPy alone: `python -P mitsuba.py [CASE...]`, without names all cases.

Each case prints what was found beside what would be right. Needs LLVM, as packages/mitsuba.py.
"""

import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy import special

sys.path.append(str(Path(__file__).parents[1]))
from plugins import BSDFS

mi.set_variant("llvm_ad_rgb")
dr.set_thread_count(1)
RANDOM = np.random.default_rng(7)
CONTEXT = mi.BSDFContext()
GLASS = {"int_ior": 1.5, "ext_ior": 1.0}


def direction(degrees, azimuth=37.0):
    theta, phi = np.radians(degrees), np.radians(azimuth)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def grid(thetas=600, phis=900):
    """Directions of the sphere and their solid angles: Gauss-Legendre nodes of cos θ on each hemisphere, equal steps of φ."""
    x, w = np.polynomial.legendre.leggauss(thetas // 2)
    z, w = np.concatenate([(x - 1) / 2, (x + 1) / 2]), np.concatenate([w, w]) / 2
    phi = 2 * np.pi * (np.arange(phis) + 0.5) / phis
    r = np.sqrt(1 - z * z)[:, None]
    d = np.stack([r * np.cos(phi), r * np.sin(phi), z[:, None] + 0 * phi], -1).reshape(-1, 3)
    return d, np.repeat(w, phis) * 2 * np.pi / phis


def surface(wo):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi, si.uv, si.n = mi.Vector3f(*map(float, wo)), mi.Point2f(0.5, 0.5), mi.Normal3f(0, 0, 1)
    si.dp_du, si.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
    si.sh_frame = mi.Frame3f(si.dp_du, si.dp_dv, si.n)
    return si


def vectors(d):
    return mi.Vector3f(d.T.astype(np.float32))


def drawn(plugin, wo, n=2_000_000):
    u = np.clip(RANDOM.random((3, n)), 2**-23, 1 - 2**-24).astype(np.float32)
    bs, weight = plugin.sample(CONTEXT, surface(wo), mi.Float(u[0]), mi.Point2f(u[1:]))
    return bs, np.array(bs.wo).T, np.array(weight).T


def values(plugin, wo, d):
    return np.array(plugin.eval(CONTEXT, surface(wo), vectors(d))).T, np.array(plugin.pdf(CONTEXT, surface(wo), vectors(d)))


def all_normals():
    """Rough glass and metal with sample_visible = false: E[weight] against the albedo by quadrature of `eval`."""
    for name, more in (("roughdielectric", GLASS), ("roughconductor", {"material": "none"})):
        for kind in ("ggx", "beckmann"):
            for visible in (True, False):
                plugin = mi.load_dict({"type": name, "distribution": kind, "alpha": 0.3, "sample_visible": visible, **more})
                d, solid = grid()
                for angle in (0, 30, 60, 85):
                    wo = direction(angle)
                    f, _ = values(plugin, wo, d)
                    _, wi, weight = drawn(plugin, wo)
                    up, down = (weight[:, 0] * (wi[:, 2] > 0)).mean(), (weight[:, 0] * (wi[:, 2] < 0)).mean()
                    error = weight[:, 0].std() / len(weight) ** 0.5
                    right_up, right_down = (f[:, 0] * solid)[d[:, 2] > 0].sum(), (f[:, 0] * solid)[d[:, 2] < 0].sum()
                    # A second moment of the lobe, as scaling the roughness keeps its integral nearly
                    spread, right = (weight[:, 0] * wi[:, 2] ** 2).mean(), (f[:, 0] * solid * d[:, 2] ** 2).sum()
                    print(f"{name} {kind} visible={visible} {angle:2}°: reflected {up:.5f}, {right_up:.5f} by quadrature; transmitted {down:.5f}, {right_down:.5f}; Σ weight cos² {spread:.5f}, {right:.5f}; standard error {error:.5f}")  # fmt: skip


def rough_fiber():
    """The integral of square_to_rough_fiber_pdf, and log I0 of its code against SciPy's."""
    d, solid = grid()
    for kappa in (3.0, 11.0, 15.0, 20.0, 50.0, 200.0):
        for wi in ((0.48, 0.36, 0.8), (-0.7, 0.68, 0.218)):
            pdf = mi.warp.square_to_rough_fiber_pdf(vectors(d), mi.Vector3f(*wi), mi.Vector3f(1, 0, 0), kappa)
            print(f"kappa {kappa}, wi {wi}: the pdf integrates to {(np.array(pdf) * solid).sum():.6f}")
    for x in (12.5, 20.0, 50.0):
        code = x + 0.5 * (-np.log(2 * np.pi * x) + 1 / (8 * x))
        print(f"log I0({x}): code {code:.6f}, SciPy {np.log(special.i0e(x)) + x:.6f}, with 1/(8x) outside of the bracket {x - 0.5 * np.log(2 * np.pi * x) + 1 / (8 * x):.6f}")


def blend_delta():
    """blendbsdf with a delta lobe: how often the lobe is sampled, and the pdf that its samples carry."""
    mirror, diffuse = {"type": "conductor"}, {"type": "diffuse"}
    for weight in (0.2, 0.4, 0.7):
        plugin = mi.load_dict({"type": "blendbsdf", "weight": weight, "a": diffuse, "b": mirror})
        bs, wi, weights = drawn(plugin, direction(30), 200_000)
        delta = np.array(bs.sampled_type) & int(mi.BSDFFlags.Delta) != 0
        print(f"weight {weight}: {delta.mean():.4f} of samples are delta; they carry the pdf {np.unique(np.array(bs.pdf)[delta])}, weight {np.unique(weights[delta][:, 0])}; others the weight {np.unique(weights[~delta][:, 0].round(5))}, pdf carried/asked {np.median(np.array(bs.pdf)[~delta] / values(plugin, direction(30), wi[~delta])[1]):.4f}")  # fmt: skip


def blend_glass():
    """blendbsdf of diffuse and glass: E[weight] against the blend of the two albedos."""
    glass, diffuse = {"type": "dielectric", **GLASS}, {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.8}}
    plugin, alone = (mi.load_dict(d) for d in ({"type": "blendbsdf", "weight": 0.4, "a": diffuse, "b": glass}, glass))
    for angle in (0, 30, 60):
        _, _, weight = drawn(plugin, direction(angle), 400_000)
        _, _, of_glass = drawn(alone, direction(angle), 400_000)
        print(f"{angle}°: E[weight] {weight[:, 0].mean():.4f}, right {0.6 * 0.8 + 0.4 * of_glass[:, 0].mean():.4f}")


def integrals():
    """The integral of the pdf above and below the surface, and the share of samples of weight 0."""
    sheet = {"base_color": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.4}
    cases = {
        "roughplastic ggx": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3, **GLASS},
        "roughconductor beckmann": {"type": "roughconductor", "distribution": "beckmann", "alpha": 0.7},
        "principled": {"type": "principled", **sheet},
    }
    d, solid = grid()
    for name, dictionary in cases.items():
        plugin = mi.load_dict(dictionary)
        for angle in (0, 60, 85, 110, 150):
            _, pdf = values(plugin, direction(angle), d)
            _, _, weight = drawn(plugin, direction(angle), 500_000)
            above, below = (pdf * solid)[d[:, 2] > 0].sum(), (pdf * solid)[d[:, 2] < 0].sum()
            print(f"{name} {angle:3}°: pdf above {above:.5f}, below {below:.5f}, samples of weight 0 {(weight == 0).all(1).mean():.5f}")


def energy():
    """The albedo of `principled` with sheen and clearcoat by quadrature of `eval`."""
    sheet = {"base_color": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.4}
    d, solid = grid()
    for more in ({}, {"sheen": 0.6, "sheen_tint": 0.4}, {"clearcoat": 0.8, "clearcoat_gloss": 0.3}, {"sheen": 0.6, "sheen_tint": 0.4, "clearcoat": 0.8, "clearcoat_gloss": 0.3, "flatness": 0.5}):
        plugin = mi.load_dict({"type": "principled", **sheet, **more})
        print(more, *(f"{angle}°: {(values(plugin, direction(angle), d)[0] * solid[:, None]).sum(0).round(4)}" for angle in (60, 80, 85, 89)))


def thin_reciprocity():
    """principledthin: f(wo, wi) and f(wi, wo) of transmission."""
    plugin = mi.load_dict({"type": "principledthin", "base_color": {"type": "rgb", "value": [0.2, 0.5, 0.8]}, "roughness": 0.4, "spec_trans": 0.4, "diff_trans": 0.7, "eta": 1.5})
    for a, b in ((0, 117), (30, 150), (60, 120), (85, 100)):
        wo, wi = direction(a, 0), direction(b, 300)
        forward, back = (values(plugin, x, y[None])[0][0] / abs(y[2]) for x, y in ((wo, wi), (wi, wo)))
        print(f"wo {a}°, wi {b}°: f(wo, wi) {forward.round(6)}, f(wi, wo) {back.round(6)}")


def sggx():
    """The mean of wo by samples and by quadrature of the pdf; along the normal they agree."""
    d, solid = grid()
    s = np.tile(np.array([0.05, 0.3, 1.0, 0.02, 0.05, 0.1], np.float32), (2, 2, 2, 1))
    plugin, context = mi.load_dict({"type": "sggx", "S": {"type": "gridvolume", "grid": mi.VolumeGrid(s)}}), mi.PhaseFunctionContext()
    for wi in ((0, 0, 1), (0.48, 0.36, 0.8)):
        point = dr.zeros(mi.MediumInteraction3f)
        point.wi = mi.Vector3f(*wi)
        point.sh_frame = mi.Frame3f(point.wi)
        u = RANDOM.random((3, 1_000_000)).astype(np.float32)
        wo = np.array(plugin.sample(context, point, mi.Float(u[0]), mi.Point2f(u[1:]))[0])
        pdf = np.array(plugin.eval_pdf(context, point, vectors(d))[1])
        print(f"wi {wi}: mean of samples {wo.mean(1).round(4)}, by the pdf {((pdf * solid) @ d).round(4)}, integral {(pdf * solid).sum():.5f}")


def envmap():
    """The pdf that samples of a map carry against the one of their direction: how many differ by more than 1 %, and where."""
    for power, compensated in ((3, False), (3, True)):
        texels = (np.random.default_rng(1).random((16, 32, 3)) ** power).astype(np.float32)
        plugin = mi.load_dict({"type": "scene", "light": {"type": "envmap", "bitmap": mi.Bitmap(texels), "mis_compensation": compensated}}).emitters()[0]
        it = dr.zeros(mi.SurfaceInteraction3f)
        ds, _ = plugin.sample_direction(it, mi.Point2f(np.clip(RANDOM.random((2, 2_000_000)), 2**-23, 1 - 2**-24).astype(np.float32)))
        carried, asked, y = np.array(ds.pdf), np.array(plugin.pdf_direction(it, ds)), np.array(ds.d)[1]
        apart = np.abs(carried - asked) > 0.01 * np.abs(carried)
        print(f"compensated={compensated}: {apart.mean():.2e} of samples differ, all within {np.degrees(np.arccos(np.abs(y[apart]).min(initial=1))):.3f}° of a pole; {(asked < 0).sum()} pdfs are negative, down to {asked.min():.2g}")
        near = np.stack([np.sin(x := np.radians(RANDOM.random(400_000) * 0.2)) * np.cos(a := RANDOM.random(400_000) * 2 * np.pi), np.cos(x), np.sin(x) * np.sin(a)], 1)
        ds.d = vectors(near)
        pdf = np.array(plugin.pdf_direction(it, ds))
        print(f"  within 0.2° of the upper pole {(pdf < 0).mean():.1%} of pdfs are negative, down to {pdf.min():.2g}")


def hair():
    """E[weight] of `hair` at 0° against the integral of `eval`, and how often a coordinate of a sample is exactly 0."""
    plugin = mi.load_dict({"type": "hair", "longitudinal_roughness": 0.3, "azimuthal_roughness": 0.3, "scale_tilt": 2.0})
    d, solid = grid()
    f, pdf = values(plugin, direction(0), d)
    _, wi, weight = drawn(plugin, direction(0), 4_000_000)
    print(f"E[weight] {weight[:, 0].mean():.5f} ± {weight[:, 0].std() / len(weight) ** 0.5:.5f}, integral of eval {(f[:, 0] * solid).sum():.5f}, of the pdf {(pdf * solid).sum():.5f}; y = 0 in {(wi[:, 1] == 0).mean():.2e}")
    _, wi, _ = drawn(plugin, direction(85), 1_000_000)
    print(f"at 85° y = 0 in {(wi[:, 1] == 0).mean():.2e} of samples")


def nan():
    """NaN at single random numbers."""
    for u in ((0.5, 0.5), (0.5, 0.6)):
        print(f"square_to_beckmann({u}, 0.3) = {mi.warp.square_to_beckmann(mi.Point2f(*u), 0.3)}")
    for u in ((0.0, 0.5), (1e-6, 0.5)):
        normals = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, 0.3)
        print(f"GGX.sample({u}) = {normals.sample(mi.Vector3f(0.48, 0.36, 0.8), mi.Point2f(*u))[0]}")


def rows(function, *arguments):
    """What a function of Mitsuba's numbers, points and vectors returns, a row for each row of the arguments, in the variant that is set."""
    kinds = [(mi.Float, mi.Point2f, mi.Vector3f)[a.shape[1] - 1] for a in arguments]
    if dr.is_jit_v(mi.Float):
        found = [np.array(x, float).T for x in function(*(kind(a.T.astype(np.float32).squeeze()) for kind, a in zip(kinds, arguments)))]
        return [np.broadcast_to(x, (len(arguments[0]), *x.shape[1:])) for x in found]
    found = [function(*(kind(*row) for kind, row in zip(kinds, each))) for each in zip(*(a.tolist() for a in arguments))]
    return [np.array(column, float) for column in zip(*found)]


def variants():
    """Every BSDF of packages/mitsuba.py in scalar_rgb and llvm_ad_rgb: sample() of the same random numbers, eval() and pdf() at the same directions.

    wo is at 0° to 150°. Differences are relative, of values and weights to at least 0.1 % of the greatest, of pdfs to at least 0.001; the first number is that which 0.1 % exceed.
    """
    count, random = 1000, np.random.default_rng(7)
    u = np.clip(random.random((count, 3)), 2**-23, 1 - 2**-24)
    d = random.standard_normal((count, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    names = ("direction", "weight", "sample's pdf", "value", "pdf")
    worst = dict.fromkeys(names, (0.0, ""))
    for each in BSDFS:
        differences, apart, total = {name: [] for name in names}, 0, 0
        for angle in (0, 30, 60, 85, 110, 150):
            found, at = [], None
            for variant in ("llvm_ad_rgb", "scalar_rgb"):
                mi.set_variant(variant)
                plugin, si, context = mi.load_dict(each.make()), surface(direction(angle)), mi.BSDFContext()

                def sample(lobe, more):
                    bs, weight = plugin.sample(context, si, lobe, more)
                    return bs.wo, weight, bs.pdf, bs.sampled_component, bs.sampled_type, bs.eta

                samples = rows(sample, u[:, :1], u[:, 1:])
                # Half of the directions are those of samples
                at = np.concatenate([d, samples[0][(samples[1] != 0).any(1)]]) if at is None else at
                found.append(samples + rows(lambda w: (plugin.eval(context, si, w), plugin.pdf(context, si, w)), at))
            (wi, weight, carried, *kind, value, pdf), (wi2, weight2, carried2, *kind2, value2, pdf2) = found
            valid, valid2 = (weight != 0).any(1), (weight2 != 0).any(1)
            same = valid & valid2 & np.all([np.abs(x - y) < 1e-5 for x, y in zip(kind, kind2)], axis=0)
            total, apart = total + count, apart + (~same & (valid | valid2)).sum()
            floor = lambda x: 1e-3 * np.abs(x).max(initial=1e-30)
            pairs = ((wi[same], wi2[same], 1), (weight[same], weight2[same], floor(weight)), (carried[same], carried2[same], 1e-3), (value, value2, floor(value)), (pdf, pdf2, 1e-3))
            for name, (x, y, least) in zip(names, pairs):
                relative = np.abs(x - y) / np.maximum(np.maximum(np.abs(x), np.abs(y)), least)
                differences[name].append(relative.max(axis=tuple(range(1, x.ndim)), initial=0))
        joined = {name: np.concatenate(all_of) for name, all_of in differences.items()}
        worst = {name: max(worst[name], (x.max(initial=0), each.name)) for name, x in joined.items()}
        print(f"{each.name}: {apart} of {total} samples fail or have another component, type or eta in one variant; " + ", ".join(f"{name} {np.quantile(x, 0.999) if len(x) else 0:.1g} to {x.max(initial=0):.1g}" + (f" ({(x > 0.01).sum()} above 1 %)" if (x > 0.01).any() else "") for name, x in joined.items()))  # fmt: skip
    print("all: " + ", ".join(f"{name} to {most:.1g} ({where})" for name, (most, where) in worst.items()))


def positions():
    """Positions of a bitmap in 3.6.4, and since: the pdf that a sample carries against pdf_position at its position."""
    mi.set_variant("llvm_ad_rgb")
    values = (np.random.default_rng(1).random((5, 7, 1))).astype(np.float32)
    u = mi.Point2f(np.clip(RANDOM.random((2, 2_000_000)), 2**-23, 1 - 2**-24).astype(np.float32))
    for kind in ("bilinear", "nearest"):
        for wrap in ("repeat", "mirror", "clamp"):
            plugin = mi.load_dict({"type": "bitmap", "bitmap": mi.Bitmap(values), "raw": True, "filter_type": kind, "wrap_mode": wrap})
            x, carried = plugin.sample_position(u)
            carried, asked = np.array(carried), np.array(plugin.pdf_position(x))
            print(f"{kind}, {wrap}: {np.mean(np.abs(carried - asked) > 0.01 * asked):.2e} of samples differ by more than 1 %, the median difference is {100 * np.median(np.abs(carried / asked - 1)):.1f} %")


def blends():
    """blendbsdf and blendphase of two smooth parts, in 3.7.1 and since: the pdf that samples carry over the one that is asked for, their weights, and light of a constant map by light samples (asked) and by samples (carried) with the power heuristic."""
    metal = {"type": "roughconductor", "alpha": 0.3, "distribution": "ggx"}
    plugin = mi.load_dict({"type": "blendbsdf", "weight": 0.3, "a": {"type": "diffuse"}, "b": metal})
    d, solid = grid()
    share = lambda a, b: a * a / (a * a + b * b)
    map_pdf = 0.25 / np.pi

    def report(name, f, pdf, carried, asked, weight):
        right = (f * solid).sum()
        both = (f * solid * share(map_pdf, pdf)).sum() + (weight * share(carried, map_pdf)).mean()
        apart = np.abs(carried - asked) > 0.01 * asked
        print(f"{name}: {apart.mean():.4f} of samples differ by more than 1 %, in the median by {100 * np.median(np.abs(carried / asked - 1)):.1f} %; E[weight] {weight.mean():.4f}, integral of the value {right:.4f}; light {100 * (both / right - 1):+.2f} %")

    for angle in (0, 30, 60):
        f, pdf = values(plugin, direction(angle), d)
        bs, wi, weight = drawn(plugin, direction(angle), 500_000)
        valid = (weight != 0).any(1)
        report(f"blendbsdf {angle}°", f[:, 0], pdf, np.where(valid, bs.pdf, 1), np.where(valid, values(plugin, direction(angle), wi)[1], 1), weight[:, 0])
    plugin, context = mi.load_dict({"type": "blendphase", "weight": 0.3, "a": {"type": "hg", "g": 0.7}, "b": {"type": "rayleigh"}}), mi.PhaseFunctionContext()
    point = dr.zeros(mi.MediumInteraction3f)
    point.wi = mi.Vector3f(0.48, 0.36, 0.8)
    point.sh_frame = mi.Frame3f(point.wi)
    u = RANDOM.random((3, 500_000)).astype(np.float32)
    wo, weight, carried = plugin.sample(context, point, mi.Float(u[0]), mi.Point2f(u[1:]))
    f, pdf = (np.array(x) for x in plugin.eval_pdf(context, point, vectors(d)))
    report("blendphase", f[0], pdf, np.array(carried), np.array(plugin.eval_pdf(context, point, wo)[1]), np.array(weight)[0] * np.ones(500_000))


CASES = [all_normals, rough_fiber, blend_delta, blend_glass, integrals, energy, thin_reciprocity, sggx, envmap, hair, nan, variants, positions, blends]
for case in CASES:
    if len(sys.argv) == 1 or case.__name__ in sys.argv[1:]:
        print(f"\n{case.__name__}: {case.__doc__}")
        case()
