# /// script
# dependencies = ["bpy==4.2.0", "numpy<2"]
# ///
"""Renders the built-in scenes cornell-lambert and sphere-env with Blender's Cycles on the CPU, for `etalon converge --renderer`:

    blender.py SCENE SPP SEED OUT.exr THREADS WIDTH HEIGHT [MAP.exr]

MAP.exr is the scene's map, envmaps/nave.exr. What is matched, and how, stands beside the lines that do it.
"""

import os
import sys
from math import radians

import bpy
import mathutils
import numpy as np

scene_name, spp, seed, out, threads, width, height, *maps = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene


def material(name, rgb, radiance=0.0):
    """Lambert's BSDF on both sides; with a radiance, a black surface whose front emits."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, link = made.node_tree.nodes, made.node_tree.links.new
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value, diffuse.inputs["Roughness"].default_value = (*rgb, 1.0), 0.0
    surface = diffuse
    if radiance:
        emission, side, surface = (nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "NewGeometry", "MixShader"))
        emission.inputs["Strength"].default_value = radiance
        link(side.outputs["Backfacing"], surface.inputs[0]), link(emission.outputs[0], surface.inputs[1]), link(diffuse.outputs[0], surface.inputs[2])
        made.cycles.emission_sampling = "FRONT"
    link(surface.outputs[0], output.inputs["Surface"])
    return made


def shape(name, points, faces, of):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(map(float, p)) for p in points], [], [tuple(map(int, f)) for f in faces])
    mesh.materials.append(of)
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def sphere(name, centre, radius, of, rows=200):
    """Facets without interpolated normals, within 10⁻⁴ of the radius."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows, endpoint=False), indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(2 * rows), indexing="ij"))
    k = (j + 1) % (2 * rows)
    shape(name, np.array(centre) + radius * points, np.stack([i * 2 * rows + j, (i + 1) * 2 * rows + j, (i + 1) * 2 * rows + k, i * 2 * rows + k], 1), of)


camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera, camera.data.clip_start, camera.data.sensor_fit = camera, 1e-3, "VERTICAL"
# Without rotation, a camera looks along -z, +y is up
if scene_name == "cornell-lambert":
    camera.location, camera.data.angle_y = (0.0, 0.75, 4.80234357), radians(23.248791448697848)
    grey, red, blue, light = material("grey", (0.6,) * 3), material("red", (0.6, 0.2, 0.2)), material("blue", (0.2, 0.2, 0.6)), material("light", (0.0,) * 3, 10.0)
    quad = [(0, 1, 2, 3)]
    shape("floor", [(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)], quad, grey)
    shape("ceiling", [(-1, 1.5, -1), (1, 1.5, -1), (1, 1.5, 1), (-1, 1.5, 1)], quad, grey)
    shape("back", [(-1, 0, -1), (1, 0, -1), (1, 1.5, -1), (-1, 1.5, -1)], quad, grey)
    shape("left", [(-1, 0, -1), (-1, 1.5, -1), (-1, 1.5, 1), (-1, 0, 1)], quad, red)
    shape("right", [(1, 0, -1), (1, 0, 1), (1, 1.5, 1), (1, 1.5, -1)], quad, blue)
    # Its front is down
    shape("lamp", [(-0.4, 1.49, -0.3), (0.4, 1.49, -0.3), (0.4, 1.49, 0.3), (-0.4, 1.49, 0.3)], quad, light)
    sphere("one", (-0.4, 0.3, -0.3), 0.3, grey), sphere("two", (0.4, 0.3, 0.3), 0.3, grey)
    bounces = 4  # five scatterings: the first is no bounce
else:
    camera.location, camera.data.type, camera.data.ortho_scale = (0.0, 0.0, 5.0), "ORTHO", 2.0
    sphere("ball", (0, 0, 0), 1.0, material("white", (1.0,) * 3))
    scene.world = world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, link = world.node_tree.nodes, world.node_tree.links.new
    at, turn, texture = (nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "Mapping", "TexEnvironment"))
    texture.image, texture.interpolation = bpy.data.images.load(os.path.abspath(maps[0])), "Closest"
    texture.image.colorspace_settings.name = "Non-Color"
    nodes["Background"].inputs["Strength"].default_value = 8.0  # the scene scales its map
    # Cycles' maps have their pole at +z, and their azimuth runs the other way from -x; ours have it at +y, the azimuth from +x to +z
    turn.inputs["Rotation"].default_value = mathutils.Matrix([(-1, 0, 0), (0, 0, 1), (0, 1, 0)]).to_euler()
    link(at.outputs["Generated"], turn.inputs["Vector"]), link(turn.outputs[0], texture.inputs[0]), link(texture.outputs[0], nodes["Background"].inputs["Color"])
    bounces = 0

for key, value in {
    "device": "CPU", "samples": int(spp), "seed": int(seed), "use_adaptive_sampling": False, "use_denoising": False, "pixel_filter_type": "BOX", "filter_width": 1.0,
    "max_bounces": bounces, "diffuse_bounces": bounces, "sample_clamp_direct": 0.0, "sample_clamp_indirect": 0.0, "light_sampling_threshold": 0.0, "blur_glossy": 0.0,
}.items():  # fmt: skip
    setattr(scene.cycles, key, value)
render = scene.render
render.engine, render.resolution_x, render.resolution_y, render.threads_mode, render.threads = "CYCLES", int(width), int(height), "FIXED", int(threads)
# Linear, without a view transform
render.image_settings.file_format, render.image_settings.color_mode, render.image_settings.color_depth, render.filepath = "OPEN_EXR", "RGB", "32", os.path.abspath(out)
bpy.ops.render.render(write_still=True)
