"""The catalogue's page, its table and its findings agree, and distributions are arguments as they are."""

import subprocess
import sys
from pathlib import Path

import etalon_bench as eb
import pytest
from scipy import stats

CATALOGUE = Path(__file__).parents[2] / "catalogue"


@pytest.mark.skipif(sys.version_info < (3, 11), reason="needs tomllib")
def test_page_and_table_agree_and_each_rejection_has_a_finding() -> None:
    done = subprocess.run([sys.executable, CATALOGUE / "page", "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(sys.version_info < (3, 11), reason="needs tomllib")
def test_the_page_to_browse_has_all_entries(tmp_path: Path) -> None:
    page = tmp_path / "catalogue.html"
    assert subprocess.run([sys.executable, CATALOGUE / "browse", page], check=False).returncode == 0
    entries = len((CATALOGUE / "results.csv").read_text().splitlines()) - 1
    text = page.read_text()
    assert text.count("<tr data-package=") == entries
    assert '<select name="class">' in text and "sggx_sample of microflake.h" in text


@pytest.mark.parametrize("distribution", [stats.beta(2, 5), stats.gamma(0.7), stats.weibull_max(3), stats.t(3, 100, 0.1), stats.poisson(9.5)])
@pytest.mark.parametrize("by", ["rvs", "ppf"])
def test_scipy_distributions_are_arguments(distribution: object, by: str) -> None:
    arguments = eb.of_scipy(distribution, by)
    assert eb.check_sampler(**arguments)


def test_a_wrong_parameter_is_found() -> None:
    arguments = eb.of_scipy(stats.beta(2, 5))
    assert eb.check_sampler(**{**arguments, "pdf": stats.beta(2.4, 5).pdf}).verdict == "reject"
