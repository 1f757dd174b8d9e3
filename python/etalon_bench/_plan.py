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
        ValueError: for a negative seed or number of samples.
    """
    count = None if samples is None else operator.index(samples)
    if operator.index(seed) < 0 or (count is not None and count < 1):
        raise ValueError(f"seed: {seed}, samples: {samples}; wanted a seed of at least 0 and at least one sample")
    return Plan(float(level), float(detect), count, operator.index(seed))


def function(value: object, name: str) -> None:
    """Refuses what cannot be called.

    Raises:
        TypeError: with the argument's name.
    """
    if not callable(value):
        raise TypeError(f"{name}: wanted a function, not {type(value).__name__}")
