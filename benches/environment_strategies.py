#!/usr/bin/env python3
"""Efficiency, 1/(time x MSE), of the default sampling of environment maps over the best other strategy, by map and scene.

    cargo build --release
    python3 benches/environment_strategies.py target/release/etalon [--default STRATEGY] [--others NAME,...]
                              [--maps NAME,...] [--scenes NAME,...] [--spp N] [--budget SECONDS] [FILE.exr ...]

Maps: two that are built in, those made here, and the files that are given. Scenes: a diffuse sphere, metal spheres of alpha
0.1 and 0.3, and a glass sphere, all on a diffuse floor; `sphere-env` has no floor. All strategies of a row are rendered
alternating, in one run of `converge`, on one thread. Values above 1 mean that the default is the most efficient strategy.
The last column says which is the best other one, and how many times as efficient the default is as each.
"""
import argparse, json, os, random, struct, subprocess, tempfile

DEFAULT = "mis-cosine-compensated"
OTHERS = ["mis-cosine", "mis", "bsdf", "strata-16"]
BUILT_IN = ["nave", "sun"]


def pfm(path, width, height, radiance):
    """A map as a PFM file, which stores the last row first."""
    rows = [[radiance(x, y) for x in range(width)] for y in reversed(range(height))]
    with open(path, "wb") as f:
        f.write(f"PF\n{width} {height}\n-1.0\n".encode())
        f.write(b"".join(struct.pack("<3f", *rgb) for row in rows for rgb in row))


def sky(width, height, lights, level):
    """A dim blue map of uneven texels with a few bright yellow ones."""
    rng = random.Random(1)
    dim = {(x, y): rng.uniform(.5, 1.5) for y in range(height) for x in range(width)}
    return width, height, lambda x, y: (
        (level, .9 * level, .7 * level) if (x, y) in lights else tuple(c * dim[x, y] for c in (.7, .9, 1.1)))


def windows(width, height):
    """Four windows in a dark room, with positions and sizes as shares of the width."""
    def at(x, y):
        inside = [light for u, v, w, h, light in [(.12, .19, .018, .04, 25), (.41, .2, .014, .03, 40),
                  (.63, .18, .02, .036, 20), (.86, .3, .01, .012, 30)]
                  if u <= x / width < u + w and v <= y / width < v + h]
        return tuple(c * (inside or [.1])[0] for c in (1, .9, .8))
    return width, height, at


MADE = {
    "sun-8x4": lambda: sky(8, 4, {(2, 1)}, 1e5),
    "sun-16x8": lambda: sky(16, 8, {(5, 3)}, 1e5),
    "sun-64x32": lambda: sky(64, 32, {(21, 11)}, 1e5),
    "low-sun-512x256": lambda: sky(512, 256, {(200, 127)}, 1e6),
    "two-suns-512x256": lambda: sky(512, 256, {(50, 75), (350, 100), (351, 100)}, 3e5),
    "windows": lambda: windows(512, 256),
    "gradient": lambda: (256, 128, lambda x, y: tuple(c * (1 - y / 128) + .05 for c in (.4, .7, 1))),
    "constant": lambda: (64, 32, lambda x, y: (1, 1, 1)),
}

SCENE = """LookAt 0 1.1 4.2  0 .8 0  0 1 0
Camera "perspective" "float fov" [40]
Film "rgb" "integer xresolution" [80] "integer yresolution" [60]
Integrator "path" "integer maxdepth" [4]
WorldBegin
AttributeBegin
Rotate -90 1 0 0
LightSource "infinite" "string filename" ["none.exr"]
AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-6 0 6  6 0 6  6 0 -6  -6 0 -6]
AttributeBegin
Translate 0 1 0
{material}
Shape "sphere" "float radius" [1]
AttributeEnd
"""
GOLD = 'Material "conductor" "spectrum eta" ["metal-Au-eta"] "spectrum k" ["metal-Au-k"] ' \
       '"float roughness" [{0}] "bool remaproughness" [false]'
SCENES = {
    "sphere-env": None,
    "diffuse": 'Material "diffuse" "rgb reflectance" [.8 .8 .8]',
    "alpha-0.1": GOLD.format(.1),
    "alpha-0.3": GOLD.format(.3),
    "glass": 'Material "dielectric" "float eta" [1.5]',
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etalon")
    parser.add_argument("files", nargs="*")
    parser.add_argument("--default", default=DEFAULT)
    parser.add_argument("--others", type=lambda text: text.split(","), default=OTHERS)
    parser.add_argument("--maps", type=lambda text: text.split(","), default=BUILT_IN + list(MADE))
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=list(SCENES))
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--budget", type=float, default=15)
    arguments = parser.parse_intermixed_args()
    print(f"{'map':<24} {'scene':<10} {'default/best':>12} {'+-':>5}  best other (all others)", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.maps + arguments.files:
            path = name
            if name in MADE:
                path = os.path.join(folder, name + ".pfm")
                pfm(path, *MADE[name]())
            for scene in arguments.scenes:
                row(arguments, folder, path, os.path.basename(name), scene)


def row(arguments, folder, path, name, scene):
    """Measures one map in one scene."""
    file = scene
    if SCENES[scene]:
        file = os.path.join(folder, scene + ".pbrt")
        with open(file, "w") as f:
            f.write(SCENE.format(material=SCENES[scene]))
    command = [arguments.etalon, "converge", file, "--envmap", path, "-t", "1", "--json", "--quiet", "-o", folder,
               "--budget", str(arguments.budget), "--max-spp", str(arguments.spp), "--replicates", "3",
               "--strategies", ",".join([arguments.default] + arguments.others)]
    command += [] if SCENES[scene] else ["-r", "80", "80"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    curves = {curve["strategy"]: curve for curve in json.loads(done.stdout)["curves"] if curve["levels"]}
    if not curves:
        print(f"{name:<24} {scene:<10} the budget is too small", flush=True)
        return
    # Compare where all have the same number of samples.
    spp = min(curve["levels"][-1]["spp"] for curve in curves.values())
    levels = {key: next(level for level in curve["levels"] if level["spp"] == spp) for key, curve in curves.items()}
    work = {key: level["cpu_seconds"] * level["mse"]["value"] for key, level in levels.items()}
    relative = {key: work[key] / work[arguments.default] for key in arguments.others if key in work}
    best = min(relative, key=relative.get)
    # The standard error is unknown if the budget allowed one replicate only.
    errors = [(levels[key]["mse"]["standard_error"] or float("nan")) / levels[key]["mse"]["value"]
              for key in (arguments.default, best)]
    error = sum(e ** 2 for e in errors) ** .5
    others = ", ".join(f"{key} {value:.3g}" for key, value in relative.items())
    print(f"{name:<24} {scene:<10} {relative[best]:>12.2f} {error * relative[best]:>5.2f}  {best} ({others})", flush=True)


if __name__ == "__main__":
    main()
