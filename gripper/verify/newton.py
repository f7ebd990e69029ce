"""Equilibrium of finger and contact: Newton with the exact derivative and a line search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gripper.objects import Array
from gripper.verify.body import Body
from gripper.verify.contact import Contact, History, Touch
from gripper.verify.elements import Elements
from gripper.verify.material import InvertedError
from gripper.verify.mesh import Index
from gripper.verify.motion import Frame

MOST_ITERATIONS = 25
ACCURACY = 1e-9  # residual over contact forces
_SEARCHES = 6
_DESCENT = 0.8


class NoSolutionError(ArithmeticError):
    """Newton did not reach an equilibrium."""


@dataclass(frozen=True, eq=False)
class Solution:
    """An equilibrium.

    Parameters
    ----------
    unknowns
        Of the body.
    positions
        All nodes (n, 2), in m.
    touch
        Contact forces.
    energy
        Strain energy, in J.
    matrix
        The system's matrix, of the last iteration.
    iterations
        How many it took.
    """

    unknowns: Array
    positions: Array
    touch: Touch
    energy: float
    matrix: Array
    iterations: int


@dataclass(frozen=True, eq=False)
class System:
    """The finger against its object.

    Parameters
    ----------
    body, elements, contact
        Its parts.
    floor
        What counts as no force, in N: above the round-off of the elements' forces.
    """

    body: Body
    elements: Elements
    contact: Contact
    floor: float

    def residual(
        self, unknowns: Array, frame: Frame, history: History, frozen: Index | None = None
    ) -> tuple[Array, Touch, float]:
        """Forces on the unknowns that are out of balance, the contact forces, and the strain energy."""
        positions = self.body.positions(unknowns)
        energy, forces = self.elements.forces(positions)
        touch = self.contact.touch(positions, frame, history, frozen)
        forces = forces - self.contact.on_nodes(touch, len(positions))
        return self.body.reduced(forces, unknowns), touch, energy

    def matrix(self, unknowns: Array, touch: Touch) -> Array:
        """Derivative of the residual, in band storage."""
        positions = self.body.positions(unknowns)
        forces, values = self.elements.tangent(positions)
        forces = forces - self.contact.on_nodes(touch, len(positions))
        blocks = [(values, self.elements.rows, self.elements.columns), self.contact.derivative(touch)]
        return self.body.banded(blocks, forces, unknowns)

    def solve(self, start: Array, frame: Frame, history: History, frozen: Index | None = None) -> Solution:
        """Find the equilibrium next to a start.

        Parameters
        ----------
        start
            Unknowns.
        frame
            Of the object.
        history
            The last pose.
        frozen
            Places that touched in the last pose: the first iteration keeps them, which predicts along the tangent.

        Raises
        ------
        NoSolutionError
            Newton does not converge.
        InvertedError
            Where every step inverts an element.
        """
        unknowns = start
        residual, touch, energy = self.residual(unknowns, frame, history, frozen)
        matrix = self.matrix(unknowns, touch)
        for iteration in range(1, MOST_ITERATIONS + 1):
            step = self.body.solve(matrix, -residual)
            if not np.all(np.isfinite(step)):
                raise NoSolutionError("the system is singular")
            predicting = iteration == 1 and frozen is not None
            slope = None if predicting else float(residual @ step)

            def trial(factor: float, at: Array = unknowns, step: Array = step) -> tuple[Array, Touch, float]:
                return self.residual(at + factor * step, frame, history)

            factor, (residual, touch, energy) = _search(trial, step, slope)
            unknowns = unknowns + factor * step
            allowed = ACCURACY * float(np.sum(np.abs(touch.forces))) + self.floor
            if np.linalg.norm(residual) <= allowed:
                return Solution(unknowns, self.body.positions(unknowns), touch, energy, matrix, iteration)
            matrix = self.matrix(unknowns, touch)
        raise NoSolutionError(f"no convergence in {MOST_ITERATIONS} iterations")


def _search(
    trial: Callable[[float], tuple[Array, Touch, float]], step: Array, slope: float | None
) -> tuple[float, tuple[Array, Touch, float]]:
    """The longest tried part of a step that inverts nothing and lowers the work of the residual along it."""
    factor = 1.0
    best: tuple[float, float, tuple[Array, Touch, float]] | None = None
    for _ in range(_SEARCHES):
        try:
            found = trial(factor)
        except InvertedError:
            factor /= 2
            continue
        work = float(found[0] @ step)
        if slope is None or abs(work) <= _DESCENT * abs(slope):
            return factor, found
        if best is None or abs(work) < best[0]:
            best = abs(work), factor, found
        ratio = slope / (slope - work) if work * slope < 0 else 0.5
        factor *= min(max(ratio, 0.1), 0.5)
    if best is None:
        raise InvertedError("every step inverts an element")
    return best[1], best[2]
