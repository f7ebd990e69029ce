"""An object grown by a distance, its corners rounded."""

from __future__ import annotations

from dataclasses import dataclass

from gripper.objects import Offset


@dataclass(frozen=True, kw_only=True)
class Grown(Offset):
    """Another object, larger by a distance all around: a polygon becomes a block with rounded corners.

    Parameters
    ----------
    part
        The object, with bounds, as it is or placed by numbers.
    distance
        How much it grows, and the radius of its rounded corners, in m.
    """
