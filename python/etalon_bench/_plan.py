"""How a statistical test is done, as the extension takes it."""

from __future__ import annotations

import operator
from dataclasses import dataclass


@dataclass(frozen=True)
class Plan:
    level: float
    detect: float
    samples: int | None
    seed: int


def plan(level: float, detect: float, samples: int | None, seed: int) -> Plan:
    """A plan whose numbers have their types.

    Raises:
        TypeError: for values that are no numbers.
        ValueError: for a seed that is not from 0 to 2^64 - 1, or a number of samples below 1.
    """
    count = None if samples is None else operator.index(samples)
    if not 0 <= operator.index(seed) < 1 << 64 or (count is not None and count < 1):
        raise ValueError(f"seed: {seed}, samples: {samples}; wanted a seed from 0 to 2^64 - 1 and at least one sample")
    return Plan(float(level), float(detect), count, operator.index(seed))


def function(value: object, name: str) -> None:
    """Refuses what cannot be called.

    Raises:
        TypeError: with the argument's name.
    """
    if not callable(value):
        raise TypeError(f"{name}: wanted a function, not {type(value).__name__}")
