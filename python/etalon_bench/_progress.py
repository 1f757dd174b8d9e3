"""A line of progress for what takes longer than two seconds: in a terminal, in Jupyter, and by the plugin in pytest."""

from __future__ import annotations

import sys
from collections.abc import Callable

_WIDTH = 79


def _to_stderr(text: str) -> None:
    """Writes where a person looks on, and nowhere else."""
    stream = sys.stderr
    # The stream of a notebook is no terminal, but obeys a carriage return
    if stream is not None and (stream.isatty() or type(stream).__module__.startswith("ipykernel")):
        stream.write(text)
        stream.flush()


write: Callable[[str], None] = _to_stderr


def line(what: str, done: int, of: int, seconds: float) -> str:
    """What has been done in how many seconds, and how many are left."""
    if not of:
        return f"{what}: {seconds:.0f} s"
    left = f", about {seconds * (of - done) / done:.0f} s left" if done else ""
    return f"{what}: {done} of {of}, {seconds:.0f} s{left}"


def show(what: str, done: int, of: int, seconds: float) -> None:
    """Shows the line in place of the one before."""
    write("\r" + line(what, done, of, seconds)[:_WIDTH].ljust(_WIDTH))


def clear() -> None:
    """Takes the line away."""
    write("\r" + " " * _WIDTH + "\r")
