"""What a sweep varies: keys and their values, and every combination of them."""

from __future__ import annotations

import dataclasses
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from gripper.expression import number
from gripper.fields import Finite, check_fields

MOST_VARIANTS = 10_000_000
_GLUED = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)([A-Za-z]+)")


@dataclasses.dataclass(frozen=True)
class Plan:
    """Keys of numbers, as a scene file writes them, and the values that each takes; all combinations are variants.

    Parameters
    ----------
    over
        Values (SI units) by key, in the order in which they vary: the last one fastest.
    """

    over: tuple[tuple[str, tuple[Finite, ...]], ...]

    def __init__(self, over: Mapping[str, Sequence[float]] | tuple[tuple[str, tuple[float, ...]], ...]) -> None:
        pairs = over.items() if isinstance(over, Mapping) else over
        axes = tuple((key, tuple(np.asarray(values, dtype=float).ravel().tolist())) for key, values in pairs)
        object.__setattr__(self, "over", axes)
        check_fields(self)
        for key, values in axes:
            if not values or len(set(values)) < len(values):
                raise ValueError(f"values of {key} must be different ones, at least one; got {values}")
        if not 1 <= self.size <= MOST_VARIANTS or not axes:
            raise ValueError(f"over must give 1 to {MOST_VARIANTS} variants; got {self.size if axes else 0}")

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies."""
        return tuple(key for key, _ in self.over)

    @property
    def size(self) -> int:
        """How many variants there are."""
        return int(np.prod([len(values) for _, values in self.over], dtype=np.int64)) if self.over else 0

    def variants(self) -> Iterator[tuple[float, ...]]:
        """Values of the keys, one variant after the other."""
        return itertools.product(*(values for _, values in self.over))


def spread(text: str) -> tuple[str, tuple[float, ...]]:
    """Read what a command line varies: ``key=start:stop:n`` or ``key=a,b,c``, numbers with units or not.

    Raises
    ------
    ValueError
        It is neither.
    """
    key, equals, right = text.partition("=")
    if not (key and equals and right):
        raise ValueError(f"over must be key=start:stop:n or key=a,b,c; got {text!r}")
    if ":" not in right:
        return key, tuple(_number(key, part) for part in right.split(","))
    parts = right.split(":")
    if len(parts) != 3 or not parts[2].isdecimal() or int(parts[2]) < 2:
        raise ValueError(f"over must be {key}=start:stop:n, with n at least 2; got {text!r}")
    return key, tuple(np.linspace(_number(key, parts[0]), _number(key, parts[1]), int(parts[2])).tolist())


def _number(key: str, text: str) -> float:
    """Read a number; on a command line 10mm is 10 mm."""
    glued = _GLUED.fullmatch(text.strip())
    try:
        return number(f"{glued[1]} {glued[2]}" if glued else text)
    except ValueError as error:
        raise ValueError(f"values of {key} {str(error).removeprefix('expression ')}") from None
