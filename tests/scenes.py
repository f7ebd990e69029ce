"""Scenes of the two examples, what a solved pose is inside, and a polygon check that knows nothing of the solver."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
import sympy
from scipy.spatial import cKDTree

import gripper as gr
from gripper.assemble import setting
from gripper.beam.axis import Axis
from gripper.contact.kinematics import Kinematics
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.trace import _Follower
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.ellipse import Ellipse

REFERENCE = Path(__file__).parent / "reference"
BEAM = json.loads((REFERENCE / "beam.json").read_text())
EXACT = json.loads((REFERENCE / "exact.json").read_text())

STRIP = """
[material]
youngs_modulus = "2.6 GPa"
poisson_ratio = 0.35
[finger]
profile = "uniform"
length = "57 mm"
thickness = "3.2 mm"
width = "9.5 mm"
"""
PIN = """
[object]
surface = "circle"
radius = "8.9 mm"
"""
Q = sympy.Symbol("q")
PLASTIC = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
RUBBER = gr.Material(youngs_modulus=4.8e6, shear_modulus=1.71e6, poisson_ratio=0.4)
HOOK = Triangle(length=0.019, lead_angle=math.radians(20), return_angle=math.radians(60))
STRAIGHT = Uniform(length=0.057, thickness=0.0032, width=0.0095, material=PLASTIC, jaw=HOOK)
TAPERED = Tapered(length=0.1778, base_thickness=0.030, tip_thickness=0.017, width=0.025, material=RUBBER)
RISING = (-0.1016, 0.0694)  # Example II: from the paper's first pose to the release
FALLING = (0.127, -0.1524)


def micro_assembly(*values: float, **options: object) -> gr.Scene:
    """Example I at these places of the pin."""
    options = {"theory": "bending", **options}
    motion = gr.Motion("q", values)
    return gr.Scene(finger=STRAIGHT, object=Circle(radius=0.0089).at(x=Q, y=-0.0105), motion=motion, **options)


def rotating_finger(*values: float, **options: object) -> gr.Scene:
    """Example II at these places of the ellipse."""
    options = {"theory": "shear", **options}
    angle = math.radians(102) - math.radians(236.22) * Q
    target = Ellipse(semi_axes=(0.04953, 0.033655)).at(x=Q, y=0.12065)
    return gr.Scene(finger=TAPERED.at(angle=angle), object=target, motion=gr.Motion("q", values), **options)


def unit_finger(thickness: float = 0.06, **options: object) -> Uniform:
    """A uniform finger of L = 1 and EI = 1; without shear unless its material says so."""
    material = gr.Material(youngs_modulus=12 / thickness**3, poisson_ratio=0.3)
    return Uniform(**{"length": 1.0, "thickness": thickness, "width": 1.0, "material": material, **options})


@dataclass(frozen=True, eq=False)
class Solved:
    """A pose, and the equilibrium that it was read from."""

    result: gr.PoseResult
    setting: Setting
    equilibrium: Equilibrium | None

    @property
    def length(self) -> float:
        """L, in m."""
        return self.setting.sections.length


def follow(scene: gr.Scene) -> Iterator[Solved]:
    """What `gripper.trace` does, with the equilibrium of each pose."""
    fixed = setting(scene)
    follower = _Follower(scene, fixed, Kinematics(scene, fixed.sections.length))
    poses: list[gr.PoseResult] = []
    for value in scene.motion.values:
        poses = follower.measured([*poses, follower.pose(value)])
        known = poses[-1].status != "failed"
        yield Solved(poses[-1], fixed, follower.tracker.current.equilibrium if known else None)


def still(scene: gr.Scene) -> gr.Scene:
    """A scene of one pose as a motion of one pose."""
    return gr.Scene(**{**{f: getattr(scene, f) for f in scene.__dataclass_fields__}, "motion": gr.Motion("q", (0.0,))})


def faces(solved: Solved) -> tuple[np.ndarray, np.ndarray]:
    """Points of the lower and upper face (n,), x + iy by L in the clamp's frame, chords within 1e-7 of them."""
    state, outline = solved.equilibrium.state, solved.setting.outline
    axis = Axis.of(state.beam, state.z)
    marks = [np.linspace(0, 1, 2001), state.beam.breaks]  # finer where contacts bend the faces most
    marks += [np.linspace(site.middle - 0.03, site.middle + 0.03, 1001) for site in state.sites if site.on_face]
    u = np.unique(np.clip(np.concatenate(marks), 0, 1))
    inward = u + 1e-12 * np.sign(0.5 - u)
    segment = state.beam.segment_of(inward)
    points = [outline.trace(axis, np.full(u.size, piece), u, segment)[0] for piece in (0, 1)]
    return points[0], points[1]


def jaw(solved: Solved) -> np.ndarray | None:
    """Corners of the deflected jaw (n,), by L in the clamp's frame."""
    state, polygon = solved.equilibrium.state, solved.setting.outline.jaw
    if polygon is None:
        return None
    end, psi, *_ = Axis.of(state.beam, state.z).values(np.ones(1), np.array([state.beam.segments - 1]))
    return end + polygon * np.exp(1j * psi)


def outlines(scene: gr.Scene, solved: Solved) -> list[np.ndarray]:
    """The object's outline, from its plugin, by L in the clamp's frame."""
    target = scene.object.body if isinstance(scene.object, gr.Placed) else scene.object
    (x, y, angle), (x0, y0, angle0) = solved.result.shape.object_pose, solved.result.shape.clamp_pose
    turn, shift = np.exp(1j * (angle - angle0)), complex(x - x0, y - y0) * np.exp(-1j * angle0)
    reach = 3 * solved.length + abs(shift)
    box = (-reach, -reach, reach, reach)
    lines = target.outline(box, 1e-7 * solved.length)
    return [((line[:, 0] + 1j * line[:, 1]) * turn + shift) / solved.length for line in lines]


def deepest_cut(scene: gr.Scene, solved: Solved) -> float:
    """How deep finger and object lie in each other, by L: two polygons, their chords within 1e-7 of the outlines."""
    lower, upper = faces(solved)
    bodies = [(np.concatenate([lower, upper[::-1]]), False)]  # the clamped section is no part of the outline
    if (hook := jaw(solved)) is not None:
        bodies.append((hook, True))
    deepest = 0.0
    for line in outlines(scene, solved):
        for body, closed in bodies:
            cut = deepest_within(body, line[:-1], closed=closed)
            deepest = max(deepest, cut, deepest_within(line[:-1], body))
    return deepest


def dense(ring: np.ndarray, *, closed: bool = True) -> np.ndarray:
    """A polygon's vertices with points along its long edges."""
    edges = np.roll(ring, -1) - ring
    edges[-1] *= closed
    counts = np.maximum(1, np.ceil(np.abs(edges) / np.abs(edges).sum() * 400)).astype(int)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    steps = (np.arange(counts.sum()) - first) / np.repeat(counts, counts)
    return np.repeat(ring, counts) + np.repeat(edges, counts) * steps


def deepest_within(points: np.ndarray, ring: np.ndarray, *, closed: bool = True) -> float:
    """How deep the deepest of points (n,), x + iy, and those on the edges between lies within a closed ring (m,)."""
    points, ring = dense(points, closed=closed), dense(ring)
    polygon = shapely.Polygon(np.column_stack([ring.real, ring.imag]))
    shapely.prepare(polygon)
    within = points[shapely.contains_xy(polygon, points.real, points.imag)]
    if not within.size:
        return 0.0
    _, nearest = cKDTree(np.column_stack([ring.real, ring.imag])).query(np.column_stack([within.real, within.imag]))
    sides = [(ring[(nearest + i - 1) % ring.size], ring[(nearest + i) % ring.size]) for i in (0, 1)]
    return float(np.min([_to_edge(within, a, b) for a, b in sides], axis=0).max())


def _to_edge(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    edge = b - a
    along = np.clip(((points - a) * edge.conj()).real / np.maximum(np.abs(edge) ** 2, 1e-300), 0, 1)
    return np.abs(points - a - along * edge)
