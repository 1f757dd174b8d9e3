"""Statistical tests of samplers, BSDFs and images for people who write renderers.

>>> import numpy as np, etalon_bench as eb
>>> def sample(u):  # a direction of the cosine-weighted hemisphere for each row of u
...     r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
...     return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)
>>> bool(eb.check_sampler(sample, lambda w: w[:, 2] / np.pi, "hemisphere"))
True

`check_sampler`, `check_bsdf`, `check_phase`, `check_light`, `compare_images` and `furnace` return a `Result`; the functions of the same name that begin with
`assert_` raise AssertionError unless the result accepts. With pytest, the fixture `etalon` has all of them at one level for the
whole run. The program `etalon` is installed with the package.
"""

from ._bsdfs import (
    Bsdf,
    BsdfSamples,
    Light,
    Phase,
    assert_bsdf,
    assert_furnace,
    assert_light,
    assert_phase,
    check_bsdf,
    check_light,
    check_phase,
    furnace,
)
from ._distributions import of_scipy, of_torch
from ._images import assert_images, compare_images
from ._result import Result
from ._samplers import (
    Chart,
    Samples,
    assert_sampler,
    check_sampler,
    domains,
    min_discrepancy_of_pdfs_detectable,
    min_num_samples_for_sampler_test,
)

__all__ = [
    "Bsdf",
    "BsdfSamples",
    "Chart",
    "Light",
    "Phase",
    "Result",
    "Samples",
    "assert_bsdf",
    "assert_furnace",
    "assert_images",
    "assert_light",
    "assert_phase",
    "assert_sampler",
    "check_bsdf",
    "check_light",
    "check_phase",
    "check_sampler",
    "compare_images",
    "domains",
    "furnace",
    "min_discrepancy_of_pdfs_detectable",
    "min_num_samples_for_sampler_test",
    "of_scipy",
    "of_torch",
]
