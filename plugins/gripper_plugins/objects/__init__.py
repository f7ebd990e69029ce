"""Objects: outlines g(x, y) = 0."""

from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.spline import Spline

__all__ = ["Circle", "Conic", "Ellipse", "Implicit", "Polygon", "Spline"]
