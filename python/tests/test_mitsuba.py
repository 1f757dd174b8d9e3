"""Mitsuba 3's warps, microfacet normals and BSDFs: the same findings as by the program's `--exec`."""

from __future__ import annotations

import shlex
import subprocess
import sys

import numpy as np
import pytest

import etalon_bench as eb

mi = pytest.importorskip("mitsuba", reason="skipped: Mitsuba 3 is not installed")


@pytest.fixture(autouse=True)
def scalar():
    mi.set_variant("llvm_ad_mono")


def inside(u):
    """Random numbers in single precision: one next to 1 must not become 1."""
    return np.minimum(u, 1 - 2**-24).T.astype(np.float32)


WARPS = {
    "uniform_hemisphere": ("square_to_uniform_hemisphere", "hemisphere"),
    "cosine_hemisphere": ("square_to_cosine_hemisphere", "hemisphere"),
    "uniform_sphere": ("square_to_uniform_sphere", "sphere"),
}


@pytest.mark.parametrize("name", WARPS)
def test_warps(name):
    warp, domain = WARPS[name]

    def sample(u):
        return np.array(getattr(mi.warp, warp)(mi.Point2f(inside(u)))).T

    def pdf(w):
        value = getattr(mi.warp, f"{warp}_pdf")(mi.Vector3f(w.T.astype(np.float32)))
        return np.broadcast_to(np.array(value), len(w))

    assert eb.check_sampler(sample, pdf, domain)
    assert eb.check_sampler(sample, lambda w: pdf(w) * (1 + 0.1 * w[:, 0]), domain).verdict == "reject"


def test_von_mises_fisher():
    def sample(u):
        return np.array(mi.warp.square_to_von_mises_fisher(mi.Point2f(inside(u)), 20.0)).T

    def pdf(w):
        return np.array(mi.warp.square_to_von_mises_fisher_pdf(mi.Vector3f(w.T.astype(np.float32)), 20.0))

    assert eb.check_sampler(sample, pdf, "sphere")


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
