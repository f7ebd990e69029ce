"""One finger on outlines of every kind: a polygon, a spline, a notch, and three pins that all touch.

Polygon and spline go through points of a circle, whose exact answer is in tests/reference/exact.json. Notch and pins
stand where beam theory (small deflections) has the same force at every contact.
"""

from math import atan2, cos, pi, sin

import numpy as np

import gripper as gr
from gripper.plot import beside
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Difference, Polygon, Spline, Union

nylon = gr.Material(youngs_modulus=2.0e9, poisson_ratio=0.4)
finger = Uniform(length=0.1, thickness=0.006, width=0.01, material=nylon)
EI, PIN = 2.0e9 * 0.01 * 0.006**3 / 12, 0.003  # N m^2, and the radius of a pin in m
ROUND = tuple((0.025 * cos(2 * pi * i / 48), 0.025 * sin(2 * pi * i / 48)) for i in range(48))  # points of a circle


def heights(places: tuple[float, ...], force: float) -> np.ndarray:
    """Where (m) the lower face of a cantilever lies at places (m) that carry this force (N) each."""
    near, far = np.minimum.outer(places, places), np.maximum.outer(places, places)
    return force * (near**2 * (3 * far - near)).sum(axis=0) / (6 * EI) - 0.003


def outlines(force: float) -> dict[str, gr.Placed]:
    """Give the four by name; notch and pins press with about this force (N) at every contact."""
    low, high = heights((0.055, 0.085), force)
    block = Polygon(vertices=((-0.03, 0), (0.03, 0), (0.03, -0.02), (-0.03, -0.02)))
    notched = Difference(parts=(block, Circle(radius=0.015)))
    tops = zip(pins := (0.04, 0.065, 0.09), heights(pins, force), strict=True)
    return {
        "polygon": Polygon(vertices=ROUND[::2]).at(x=0.07, y=-0.02),
        "spline": Spline(points=ROUND[::3]).at(x=0.07, y=-0.02),
        "notch": notched.at(x=0.07, y=(low + high) / 2, angle=atan2(high - low, 0.03)),
        "three pins": Union(parts=tuple(Circle(radius=PIN).at(x=x, y=y - PIN) for x, y in tops)).at(),
    }


def main(folder: str = "out/outlines", force: float = 10.0) -> dict[str, gr.Result]:
    """Solve the four and draw them beside each other into the folder."""
    objects = outlines(force).items()
    results = {name: gr.solve(gr.Scene(finger=finger, object=o, theory="bending")) for name, o in objects}
    beside(results, title="One finger on four outlines").savefig(f"{folder}/outlines.png")
    return results


if __name__ == "__main__":
    print(*main().values(), "Figures: out/outlines", sep="\n")
