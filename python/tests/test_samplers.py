"""Samplers against their pdfs: right ones, planted faults, what results say."""

from __future__ import annotations

import json

import numpy as np
import pytest

import etalon_bench as eb


def cosine(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)


def cosine_pdf(w):
    return w[:, 2] / np.pi


def test_a_right_sampler_is_accepted():
    result = eb.check_sampler(cosine, cosine_pdf, "hemisphere")
    assert result and result.verdict == "accept" and result.p > 1e-4
    assert result.detectable <= 0.0201 and abs(result.integral - 1) < 1e-6 and result.degrees_of_freedom == 199
    assert not result.places and result.reason is None
    assert str(result).startswith("accept\n") and "hemisphere" not in repr(result)


def test_a_wrong_pdf_is_rejected_and_the_place_is_told():
    uniform = eb.check_sampler(cosine, lambda w: np.full(len(w), 0.5 / np.pi), "hemisphere")
    assert not uniform and uniform.verdict == "reject" and uniform.p < 1e-9
    assert any("horizon" in place or "theta" in place for place in uniform.places), uniform.places
    mass = eb.check_sampler(cosine, lambda w: 1.01 * cosine_pdf(w), "hemisphere")
    assert mass.verdict == "reject" and "integrates to 1.01" in mass.reason


def test_the_smallest_error_is_found():
    # 3 % more in one half: three times what 1 % of detectable error asks for
    def biased(u):
        w = cosine(np.stack([u[:, 0], np.where(u[:, 1] < 0.515, u[:, 1] / 1.03, 0.5 + (u[:, 1] - 0.515) / 0.97)], axis=1))
        return w

    assert eb.check_sampler(biased, cosine_pdf, "hemisphere", detect=0.01).verdict == "reject"
    assert eb.check_sampler(cosine, cosine_pdf, "hemisphere", detect=0.01).verdict == "accept"


def test_table_has_the_counts():
    result = eb.check_sampler(cosine, cosine_pdf, "hemisphere")
    table = result.table
    assert set(table) >= {"kind", "x_from", "x_to", "y_from", "y_to", "observed", "expected", "residual"}
    assert table["observed"].sum() == result.samples and table["expected"].sum() == pytest.approx(result.samples)
    cells = table["kind"] == "cell"
    assert cells.sum() == 200 and table["residual"].dtype == float
    # Pearson's statistic is the sum of the squared residuals
    assert np.sum(table["residual"][cells] ** 2) == pytest.approx(result.statistic)


def test_notebooks_show_figure_and_text(tmp_path):
    result = eb.check_sampler(cosine, cosine_pdf, "hemisphere", name="<cosine>")
    assert result._repr_svg_().startswith("<svg") and "Observed" in result._repr_svg_()
    for suffix, begin in [("svg", b"<svg"), ("png", b"\x89PNG"), ("pdf", b"%PDF")]:
        path = tmp_path / f"a.{suffix}"
        # What is too high for a column goes to further files
        saved = result.save(path, style="column")
        assert saved[0] == path and all(file.read_bytes().startswith(begin) for file in saved)
    with pytest.raises(ValueError, match="gif"):
        result.save(tmp_path / "a.gif")
    with pytest.raises(ValueError, match="screen, slide, column"):
        result.save(tmp_path / "a.png", style="poster")
    page = result._repr_html_()
    assert "data:image/svg+xml;base64," in page and "accept\n" in page


def test_equal_seeds_and_names_give_equal_results():
    def run(**options):
        result = eb.check_sampler(cosine, cosine_pdf, "hemisphere", **options)
        return result.statistic, result.p

    assert run() == run() and run(seed=2) != run() and run(name="other") != run()


def test_lines_and_finite_sets_have_points_of_one_coordinate():
    shapes = []

    def pdf(x):
        shapes.append(x.shape)
        return 2 * x

    assert eb.check_sampler(np.sqrt, pdf, "line")
    assert {len(shape) for shape in shapes} == {1}
    p = np.array([0.5, 0.25, 0.125, 0.125])
    edges = np.cumsum(p)[:-1]
    assert eb.check_sampler(lambda u: np.searchsorted(edges, u[:, 0], side="right"), lambda i: p[i], "discrete:4")
    assert eb.check_sampler(lambda u: np.searchsorted(edges, u[:, 0]) // 2 * 2, lambda i: p[i], "discrete:4").verdict == "reject"


def test_missing_samples_are_counted():
    def sample(u):  # uniform on the sphere, of which the upper half is kept
        z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
        r = np.sqrt(1 - z * z)
        x = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)
        x[z < 0] = np.nan
        return eb.Samples(x, valid=z >= 0)

    def pdf(w):
        return np.full(len(w), 1 / (4 * np.pi))

    result = eb.check_sampler(sample, pdf, "hemisphere", mass=0.5)
    assert result and 0.49 < result.table["observed"][-1] / result.samples < 0.51
    assert eb.check_sampler(sample, pdf, "hemisphere", mass="at-most-1")
    assert eb.check_sampler(sample, lambda w: 2 * pdf(w), "hemisphere").verdict == "reject"


def test_atoms_and_the_pdf_of_a_sample():
    up = (0.0, 0.0, 1.0)

    def sample(u):  # a mirror with a probability of 1/4, else the cosine
        mirror = u[:, 0] < 0.25
        w = cosine(np.stack([np.where(mirror, 0, (u[:, 0] - 0.25) / 0.75), u[:, 1]], axis=1))
        return eb.Samples(np.where(mirror[:, None], up, w), pdf=pdf(w), atom=mirror)

    def pdf(w):
        return 0.75 * cosine_pdf(w)

    assert eb.check_sampler(sample, pdf, "hemisphere", atoms=[(up, 0.25)])
    assert eb.check_sampler(sample, pdf, "hemisphere", atoms=[(up, 0.2)], mass=0.95).verdict == "reject"
    carried = eb.check_sampler(lambda u: eb.Samples(cosine(u), pdf=2 * cosine_pdf(cosine(u))), cosine_pdf, "hemisphere")
    assert carried.verdict == "reject" and "carries the pdf" in carried.reason


def test_an_inverse_is_tested():
    def invert(x, wrong=0.0):
        return (x**2)[:, None] + wrong

    assert eb.check_sampler(np.sqrt, lambda x: 2 * x, "line", invert=invert)
    wrong = eb.check_sampler(np.sqrt, lambda x: 2 * x, "line", invert=lambda x: invert(x, 1e-3))
    assert wrong.verdict == "reject" and "inverse" in wrong.reason


def test_random_numbers_of_its_own():
    def sample(n, seed):
        return np.random.default_rng(seed).random((n, 2))

    assert eb.check_sampler(sample, lambda x: np.ones(len(x)), "square", dimension=0)
    constant = eb.check_sampler(lambda n, seed: sample(n, 7), lambda x: np.ones(len(x)), "square", dimension=0)
    assert constant.verdict == "reject" and "repeat" in constant.reason


def test_too_few_samples_are_inconclusive():
    result = eb.check_sampler(cosine, cosine_pdf, "hemisphere", samples=500)
    assert result.verdict == "inconclusive" and not result and "too few samples" in result.reason


def test_assertions_say_what_was_found():
    assert eb.assert_sampler(cosine, cosine_pdf, "hemisphere")
    with pytest.raises(AssertionError, match="where counts differ most"):
        eb.assert_sampler(cosine, lambda w: np.full(len(w), 0.5 / np.pi), "hemisphere")
    with pytest.raises(AssertionError, match="too few samples"):
        eb.assert_sampler(cosine, cosine_pdf, "hemisphere", samples=500)


def test_sample_counts_are_those_of_the_test():
    n = eb.min_num_samples_for_sampler_test(0.02)
    assert eb.min_discrepancy_of_pdfs_detectable(n) == pytest.approx(0.02, rel=1e-4)
    assert eb.check_sampler(cosine, cosine_pdf, "hemisphere", detect=0.02).samples == n
    assert eb.min_num_samples_for_sampler_test(0.01, level=0.001) > 4 * n
    with pytest.raises(ValueError, match="level"):
        eb.min_discrepancy_of_pdfs_detectable(1000, level=2)


def test_the_result_is_that_of_the_program(validate_exec, examples, monkeypatch):
    import sys

    command = [sys.executable, str(examples / "sampler_numpy.py"), "0.4"]
    for seed in (1, 20):
        found = validate_exec(command, "--seed", str(seed))["tests"][0]
        source = (examples / "sampler_numpy.py").read_text().split("for line in sys.stdin")[0]
        client: dict = {}
        monkeypatch.setattr(sys, "argv", command[1:])
        exec(source, client)
        result = eb.check_sampler(
            lambda u: eb.Samples(client["sample"](u), client["pdf"](client["sample"](u))),
            client["pdf"],
            "hemisphere",
            name=found["name"],
            seed=seed,
        )
        # Equal to the last bit: JSON has all digits
        own = {"p": result.p, "statistic": result.statistic, "detectable": result.detectable, "samples": result.samples}
        assert own == {key: found[key] for key in own}, json.dumps(found)


def test_assertions_have_the_signature_and_the_documentation_of_the_checks():
    import inspect

    assert inspect.signature(eb.assert_sampler) == inspect.signature(eb.check_sampler)
    assert eb.assert_sampler.__name__ == "assert_sampler" and "raises AssertionError" in eb.assert_sampler.__doc__
    assert "dimension:" in eb.assert_sampler.__doc__


def test_carried_pdfs_may_have_a_declared_precision():
    def sample(u):
        x = np.sqrt(u[:, 0])
        return eb.Samples(x, pdf=(2 * x).astype(np.float32))

    def check(**options):
        return eb.check_sampler(sample, lambda x: 2 * x, "line", dimension=1, **options)

    exact = check()
    assert exact.verdict == "reject" and "precision=single" in str(exact), str(exact)
    assert check(precision="single"), str(check(precision="single"))
    assert check(precision=1e-6)
    assert check(precision=1e-9).verdict == "reject"
    with pytest.raises(ValueError, match="precision"):
        check(precision=0.5)


def to_cube(x):
    return np.stack([np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0]) / np.pi], axis=1)


def from_cube(u):
    return np.stack([u[:, 0] * np.cos(np.pi * u[:, 1]), u[:, 0] * np.sin(np.pi * u[:, 1])], axis=1)


def jacobian(u):
    return np.pi * u[:, 0]


def half_disk(u, radius=np.sqrt):
    return from_cube(np.stack([radius(u[:, 0]), u[:, 1]], axis=1))


def uniform_on_half_disk(x):
    return np.full(len(x), 2 / np.pi)


def test_domains_by_name_and_a_chart_of_its_own():
    assert "real[:PLACE[,WIDTH]]" in eb.domains()
    chart = eb.Chart(to_cube, from_cube, jacobian, names=("r", "phi / pi"))
    assert eb.check_sampler(half_disk, uniform_on_half_disk, chart)
    wrong = eb.check_sampler(lambda u: half_disk(u, radius=lambda u: u), uniform_on_half_disk, chart)
    assert wrong.verdict == "reject" and any("for r 0" in place for place in wrong.places), wrong.places
    # A line that is folded: one dimension, points with two coordinates
    diagonal = eb.Chart(lambda x: x[:, 0], lambda u: np.stack([u, 2 * u], axis=1), lambda u: np.full(len(u), 5**0.5), dimension=1)
    assert eb.check_sampler(lambda u: u[:, :1] * [1.0, 2.0], lambda x: np.full(len(x), 5**-0.5), diagonal, dimension=1)
    # An index and a point
    assert eb.check_sampler(lambda u: np.stack([np.floor(3 * u[:, 0]), u[:, 1]], axis=1), lambda x: np.full(len(x), 1 / 3), "3*line")


@pytest.mark.parametrize(
    "chart, error",
    [
        ((lambda x: to_cube(x[:, ::-1]), from_cube, jacobian), "do not invert each other|outside of the unit square"),
        ((to_cube, from_cube, lambda u: u[:, 0]), "π times as much"),
        ((to_cube, from_cube, lambda u: -jacobian(u)), "must be positive and finite"),
        ((to_cube, from_cube, lambda u: jacobian(u)[:, None]), "jacobian: shape"),
        ((to_cube, lambda u: u[:, 0] * np.nan, jacobian), "from_cube"),
    ],
)
def test_each_wrong_function_of_a_chart_is_named(chart, error):
    with pytest.raises(ValueError, match=error):
        eb.check_sampler(half_disk, uniform_on_half_disk, eb.Chart(*chart))


def test_domains_that_make_no_sense():
    for domain in ("disc", "real:0,0", "2*discrete:6"):
        with pytest.raises(ValueError, match="domain"):
            eb.check_sampler(half_disk, uniform_on_half_disk, domain)
    with pytest.raises(ValueError, match="dimension"):
        eb.Chart(to_cube, from_cube, jacobian, dimension=7)


def resampled(u, power=1.0, normalization=4):
    """One of four uniform candidates, by a power of x, with its weight."""
    importance = 0.2 + u[:, :4] ** power
    total = importance.cumsum(axis=1)
    i = (total < u[:, 4:] * total[:, -1:]).sum(axis=1)
    rows = np.arange(len(u))
    return eb.Samples(u[rows, i], weight=total[:, -1] / (normalization * importance[rows, i]))


def test_weights_in_place_of_a_pdf() -> None:
    found = eb.check_sampler(resampled, None, "line", dimension=5)
    assert found and "variance of the weights" in str(found)
    wrong = eb.check_sampler(lambda u: resampled(u, normalization=3), None, "line", dimension=5)
    assert wrong.verdict == "reject" and "1.33" in wrong.reason
    doubled = lambda u: resampled(u, normalization=2)
    assert eb.check_sampler(doubled, None, "line", target=lambda x: np.full(len(x), 2.0), dimension=5)
    with pytest.raises(TypeError, match="no weights"):
        eb.check_sampler(lambda u: u, None, "square")
    with pytest.raises(ValueError, match="target"):
        eb.check_sampler(lambda u: u, lambda x: x[:, 0], "square", target=lambda x: x[:, 0])


def test_ranges_of_parameters() -> None:
    sample = lambda u, n: u[:, 0] ** (1 / (n + 1))
    pdf = lambda x, n: (n + 1) * x**n
    right = eb.check_sampler(sample, pdf, "line", parameters={"n": (0.1, 50)}, detect=0.05)
    assert right and "values of the parameters" in str(right)
    wrong = eb.check_sampler(sample, lambda x, n: pdf(x, n if n < 10 else 0.8 * n), "line", parameters={"n": (0.1, 50)}, detect=0.04)
    assert wrong.reason.startswith("fails for n ≥ 10")
    assert eb.check_sampler(resampled, None, "line", dimension=5, parameters={"power": (1, 0.5, 3)}, samples=20000)
    with pytest.raises(ValueError, match="parameters: n"):
        eb.check_sampler(sample, pdf, "line", parameters={"n": (5, 1)})


def test_stochastic_and_narrow_pdfs() -> None:
    noise = lambda x: 2 * np.modf(x * 7919)[0]
    assert eb.check_sampler(lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x * noise(x), "line", stochastic=True, detect=0.05)
    assert not eb.check_sampler(lambda u: u[:, 0], lambda x: 2 * x * noise(x), "line", stochastic=True, detect=0.05)
    spike = lambda x: np.where(np.abs(x - 0.3) < 1e-9, 1e8, 0.0) + 0.8
    uniform = eb.check_sampler(lambda u: u[:, 0], spike, "line", narrow=[(0.3,)])
    assert uniform.verdict == "reject" and "too few for x 0.29" in uniform.reason
    with pytest.raises(ValueError, match="narrow"):
        eb.check_sampler(lambda u: u[:, 0], spike, "line", narrow=[(3.0,)])
