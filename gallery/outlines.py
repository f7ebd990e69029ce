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
EI = 2.0e9 * 0.01 * 0.006**3 / 12
ROUND, PIN = 0.025, 0.003  # radii of the circle and of a pin, in m


def on_circle(n: int) -> tuple[tuple[float, float], ...]:
    """Give n points on the circle."""
    return tuple((ROUND * cos(2 * pi * i / n), ROUND * sin(2 * pi * i / n)) for i in range(n))


def heights(places: tuple[float, ...], force: float) -> np.ndarray:
    """Deflections (m) at places along a cantilever that carries this force (N) at each of them."""
    near, far = np.minimum.outer(places, places), np.maximum.outer(places, places)
    return near**2 * (3 * far - near) / (6 * EI) @ np.full(len(places), force)


def notched(force: float, places: tuple[float, float] = (0.055, 0.085)) -> gr.Placed:
    """Give a block with a notch whose two rims press alike; between them the finger bellies into the notch."""
    half, (low, high) = (places[1] - places[0]) / 2, heights(places, force)
    block = Polygon(vertices=((-0.03, 0), (0.03, 0), (0.03, -0.02), (-0.03, -0.02)))
    tilt = atan2(high - low, 2 * half)
    return Difference(parts=(block, Circle(radius=half))).at(x=sum(places) / 2, y=(low + high) / 2 - 0.003, angle=tilt)


def pins(force: float, places: tuple[float, ...] = (0.04, 0.065, 0.09)) -> gr.Placed:
    """Give three pins that press alike, as one object."""
    tops = zip(places, heights(places, force), strict=True)
    return Union(parts=tuple(Circle(radius=PIN).at(x=x, y=y - 0.003 - PIN) for x, y in tops)).at()


def touching(outline: gr.Placed) -> gr.Result:
    """Solve the pose."""
    return gr.solve(gr.Scene(finger=finger, object=outline, theory="bending"))


def main(folder: str | Path = "out/outlines") -> dict[str, gr.Result]:
    """Solve the four and draw them beside each other into the folder."""
    polygon, spline = (
        kind.at(x=0.07, y=-0.02) for kind in (Polygon(vertices=on_circle(24)), Spline(points=on_circle(16)))
    )
    outlines = {"polygon": polygon, "spline": spline, "notch": notched(12.0), "three pins": pins(8.0)}
    results = {name: touching(outline) for name, outline in outlines.items()}
    Path(folder).mkdir(parents=True, exist_ok=True)
    beside(results, title="One finger on four outlines").savefig(Path(folder, "outlines.png"))
    return results


if __name__ == "__main__":
    print(*main().values(), "Figures: out/outlines", sep="\n")
