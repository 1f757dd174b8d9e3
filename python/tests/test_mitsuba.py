"""Mitsuba 3's warps, microfacet normals and BSDFs: the same findings as by the program's `--exec`."""

from __future__ import annotations

import shlex
import subprocess
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


def normals(examples, command):
    """The functions of the example, whose variant takes one number after the other."""
    client: dict = {}
    argv, sys.argv = sys.argv, command[1:]
    try:
        exec((examples / "sampler_mitsuba.py").read_text().split("\nfor line in sys.stdin")[0], client)
    finally:
        sys.argv = argv

    def sample(u):
        return np.array([client["sample"](row) for row in u.tolist()])

    def pdf(w):
        return np.array([client["NORMALS"].pdf(client["WI"], mi.Vector3f(row)) for row in w.tolist()])

    return sample, pdf


@pytest.mark.parametrize(("kind", "alpha", "angle", "which"), [("ggx", 0.3, 60, "all"), ("beckmann", 0.1, 30, "visible")])
def test_normals_as_by_the_program(validate_exec, examples, kind, alpha, angle, which):
    command = [sys.executable, str(examples / "sampler_mitsuba.py"), kind, str(alpha), str(angle), which]
    found = validate_exec(command, "--samples", "30000")["tests"][0]
    result = eb.check_sampler(*normals(examples, command), "sphere", name=found["name"], samples=30000)
    assert (result.verdict, result.p, result.statistic) == (found["verdict"], found["p"], found["statistic"])


def test_nan_of_visible_normals_is_found_by_both(examples):
    """Mitsuba 3.9 returns NaN for visible normals of GGX where the first random number is 0."""
    command = [sys.executable, str(examples / "sampler_mitsuba.py"), "ggx", "0.3", "60", "visible"]
    sample, pdf = normals(examples, command)
    if not np.isnan(sample(np.array([[0.0, 0.5]]))).any():
        pytest.skip("skipped: this version of Mitsuba has no NaN there")
    result = eb.check_sampler(sample, pdf, "sphere")
    assert result.verdict == "reject" and "(NaN, NaN, NaN) is outside of the domain (sampled from u = (0.0, 0.5))" in result.reason
    program = [sys.executable, "-m", "etalon_bench", "validate", "--exec", shlex.join(command)]
    done = subprocess.run(program, capture_output=True, text=True, timeout=300)
    assert done.returncode == 1 and "(NaN, NaN, NaN) is outside of the domain" in done.stdout


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
