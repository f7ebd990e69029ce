"""Equilibrium of finger and contact: Newton with the exact derivative and a line search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse

from gripper.objects import Array
from gripper.verify.body import Body, positive, solve
from gripper.verify.contact import Contact
from gripper.verify.elements import Elements
from gripper.verify.material import InvertedError
from gripper.verify.motion import Frame
from gripper.verify.touch import History, Touch

MOST_ITERATIONS = 16
STAGES = ((1 / 256, 0.1), (1 / 16, 0.1), (1.0, 1e-9))
"""Of the contact's stiffness: its share, and the residual over the contact forces that ends the stage."""
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
    iterations
        How many it took.
    """

    unknowns: Array
    positions: Array
    touch: Touch
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
    drag, anchor
        Stiffness (N/m, on a rigid jaw's angle N m) of springs from the unknowns to an anchor: none by default.
    """

    body: Body
    elements: Elements
    contact: Contact
    floor: float
    drag: Array | None = None
    anchor: Array | None = None

    def residual(self, unknowns: Array, frame: Frame, history: History) -> tuple[Array, Touch]:
        """Forces on the unknowns that are out of balance, and the contact forces."""
        positions = self.body.positions(unknowns)
        _, forces = self.elements.forces(positions)
        touch = self.contact.touch(positions, frame, history)
        residual = self.body.reduced(forces - touch.on_nodes(len(positions)), unknowns)
        if self.drag is not None and self.anchor is not None:
            residual = residual + self.drag * (unknowns - self.anchor)
        return residual, touch

    def matrix(self, unknowns: Array, touch: Touch) -> sparse.csc_array:
        """Derivative of the residual."""
        positions = self.body.positions(unknowns)
        forces, values = self.elements.tangent(positions)
        blocks = [(values, self.elements.rows, self.elements.columns), touch.derivative()]
        matrix = self.body.matrix(blocks, forces - touch.on_nodes(len(positions)), unknowns)
        return matrix if self.drag is None else (matrix + sparse.diags_array(self.drag)).tocsc()

    def stable(self, solution: Solution) -> bool:
        """Whether the energy has a minimum there; not decided with friction, where there is no energy."""
        return self.contact.rough or positive(self.matrix(solution.unknowns, solution.touch))

    def solve(self, start: Array, frame: Frame, history: History) -> Solution:
        """Find the equilibrium next to a start.

        Contact is soft at first and stiffened in stages: its patch is then wide enough for Newton's steps.

        Parameters
        ----------
        start
            Unknowns.
        frame
            Of the object.
        history
            The last pose.

        Raises
        ------
        NoSolutionError
            Newton does not converge.
        InvertedError
            Where every step inverts an element.
        """
        unknowns, iterations = start, 0
        for stiffness, accuracy in STAGES:
            softened = replace(self, contact=self.contact.softened(stiffness))
            found = softened._newton(unknowns, frame, history, accuracy)
            unknowns, iterations = found.unknowns, iterations + found.iterations
            if not found.touch.at.size:
                break
        return replace(found, iterations=iterations)

    def _newton(self, unknowns: Array, frame: Frame, history: History, accuracy: float) -> Solution:
        residual, touch = self.residual(unknowns, frame, history)
        for iteration in range(MOST_ITERATIONS + 1):
            if np.linalg.norm(residual) <= accuracy * touch.size + self.floor:
                return Solution(unknowns, self.body.positions(unknowns), touch, iteration)
            step = solve(self.matrix(unknowns, touch), -residual)

            def trial(factor: float, at: Array = unknowns, step: Array = step) -> tuple[Array, Touch]:
                return self.residual(at + factor * step, frame, history)

            factor, (residual, touch) = _search(trial, step, float(residual @ step))
            unknowns = unknowns + factor * step
        raise NoSolutionError(f"no convergence in {MOST_ITERATIONS} iterations")


def _search(
    trial: Callable[[float], tuple[Array, Touch]], step: Array, slope: float
) -> tuple[float, tuple[Array, Touch]]:
    """The longest tried part of a step that inverts nothing and lowers the residual's work along it from ``slope``."""
    factor = 1.0
    best: tuple[float, float, tuple[Array, Touch]] | None = None
    for _ in range(_SEARCHES):
        try:
            found = trial(factor)
        except InvertedError:
            factor /= 2
            continue
        work = float(found[0] @ step)
        if abs(work) <= _DESCENT * abs(slope):
            return factor, found
        if best is None or abs(work) < best[0]:
            best = abs(work), factor, found
        factor *= min(max(slope / (slope - work), 0.1), 0.5) if work * slope < 0 else 0.5
    if best is None:
        raise InvertedError("every step inverts an element")
    return best[1], best[2]
