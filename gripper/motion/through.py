"""The polynomial through samples of a smooth number, with a bound of what may lie above it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gripper.arrays import Array
from gripper.contact.parabola import vertex

_SAME = 1e-5
_HALF = 32
_MARKS = np.linspace(0.0, 1.0, 2 * _HALF + 1)
_AROUND = np.linspace(-0.5, 0.5, 2 * _HALF + 1)
_ZOOMS = 3  # after which a parabola's vertex is found to round-off


class Through:
    """Newton's form of the polynomial through samples, which may be added one by one.

    Parameters
    ----------
    samples
        Place and value of each.
    """

    def __init__(self, samples: Iterable[tuple[float, float]]) -> None:
        self._places: list[float] = []
        self._factors: list[float] = []  # divided differences
        for place, value in samples:
            self.add(place, value)

    def add(self, place: float, value: float) -> None:
        """Take in a sample more."""
        for known, factor in zip(self._places, self._factors, strict=True):
            value = (value - factor) / (place - known)
        self._places.append(place)
        self._factors.append(value)

    def knows(self, place: float) -> bool:
        """Whether a sample is so near that another one there would tell of round-off only."""
        return min(abs(place - known) for known in self._places) < _SAME

    def highest(self) -> tuple[float, float]:
        """Where on [0, 1] it may be highest, and how high there: with what one sample more might add."""
        marks, step = _MARKS, 1.0
        for _ in range(_ZOOMS):
            heights = self._hopes(marks)
            best = int(np.argmax(heights))
            place, height = vertex(marks, heights, best)
            if best in (0, marks.size - 1):
                break
            step /= _HALF
            marks = marks[best] + step * _AROUND
        return place, height

    def _hopes(self, places: Array) -> Array:
        """Its values at some places (k,), and what one sample more would add, were its divided difference as large.

        That is nothing at the samples themselves. Lengths count by the unit of the places.
        """
        values, product = np.zeros(places.shape), np.ones(places.shape)
        for place, factor in zip(self._places, self._factors, strict=True):
            values += factor * product
            product *= places - place
        return values + abs(self._factors[-1]) * np.abs(product)
