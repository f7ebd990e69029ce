"""What else loads the finger at a pose, as plain numbers: SI, world frame."""

from __future__ import annotations

import numpy as np

from gripper.beam.sections import Sections
from gripper.contact.kinematics import Placement
from gripper.results.pose_result import Applied
from gripper.statics.acting import Felt
from gripper.statics.equilibrium import Equilibrium


def applied(equilibrium: Equilibrium, placement: Placement, scales: Sections) -> tuple[Applied, ...]:
    """One entry a load and station; of a load along the whole axis its resultant, at its weighted place."""
    acting = equilibrium.obstacle.acting
    if acting is None:
        return ()
    out = []
    for i, (felt, load) in enumerate(zip(acting.each(equilibrium.state.axis), acting.loads.parts, strict=True)):
        for part in _parts(felt) if load.stations is not None else (_resultant(felt),):
            point = placement.origin + placement.turn * complex(part.points[0]) * scales.length
            force = placement.turn * complex(part.forces[0]) * scales.force_scale
            out.append(
                Applied(
                    load=i,
                    s=float(part.s[0]) * scales.length,
                    point=(point.real, point.imag),
                    force=(force.real, force.imag),
                    moment=float(part.couples[0]) * scales.energy_scale,
                )
            )
    return tuple(out)


def _parts(felt: Felt) -> list[Felt]:
    return [Felt(*(getattr(felt, name)[i : i + 1] for name in Felt.__dataclass_fields__)) for i in range(felt.s.size)]


def _resultant(felt: Felt) -> Felt:
    """All of it at its middle, weighted by its size: weight at the centre of mass."""
    sizes = np.abs(felt.forces) + np.abs(felt.couples)
    weights = sizes / sizes.sum() if sizes.any() else np.full(sizes.shape, 1 / sizes.size)
    point = np.atleast_1d(weights @ felt.points)
    couple = np.sum(((felt.points - point).conj() * felt.forces).imag + felt.couples)
    return Felt(np.atleast_1d(weights @ felt.s), point, np.atleast_1d(felt.forces.sum()), np.atleast_1d(couple))
