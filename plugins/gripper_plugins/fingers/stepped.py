"""The finger whose thickness is linear between stations, and may jump at them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import sympy

from gripper.fields import Coordinate, Length
from gripper.fingers import Finger

FLANK = 0.1  # a jump's run over the height of its step on each face


@dataclass(frozen=True, kw_only=True)
class Stepped(Finger):
    """Finger of piecewise linear thickness; a jump is a steep flank, 84 degrees to the axis, about its station.

    Parameters
    ----------
    stations
        Arc lengths s, from 0 to L, in m, none falling; the same one twice is a jump.
    thicknesses
        In-plane thickness w at each station, in m.
    length, width, material, jaw
        As every `gripper.fingers.Finger`.

    Raises
    ------
    ValueError
        The stations do not run from 0 to L, are not as many as the thicknesses, or leave no room for a flank.
    """

    stations: tuple[Coordinate, ...]
    thicknesses: tuple[Length, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        s, w = self.stations, self.thicknesses
        if len(s) < 2 or len(s) != len(w):
            raise ValueError(f"thicknesses must be as many as stations, 2 or more; got {len(w)} and {len(s)}")
        if s[0] != 0 or s[-1] != self.length:
            raise ValueError(f"stations must run from 0 to length = {self.length}, in m; got {s!r}")
        if any(a > b for a, b in pairwise(s)):
            raise ValueError(f"stations must not fall, in m; got {s!r}")
        marks = [place for place, _ in self._marks()]
        if any(a >= b for a, b in pairwise(marks)) or (marks[0], marks[-1]) != (0, self.length):
            raise ValueError(f"stations must leave room for the flanks of jumps, in m; got {s!r}, flanks at {marks!r}")

    def _marks(self) -> list[tuple[float, float]]:
        """The corners (s, w) of the profile: stations, and both ends of each flank."""
        s, w = self.stations, self.thicknesses
        runs = [
            FLANK * abs(b - a) / 4 if p == q else 0.0 for (p, q), (a, b) in zip(pairwise(s), pairwise(w), strict=True)
        ]
        before, after = [0.0, *runs], [*runs, 0.0]
        return [(p + one - other, v) for p, v, one, other in zip(s, w, before, after, strict=True)]

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Write the thickness, in m."""
        pieces = [(a + (b - a) * (s - p) / (q - p), s <= q) for (p, a), (q, b) in pairwise(self._marks())]
        return sympy.Piecewise(*pieces[:-1], (pieces[-1][0], True))

    def kinks(self) -> tuple[float, ...]:
        """Where the thickness or its slope changes, in m."""
        return tuple(place for place, _ in self._marks()[1:-1])
