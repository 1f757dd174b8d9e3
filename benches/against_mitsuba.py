#!/usr/bin/env python3
"""Time x MSE of `etalon render` and of Mitsuba 3 on the same scenes, alternating, at equal depth, resolution and samples.

    cargo build --release
    python3 -m venv venv && venv/bin/pip install mitsuba numpy     # its LLVM variant also wants libLLVM
    venv/bin/python benches/against_mitsuba.py target/release/etalon [SPP] [SCENE,...]

Every scene is written once as a .pbrt file and built once as a Mitsuba dictionary, from the same numbers. Mitsuba runs its
LLVM variant with the multijitter sampler (the better of its samplers on all of these), its kernels compiled beforehand.
Times are those of rendering alone, as either program reports them, the quickest of three. The MSE is half the mean squared
difference of renders with different seeds, which needs no reference; the means of both are printed beside it.
"""
import json, math, os, subprocess, sys, tempfile, time
import mitsuba as mi, drjit as dr, numpy as np

WIDTH, HEIGHT, ROUNDS = 480, 360, 3
ETA, K = [0.15557, 0.42415, 1.3831], [3.6024, 2.4721, 1.9155]           # gold
WHITE, RED, BLUE = [.6] * 3, [.6, .05, .05], [.05, .05, .6]
WALLS = [  # corners counter-clockwise from inside, albedo
    ([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], WHITE),
    ([[-1, 1.5, -1], [1, 1.5, -1], [1, 1.5, 1], [-1, 1.5, 1]], WHITE),
    ([[-1, 0, -1], [1, 0, -1], [1, 1.5, -1], [-1, 1.5, -1]], WHITE),
    ([[-1, 0, 1], [-1, 0, -1], [-1, 1.5, -1], [-1, 1.5, 1]], RED),
    ([[1, 0, -1], [1, 0, 1], [1, 1.5, 1], [1, 1.5, -1]], BLUE),
]
AREA_LIGHT = [[-.35, 1.495, -.25], [.35, 1.495, -.25], [.35, 1.495, .25], [-.35, 1.495, .25]]
FOV = 45.0                                                              # horizontal, degrees


def knot(path, around=1000, across=50):
    """A torus knot of 100,000 triangles as a binary PLY file."""
    t = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    line = lambda t: np.hstack([(2 + np.cos(3 * t)) * np.cos(2 * t), np.sin(3 * t), (2 + np.cos(3 * t)) * np.sin(2 * t)]) / 2
    unit = lambda v: v / np.linalg.norm(v, axis=1, keepdims=True)
    tangent = unit(line(t + 1e-4) - line(t - 1e-4))
    side = unit(np.cross(tangent, line(t) + [0, 3, 0]))
    angle = np.linspace(0, 2 * np.pi, across, endpoint=False)
    normal = np.cos(angle)[None, :, None] * np.cross(side, tangent)[:, None] + np.sin(angle)[None, :, None] * side[:, None]
    place = .25 * (line(t)[:, None] + .28 * normal) + [0, .55, 0]
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    at = lambda di, dj: ((i + di) % around * across + (j + dj) % across).ravel()
    faces = np.concatenate([np.stack([at(0, 0), at(1, 1), at(1, 0)], 1), np.stack([at(0, 0), at(0, 1), at(1, 1)], 1)])
    records = np.zeros(len(faces), dtype=[("n", "u1"), ("i", "<i4", (3,))])
    records["n"], records["i"] = 3, faces
    names = "".join(f"property float {n}\n" for n in "x y z nx ny nz".split())
    with open(path, "wb") as f:
        f.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {around * across}\n{names}element face {len(faces)}\n"
                 "property list uchar int vertex_indices\nend_header\n").encode())
        f.write(np.concatenate([place, normal], -1).astype("<f4").tobytes())
        f.write(records.tobytes())


def sky(path):
    """A dim map with four windows and a sun of nine texels, as an EXR file."""
    image = np.full((512, 1024, 3), .1, np.float32) * np.array([.85, .95, 1.1], np.float32)
    for x, y, w, h, light in [(120, 190, 18, 40, 25), (420, 200, 14, 30, 40), (640, 180, 20, 36, 20), (880, 300, 10, 12, 30)]:
        image[y:y + h, x:x + w] = light
    image[100:103, 250:253] = 12000
    mi.Bitmap(image).write(path)


def rgb(c): return {"type": "rgb", "value": list(c)}
def numbers(c): return "[" + " ".join(repr(float(x)) for x in np.ravel(c)) + "]"


def scene(name, depth, folder):
    """The scene as pbrt text and as a Mitsuba dictionary; `depth` counts scatterings (Mitsuba: edges of the path)."""
    eye, at = ([0, 0, 4], [0, 0, 0]) if name == "sphere-env" else ([0, .75, 3.45], [0, .75, 0])
    short = 2 * math.degrees(math.atan(math.tan(math.radians(FOV / 2)) * HEIGHT / WIDTH))
    text = [f"Scale -1 1 1\nLookAt {' '.join(map(str, eye + at))} 0 1 0", f'Camera "perspective" "float fov" {short!r}',
            f'Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT} "string filename" "x.exr"',
            'PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5', 'Sampler "independent" "integer pixelsamples" 1',
            f'Integrator "path" "integer maxdepth" {depth}', "WorldBegin"]
    tree = {"type": "scene", "integrator": {"type": "path", "max_depth": depth + 1, "hide_emitters": name == "sphere-env"},
            "sensor": {"type": "perspective", "fov": FOV, "fov_axis": "x", "sampler": {"type": "multijitter"},
                       "to_world": mi.ScalarTransform4f().look_at(origin=eye, target=at, up=[0, 1, 0]),
                       "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}}}}
    sphere = lambda c, r, bsdf: {"type": "sphere", "center": c, "radius": r, "bsdf": bsdf}
    place = lambda material, c, r: text.append(
        f'AttributeBegin\nMaterial {material}\nTranslate {c[0]} {c[1]} {c[2]}\nShape "sphere" "float radius" {r}\nAttributeEnd')
    if name == "sphere-env":
        sky(os.path.join(folder, "sky.exr"))
        # Mitsuba's column 0 looks along +z, pbrt's along +x with z up.
        text.append('AttributeBegin\nTransform [0 0 -1 0  1 0 0 0  0 1 0 0  0 0 0 1]\nLightSource "infinite" "string mapname" '
                    '"sky.exr"\nAttributeEnd\nMaterial "diffuse" "rgb reflectance" [1 1 1]\nShape "sphere" "float radius" 1')
        tree["sky"] = {"type": "envmap", "filename": os.path.join(folder, "sky.exr")}
        tree["sphere"] = sphere([0, 0, 0], 1, {"type": "diffuse", "reflectance": rgb([1, 1, 1])})
        return "\n".join(text), tree
    quad = lambda corners: f'Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" {numbers(corners)}'
    for i, (corners, albedo) in enumerate(WALLS + [(AREA_LIGHT, [0, 0, 0])]):
        emission = 'AreaLightSource "diffuse" "rgb L" [10 10 10]\n' if corners is AREA_LIGHT else ""
        text.append(f'AttributeBegin\n{emission}Material "diffuse" "rgb reflectance" {numbers(albedo)}\n{quad(corners)}\nAttributeEnd')
        c = np.array(corners, float)
        x, y, centre = (c[1] - c[0]) / 2, (c[3] - c[0]) / 2, c.mean(0)
        z = np.cross(x, y)
        frame = np.eye(4)
        frame[:3] = np.stack([x, y, z / np.linalg.norm(z), centre], 1)
        tree[f"wall{i}"] = {"type": "rectangle", "to_world": mi.ScalarTransform4f(frame),
                            "bsdf": {"type": "diffuse", "reflectance": rgb(albedo)}}
        if corners is AREA_LIGHT:
            tree[f"wall{i}"]["emitter"] = {"type": "area", "radiance": rgb([10, 10, 10])}
    if name.startswith("spheres"):
        place('"mirror" "rgb Kr" [1 1 1]', [-.42, .33, -.35], .33)
        place('"dielectric" "float eta" 1.45', [.42, .33, .3], .33)
        tree["mirror"] = sphere([-.42, .33, -.35], .33, {"type": "conductor", "material": "none"})
        tree["glass"] = sphere([.42, .33, .3], .33, {"type": "dielectric", "int_ior": 1.45, "ext_ior": 1.0})
        return "\n".join(text), tree
    alpha = .25 if name == "mesh" else float(name.removeprefix("alpha-"))
    metal = (f'"conductor" "rgb eta" {numbers(ETA)} "rgb k" {numbers(K)} "float roughness" {alpha} '
             '"bool remaproughness" false "string distribution" "beckmann"')
    bsdf = {"type": "roughconductor", "distribution": "beckmann", "alpha": alpha, "eta": rgb(ETA), "k": rgb(K)}
    if name == "mesh":
        path = os.path.join(folder, "knot.ply")
        knot(path)
        text.append(f'Material {metal}\nShape "plymesh" "string filename" "knot.ply"')
        tree["metal"] = {"type": "ply", "filename": path, "bsdf": bsdf}
    else:
        place(metal, [0, .5, 0], .45)
        tree["metal"] = sphere([0, .5, 0], .45, bsdf)
    return "\n".join(text), tree


def mse(images, where):
    pairs = [(a, b) for i, a in enumerate(images) for b in images[:i]]
    return float(np.mean([((a - b) ** 2).mean(-1)[where].mean() / 2 for a, b in pairs]))


def main():
    program, spp = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 64
    scenes = {"spheres-5": 4, "spheres-100": 99, "alpha-0.005": 4, "alpha-0.05": 4, "alpha-0.25": 4, "alpha-0.5": 4,
              "mesh": 4, "sphere-env": 1}
    wanted = sys.argv[3].split(",") if len(sys.argv) > 3 else scenes
    mi.set_variant("llvm_ad_rgb")
    print("| scene | Mitsuba s | MSE | etalon s | MSE | time x MSE, ratio | means |\n|---|---|---|---|---|---|---|")
    for name in wanted:
        with tempfile.TemporaryDirectory() as folder:
            text, tree = scene(name, scenes[name], folder)
            source, image_path = os.path.join(folder, "scene.pbrt"), os.path.join(folder, "image.exr")
            open(source, "w").write(text)
            loaded = mi.load_dict(tree)
            dr.eval(mi.render(loaded, spp=4)); dr.sync_thread()
            theirs, ours, times = [], [], ([], [])
            for seed in range(1, ROUNDS + 1):
                start = time.perf_counter()
                image = mi.render(loaded, spp=spp, seed=seed)
                dr.eval(image); dr.sync_thread()
                times[0].append(time.perf_counter() - start)
                theirs.append(np.array(image, dtype=np.float64))
                run = subprocess.run([program, "render", source, "-s", str(spp), "-l", "1", "--seed", str(seed), "--json",
                                      "-o", image_path], capture_output=True, text=True, check=True)
                times[1].append(json.loads(run.stdout)["seconds"])
                ours.append(np.array(dict(mi.Bitmap(image_path).split())["<root>"], dtype=np.float64))
        # Under the sky the two show different backgrounds: only the sphere counts, without its silhouette.
        where = np.ones((HEIGHT, WIDTH), bool)
        if name == "sphere-env":
            lit = theirs[0].sum(-1) > 0
            where[1:-1, 1:-1] = lit[1:-1, 1:-1] & lit[2:, 1:-1] & lit[:-2, 1:-1] & lit[1:-1, 2:] & lit[1:-1, :-2]
            where[[0, -1]] = False; where[:, [0, -1]] = False
        a, b = (min(times[0]), mse(theirs, where)), (min(times[1]), mse(ours, where))
        means = [np.mean(images, 0)[where].mean() for images in (theirs, ours)]
        print(f"| {name} | {a[0]:.2f} | {a[1]:.2e} | {b[0]:.2f} | {b[1]:.2e} | {b[0] * b[1] / (a[0] * a[1]):.2f} "
              f"| {means[0]:.4f} {means[1]:.4f} |", flush=True)


if __name__ == "__main__":
    main()
