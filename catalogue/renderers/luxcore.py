# /// script
# dependencies = ["pyluxcore==2.11.2", "numpy"]
# ///
"""Renders the built-in scenes cornell-lambert and sphere-env with LuxCore's path tracer on the CPU, for `etalon converge --renderer`:

    luxcore.py SCENE SPP SEED OUT THREADS WIDTH HEIGHT [MAP.exr]

MAP.exr is the scene's map, envmaps/nave.exr. What is matched, and how, stands beside the lines that do it.
"""

import os
import sys
import time

import numpy as np
import pyluxcore

scene_name, spp, seed, out, threads, width, height, *maps = sys.argv[1:]
spp, seed, threads, width, height = (int(word) for word in (spp, seed, threads, width, height))
pyluxcore.Init(lambda text: None)
scene, properties = pyluxcore.Scene(), pyluxcore.Properties()


def matte(name, rgb, radiance=None):
    properties.Set(pyluxcore.Property(f"scene.materials.{name}.type", "matte"))
    properties.Set(pyluxcore.Property(f"scene.materials.{name}.kd", list(rgb)))
    if radiance:
        # Radiance in W/(sr m²) as it stands: no power, no photometric units
        properties.Set(pyluxcore.Property(f"scene.materials.{name}.emission", [radiance] * 3))
        properties.Set(pyluxcore.Property(f"scene.materials.{name}.emission.gain", [1.0, 1.0, 1.0]))


def shape(name, points, triangles, material):
    scene.DefineMesh(f"{name}-mesh", [tuple(map(float, p)) for p in points], [tuple(map(int, t)) for t in triangles], None, None, None, None)
    properties.Set(pyluxcore.Property(f"scene.objects.{name}.shape", f"{name}-mesh"))
    properties.Set(pyluxcore.Property(f"scene.objects.{name}.material", material))


def quad(name, corners, material):
    shape(name, corners, [(0, 1, 2), (0, 2, 3)], material)


def sphere(name, centre, radius, material, rows=200):
    """LuxCore has no spheres: facets without interpolated normals, within 10⁻⁴ of the radius."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows, endpoint=False), indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(2 * rows), indexing="ij"))
    a, b, c, d = (i * 2 * rows + j, (i + 1) * 2 * rows + j, (i + 1) * 2 * rows + (j + 1) % (2 * rows), i * 2 * rows + (j + 1) % (2 * rows))
    triangles = np.concatenate([np.stack([a, b, c], 1)[i > -1], np.stack([a, c, d], 1)[i > 0]])
    shape(name, np.array(centre) + radius * points, triangles[(triangles[:, 0] != triangles[:, 1])], material)


def window(aspect):
    """LuxCore 2.11 asks for the film's row y at height - y - 1, a pixel away: the window is moved by as much."""
    pixel = 2.0 / height
    return [-aspect, aspect, -1.0 - pixel, 1.0 - pixel]


camera = {"lookat.orig": [0.0, 0.75, 4.80234357], "lookat.target": [0.0, 0.75, 0.0], "up": [0.0, 1.0, 0.0], "autofocus.enable": False}
if scene_name == "cornell-lambert":
    # The field of view is that of 1 on the screen; by default, 1 is half of the larger side. In the exported scene it is the smaller one.
    camera |= {"type": "perspective", "fieldofview": 23.248791448697848, "screenwindow": window(width / height)}
    grey, red, blue = (0.6,) * 3, (0.6, 0.2, 0.2), (0.2, 0.2, 0.6)
    matte("grey", grey), matte("red", red), matte("blue", blue), matte("light", (0.0,) * 3, 10.0)
    quad("floor", [(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)], "grey")
    quad("ceiling", [(-1, 1.5, -1), (1, 1.5, -1), (1, 1.5, 1), (-1, 1.5, 1)], "grey")
    quad("back", [(-1, 0, -1), (1, 0, -1), (1, 1.5, -1), (-1, 1.5, -1)], "grey")
    quad("left", [(-1, 0, -1), (-1, 1.5, -1), (-1, 1.5, 1), (-1, 0, 1)], "red")
    quad("right", [(1, 0, -1), (1, 0, 1), (1, 1.5, 1), (1, 1.5, -1)], "blue")
    # Emits to the side of its normal, down
    quad("lamp", [(-0.4, 1.49, -0.3), (0.4, 1.49, -0.3), (0.4, 1.49, 0.3), (-0.4, 1.49, 0.3)], "light")
    sphere("one", (-0.4, 0.3, -0.3), 0.3, "grey"), sphere("two", (0.4, 0.3, 0.3), 0.3, "grey")
    depth = 6  # five scatterings, and the way to the light
else:
    camera |= {"type": "orthographic", "lookat.orig": [0.0, 0.0, 5.0], "lookat.target": [0.0, 0.0, 0.0], "screenwindow": window(1.0)}
    matte("white", (1.0,) * 3)
    sphere("ball", (0, 0, 0), 1.0, "white")
    properties.Set(pyluxcore.Property("scene.lights.map.type", "infinite"))
    properties.Set(pyluxcore.Property("scene.lights.map.file", maps[0]))
    properties.Set(pyluxcore.Property("scene.lights.map.gamma", 1.0))
    # The scene scales its map by 8
    properties.Set(pyluxcore.Property("scene.lights.map.gain", [8.0, 8.0, 8.0]))
    # LuxCore's maps have their pole at +z, ours at +y: y and z change places
    properties.Set(pyluxcore.Property("scene.lights.map.transformation", [1.0, 0, 0, 0, 0, 0, 1.0, 0, 0, 1.0, 0, 0, 0, 0, 0, 1.0]))
    depth = 2
for key, value in camera.items():
    properties.Set(pyluxcore.Property(f"scene.camera.{key}", value))
scene.Parse(properties)

settings = {
    "renderengine.type": "PATHCPU", "renderengine.seed": seed, "native.threads.count": threads,
    "sampler.type": "RANDOM", "sampler.random.adaptive.strength": 0.0, "batch.haltspp": spp,
    "path.pathdepth.total": depth, "path.pathdepth.diffuse": depth, "path.pathdepth.glossy": depth, "path.pathdepth.specular": depth,
    "path.russianroulette.depth": 100, "path.clamping.variance.maxvalue": 0.0,
    "film.width": width, "film.height": height, "film.filter.type": "NONE", "film.imagepipelines.0.0.type": "NOP",
    "film.outputs.0.type": "RGB", "film.outputs.0.filename": "unused.exr",
}  # fmt: skip
config = pyluxcore.Properties()
for key, value in settings.items():
    config.Set(pyluxcore.Property(key, value))
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(config, scene))
session.Start()
while session.GetStats().Get("stats.renderengine.pass").GetInt() < spp:
    time.sleep(0.02)
    session.UpdateStats()
session.Stop()
# Linear, without tone mapping, the lowest row first, which is the order of PFM
image = np.zeros(width * height * 3, np.float32)
session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, image)
with open(out, "wb") as file:
    file.write(b"PF\n%d %d\n-1.0\n" % (width, height) + image.tobytes())
# Its destructors at the exit of the interpreter abort
del session, scene
os._exit(0)
