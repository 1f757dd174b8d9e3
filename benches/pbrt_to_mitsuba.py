"""Reads the subset of pbrt-v4's scene format that `benches/scenes` is written in, for Mitsuba 3."""
import os, re
import mitsuba as mi, drjit as dr, numpy as np
from scene_assets import write_ply

rgb = lambda values: {"type": "rgb", "value": list(values)}


def source(path):
    """The text of a scene file, with the files that it includes."""
    included = lambda name: source(os.path.join(os.path.dirname(path), name[1]))
    with open(path) as f:
        return re.sub(r'^Include "(.*)"', included, f.read(), flags=re.MULTILINE)


def directives(path):
    """The directives of a scene: name, positional arguments, and parameters by name."""
    words, i = re.findall(r'"[^"]*"|[][]|[^]["#\s]+', re.sub("#.*", "", source(path))), 0
    value = lambda word: word[1:-1] if word[0] == '"' else word == "true" if word in ("true", "false") else float(word)
    while i < len(words):
        name, positional, parameters, i = words[i], [], {}, i + 1
        while i < len(words) and re.match(r'["\[\d.+-]', words[i]):
            declaration = re.fullmatch(r'"\w+ (\w+)"', words[i])
            i += bool(declaration)
            end = words.index("]", i) if words[i] == "[" else i + 1
            values = [value(word) for word in words[i:end] if word != "["]
            if declaration:
                parameters[declaration[1]] = values
            else:
                positional += values
            i = end + (words[i] == "[")
        yield name, positional, parameters


def transform(name, x):
    """The matrix of a transformation directive."""
    t = mi.ScalarTransform4f()
    if name == "LookAt":
        t = t.look_at(origin=x[:3], target=x[3:6], up=x[6:]).inverse()
    else:
        t = t.rotate(x[1:], x[0]) if name == "Rotate" else t.scale(x) if name == "Scale" else t.translate(x)
    return np.array(t.matrix, float)


class HeightCorrelated(mi.BSDF):
    """Mitsuba's rough conductor with pbrt's G(wo, wi) = 1 / (1 + Λ(wo) + Λ(wi)) in place of G₁(wo) G₁(wi)."""

    def __init__(self, props):
        super().__init__(props)
        self.alpha = [props["alpha_u"], props["alpha_v"]]
        self.kind = {"beckmann": mi.MicrofacetType.Beckmann, "ggx": mi.MicrofacetType.GGX}[props["distribution"]]
        self.separable = mi.load_dict({"type": "roughconductor", "distribution": props["distribution"],
                                       "alpha_u": self.alpha[0], "alpha_v": self.alpha[1],
                                       "eta": rgb(props["eta"]), "k": rgb(props["k"])})
        self.m_components, self.m_flags = [self.separable.flags(0)], self.separable.flags()

    def correction(self, si, wo):
        distribution, wm = mi.MicrofacetDistribution(self.kind, *self.alpha), dr.normalize(si.wi + wo)
        a, b = distribution.smith_g1(si.wi, wm), distribution.smith_g1(wo, wm)
        return dr.select(a + b > 0, dr.rcp(a + b - a * b), 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        sample, weight = self.separable.sample(ctx, si, sample1, sample2, active)
        return sample, weight * self.correction(si, sample.wo)

    def eval(self, ctx, si, wo, active=True):
        return self.separable.eval(ctx, si, wo, active) * self.correction(si, wo)

    def pdf(self, ctx, si, wo, active=True):
        return self.separable.pdf(ctx, si, wo, active)


def microfacets(p):
    """The parameters of a rough surface; alpha is what pbrt calls roughness where it is not remapped."""
    if p["remaproughness"] != [False]:
        raise ValueError("a roughness that is remapped")
    u, v = (p[name if name in p else "roughness"][0] for name in ("uroughness", "vroughness"))
    return {"distribution": p.get("distribution", ["ggx"])[0], "alpha_u": u, "alpha_v": v}


def material(kind, p):
    if kind == "dielectric":
        boundary = {"type": "dielectric", "int_ior": p["eta"][0], "ext_ior": 1.0}
        rough = any(name.endswith("roughness") for name in p)
        return boundary | microfacets(p) | {"type": "roughdielectric"} if rough else boundary
    if kind == "diffuse":
        bsdf = {"type": "diffuse", "reflectance": rgb(p["reflectance"])}
    elif kind == "mirror":
        bsdf = {"type": "conductor", "material": "none", "specular_reflectance": rgb(p["Kr"])}
    elif kind == "conductor":
        bsdf = {"type": "height-correlated", **microfacets(p),
                "eta": mi.ScalarColor3f(p["eta"]), "k": mi.ScalarColor3f(p["k"])}
    else:
        raise ValueError(f"material {kind} {p}")
    return {"type": "twosided", "bsdf": bsdf}


def shape(kind, p, to_world, folder, label):
    if kind == "sphere":
        return {"type": "sphere", "radius": p["radius"][0], "to_world": mi.ScalarTransform4f(to_world)}
    if kind == "plymesh":
        path = os.path.join(folder, p["filename"][0])
        with open(path, "rb") as f:
            has_normals = b"property float nx" in f.read(400)
    else:
        points, faces = np.reshape(p["P"], (-1, 3)), np.reshape(p["indices"], (-1, 3)).astype(int)
        a, b, c, d = points[:4]
        if faces.tolist() == [[0, 1, 2], [0, 2, 3]] and np.allclose(a + c, b + d):
            # A parallelogram: Mitsuba's rectangle is the square from -1 to 1.
            normal = np.cross(b - a, d - a)
            axes = np.stack([(b - a) / 2, (d - a) / 2, normal / np.linalg.norm(normal), (a + c) / 2], 1)
            return {"type": "rectangle", "to_world": mi.ScalarTransform4f(to_world @ np.vstack([axes, [0, 0, 0, 1]]))}
        path, normals = os.path.join(folder, f"{label}.ply"), np.reshape(p["N"], (-1, 3)) if "N" in p else None
        write_ply(path, points, faces, normals)
        has_normals = normals is not None
    to_world = mi.ScalarTransform4f(to_world)
    return {"type": "ply", "filename": path, "to_world": to_world, "face_normals": not has_normals}


def sky(image):
    """A map for Mitsuba, which interpolates bilinearly, with the first and the last row at the poles.

    Twice the resolution, with every other row on the edge between two of pbrt's constant texels, has the same
    irradiance to second order.
    """
    image = image.repeat(2, axis=1)
    rows = np.zeros((2 * len(image) + 1, *image.shape[1:]), np.float32)
    rows[1::2] = image
    rows[0], rows[2:-1:2], rows[-1] = image[0], (image[:-1] + image[1:]) / 2, image[-1]
    return mi.Bitmap(rows)


def light(kind, p, to_world, folder):
    if kind == "point":
        return {"type": "point", "position": list(to_world[:3, 3]), "intensity": rgb(p["I"])}
    if kind == "distant":
        direction = to_world[:3, :3] @ np.subtract(p["to"], p["from"])
        return {"type": "directional", "direction": list(direction), "irradiance": rgb(p["L"])}
    if "mapname" not in p:
        return {"type": "constant", "radiance": rgb(p["L"])}
    # Mitsuba's column 0 looks along -z with y up, pbrt's along +x with z up.
    turn = np.array([[0, 0, -1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    image = np.array(mi.Bitmap(os.path.join(folder, p["mapname"][0])))
    return {"type": "envmap", "bitmap": sky(image), "to_world": mi.ScalarTransform4f(to_world @ turn)}


def load(path, width, height):
    """The scene of a .pbrt file for Mitsuba, with an image of the given size."""
    mi.register_bsdf("height-correlated", HeightCorrelated)
    (folder, label), scene = os.path.split(path), {"type": "scene"}
    ctm, bsdf, emission, stack = np.eye(4), None, {}, []
    for name, x, p in directives(path):
        kind = x[0] if x else None
        if name in ("Translate", "Scale", "Rotate", "LookAt"):
            ctm = ctm @ transform(name, x)
        elif name in ("Transform", "WorldBegin"):
            ctm = np.reshape(x, (4, 4)).T if x else np.eye(4)
        elif name == "AttributeBegin":
            stack.append((ctm, bsdf, emission))
        elif name == "AttributeEnd":
            ctm, bsdf, emission = stack.pop()
        elif name == "Camera":
            # Mitsuba's x is to the left; orthographic, it shows -1 to 1 across the width, pbrt across the shorter side.
            side = width / min(width, height) if kind == "orthographic" else 1
            to_world = np.linalg.inv(ctm) @ np.diag([-side, side, 1, 1])
            view = {"fov": p["fov"][0], "fov_axis": "smaller"} if kind == "perspective" else {}
            film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}}
            scene["sensor"] = {"type": kind, "to_world": mi.ScalarTransform4f(to_world), "film": film,
                               "sampler": {"type": "multijitter"}, **view}
        elif name == "Integrator":
            # pbrt counts scatterings, Mitsuba the edges of a path.
            scene["integrator"] = {"type": "path", "max_depth": int(p["maxdepth"][0]) + 1}
        elif name == "Material":
            bsdf = material(kind, p)
        elif name == "AreaLightSource":
            emission = {"emitter": {"type": "area", "radiance": rgb(p["L"])}}
        elif name == "LightSource":
            scene[f"light{len(scene)}"] = light(kind, p, ctm, folder)
        elif name == "Shape":
            made = shape(kind, p, ctm, folder, f"{label}-{len(scene)}")
            scene[f"shape{len(scene)}"] = {**made, "bsdf": bsdf, **emission}
        elif name not in ("Film", "Sampler", "PixelFilter"):
            raise ValueError(f"{path}: {name} is not in the subset that this reader knows")
    # Merged shapes lose their bounding box, without which Mitsuba ends shadow rays to the environment too early.
    return mi.load_dict(scene, parallel=False, optimize=False)
