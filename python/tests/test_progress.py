"""The line of progress, and what an interruption says."""

from __future__ import annotations

import io
import os
import signal
import threading
import time

import etalon_bench as eb
import numpy as np
import pytest
from etalon_bench import _progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def slow(u: np.ndarray) -> np.ndarray:
    time.sleep(0.3)
    return u


def test_a_line_says_how_long_it_will_take() -> None:
    assert _progress.line("ggx", 11, 44, 5.0) == "ggx: 11 of 44, 5 s, about 15 s left"
    assert _progress.line("ggx", 0, 44, 5.0) == "ggx: 0 of 44, 5 s"
    assert _progress.line("ggx", 0, 0, 5.0) == "ggx: 5 s"


def test_long_work_is_told_of_in_a_terminal_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_progress, "write", _progress._to_stderr)
    for stream, is_told in ((Terminal(), True), (io.StringIO(), False)):
        monkeypatch.setattr("sys.stderr", stream)
        eb.check_sampler(slow, lambda x: np.ones(len(x)), "square", samples=40_000, name="slow")
        assert ("slow: 2 s" in stream.getvalue()) == is_told
        assert stream.getvalue().endswith(" \r") == is_told


def test_an_interruption_says_what_was_done() -> None:
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt, match=r"slow: interrupted after \d+\.\d s"):
        eb.check_sampler(slow, lambda x: np.ones(len(x)), "square", samples=10_000_000, name="slow")
