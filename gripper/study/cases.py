"""Scenes for a study of robustness: maps over what matters once the problem is dimensionless, and random scenes.

Every scene is a motion: an object comes from where the straight finger is free (q = 0) to where it indents it (q = 1).
Where it does not press on the clamp such a path has an equilibrium at every pose: a frictionless elastic finger that is
free to move away has a least energy among the shapes that clear the object.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import shapely
import sympy

from gripper.beam.strains import BeamTheory
from gripper.fingers import Finger, Material
from gripper.objects import Object
from gripper.registry import load
from gripper.scene import Motion, Scene

Q = sympy.Symbol("q", real=True)
_AWAY = 0.02  # of L: how far off the finger an object starts
_CLEAR = 0.01  # of L: between object and clamp
_THEORIES: tuple[BeamTheory, ...] = ("bending", "shear")
_DRAWN = 2000  # corners of the polygon that stands for a smooth object
plugin = functools.cache(load)
"""A plugin by its group and name, looked up once."""
PLASTIC = {"youngs_modulus": 2.6e9, "poisson_ratio": 0.35}


@dataclass(frozen=True)
class Body:
    """An object in words that the oracles understand without the solver: kind and sizes, by L."""

    kind: Literal["circle", "ellipse", "polygon"]
    sizes: tuple[float, ...]
    """Radius; semi-axes and angle; x, y of the vertices."""

    def outline(self) -> shapely.Polygon:
        """A polygon with its corners on the outline, about the origin."""
        t = np.linspace(0, 2 * np.pi, _DRAWN, endpoint=False)
        if self.kind == "circle":
            return shapely.Polygon(self.sizes[0] * np.column_stack([np.cos(t), np.sin(t)]))
        if self.kind == "ellipse":
            a, b, angle = self.sizes
            points = (a * np.cos(t) + 1j * b * np.sin(t)) * np.exp(1j * angle)
            return shapely.Polygon(np.column_stack([points.real, points.imag]))
        return shapely.Polygon(np.reshape(self.sizes, (-1, 2)))

    def plugin(self, length: float) -> tuple[Object, float]:
        """The same as the solver's object, in m, and its angle."""
        if self.kind == "circle":
            return plugin("gripper.objects", "circle")(radius=self.sizes[0] * length), 0.0
        if self.kind == "ellipse":
            a, b, angle = self.sizes
            return plugin("gripper.objects", "ellipse")(semi_axes=(a * length, b * length)), angle
        vertices = tuple(map(tuple, (np.reshape(self.sizes, (-1, 2)) * length).tolist()))
        return plugin("gripper.objects", "polygon")(vertices=vertices), 0.0


@dataclass(frozen=True)
class Case:
    """One scene of a study.

    Parameters
    ----------
    family, name
        Which map, and which place on it.
    scene
        Its motion is q from 0 to 1.
    body, start, stop
        The object for the oracles; its place at q = 0 and q = 1, by L.
    built
        Whether it is built to have an equilibrium at every pose.
    """

    family: str
    name: str
    scene: Scene
    body: Body
    start: tuple[float, float]
    stop: tuple[float, float]
    built: bool

    @property
    def key(self) -> str:
        """What it is called in a table."""
        return f"{self.family}: {self.name}"

    def moving(self, poses: tuple[float, ...]) -> Scene:
        """The scene with these poses of its motion."""
        return replace(self.scene, motion=Motion("q", poses))


def case(
    family: str,
    name: str,
    finger: Finger,
    body: Body,
    x: float,
    depth: float,
    *,
    theory: BeamTheory = "shear",
    lean: float = 0.0,
) -> Case:
    """A body that comes from below onto a finger.

    Parameters
    ----------
    family, name, finger, body, theory
        As they stand in the case.
    x
        Of its reference point at the end, by L.
    depth
        How far its top is then above the straight lower face, by L.
    lean
        How much it moves along the finger, over what it moves up.
    """
    length = finger.length
    half = float(sympy.sympify(finger.w(sympy.Float(min(max(x, 0.0), 1.0) * length)))) / length / 2
    thickest = max(float(sympy.sympify(finger.w(sympy.Float(f * length)))) for f in (0.0, 1.0)) / length / 2
    outline = body.outline()
    top = outline.bounds[3]
    below = -thickest - top - _AWAY
    stop = (x, -half - top + depth)
    rise = max(stop[1] - below, 1e-12)
    start = (x - lean * rise, below)
    target, angle = body.plugin(length)
    path = [(a + Q * (b - a)) * length for a, b in zip(start, stop, strict=True)]
    scene = Scene(
        finger=finger,
        object=target.at(x=path[0], y=path[1], angle=angle),
        motion=Motion("q", (0.0, 1.0)),
        theory=theory,
    )
    clamp = shapely.LineString([(0, -thickest), (0, thickest)])
    swept = shapely.union_all([shapely.affinity.translate(outline, *place) for place in (start, stop)]).convex_hull
    return Case(family, name, scene, body, start, stop, built=bool(swept.distance(clamp) > _CLEAR))


def facing(name: str, finger: Finger, body: Body, y: float, *, theory: BeamTheory = "shear") -> Case:
    """A body that comes along the finger's axis, y (by L) beside it, against the end face: a strut, which buckles.

    Statics do not decide to which side: a refusal is as right as a snap that says so.
    """
    right = body.outline().bounds[2]
    start, stop = (1 + right + _AWAY, y), (0.95 + right, y)
    length = finger.length
    target, angle = body.plugin(length)
    path = [(a + Q * (b - a)) * length for a, b in zip(start, stop, strict=True)]
    placed = target.at(x=path[0], y=path[1], angle=angle)
    scene = Scene(finger=finger, object=placed, motion=Motion("q", (0.0, 1.0)), theory=theory)
    return Case("head-on", name, scene, body, start, stop, built=False)


def example_two(theory: BeamTheory) -> Case:
    """Lan & Lee's Example II from further left than they begin: the ellipse meets the turning finger's end face."""
    length, (start, stop), y = 0.1778, (-0.21, 0.05), 0.12065
    rubber = {"youngs_modulus": 4.8e6, "shear_modulus": 1.71e6, "poisson_ratio": 0.4}
    finger = tapered(0.030 / length, 0.017 / length, length, **rubber)
    body = Body("ellipse", (0.04953 / length, 0.033655 / length, 0.0))
    x = start + Q * (stop - start)
    scene = Scene(
        finger=finger.at(angle=math.radians(102) - math.radians(236.22) * x),
        object=body.plugin(length)[0].at(x=x, y=y),
        motion=Motion("q", (0.0, 1.0)),
        theory=theory,
    )
    places = (start / length, y / length), (stop / length, y / length)
    return Case("head-on", f"Example II from x_e = {start}, {theory}", scene, body, *places, built=False)


def uniform(thickness: float, length: float = 0.1, **material: Any) -> Finger:
    """A uniform finger, its thickness by L."""
    made = Material(**(PLASTIC | material))
    return plugin("gripper.fingers", "uniform")(
        length=length, thickness=thickness * length, width=length / 10, material=made
    )


def tapered(base: float, tip: float, length: float = 0.1, **material: Any) -> Finger:
    """A tapered finger, its thicknesses by L."""
    made = Material(**(PLASTIC | material))
    return plugin("gripper.fingers", "tapered")(
        length=length, base_thickness=base * length, tip_thickness=tip * length, width=length / 10, material=made
    )


def circle(radius: float) -> Body:
    """A circle."""
    return Body("circle", (radius,))


def regular(sides: int, radius: float, angle: float) -> Body:
    """A regular polygon; at angle 0 a corner points up."""
    points = radius * np.exp(1j * (np.pi / 2 + angle + 2 * np.pi * np.arange(sides) / sides))
    return Body("polygon", tuple(np.column_stack([points.real, points.imag]).ravel().tolist()))


def maps() -> Iterator[Case]:
    """One line of scenes for each number that matters, the others held at a plain case."""
    plain, pin = uniform(0.05), circle(0.1)
    for power in range(-2, 11):
        rigidity = 10.0**power  # kappa_s G A L^2 / EI
        finger = uniform(0.05, shear_modulus=rigidity * PLASTIC["youngs_modulus"] * 0.05**2 / 12 / 0.876)
        yield case("shear stiffness", f"kGAL2/EI = 1e{power}", finger, pin, 0.7, 0.1)
    for w in (1e-5, 1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6):
        yield case("slenderness", f"w/L = {w:g}", uniform(w), pin, 0.7, 0.05)
    for power in np.linspace(-3, 3, 13):
        ratio = 10.0**power
        base, tip = (0.05, 0.05 * ratio) if ratio < 1 else (0.05 / ratio, 0.05)
        yield case("taper", f"tip/base = {ratio:.3g}", tapered(base, tip), pin, 0.7, 0.05)
    for s in (0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999, 1.0, 1.01, 1.02, 1.03):
        yield case("place", f"s/L = {s:g}", uniform(0.02), circle(0.005 if s < 0.1 else 0.03), s, 0.05 * s)
    for power in range(-6, 4):
        yield case("radius", f"R/L = 1e{power}", plain, circle(10.0**power), 0.7, 0.05)
    for depth in (1e-9, 1e-7, 1e-5, 1e-3, 0.01, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8):
        yield case("indentation", f"d/L = {depth:g}", uniform(0.02), pin, 0.6, depth)
    for x in (0.15, 0.25, 0.35, 0.5):
        for depth in (0.3, 0.5, 0.7):
            yield case("wrapping", f"x/L = {x:g}, d/L = {depth:g}", uniform(0.01), circle(0.03), x, depth)
    for sides in (3, 4, 6):
        for angle in (0.0, 0.2, math.pi / sides):
            for theory in _THEORIES:
                name = f"{sides} sides at {angle:.3g} rad, {theory}"
                body = regular(sides, 0.1, angle)
                family = "flat" if angle == math.pi / sides else "corner"
                yield case(family, name, plain, body, 0.7, 0.05, theory=theory)
    for y in (0.0, 1e-3, 0.02, -0.02):
        for theory in _THEORIES:
            yield facing(f"y/L = {y:g}, {theory}", plain, circle(0.2), y, theory=theory)
    for theory in _THEORIES:
        yield example_two(theory)
    for power in range(0, 16, 3):
        yield case("scale", f"E = 1e{power} Pa", uniform(0.05, youngs_modulus=10.0**power), pin, 0.7, 0.1)
    for power in range(-9, 4, 3):
        yield case("scale", f"L = 1e{power} m", uniform(0.05, length=10.0**power), pin, 0.7, 0.1)


def random(count: int, seed: int = 0) -> Iterator[Case]:
    """Random scenes; the first of a seed are the same however many are asked for."""
    for i in range(count):
        yield _random(np.random.default_rng([seed, i]), f"{seed}/{i}")


def _random(rng: np.random.Generator, name: str) -> Case:
    while True:
        w = float(np.exp(rng.uniform(np.log(0.005), np.log(0.2))))
        nu = float(rng.uniform(0.0, 0.49))
        taper = float(rng.uniform(0.4, 1.0))
        finger = tapered(w, w * taper, poisson_ratio=nu) if rng.random() < 0.5 else uniform(w, poisson_ratio=nu)
        size = float(np.exp(rng.uniform(np.log(0.01), np.log(1.0))))
        body = _random_body(rng, size)
        x = float(rng.uniform(0.15, 1.02))
        depth = float(np.exp(rng.uniform(np.log(1e-4), np.log(0.4)))) * x
        theory: BeamTheory = "bending" if rng.random() < 0.4 else "shear"
        found = case("random", name, finger, body, x, depth, theory=theory, lean=float(rng.uniform(-0.5, 0.5)))
        if found.built:
            return found


def _random_body(rng: np.random.Generator, size: float) -> Body:
    kind = rng.choice(["circle", "ellipse", "polygon"])
    if kind == "circle":
        return circle(size)
    if kind == "ellipse":
        return Body("ellipse", (size, size * float(rng.uniform(0.3, 1.0)), float(rng.uniform(0, np.pi))))
    return regular(int(rng.integers(3, 7)), size, float(rng.uniform(0, np.pi)))
