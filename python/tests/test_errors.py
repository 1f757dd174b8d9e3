"""Bad arguments, and functions that return what they should not: errors that name argument, shape found and shape wanted."""

from __future__ import annotations

import os
import re
import signal
import threading
import time

import numpy as np
import pytest

import etalon_bench as eb


def uniform(u):
    return u


def one(x):
    return np.ones(len(x))


@pytest.mark.parametrize(
    ("sample", "pdf", "kind", "message"),
    [
        (lambda u: u[:, :1], one, ValueError, r"sample: shape \(\d+, 1\); wanted \(\d+, 2\)"),
        (lambda u: u.T, one, ValueError, r"sample: shape \(2, \d+\); wanted \(\d+, 2\)"),
        (lambda u: u.astype(complex), one, TypeError, "sample: ndarray of dtype complex128; wanted real numbers"),
        (lambda u: [["a", "b"]] * len(u), one, TypeError, "sample: list of dtype <U1"),
        (lambda u: None, one, TypeError, "sample: NoneType of dtype object"),
        (lambda u: (u, u), one, TypeError, "sample: a tuple of 2"),
        (lambda u: eb.Samples(u, valid=np.ones(len(u))), one, TypeError, "sample.valid: dtype float64; wanted bool"),
        (lambda u: eb.Samples(u, valid=np.ones(3, bool)), one, ValueError, r"sample.valid: shape \(3,\)"),
        (uniform, lambda x: np.ones((len(x), 1)), ValueError, r"pdf: shape \(\d+, 1\); wanted \(\d+,\)"),
        (uniform, lambda x: 1.0, ValueError, r"pdf: shape \(\); wanted \(\d+,\)"),
        (uniform, lambda x: x[:, 0] > 0.5, TypeError, "pdf: ndarray of dtype bool"),
        (uniform, "1", TypeError, "pdf: wanted a function, not str"),
        (3, one, TypeError, "sample: wanted a function, not int"),
    ],
)
def test_functions_that_return_something_else(sample, pdf, kind, message):
    with pytest.raises(kind, match=message):
        eb.check_sampler(sample, pdf, "square")


def raising(u):
    if (u[:, 0] > 0.999).any():
        raise ZeroDivisionError("too far right")
    return u


@pytest.mark.parametrize(
    ("sample", "pdf", "reason"),
    [
        (lambda u: np.where(u > 0.999, np.nan, u), one, r"the sample \(.*NaN.*\) is outside of the domain \(sampled from u = \(0\.\d+, 0\.\d+\)\)"),
        (lambda u: eb.Samples(u, pdf=np.full(len(u), np.nan)), one, "carries the pdf NaN"),
        (uniform, lambda x: np.where(x[:, 0] > 0.9, np.nan, 1), r"the pdf at .*\(0\.9\d+, 0\.\d+\) is NaN"),
        (lambda u: u / np.where(u > 0.999, 0, 1), one, r"the sample \(.*inf.*\) is outside"),
        (raising, one, r"sample raises ZeroDivisionError: too far right, for u = \[0\.999\d+, 0\.\d+\]"),
        (uniform, lambda x: raising(x)[:, 0] * 0 + 1, r"pdf raises ZeroDivisionError: too far right, for x = \[0\.999\d+, 0\.\d+\]"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_nan_and_exceptions_at_some_inputs_are_findings(sample, pdf, reason):
    result = eb.check_sampler(sample, pdf, "square")
    assert result.verdict == "reject" and re.search(reason, result.reason), result.reason


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"domain": "disc"}, ValueError, "unknown domain \"disc\""),
        ({"domain": "discrete:0"}, ValueError, "needs a number"),
        ({"level": 0.0}, ValueError, "level: level 0"),
        ({"level": float("nan")}, ValueError, "level"),
        ({"detect": 2}, ValueError, "detect: error 2"),
        ({"detect": 1e-9}, ValueError, "more than 2\\^34 samples"),
        ({"samples": 0}, ValueError, "at least one sample"),
        ({"samples": 1.5}, TypeError, "integer"),
        ({"seed": -1}, ValueError, "seed"),
        ({"seed": 2**64}, ValueError, "seed: 18446744073709551616"),
        ({"dimension": 65}, ValueError, "dimension: 65"),
        ({"dimension": -1}, ValueError, "dimension: -1"),
        ({"mass": 1.5}, ValueError, "mass: 1.5"),
        ({"atoms": [((0.5,), 0.1)]}, ValueError, "atoms"),
        ({"atoms": [((0.5, 0.5), 1.1)]}, ValueError, "atoms"),
        ({"atoms": [((0.5, 1.5), 0.1)]}, ValueError, r"atoms: \(\[0.5, 1.5\], 0.1\) is no point"),
    ],
)
def test_arguments_out_of_range(options, kind, message):
    arguments = {"domain": "square"} | options
    with pytest.raises(kind, match=message):
        eb.check_sampler(uniform, one, **arguments)


def test_exceptions_of_functions_come_back_unchanged():
    class Own(Exception):
        pass

    error = Own("mine")

    def fails(x):
        raise error

    with pytest.raises(Own) as caught:
        eb.check_sampler(uniform, fails, "square")
    assert caught.value is error and any(frame.name == "fails" for frame in caught.traceback)
    with pytest.raises(Own):
        eb.check_sampler(fails, one, "square")
    # Later tests are not disturbed
    assert eb.check_sampler(uniform, one, "square")


def test_functions_run_in_the_calling_thread_one_at_a_time():
    threads, running = set(), []

    def pdf(x):
        running.append(1)
        threads.add(threading.get_ident())
        assert len(running) == 1
        running.pop()
        return np.ones(len(x))

    assert eb.check_sampler(uniform, pdf, "square")
    assert threads == {threading.get_ident()}


def test_tests_may_be_nested_and_run_in_many_threads():
    inner = []

    def pdf(x):
        if not inner:
            inner.append(bool(eb.check_sampler(uniform, one, "square", samples=20_000)))
        return np.ones(len(x))

    assert eb.check_sampler(uniform, pdf, "square") and inner == [True]
    found = []
    many = [threading.Thread(target=lambda: found.append(bool(eb.check_sampler(uniform, one, "square")))) for _ in range(3)]
    [thread.start() for thread in many]
    [thread.join(60) for thread in many]
    assert found == [True] * 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="skipped: no fork")
def test_a_forked_process_can_test():
    assert eb.check_sampler(uniform, one, "square")
    child = os.fork()
    if child == 0:
        os._exit(0 if eb.check_sampler(uniform, one, "square") else 1)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            assert status == 0
            return
        time.sleep(0.05)
    os.kill(child, signal.SIGKILL)
    pytest.fail("the child hangs")


@pytest.mark.skipif(os.name != "posix", reason="skipped: signals of POSIX")
@pytest.mark.parametrize("what", ["sampler", "images", "furnace"])
def test_ctrl_c_raises_at_once(what):
    noise = np.random.default_rng(1).random((8, 1024, 1024, 3), dtype=np.float32) if what == "images" else None
    pid = os.getpid()
    threading.Timer(0.5, lambda: os.kill(pid, signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while True:
            if what == "sampler":
                eb.check_sampler(uniform, one, "square", detect=1e-4)
            elif what == "furnace":
                eb.furnace("ggx", size=(256, 256))
            else:
                eb.compare_images(noise[:4], noise[4:])
    assert time.monotonic() - start < 5
    assert eb.check_sampler(uniform, one, "square")


def test_the_interpreter_goes_on_meanwhile():
    """Another thread runs while a test computes without callbacks."""
    ticks = []
    stop = threading.Event()
    thread = threading.Thread(target=lambda: [ticks.append(1) or time.sleep(0.001) for _ in iter(stop.is_set, True)])
    thread.start()
    eb.furnace("ggx", size=(12, 12))
    stop.set()
    thread.join()
    assert len(ticks) > 20


def test_functions_of_one_row_at_a_time_are_errors_of_use():
    import math

    with pytest.raises(TypeError):
        eb.check_sampler(lambda u: [[math.sqrt(u[:, 0]), 0.5]], one, "square")
