# /// script
# dependencies = ["warp-lang==1.19.0"]
# ///
"""Warp: its random functions in kernels on the CPU, in single precision."""

import numpy as np
import warp as wp

from entry import run, sampler

wp.config.quiet = True
wp.init()
wp.set_device("cpu")


def entry(name, kernel, kind, pdf, domain, convert=lambda x: x, **options):
    def sample(n, seed):
        out = wp.zeros(n, dtype=kind, device="cpu")
        wp.launch(kernel, dim=n, inputs=[int(seed) & 0x7FFFFFFF], outputs=[out], device="cpu")
        return convert(out.numpy().astype(np.int64 if kind in (int, wp.uint32) else float))

    return sampler(name, sample, pdf, domain, dimension=0, **options)


@wp.kernel
def randf(seed: int, out: wp.array(dtype=float)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.randf(state)


@wp.kernel
def randf_range(seed: int, out: wp.array(dtype=float)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.randf(state, -2.0, 5.0)


@wp.kernel
def randf_second(seed: int, out: wp.array(dtype=wp.vec2)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.vec2(wp.randf(state), wp.randf(state))


@wp.kernel
def randn(seed: int, out: wp.array(dtype=float)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.randn(state)


@wp.kernel
def randi(seed: int, out: wp.array(dtype=int)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.randi(state, -3, 1000)


@wp.kernel
def poisson_small(seed: int, out: wp.array(dtype=wp.uint32)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.poisson(state, 4.0)


@wp.kernel
def poisson_large(seed: int, out: wp.array(dtype=wp.uint32)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.poisson(state, 40.0)


@wp.kernel
def cdf(seed: int, table: wp.array(dtype=float), out: wp.array(dtype=int)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_cdf(state, table)


@wp.kernel
def triangle(seed: int, out: wp.array(dtype=wp.vec2)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_triangle(state)


@wp.kernel
def ring(seed: int, out: wp.array(dtype=wp.vec2)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_ring(state)


@wp.kernel
def disk(seed: int, out: wp.array(dtype=wp.vec2)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_disk(state)


@wp.kernel
def square(seed: int, out: wp.array(dtype=wp.vec2)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_square(state)


@wp.kernel
def sphere_surface(seed: int, out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_sphere_surface(state)


@wp.kernel
def hemisphere_surface(seed: int, out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_hemisphere_surface(state)


@wp.kernel
def ball(seed: int, out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_sphere(state)


@wp.kernel
def half_ball(seed: int, out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_hemisphere(state)


@wp.kernel
def cube(seed: int, out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    state = wp.rand_init(seed, i)
    out[i] = wp.sample_unit_cube(state)


def constant(value):
    return lambda x: np.full(len(x), value)


def poisson(mean):
    log = lambda k: k * np.log(mean) - mean - np.vectorize(__import__("math").lgamma)(k + 1.0)  # noqa: E731
    return lambda k: np.exp(log(k))


def unit(x):
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def sampled_cdf():
    shares = np.array([0.1, 0.0, 0.3, 0.05, 0.55])
    table = wp.array(np.cumsum(shares), dtype=float, device="cpu")

    def sample(n, seed):
        out = wp.zeros(n, dtype=int, device="cpu")
        wp.launch(cdf, dim=n, inputs=[int(seed) & 0x7FFFFFFF, table], outputs=[out], device="cpu")
        return out.numpy()

    return sampler("sample_cdf", sample, lambda i: shares[i], "discrete:5", dimension=0)


ENTRIES = [
    entry("control/disk", disk, wp.vec2, constant(1 / np.pi), "disk", control="right"),
    entry("control/disk, radii squared", disk, wp.vec2, constant(1 / np.pi), "disk", lambda x: x * np.linalg.norm(x, axis=1, keepdims=True), control="wrong"),
    entry("randf", randf, float, constant(1), "line"),
    entry("randf range", randf_range, float, constant(1 / 7), "interval:-2,5"),
    entry("randf twice", randf_second, wp.vec2, constant(1), "square"),
    entry("randn", randn, float, lambda x: np.exp(-x * x / 2) / np.sqrt(2 * np.pi), "real"),
    entry("randi", randi, int, constant(1 / 1003), "discrete:1003", lambda i: i + 3),
    entry("poisson 4", poisson_small, wp.uint32, poisson(4), "discrete:60"),
    entry("poisson 40", poisson_large, wp.uint32, poisson(40), "discrete:200"),
    entry("sample_triangle", triangle, wp.vec2, constant(2), "triangle"),
    entry("sample_unit_ring", ring, wp.vec2, constant(0.5 / np.pi), "circle", unit),
    entry("sample_unit_disk", disk, wp.vec2, constant(1 / np.pi), "disk"),
    entry("sample_unit_square", square, wp.vec2, constant(1), "square", lambda x: x + 0.5),
    entry("sample_unit_sphere_surface", sphere_surface, wp.vec3, constant(0.25 / np.pi), "sphere", unit),
    entry("sample_unit_hemisphere_surface", hemisphere_surface, wp.vec3, constant(0.5 / np.pi), "hemisphere", unit),
    entry("sample_unit_sphere, direction", ball, wp.vec3, constant(0.25 / np.pi), "sphere", unit),
    entry("sample_unit_sphere, radius", ball, wp.vec3, lambda r: 3 * r * r, "line", lambda x: np.linalg.norm(x, axis=1).clip(0, 1)),
    entry("sample_unit_hemisphere, direction", half_ball, wp.vec3, constant(0.5 / np.pi), "hemisphere", unit),
    entry("sample_unit_hemisphere, radius", half_ball, wp.vec3, lambda r: 3 * r * r, "line", lambda x: np.linalg.norm(x, axis=1).clip(0, 1)),
    entry("sample_unit_cube", cube, wp.vec3, constant(1), "square", lambda x: x[:, 1:] + 0.5),
    sampled_cdf(),
]

run(ENTRIES)
