"""Second derivatives of an equilibrium's numbers: by each number of the scene, and along the motion.

With r(x, q, p) = 0 and its rates r_x x_p + r_p = 0 by every number p, one derivative more along a direction gives

    r_x x_pa = - d/da (r_x x_p + r_p), the rates x_p held,

whose right-hand side is what the formulas of the first derivatives give at arrays that carry their rate along a
(:mod:`gripper.sensitivity.jet`). The matrix is the same one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gripper.arrays import Array
from gripper.sensitivity.flow import Change
from gripper.sensitivity.jet import jet, rate_of
from gripper.sensitivity.numbers import Reading
from gripper.sensitivity.seeds import Seeds, Solved
from gripper.sensitivity.swept import SweptObstacle
from gripper.sensitivity.tangent import carried, residual, whole
from gripper.sensitivity.touching import Touching
from gripper.statics.equilibrium import Equilibrium


def along_motion(seeds: Seeds, equilibrium: Equilibrium) -> Reading:
    """An equilibrium's rates by each number, carrying their own along the motion.

    Raises
    ------
    NotFormedError
        Where second derivatives are not formed.
    """
    known, parameter = seeds.solved(equilibrium), equilibrium.obstacle.frame.parameter
    if parameter is None:
        raise ValueError("the equilibrium must be one of a motion; got one without a parameter")
    frames = seeds.going(parameter)
    found, frame = known.rates, equilibrium.obstacle.frame
    going: dict[str, Any] = {
        name: jet(getattr(frame, name), getattr(known.frames, name)[-1])
        for name in ("origin", "angle", "velocity", "spin")
    }
    touching = known.touching.moved(found.change, -1, SweptObstacle(equilibrium.obstacle, replace(frame, **going)))
    change = seeds.change(touching, frames)
    off = left(touching, change, found.solution)
    solution = jet(found.solution, -np.linalg.solve(found.system, off.T).T)
    return Reading.of(seeds, Solved(touching, frames, carried(touching, change, solution, found.system)))


def left(touching: Touching, change: Change, solution: Array) -> Array:
    """How the residual's rates change (d, n + m + k) as an equilibrium moves, the rates of its unknowns held."""
    found: Array = rate_of(residual(touching, strained(touching, whole(touching, change, solution))).stacked)
    return found


def strained(touching: Touching, change: Change) -> Change:
    """A change whose stresses are also those of its strains: what else the system's matrix gives."""
    if change.coefficients is None:
        return change
    geometry = touching.geometry
    strains = (change.coefficients @ geometry.rule.modes.T).reshape(*change.stresses.shape)
    return replace(change, stresses=change.stresses + touching.sections.stiffness * strains)
