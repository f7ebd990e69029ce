"""How near friction is to locking the finger, by the numbers of its scene.

A contact locks at the ratio rho at which the matrix M(rho) of the slipping contact, linear in rho, is singular: with
u M = 0 and M v = 0

    rho_p = - (u M_p v) / (u M_rho v),

and M_p v is the derivative along v of the residual's rates: second derivatives, as :mod:`gripper.sensitivity.second`
has them along the motion.
"""

from __future__ import annotations

import numpy as np

from gripper.arrays import Array
from gripper.motion.locking import Limit, limits, opened
from gripper.sensitivity.flow import Change
from gripper.sensitivity.jet import NotFormedError
from gripper.sensitivity.second import left
from gripper.sensitivity.seeds import Seeds, Solved
from gripper.sensitivity.swept import SweptObstacle
from gripper.sensitivity.tangent import whole
from gripper.sensitivity.touching import Touching
from gripper.statics.equilibrium import Equilibrium


def nearness_rates(seeds: Seeds, equilibrium: Equilibrium, value: float) -> Array:
    """Rates of mu over its limiting value, at the contact where that is (about) a value.

    Raises
    ------
    NotFormedError
        Where a contact lies on a face: ends of segments move with it, which the limit holds still.
    """
    known = seeds.solved(equilibrium)
    equilibrium, setting = known.touching.equilibrium, seeds.setting
    every = [limit for heading in (1.0, -1.0) for limit in limits(setting, equilibrium, heading)]
    limit = min(every, key=lambda each: abs(each.nearness - value))
    mu = seeds.friction_rates(equilibrium.state.sites[limit.contact])
    if not np.isfinite(limit.ratio):
        return np.zeros(len(seeds.keys))
    if any(site.on_face for site in equilibrium.state.sites):
        raise NotFormedError("a contact on a face")
    return (mu - limit.nearness * np.sign(limit.ratio) * _limit_rates(seeds, known, limit)) / abs(limit.ratio)


def _limit_rates(seeds: Seeds, known: Solved, limit: Limit) -> Array:
    """Rates of the ratio that would lock the finger."""
    setting, equilibrium = seeds.setting, known.touching.equilibrium
    without, slipping = (opened(setting, equilibrium, limit.contact, ratio) for ratio in (0.0, limit.ratio))
    matrix = slipping.matrix()
    across, _, along = np.linalg.svd(matrix)
    u, v = across[:, -1], along[-1]
    touching = Touching(setting, slipping, seeds.finger, seeds.loads)
    way = whole(touching, Change.none(touching, 1), v[None])
    moved = touching.moved(way, 0, SweptObstacle(equilibrium.obstacle, equilibrium.obstacle.frame))
    off = left(moved, seeds.change(moved, known.frames), _solution(known, touching))
    turned: Array = -(off @ u) * limit.ratio / (u @ (matrix - without.matrix()) @ v)
    return turned


def _solution(known: Solved, touching: Touching) -> Array:
    """The equilibrium's rates without those of the ratio at the contacts that are free to slip."""
    found, parts = known.rates, [known.rates.unknowns, known.rates.multipliers]
    for old, new in zip(known.touching.spans, touching.spans, strict=True):
        parts.append(found.places[:, old.column : old.column + new.site.unknowns])
    return np.concatenate(parts, axis=1)
