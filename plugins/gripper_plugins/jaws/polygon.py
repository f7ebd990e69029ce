"""The jaw of any shape."""

from __future__ import annotations

from dataclasses import dataclass

from gripper.fields import Point
from gripper.fingers import Jaw
from gripper.objects import closed_polygon


@dataclass(frozen=True, kw_only=True)
class PolygonJaw(Jaw):
    """Jaw given by its corners.

    Parameters
    ----------
    vertices
        Corners (x, y) in the jaw frame (origin on the neutral axis at s = L), in m, in either sense.
    """

    vertices: tuple[Point, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        closed_polygon("vertices", self.vertices)

    def polygon(self, thickness: float) -> tuple[tuple[float, float], ...]:
        """Return the vertices (n, 2), in m, whatever the finger's thickness (m)."""
        return self.vertices
