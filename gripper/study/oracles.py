"""Judges of a solved motion that share no code with the solver: polygons, energies, another path, another finger.

Each returns None, or an objection in words with its number.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from gripper.arrays import Array
from gripper.pose import placed
from gripper.result import PoseResult, Result
from gripper.study.cases import Body, Case

OVERLAP = 1e-5
"""Depth (by L) from which outlines are said to overlap: the drawn shape has 81 stations."""
SLOPE = 1e-3
"""Relative: what Simpson's rule over a hundredth of the motion may leave where forces change fast."""
BRANCH = 1e-3
"""Relative difference of the force on two ways with different steps: ten times the tolerance asked."""
_SAME_ENERGY = 0.1
_ELEMENTS, _POINTS = 40, 4
_PATH = 16
_SUNK = 2e-3  # of L: how deep one point of the chain sinks under the force that is expected


def overlap(case: Case, pose: PoseResult, q: float) -> str | None:
    """Whether the drawn finger and the object's polygon lie in one another."""
    if pose.shape is None:
        return None
    length = placed(case.scene.finger).body.length
    place = [a + q * (b - a) for a, b in zip(case.start, case.stop, strict=True)]
    target = shapely.affinity.translate(case.body.outline(), *place)
    core = target.buffer(-OVERLAP) if target.area > 4 * OVERLAP * target.length else target
    kinks = _kinks(pose, length)
    for name in ("axis", "lower", "upper"):
        points = getattr(pose.shape, name) / length
        drawn = [_smooth(points[start : stop + 1]) for start, stop in itertools.pairwise(kinks) if stop - start > 1]
        inside = sum(shapely.LineString(line).intersection(core).length for line in drawn)
        if inside > 10 * OVERLAP:
            return f"overlap: {inside:.1e} L of the {name} line lies in the object"
    return None


def _kinks(pose: PoseResult, length: float) -> list[int]:
    """The drawn stations at which shear gives the lines a kink, and their ends: those of the stretches in contact.

    A stretch without a station inside is not drawn: it lies on the object as a whole.
    """
    axis = pose.shape.axis / length if pose.shape else np.zeros((1, 2))
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(axis, axis=0).T))])
    ends = [end / length for contact in pose.contacts if contact.on in ("lower", "upper") for end in contact.extent]
    return sorted({0, len(axis) - 1, *(int(np.argmin(np.abs(s - end))) for end in ends)})


def _smooth(points: Array) -> Array:
    """A fine polyline through the points (3 or more) of a smooth curve."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    fine = np.union1d(np.linspace(0.0, along[-1], 1201), along)
    return np.asarray(CubicSpline(along, points)(fine))


def energy_slope(poses: Sequence[PoseResult], step: float) -> str | None:
    """Whether the energy grows as the drive's work says: dV/dq is the motion's force; three poses, Simpson's rule.

    The force is a sum over contacts, the energy an integral over the finger.
    """
    forces = [pose.motion_force for pose in poses if pose.motion_force is not None]
    energies = [pose.energy for pose in poses if pose.energy is not None]
    if len(forces) < 3 or len(energies) < 3:
        return None
    gained, work = energies[2] - energies[0], (forces[0] + 4 * forces[1] + forces[2]) / 6 * step
    size = max(abs(gained), abs(work), 1e-6 * energies[2])
    if size > 0 and abs(gained - work) > SLOPE * size:
        return f"energy: {gained:.4e} J gained, {work:.4e} J of work done"
    return None


def other_steps(one: PoseResult, other: PoseResult) -> str | None:
    """Whether the same pose, reached by other steps, has the same answer."""
    if one.force_on_object is None or other.force_on_object is None:
        return None
    size = max(math.hypot(*one.force_on_object), math.hypot(*other.force_on_object))
    apart = math.dist(one.force_on_object, other.force_on_object)
    if size > 0 and "contact" in (one.status, other.status) and apart > BRANCH * size:
        return f"branch: the force differs by {apart / size:.1e} when the steps are halved"
    return None


def undecided(case: Case, result: Result) -> str | None:
    """Whether a strut that is met head-on has buckled to one side without a word: statics do not decide to which."""
    if case.family != "head-on" or any(event.kind == "snap" for event in result.events):
        return None
    touched = any(event.kind == "touch" for event in result.events)
    return "undecided: the side to which a strut buckles was picked without a snap that says so" if touched else None


def descent(case: Case, result: Result) -> str | None:
    """Whether a chain of rigid links that is pushed up by the object in small steps ends in the same place.

    The chain has a penalty in place of contact and follows the object by descending its energy from the last step:
    a damped finger. It is coarse, and tells branches apart, not digits; it is not asked where its points could miss the
    object: sharp or small ones, thin fingers, and contacts that slip off the tip.
    """
    pose, theory = result.poses[-1], result.model.theory
    if pose.energy is None or pose.status != "contact" or pose.shape is None or not _resolved(case, pose):
        return None
    finger = placed(case.scene.finger).body
    chain = _Chain(case, theory == "shear")
    x = np.zeros(chain.size)
    for step in range(1, _PATH + 1):
        x = chain.pushed(x, step / _PATH)
    unit = chain.unit
    energy = chain.strain_energy(x) * unit
    tip = chain.nodes(x)[0][-1]
    axis = pose.shape.axis[-1] / finger.length
    moved = abs(tip - complex(*axis))
    if abs(energy - pose.energy) > _SAME_ENERGY * max(energy, pose.energy) and moved > 0.03:
        return f"descent: energy {energy:.3e} J against {pose.energy:.3e}, tips {moved:.2f} L apart"
    return None


def _resolved(case: Case, pose: PoseResult) -> bool:
    """Whether the chain's points see the object: it is round, and large against their spacing and the steps."""
    finger = placed(case.scene.finger).body
    thickness = 2 * float(np.min(np.hypot(*(pose.shape.upper - pose.shape.axis).T))) if pose.shape else 0.0
    smallest = min(case.body.sizes[:2]) if case.body.kind == "ellipse" else case.body.sizes[0]
    if case.body.kind == "polygon" or not pose.contacts:
        return False
    step = math.dist(case.start, case.stop) / _PATH
    wide = smallest > max(4 * step, 4 / (_ELEMENTS * _POINTS)) and thickness > 0.02 * finger.length
    return wide and all(contact.on == "lower" and contact.s < 0.95 * finger.length for contact in pose.contacts)


class _Chain:
    """Links with springs at their joints, by L and EI(0) / L; a penalty keeps their faces out of the object."""

    def __init__(self, case: Case, shear: bool) -> None:
        finger = placed(case.scene.finger).body
        material, n = finger.material, _ELEMENTS
        self.case, self.shear, self.h = case, shear, 1 / n
        s = (np.arange(n) + 0.5) / n
        w = np.array([float(finger.w(f * finger.length)) for f in s]) / finger.length
        at_clamp = float(finger.w(0.0 * finger.length)) / finger.length
        b = float(finger.b(0.0 * finger.length)) / finger.length
        E = material.youngs_modulus / (1 - material.poisson_ratio**2 * (material.plane == "strain"))
        self.bend = (w / at_clamp) ** 3
        kappa_s = (5 + 5 * material.poisson_ratio) / (6 + 5 * material.poisson_ratio)
        self.slide = 12 * kappa_s * material.G / E * w / at_clamp**3
        self.half = w / 2
        self.unit = E * b * at_clamp**3 / 12 * finger.length**3
        self.size = 2 * n if shear else n
        x, depth = max(min(case.stop[0], 1.0), 0.05), case.stop[1] - case.start[1]
        self.penalty = 3 * depth / x**3 / (_SUNK * self.h)

    def nodes(self, x: Array) -> tuple[Array, Array, Array]:
        """Ends of the links (n + 1,), and the angles of sections and axis (n,)."""
        psi = np.cumsum(x[:_ELEMENTS]) - x[:_ELEMENTS] / 2
        theta = psi + x[_ELEMENTS:] if self.shear else psi
        return np.concatenate([[0j], np.cumsum(np.exp(1j * theta)) * self.h]), psi, theta

    def strain_energy(self, x: Array) -> float:
        """Over EI(0) / L."""
        value = float(self.bend @ x[:_ELEMENTS] ** 2) / (2 * self.h)
        if self.shear:
            value += float(self.slide @ x[_ELEMENTS:] ** 2) * self.h / 2
        return value

    def pushed(self, x: Array, q: float) -> Array:
        """The next rest of the chain with the object at q."""
        place = [a + q * (b - a) for a, b in zip(self.case.start, self.case.stop, strict=True)]
        options = {"maxiter": 1000, "maxfun": 1500}
        found = minimize(self._total, x, (complex(*place),), "L-BFGS-B", jac=True, options=options)
        return np.asarray(found.x)

    def _total(self, x: Array, place: complex) -> tuple[float, Array]:
        n = _ELEMENTS
        ends, psi, theta = self.nodes(x)
        gradient = np.zeros(self.size)
        gradient[:n] = self.bend * x[:n] / self.h
        if self.shear:
            gradient[n:] = self.slide * x[n:] * self.h
        value = self.strain_energy(x)
        fractions = (np.arange(_POINTS) + 0.5) / _POINTS
        axis = ends[:-1, None] + np.outer(np.exp(1j * theta), fractions) * self.h
        for side in (-1j, 1j):
            offset = (side * self.half * np.exp(1j * psi))[:, None]
            depth, out = _depth(self.case.body, (axis + offset - place).ravel())
            depth, force = depth.reshape(n, _POINTS), (depth * out).reshape(n, _POINTS) * self.penalty * self.h
            value += float(np.sum(depth**2)) * self.penalty * self.h / 2
            self._add(gradient, -force, offset, theta, fractions)
        return value, gradient

    def _add(self, gradient: Array, force: Array, offset: Array, theta: Array, fractions: Array) -> None:
        """Gradient of the penalty, from its slopes at the points (n, points) as vectors."""
        n = _ELEMENTS
        total = force.sum(axis=1)
        beyond = np.cumsum(total[::-1])[::-1] - total  # on the links after each
        along = 1j * np.exp(1j * theta) * self.h
        by_theta = (along.conj() * (beyond + force @ fractions)).real
        by_psi = np.sum(((1j * offset).conj() * force).real, axis=1)
        turned = by_theta + by_psi
        gradient[:n] += np.cumsum(turned[::-1])[::-1] - turned / 2
        if self.shear:
            gradient[n:] += by_theta


def _depth(body: Body, points: Array) -> tuple[Array, Array]:
    """How deep points (k,) about the object's origin lie in it, and the way out (unit vectors)."""
    if body.kind == "circle":
        away = np.maximum(np.abs(points), 1e-12)
        return np.maximum(body.sizes[0] - away, 0.0), points / away
    if body.kind == "ellipse":
        a, b, angle = body.sizes
        local = points * np.exp(-1j * angle)
        level = np.maximum(np.hypot(local.real / a, local.imag / b), 1e-9)
        slope = (local.real / a**2 + 1j * local.imag / b**2) / level
        size = np.maximum(np.abs(slope), 1e-12)
        return np.maximum((1 - level) / size, 0.0), slope / size * np.exp(1j * angle)
    vertices = np.reshape(body.sizes, (-1, 2)) @ np.array([1, 1j])
    edges = np.roll(vertices, -1) - vertices
    normals = -1j * edges / np.abs(edges)
    distances = ((points[:, None] - vertices).conj() * normals).real
    nearest = np.argmax(distances, axis=1)
    return np.maximum(-distances[np.arange(len(points)), nearest], 0.0), normals[nearest]
