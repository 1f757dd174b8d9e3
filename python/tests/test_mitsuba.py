"""Mitsuba 3's warps, microfacet normals and BSDFs: the same findings as by the program's `--exec`."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import etalon_bench as eb

mi = pytest.importorskip("mitsuba", reason="skipped: Mitsuba 3 is not installed")
mi.set_variant("llvm_ad_mono")
from etalon_bench import mitsuba  # noqa: E402


@pytest.fixture(autouse=True)
def scalar():
    mi.set_variant("llvm_ad_mono")


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"])
def test_adapter_in_scalar_and_vectorized_variants(variant):
    mi.set_variant(variant)
    cosine = mitsuba.warp("square_to_cosine_hemisphere", domain="hemisphere")
    assert eb.check_sampler(**cosine)
    assert eb.check_sampler(**cosine | {"pdf": lambda w: cosine["pdf"](w) * (1 + 0.1 * w[:, 0])}).verdict == "reject"
    normals = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, 0.3)
    samplers = [
        mitsuba.phase({"type": "hg", "g": -0.5}, (0.48, 0.36, 0.8)),
        mitsuba.microfacets(normals, (0.48, 0.36, 0.8)),
        mitsuba.emitter({"type": "constant"}),
        mitsuba.texture({"type": "bitmap", "bitmap": mi.Bitmap(np.array([[1, 2], [0, 5]], np.float32)), "raw": True}),
    ]
    assert all(eb.check_sampler(**sampler, detect=0.1) for sampler in samplers)
    assert eb.check_sampler(**mitsuba.microfacets(normals, (0.6, 0, 0.8), zero=True)).verdict == "reject"


def test_adapter_declares_what_a_bsdf_is():
    glass = mitsuba.bsdf({"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0})
    assert (glass.scatters, glass.channels, glass.precision, glass.eta) == ("both", 1, "single", pytest.approx(1.5))
    directions, probability, factor = glass.lobes(np.array([[0.6, 0, 0.8]]))
    assert sorted(np.sign(directions[0, :, 2])) == [-1, 1] and probability.sum() == pytest.approx(1)
    assert factor.sum() == pytest.approx(probability[0, directions[0, :, 2] > 0][0] + probability[0, directions[0, :, 2] < 0][0] / 1.5**2)
    assert mitsuba.bsdf({"type": "diffuse"}, energy="conserved:0.6").energy == "conserved:0.6"


def bsdf(examples, plugin):
    """The functions of the example for a plugin with its usual parameters."""
    client: dict = {"__name__": "client"}
    argv, sys.argv = sys.argv, ["bsdf_mitsuba.py", plugin]
    try:
        exec((examples / "bsdf_mitsuba.py").read_text(), client)
    finally:
        sys.argv = argv
    values = [default for default, _, _ in client["PARAMETERS"].values()]
    declared = dict(word.split("=") for word in client["properties"](values).split())

    def sample(wo, u):
        wi, weight, pdf, delta, valid = client["sample"](wo, u)
        return eb.BsdfSamples(wi, weight, pdf, delta, valid)

    def lobes(wo):
        rows = client["lobes"](wo)
        k = max(1, max(len(row) for row in rows) // 5)
        all_rows = np.zeros((len(wo), k, 5))
        for i, row in enumerate(rows):
            all_rows[i, : len(row) // 5] = np.reshape(row, (-1, 5))
        return all_rows[..., :3], all_rows[..., 3], all_rows[..., 4]

    return eb.Bsdf(
        sample,
        lambda wo, wi: client["evaluate"](wo, wi)[0],
        lambda wo, wi: client["evaluate"](wo, wi)[1],
        lobes if declared["delta"] == "yes" else None,
        scatters=declared["scatters"],
        eta=float(declared["eta"]),
        precision="single",
    )


@pytest.mark.parametrize("plugin", ["roughconductor", "roughplastic", "thindielectric"])
def test_bsdfs_as_by_the_program(validate_exec, examples, plugin):
    command = [sys.executable, str(examples / "bsdf_mitsuba.py"), plugin]
    found = validate_exec(command, "--samples", "40000")["tests"]
    result = eb.check_bsdf(bsdf(examples, plugin), name=f"mitsuba-{plugin}", samples=40000)
    verdicts = {check.name: check.verdict for check in result.checks}
    assert verdicts == {test["name"]: test["verdict"] for test in found}
    ours = {check.name: check.p for check in result.checks if check.p is not None}
    assert ours == pytest.approx({test["name"]: test["p"] for test in found if test["p"] is not None}, rel=1e-6)
