"""The pytest plugin: the fixture `etalon`, whose checks of a whole run share one level, and a report of them."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

import pytest

from . import _html, _progress
from ._bsdfs import check_bsdf, furnace
from ._images import compare_images
from ._result import Result
from ._samplers import check_sampler

USERS = pytest.StashKey[int]()
CHECKS = pytest.StashKey[list[Result]]()


class Etalon:
    """The functions of `etalon_bench`, at the level of the run.

    A test has an equal share of it, of which its first check takes a half, the second a quarter, and so on: together they never take
    more than all, and each is decided at once. Furnace tests have no level.
    """

    def __init__(self, name: str, level: float) -> None:
        self._name = name
        self._level = level
        self._results: list[Result] = []
        self._checks = 0

    def check_sampler(self, sample: Callable[..., Any], pdf: Callable[..., Any], domain: str, **options: Any) -> Result:
        """As `etalon_bench.check_sampler`."""
        return self._keep(check_sampler(sample, pdf, domain, **self._at_level(options)))

    def check_bsdf(self, bsdf: Any, **options: Any) -> Result:
        """As `etalon_bench.check_bsdf`."""
        return self._keep(check_bsdf(bsdf, **self._at_level(options)))

    def compare_images(self, a: Any, b: Any, **options: Any) -> Result:
        """As `etalon_bench.compare_images`."""
        return self._keep(compare_images(a, b, **self._at_level(options)))

    def furnace(self, bsdf: Any, **options: Any) -> Result:
        """As `etalon_bench.furnace`."""
        return self._keep(furnace(bsdf, **({"name": self._next_name()} | options)))

    def assert_sampler(self, sample: Callable[..., Any], pdf: Callable[..., Any], domain: str, **options: Any) -> Result:
        """As `etalon_bench.assert_sampler`."""
        __tracebackhide__ = True
        return self.check_sampler(sample, pdf, domain, **options).check()

    def assert_bsdf(self, bsdf: Any, **options: Any) -> Result:
        """As `etalon_bench.assert_bsdf`."""
        __tracebackhide__ = True
        return self.check_bsdf(bsdf, **options).check()

    def assert_images(self, a: Any, b: Any, **options: Any) -> Result:
        """As `etalon_bench.assert_images`."""
        __tracebackhide__ = True
        return self.compare_images(a, b, **options).check()

    def assert_furnace(self, bsdf: Any, **options: Any) -> Result:
        """As `etalon_bench.assert_furnace`."""
        __tracebackhide__ = True
        return self.furnace(bsdf, **options).check()

    def _at_level(self, options: dict[str, Any]) -> dict[str, Any]:
        """The options with the level of the next check, and its name if there is none."""
        if "level" in options:
            raise TypeError("level: it is that of the run; see --etalon-level")
        self._checks += 1
        return {"name": self._next_name(), "level": self._level * 0.5**self._checks} | options

    def _next_name(self) -> str:
        """The name of the test; from its second check on with a number."""
        return self._name if not self._results else f"{self._name}/{len(self._results) + 1}"

    def _keep(self, result: Result) -> Result:
        self._results.append(result)
        return result


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("etalon", "statistical tests of samplers, BSDFs and images")
    group.addoption(
        "--etalon-level",
        type=float,
        default=0.01,
        metavar="A",
        help="probability that a run in which all is right fails by chance: shared by all tests that use the fixture etalon "
        "(default: %(default)s)",
    )
    group.addoption("--etalon-report", metavar="FILE", help="write verdict, power and figure of each check to this HTML file")


def pytest_configure(config: pytest.Config) -> None:
    level = config.getoption("--etalon-level")
    if not 0 < level < 1:
        raise pytest.UsageError(f"--etalon-level: {level} is not between 0 and 1")
    # The workers of pytest-xdist send their results to the process that started them
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Gathered(config), "etalon-gathered")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Progress goes to the terminal of pytest, around its capture of output, on a line of its own."""
    plugins = session.config.pluginmanager
    terminal, capture = plugins.get_plugin("terminalreporter"), plugins.get_plugin("capturemanager")
    if terminal is None or capture is None or not terminal.isatty:
        return

    def write(text: str) -> None:
        with capture.global_and_fixture_disabled():
            terminal.ensure_newline()
            terminal.write(text, flush=True)

    _progress.write = write


def pytest_collection_finish(session: pytest.Session) -> None:
    uses = [item for item in session.items if "etalon" in getattr(item, "fixturenames", ())]
    session.config.stash[USERS] = len(uses)


@pytest.fixture
def etalon(request: pytest.FixtureRequest) -> Etalon:
    """The functions of etalon_bench, such as `assert_sampler`, at one level for the whole run."""
    node = request.node
    if "etalon" not in node.fixturenames:
        raise pytest.UsageError("name the fixture etalon among the arguments of the test: its users share the level")
    level = request.config.getoption("--etalon-level") / request.config.stash[USERS]
    found = Etalon(node.name, level)
    node.stash[CHECKS] = found._results
    return found


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, None]:
    report = (yield).get_result()
    if call.when == "call" and CHECKS in item.stash:
        with_figures = item.config.getoption("--etalon-report") is not None
        # Attributes of a report travel between processes, if they are plain values
        report.etalon_checks = [_html.record(item.nodeid, result, with_figures) for result in item.stash[CHECKS]]


class Gathered:
    """The checks of all tests of the run."""

    def __init__(self, config: pytest.Config) -> None:
        self.path = config.getoption("--etalon-report")
        self.level = config.getoption("--etalon-level")
        self.checks: list[dict[str, Any]] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.checks += getattr(report, "etalon_checks", [])

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self.path is not None:
            _html.write(self.path, self.checks, self.level)
        if self.checks:
            written = "" if self.path is None else f"; wrote {self.path}"
            terminalreporter.write_sep("-", f"etalon: level {self.level} together; {_html.counted(self.checks)}{written}")
