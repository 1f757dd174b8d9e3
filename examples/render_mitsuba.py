#!/usr/bin/env python3
"""Renders a Mitsuba 3 scene for `etalon converge`: one process, one image.

    pip install mitsuba        # its LLVM variant also wants libLLVM; DRJIT_LIBLLVM_PATH says where it is
    etalon scenes --export cornell-spheres.xml
    etalon converge cornell-spheres --renderer-scene cornell-spheres.xml --renderer \
      'mitsuba=python3 examples/render_mitsuba.py {scene} {spp} {seed} {out} {threads} {width} {height}'

`scalar_rgb`, the default, interprets the scene. `--variant llvm_ad_rgb` compiles it first and renders faster; `converge` separates
the time of start-up by its fit.
"""
import argparse

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("scene"), parser.add_argument("spp", type=int), parser.add_argument("seed", type=int)
parser.add_argument("out"), parser.add_argument("threads", type=int)
parser.add_argument("size", type=int, nargs="*", help="width and height; without them, those of the scene")
parser.add_argument("--variant", default="scalar_rgb")
options = parser.parse_args()

import mitsuba as mi

mi.set_variant(options.variant)
import drjit as dr

# The reader and the writer of OpenEXR files wait for a second thread.
dr.set_thread_count(max(2, options.threads))
# Merged shapes lose their bounding box, without which shadow rays to the environment end too early.
scene = mi.load_file(options.scene, parallel=False, optimize=False)
sensor = scene.sensors()[0]
if options.size:
    parameters = mi.traverse(sensor)
    parameters["film.size"] = options.size
    parameters.update()
dr.set_thread_count(options.threads)
image = mi.render(scene, sensor=sensor, spp=options.spp, seed=options.seed)
dr.eval(image), dr.sync_thread()
# Alpha and arbitrary output variables are left out.
dr.set_thread_count(max(2, options.threads))
mi.Bitmap(mi.TensorXf(image)[:, :, :3]).write(options.out)
