"""The pytest plugin: one level for a run, the report, pytest-xdist."""

from __future__ import annotations

import pytest

SUITE = """
import numpy as np
import pytest

def one(x):
    return np.ones(len(x))

@pytest.mark.parametrize("k", range(3))
def test_right(etalon, k):
    assert etalon.assert_sampler(lambda u: u, one, "square", samples=20_000).name == f"test_right[{k}]"

def test_several(etalon):
    etalon.assert_sampler(lambda u: u, one, "square", samples=20_000)
    assert etalon.check_sampler(lambda u: u, one, "line", samples=20_000).name == "test_several/2"
    etalon.assert_furnace("diffuse", size=(2, 2))

def test_wrong(etalon):
    etalon.assert_sampler(lambda u: u**1.1, one, "square", samples=20_000, name="<wrong>")

def test_without():
    pass
"""


def test_a_run_shares_its_level(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import etalon_bench._native as native, etalon_bench._samplers as samplers
        levels = []

        class Spy:
            @staticmethod
            def check_sampler(sampler, domain, plan):
                levels.append(plan.level)
                return native.check_sampler(sampler, domain, plan)

        def test_one(etalon, monkeypatch):
            monkeypatch.setattr(samplers, "_native", Spy)
            for _ in range(3):
                etalon.assert_sampler(lambda u: u, lambda x: x[:, 0] * 0 + 1, "square", samples=20_000)
            # Two tests use the fixture: half of 0.04 each, in halves
            assert levels == [0.01, 0.005, 0.0025]

        def test_two(etalon):
            pass

        def test_three():
            pass
        """
    )
    result = pytester.runpytest_subprocess("--etalon-level=0.04")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*etalon: level 0.04 together; 3 accepted, 0 rejected, 0 inconclusive*"])


@pytest.mark.parametrize("workers", [0, 2])
def test_the_report_has_all_checks(pytester: pytest.Pytester, workers: int) -> None:
    if workers:
        pytest.importorskip("xdist", reason="skipped: pytest-xdist is not installed")
    pytester.makepyfile(SUITE)
    result = pytester.runpytest_subprocess("--etalon-report=out/report.html", *(["-n", str(workers)] if workers else []))
    result.assert_outcomes(passed=5, failed=1)
    result.stdout.fnmatch_lines(["*AssertionError: <wrong>: reject*"])
    page = (pytester.path / "out/report.html").read_text(encoding="utf-8")
    assert "7 checks at level 0.01 together: 6 accepted, 1 rejected, 0 inconclusive" in page
    # Rejected ones first, names escaped, a figure for each, nothing from elsewhere
    assert page.index("&lt;wrong&gt;") < page.index("test_right[0]") and "<wrong>" not in page
    assert page.count("data:image/svg+xml;base64,") == 7 and "http" not in page.replace("http://www.w3.org", "")
    assert [path.name for path in (pytester.path / "out").iterdir()] == ["report.html"]


def test_what_is_refused(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        def test_level(etalon):
            with pytest.raises(TypeError, match="level: it is that of the run"):
                etalon.check_sampler(lambda u: u, len, "square", level=0.1)

        def test_dynamic(request):
            request.getfixturevalue("etalon")
        """
    )
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*name the fixture etalon among the arguments*"])
    bad = pytester.runpytest_subprocess("--etalon-level=0")
    assert bad.ret == 4
    bad.stderr.fnmatch_lines(["*--etalon-level: 0.0 is not between 0 and 1*"])
