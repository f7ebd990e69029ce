"""What an answer says of a pose, by whatever method, and what an independent one says besides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Complex

MARKS = np.linspace(0.0, 1.0, 65)
"""Stations (by L) at which shapes are compared."""


class NoReferenceError(Exception):
    """There is no independent answer to this pose; says why."""


@dataclass(frozen=True, eq=False)
class Answer:
    """A pose by some method: lengths by L, forces by EI(0) / L^2, in the clamp's axes.

    Parameters
    ----------
    force
        On the finger, x + iy.
    place
        Mean of the points of contact, weighted by the sizes of their forces.
    energy
        Strain energy.
    axis
        At ``MARKS``.
    """

    force: complex
    place: complex
    energy: float
    axis: Complex


@dataclass(frozen=True, eq=False)
class Shot(Answer):
    """An answer by shooting.

    Parameters
    ----------
    residual
        What is left of its equations.
    """

    residual: float
