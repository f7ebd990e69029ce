"""What a polygon of 500 sides costs beside its circle, at a dozen random places: one pose, and a motion to there.

CPU time on one thread, median of the repeats after a warm-up, polygon and circle in one run; with gripper's checks,
certificate and error estimate. The force differs as the corners' places do, by about a side; the energy as n^-2.
"""

import os

if __name__ == "__main__":  # before numpy is imported: a BLAS library's waiting threads burn CPU time too
    os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1"))

from collections.abc import Iterator
from math import cos, pi, sin
from random import Random
from typing import NamedTuple

import sympy

import gripper as gr
from gripper.study.cost import repeated
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Polygon

unit = gr.Material(youngs_modulus=12 / 0.06**3, poisson_ratio=0.3)
finger = Uniform(length=1.0, thickness=0.06, width=1.0, material=unit)  # EI = 1 N m^2
HEAD = "theory   radius   place  depth  angle   pose: circle ms  ratio   motion: circle ms  ratio   energy differs"


class Place(NamedTuple):
    """Radius, place along the finger, how deep it comes (all in m, L = 1 m), and how the polygon is turned."""

    radius: float
    x: float
    depth: float
    angle: float


def places(count: int = 12, seed: int = 500) -> list[Place]:
    """Draw places at random."""
    draw = Random(seed).uniform
    return [Place(draw(0.08, 0.35), draw(0.35, 0.95), draw(0.01, 0.12), draw(0.0, 2 * pi)) for _ in range(count)]


def compared(place: Place, theory: str, sides: int = 500, repeats: int = 7) -> tuple[list[float], float]:
    """CPU seconds of the circle's pose, the polygon's, and of both motions; by how much the poses' energies differ."""
    ring = tuple((place.radius * cos(2 * pi * i / sides), place.radius * sin(2 * pi * i / sides)) for i in range(sides))
    lowest, q, seconds, energies = -finger.thickness / 2 - place.radius, sympy.Symbol("q"), [], []
    for body in (Circle(radius=place.radius), Polygon(vertices=ring)):
        at = body.at(x=place.x, y=lowest + place.depth, angle=place.angle)
        pose = repeated(lambda at=at: gr.solve(gr.Scene(finger=finger, object=at, theory=theory)), repeats)
        along = body.at(x=place.x, y=lowest + q, angle=place.angle)
        motion = gr.Scene(
            finger=finger, object=along, theory=theory, motion=gr.Motion.between("q", -0.02, place.depth, 9)
        )
        moved = repeated(lambda motion=motion: gr.trace(motion), repeats)
        if pose.answers[0].failed or moved.answers[0].failed:
            raise RuntimeError(f"{theory}, {place}: {pose.answers[0].failed or moved.answers[0].failed}")
        seconds.append((pose.median, moved.median))
        energies.append(pose.answers[0].poses[0].energy)
    (a, c), (b, d) = seconds
    return [a, b, c, d], abs(energies[1] / energies[0] - 1)


def main(count: int = 12, sides: int = 500, repeats: int = 7) -> Iterator[tuple[float, float]]:
    """Print the table; yield the ratios of each row: of the pose, of the motion."""
    print(HEAD)
    for place in places(count):
        for theory in ("bending", "shear"):
            (a, b, c, d), differs = compared(place, theory, sides, repeats)
            row = f"{theory:8} {place.radius:6.3f} {place.x:7.3f} {place.depth:6.3f} {place.angle:6.3f}"
            print(f"{row} {1e3 * a:17.1f} {b / a:6.2f} {1e3 * c:20.1f} {d / c:6.2f} {differs:15.1e}", flush=True)
            yield b / a, d / c


if __name__ == "__main__":
    ratios = list(zip(*main(), strict=True))
    print("largest ratio: pose {:.2f}, motion {:.2f}".format(*map(max, ratios)))
