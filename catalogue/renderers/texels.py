# /// script
# dependencies = ["pyluxcore==2.11.2", "numpy"]
# ///
"""What LuxCore makes of a map of two texels, black and white: the radiance of the background by azimuth. Steps if texels are constant, ramps if it interpolates."""

import os
import time

import numpy as np
import pyluxcore

pyluxcore.Init(lambda text: None)
scene, properties = pyluxcore.Scene(), pyluxcore.Properties()
scene.DefineImageMap("map", np.array([0, 0, 0, 1, 1, 1], np.float32), 1.0, 3, 2, 1)
scene.DefineMesh("mesh", [(0.0, 0.0, -9.0), (1.0, 0.0, -9.0), (0.0, 1.0, -9.0)], [(0, 1, 2)], None, None, None, None)
WIDTH = 36
for key, value in {
    "camera.type": "environment", "camera.lookat.orig": [0.0, 0.0, 0.0], "camera.lookat.target": [1.0, 0.0, 0.0], "camera.up": [0.0, 0.0, 1.0], "camera.autofocus.enable": False,
    "lights.map.type": "infinite", "lights.map.file": "map", "lights.map.gamma": 1.0, "materials.black.type": "matte", "materials.black.kd": [0.0] * 3,
    "objects.far.shape": "mesh", "objects.far.material": "black",
}.items():  # fmt: skip
    properties.Set(pyluxcore.Property(f"scene.{key}", value))
scene.Parse(properties)
config = pyluxcore.Properties()
for key, value in {
    "renderengine.type": "PATHCPU", "native.threads.count": 1, "sampler.type": "RANDOM", "sampler.random.adaptive.strength": 0.0, "path.pathdepth.total": 1,
    "film.width": WIDTH, "film.height": WIDTH // 2, "film.filter.type": "NONE", "film.imagepipelines.0.0.type": "NOP", "film.outputs.0.type": "RGB", "film.outputs.0.filename": "unused.exr",
}.items():  # fmt: skip
    config.Set(pyluxcore.Property(key, value))
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(config, scene))
session.Start()
while session.GetStats().Get("stats.renderengine.pass").GetInt() < 64:
    time.sleep(0.02)
    session.UpdateStats()
session.Stop()
image = np.zeros(WIDTH * WIDTH // 2 * 3, np.float32)
session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, image)
for azimuth, radiance in zip(10 * np.arange(WIDTH) + 5, image.reshape(-1, WIDTH, 3)[WIDTH // 4, :, 0]):
    print(f"column at {azimuth:3}°: {radiance:.3f}")
del session, scene
os._exit(0)
