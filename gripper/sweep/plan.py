"""What a sweep varies: keys and their values, and every combination of them."""

from __future__ import annotations

import dataclasses
import itertools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from gripper.expression import number
from gripper.expression.dimensions import METRE, RADIAN, Dimension
from gripper.expression.vocabulary import UNITS
from gripper.fields import Finite, check_fields

MOST_VARIANTS = 10_000_000
_GLUED = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?) *([A-Za-z]+)")


class Axis(NamedTuple):
    """What a command line varies: a key, its values in SI units, and the unit in which they were written, if any."""

    key: str
    values: tuple[float, ...]
    unit: str = ""


@dataclasses.dataclass(frozen=True)
class Plan:
    """Keys of numbers, as a scene file writes them, and the values that each takes; all combinations are variants.

    Parameters
    ----------
    over
        Values (SI units) by key, in the order in which they vary: the last one fastest.
    units
        In which each key is shown; SI's where none is given.
    """

    over: tuple[tuple[str, tuple[Finite, ...]], ...]
    units: tuple[str, ...] = dataclasses.field(default=(), compare=False)

    def __init__(
        self,
        over: Mapping[str, Sequence[float]] | Sequence[Axis] | tuple[tuple[str, tuple[float, ...]], ...],
        units: Sequence[str] = (),
    ) -> None:
        pairs = over.items() if isinstance(over, Mapping) else [item[:2] for item in over]
        axes = tuple((key, tuple(np.asarray(values, dtype=float).ravel().tolist())) for key, values in pairs)
        object.__setattr__(self, "over", axes)
        written = [item.unit if isinstance(item, Axis) else "" for item in over]
        object.__setattr__(self, "units", tuple(units) or tuple(written))
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

    def shown_for(self, kind: Callable[[str], Dimension | None]) -> Plan:
        """This plan with a unit for each key that has none: mm and deg for what is a length or an angle."""
        usual = {METRE: "mm", RADIAN: "deg"}
        kinds = [kind(key) for key in self.keys]
        units = [unit or (usual.get(of, "") if of else "") for unit, of in zip(self.units, kinds, strict=True)]
        return Plan(self.over, units)

    def shown(self, i: int, value: float) -> str:
        """Write a value of the i-th key, in its unit."""
        unit = self.units[i]
        return f"{value / UNITS[unit]:.6g} {unit}" if unit else f"{value:.6g}"

    def variants(self) -> Iterator[tuple[float, ...]]:
        """Values of the keys, one variant after the other."""
        return itertools.product(*(values for _, values in self.over))


def spread(text: str, kind: Callable[[str], Dimension | None] = lambda key: None) -> Axis:
    """Read what a command line varies: ``key=start:stop:n`` or ``key=a,b,c``, numbers with units or not.

    Parameters
    ----------
    text
        As it is typed.
    kind
        Tells of which kind of quantity a key is; None where it is not known.

    Raises
    ------
    ValueError
        It is neither, or a unit is of another kind.
    """
    key, equals, right = text.partition("=")
    if not (key and equals and right):
        raise ValueError(f"over must be key=start:stop:n or key=a,b,c; got {text!r}")
    if ":" not in right:
        of = kind(key)
        return Axis(key, tuple(_number(key, part, of) for part in right.split(",")), _unit(right.split(",")))
    parts = right.split(":")
    if len(parts) != 3 or not parts[2].isdecimal() or int(parts[2]) < 2:
        raise ValueError(f"over must be {key}=start:stop:n, with n at least 2; got {text!r}")
    start, stop = (_number(key, part, kind(key)) for part in parts[:2])
    return Axis(key, tuple(np.linspace(start, stop, int(parts[2])).tolist()), _unit(parts[:2]))


def _unit(texts: Sequence[str]) -> str:
    """The unit in which numbers are written, where it is one."""
    glued = [_GLUED.fullmatch(text.strip()) for text in texts]
    names = {match[2] for match in glued if match and match[2] in UNITS}
    return names.pop() if len(names) == 1 else ""


def _number(key: str, text: str, kind: Dimension | None) -> float:
    """Read a number; on a command line 10mm is 10 mm."""
    glued = _GLUED.fullmatch(text.strip())
    try:
        return number(f"{glued[1]} {glued[2]}" if glued else text, kind)
    except ValueError as error:
        raise ValueError(f"values of {key} {str(error).removeprefix('expression ')}") from None
