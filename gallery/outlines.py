"""One finger on outlines of every kind: a polygon, a spline, a notch, and three pins that all touch.

Polygon and spline go through points of a circle, whose exact answer is in tests/reference/exact.json. Notch and pins
stand where beam theory (small deflections) has the same force at every contact.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin
from pathlib import Path

import numpy as np

import gripper as gr
from gripper.plot import beside
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Difference, Polygon, Spline, Union

nylon = gr.Material(youngs_modulus=2.0e9, poisson_ratio=0.4)
finger = Uniform(length=0.1, thickness=0.006, width=0.01, material=nylon)
EI, ROUND, PIN = 2.0e9 * 0.01 * 0.006**3 / 12, 0.025, 0.003  # N m^2; radii of the circle and of a pin, in m


def on_circle(n: int) -> tuple[tuple[float, float], ...]:
    """Give n points on the circle."""
    return tuple((ROUND * cos(2 * pi * i / n), ROUND * sin(2 * pi * i / n)) for i in range(n))


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
        "polygon": Polygon(vertices=on_circle(24)).at(x=0.07, y=-0.02),
        "spline": Spline(points=on_circle(16)).at(x=0.07, y=-0.02),
        "notch": notched.at(x=0.07, y=(low + high) / 2, angle=atan2(high - low, 0.03)),
        "three pins": Union(parts=tuple(Circle(radius=PIN).at(x=x, y=y - PIN) for x, y in tops)).at(),
    }


def main(folder: str | Path = "out/outlines", force: float = 10.0) -> dict[str, gr.Result]:
    """Solve the four and draw them beside each other into the folder."""
    scenes = {name: gr.Scene(finger=finger, object=o, theory="bending") for name, o in outlines(force).items()}
    results = {name: gr.solve(scene) for name, scene in scenes.items()}
    Path(folder).mkdir(parents=True, exist_ok=True)
    beside(results, title="One finger on four outlines").savefig(Path(folder, "outlines.png"))
    return results


if __name__ == "__main__":
    print(*main().values(), "Figures: out/outlines", sep="\n")
