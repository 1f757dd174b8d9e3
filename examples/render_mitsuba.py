#!/usr/bin/env python3
"""Renders a Mitsuba 3 scene for `etalon converge`: one process, one image.

    pip install mitsuba        # its LLVM variant also wants libLLVM; DRJIT_LIBLLVM_PATH says where it is
    etalon converge cornell-spheres --renderer-scene room.xml --renderer \
      'mitsuba=python3 examples/render_mitsuba.py {scene} {spp} {seed} {out} {threads} {width} {height}'

`scalar_rgb`, the default, starts at once and interprets the scene: for small images. `--variant llvm_ad_rgb` compiles the
scene first, which takes about as long as it takes without a cache of kernels, and renders several times as fast. Either way
the same seed gives the same image; the time of start-up is separated by the fit.
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

dr.set_thread_count(options.threads)
scene = mi.load_file(options.scene, parallel=False)
sensor = scene.sensors()[0]
if options.size:
    parameters = mi.traverse(sensor)
    parameters["film.size"] = options.size
    parameters.update()
image = mi.render(scene, sensor=sensor, spp=options.spp, seed=options.seed)
# The writer of OpenEXR files waits for a second thread. Alpha and arbitrary output variables are left out.
dr.set_thread_count(max(2, options.threads))
mi.Bitmap(mi.TensorXf(image)[:, :, :3]).write(options.out)
