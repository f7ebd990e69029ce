"""Where a finger's segments are cut because its stiffness varies: by decades along it, or within a narrow place."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from gripper.arrays import Array

_ORDER = 6
"""Order of the strains that segments are cut for: the fields' own lies between 3 and 14."""
_UNRESOLVED = 1e-2  # of the largest compliance: what polynomials of that order may leave
_SHORTEST = 1e-4  # of L
_POINTS = 16


def graded(compliance: Callable[[Array], Array], marks: tuple[float, ...]) -> tuple[float, ...]:
    """The places between marks at which halved segments end, so that polynomials resolve the compliance on each.

    The strains of a finger are its moments, which are smooth, times its compliance.

    Parameters
    ----------
    compliance
        1 / EI over sigma in [0, 1].
    marks
        Where segments end already, 0 and 1 among them.
    """
    x = np.cos(np.linspace(np.pi, 0.0, _POINTS))  # both ends among them, where a compliance is largest
    modes = np.polynomial.legendre.legvander(x, _ORDER)
    left = modes @ np.linalg.pinv(modes) - np.eye(_POINTS)
    parts, cuts = list(itertools.pairwise(marks)), []
    largest = float(np.max(compliance(np.array(marks))))
    while parts:
        start, stop = parts.pop()
        values = compliance((start + stop) / 2 + (stop - start) / 2 * x)
        largest = max(largest, float(np.max(values)))
        if stop - start < 2 * _SHORTEST or float(np.max(np.abs(left @ values))) < _UNRESOLVED * largest:
            continue
        middle = (start + stop) / 2
        cuts.append(middle)
        parts += [(start, middle), (middle, stop)]
    return tuple(sorted(cuts))
