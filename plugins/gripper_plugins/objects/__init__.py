"""Objects: outlines g(x, y) = 0."""

from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.difference import Difference
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.grown import Grown
from gripper_plugins.objects.halfplane import HalfPlane
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.intersection import Intersection
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.spline import Spline
from gripper_plugins.objects.superellipse import Superellipse
from gripper_plugins.objects.union import Union

__all__ = [
    "Circle",
    "Conic",
    "Difference",
    "Ellipse",
    "Grown",
    "HalfPlane",
    "Implicit",
    "Intersection",
    "Polygon",
    "Spline",
    "Superellipse",
    "Union",
]
