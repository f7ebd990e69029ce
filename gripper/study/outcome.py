"""What a method says of a pose, in one form for all, and how far it is from a reference."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER
from gripper.objects import Object
from gripper.statics.equilibrium import Setting, State
from gripper.study.shot import MARKS, Answer, Shot

QUANTITIES = ("force", "energy", "place", "shape", "depth")
"""What is compared: force and energy relative, place of contact, shape and deepest penetration by L."""
_FINE = np.linspace(0.0, 1.0, 2001)
_EDGE = np.linspace(0.0, 1.0, 401)


@dataclass(frozen=True, eq=False)
class Outcome(Answer):
    """What a method that is measured says of a pose.

    Parameters
    ----------
    depth
        Deepest penetration of the drawn outline, sampled.
    iterations, evaluations
        Of the method's solver; points at which g was evaluated.
    """

    depth: float
    iterations: int
    evaluations: int


class NoOutcomeError(Exception):
    """The method gave no answer; says why."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Counted(Object):
    """An object that counts the points at which it is asked for g.

    Parameters
    ----------
    body
        The object.
    points
        How often, one entry a call.
    """

    body: Object
    points: list[int]

    def __post_init__(self) -> None:
        """Check nothing: the body was checked."""

    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """Return what the body does."""
        self.points.append(len(points))
        return self.body.evaluate(points, order)

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """Return what the body does."""
        self.points.append(len(centers))
        return self.body.bounds(centers, radii)

    def outline(self, box: tuple[float, ...] | None = None, tolerance: float | None = None) -> list[Array]:
        """Return what the body does."""
        return self.body.outline(box, tolerance)  # type: ignore[arg-type]

    @property
    def corners(self) -> Array:
        """The body's."""
        return self.body.corners

    @property
    def corner_normals(self) -> Array:
        """The body's."""
        return self.body.corner_normals

    @property
    def hollows(self) -> Array:
        """The body's."""
        return self.body.hollows

    @property
    def hollow_normals(self) -> Array:
        """The body's."""
        return self.body.hollow_normals

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """Return what the body does."""
        return self.body.largest_curvature(centers, radii)

    @functools.cached_property
    def box(self) -> tuple[float, float, float, float]:
        """The body's."""
        return self.body.box

    @property
    def inner_radius(self) -> float:
        """The body's."""
        return self.body.inner_radius

    @property
    def inner_point(self) -> Array:
        """The body's."""
        return self.body.inner_point


def counted(setting: Setting) -> tuple[Setting, list[int]]:
    """The setting with an object that counts, and its counts."""
    points: list[int] = []
    return replace(setting, body=Counted(body=setting.body, points=points)), points


def of_strains(
    setting: Setting, obstacle: Obstacle, state: State, lin: Linearisation, work: tuple[int, int]
) -> Outcome:
    """What this project's strain fields say, with the contacts' points and forces of a linearisation."""
    axis = Axis.of(state.beam, state.z)

    def at(s: Array) -> tuple[Complex, Array]:
        position, psi, *_ = axis.values(s, state.beam.segment_of(s))
        return position, psi

    points, forces = np.concatenate([[0j], *lin.points]), np.concatenate([[0j], *lin.forces])
    return Outcome(
        force=complex(forces.sum()),
        place=_weighted(points, forces),
        energy=state.energy,
        axis=at(MARKS)[0],
        depth=depth(setting, obstacle, *at(_FINE)),
        iterations=work[0],
        evaluations=work[1],
    )


def of_nodes(
    setting: Setting,
    obstacle: Obstacle,
    axis: Complex,
    psi: Array,
    points: Complex,
    forces: Complex,
    energy: float,
    work: tuple[int, int],
) -> Outcome:
    """What a scheme of equal elements says: axis and psi at its nodes (N + 1,), forces on the finger at points."""
    nodes = np.linspace(0.0, 1.0, len(axis))
    drawn, turned = CubicSpline(nodes, axis), CubicSpline(nodes, psi)
    return Outcome(
        force=complex(forces.sum()),
        place=_weighted(points, forces),
        energy=energy,
        axis=drawn(MARKS),
        depth=depth(setting, obstacle, drawn(_FINE), turned(_FINE)),
        iterations=work[0],
        evaluations=work[1],
    )


def depth(setting: Setting, obstacle: Obstacle, axis: Complex, psi: Array) -> float:
    """Deepest penetration (by L) of the outline, sampled: both faces (axis and psi at 2001 stations), and the rest."""
    outline, turn = setting.outline, np.exp(1j * psi)
    parts = []
    for number, piece in enumerate(outline.pieces):
        flexible = number in (LOWER, UPPER)
        u = _FINE if flexible else _EDGE * piece.length
        pieces: Index = np.full(u.size, number)
        P = outline.offsets(pieces, u)[1]
        parts.append(axis + P * turn if flexible else axis[-1] + P * turn[-1])
    g, slope = obstacle.slope(np.concatenate(parts))
    return max(0.0, -float(np.min(g / np.maximum(np.abs(slope), 1e-12))))


def _weighted(points: Complex, forces: Complex) -> complex:
    weights = np.abs(forces)
    return complex(weights @ points / weights.sum()) if weights.sum() else 0j


def errors(outcome: Outcome, reference: Shot) -> dict[str, float]:
    """How far an outcome is from the reference, by quantity."""
    return {
        "force": abs(outcome.force - reference.force) / abs(reference.force),
        "energy": abs(outcome.energy / reference.energy - 1),
        "place": abs(outcome.place - reference.place),
        "shape": float(np.max(np.abs(outcome.axis - reference.axis))),
        "depth": outcome.depth,
    }


def uncertainty(fine: Shot, coarse: Shot) -> dict[str, float]:
    """How far the reference may be off, by quantity: its distance from a coarser one, at least round-off."""
    apart = {
        "force": abs(coarse.force - fine.force) / abs(fine.force),
        "energy": abs(coarse.energy / fine.energy - 1),
        "place": abs(coarse.place - fine.place),
        "shape": float(np.max(np.abs(coarse.axis - fine.axis))),
        "depth": 0.0,
    }
    return {name: max(value, 1e-13) for name, value in apart.items()}
