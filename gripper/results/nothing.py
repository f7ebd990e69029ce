"""What is nothing to a reader: round-off, and numbers that a finger so stiff would not feel. Data keep them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from gripper.beam.sections import sections
from gripper.pose import placed

if TYPE_CHECKING:
    from gripper.scene import Scene

PART = 1e-12
"""Of what bends a finger by its own length, and of 1: less is nothing."""
_GAP = 1e-9
"""Of a finger's length: a smaller gap is none."""


class Least(NamedTuple):
    """Smaller numbers are nothing: by kind, in N, N m, J, m, and of strains and angles."""

    force: float
    moment: float
    energy: float
    length: float
    ratio: float


def least(scene: Scene) -> Least:
    """Give the least numbers that count in a scene."""
    finger = sections(placed(scene.finger).body)
    force, moment = PART * finger.force_scale, PART * finger.energy_scale
    return Least(force, moment, PART * moment, _GAP * finger.length, PART)
