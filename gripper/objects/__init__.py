"""The objects' side: what an outline is to the solver, and what a plugin has to write.

An object writes g(x, y) in its own frame, in metres: negative inside, positive outside, |grad g| about 1 on
the outline. All else (derivatives, bounds, box, outline) is derived here.
"""

from gripper.objects.base import Array, Box, Object
from gripper.objects.closed import closed_points, closed_polygon
from gripper.objects.combined import Combined
from gripper.objects.feature import FeatureSurface
from gripper.objects.implicit import ImplicitSurface
from gripper.objects.level_set import typical_slope
from gripper.objects.offset import Offset
from gripper.objects.part import Part
from gripper.objects.quadric import Quadric

__all__ = [
    "Array",
    "Box",
    "Combined",
    "FeatureSurface",
    "ImplicitSurface",
    "Object",
    "Offset",
    "Part",
    "Quadric",
    "closed_points",
    "closed_polygon",
    "typical_slope",
]
