"""Figures of a result: filmstrips to scale in the world frame, curves along the motion, animations.

Figures are made without pyplot: nothing global changes, no display is needed, and a notebook shows them. Written as
SVG they repeat bit for bit. ``result.filmstrip()``, ``result.curve()`` and ``result.animate()`` call these.
"""

from gripper.plot.animation import animate, check_film
from gripper.plot.compare import chart, compare, sticks
from gripper.plot.curve import curve
from gripper.plot.filmstrip import beside, filmstrip
from gripper.plot.quantity import QUANTITIES
from gripper.plot.sketch import Axis
from gripper.plot.style import COLUMN, INCH, PAGE, Picture, styled

__all__ = [
    "COLUMN",
    "INCH",
    "PAGE",
    "QUANTITIES",
    "Axis",
    "Picture",
    "animate",
    "beside",
    "chart",
    "check_film",
    "compare",
    "curve",
    "filmstrip",
    "sticks",
    "styled",
]
