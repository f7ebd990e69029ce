"""One mesh, one law, one motion: the poses that the elements find."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gripper.fingers import S
from gripper.pose import placed
from gripper.scene import Scene
from gripper.verify.body import Body
from gripper.verify.contact import Contact
from gripper.verify.corners import Corners
from gripper.verify.elements import Elements
from gripper.verify.follow import Follower, Setting
from gripper.verify.friction import coefficients, senses
from gripper.verify.material import Law, LawName
from gripper.verify.mesh import JawKind, Mesh, build, profile
from gripper.verify.motion import relative
from gripper.verify.newton import Solution, System
from gripper.verify.outline import PARTS, Part
from gripper.verify.surface import places
from gripper.verify.touch import Touch

State = Literal["frictionless", "slip", "stick"]
_ROUND_OFF = 2e-15
_NO_CONTACT = 1e-2  # of all normal forces: the end of an edge beside a corner that carries the force


@dataclass(frozen=True, kw_only=True)
class Model:
    """What the elements are.

    Parameters
    ----------
    elements
        Along and across.
    law
        Material law.
    jaw
        "rigid" or "elastic".
    """

    elements: tuple[int, int]
    law: LawName = "svk"
    jaw: JawKind = "rigid"


@dataclass(frozen=True, kw_only=True)
class Place:
    """One separate contact.

    Parameters
    ----------
    on
        Which part of the finger.
    s
        Force-weighted place along it, in m.
    normal_force
        In N.
    state
        "frictionless", or "stick" where most of the normal force stands on points that stick, or "slip".
    """

    on: Part
    s: float
    normal_force: float
    state: State


@dataclass(frozen=True, kw_only=True)
class Found:
    """One pose of the elements, in the clamp's frame; numbers are None where it failed.

    Parameters
    ----------
    status
        "free", "contact" or "failed".
    reason
        Why it failed.
    force
        Of the finger on the object, in N.
    tip
        Neutral axis at s = L, in m.
    contacts
        Ordered by part and place.
    max_strain
        Largest abs(principal stretch - 1), away from the clamp's corners, where it has no limit.
    depth
        How deep the object is inside the finger, in m.
    snapped
        Whether the finger snapped on the way from the last pose.
    iterations, seconds
        Of Newton, and CPU time, since the last pose.
    """

    status: str
    reason: str | None = None
    force: tuple[float, float] | None = None
    tip: tuple[float, float] | None = None
    contacts: tuple[Place, ...] = ()
    max_strain: float | None = None
    depth: float | None = None
    snapped: bool = False
    iterations: int = 0
    seconds: float = 0.0


def assembled(scene: Scene, model: Model) -> tuple[Setting, Mesh]:
    """Finger and object as a system of equations, and its mesh."""
    finger, body = placed(scene.finger).body, placed(scene.object).body
    material = finger.material
    mesh = build(finger, model.elements, model.jaw)
    elements = Elements(mesh, Law.of(material, model.law))
    stations = np.linspace(0, finger.length, 129)
    w = profile(finger.w(S))(stations)
    thickness, E, b = float(w.min()), material.youngs_modulus, float(mesh.width(stations[:1])[0])
    corners = Corners.of(mesh, np.asarray(body.corners, dtype=float), E, thickness)
    rough = coefficients(scene, mesh), senses(scene, mesh)
    contact = Contact(places(mesh, E, thickness), corners, mesh.outline.edges, mesh.outline.part, body, *rough)
    floor = E * b * (1e-9 * w[0] ** 3 / 12 / finger.length**2 + _ROUND_OFF * finger.length**2 / mesh.size)
    system = System(Body(mesh, elements), elements, contact, float(floor))
    reach = float(min(np.hypot(*np.abs(np.reshape(body.box, (2, 2))).max(axis=0)), 2 * finger.length))
    inner = np.asarray(body.inner_point, dtype=float)
    return Setting(system, E * b, finger.length, thickness, reach, inner, body.inner_radius), mesh


def run(
    scene: Scene, model: Model, way: Sequence[float], wanted: Sequence[bool], done: Callable[[], None]
) -> list[Found]:
    """Follow a way and report the poses wanted.

    Parameters
    ----------
    scene, model
        What to solve, and how.
    way
        Values of the motion's parameter, from its first.
    wanted
        Which of them to report.
    done
        Called after each of those.
    """
    setting, mesh = assembled(scene, model)
    path, follower = relative(scene), None
    found = []
    counted, began = 0, time.process_time()
    for value, asked in zip(way, wanted, strict=True):
        try:
            follower = follower or Follower(setting, path, value, _next(way, value), scene.approach)
            pose = _pose(follower, mesh, follower.advance(value))
        except ArithmeticError as error:
            pose = Found(status="failed", reason=str(error))
        if asked:
            total = follower.iterations if follower else 0
            found.append(replace(pose, iterations=total - counted, seconds=time.process_time() - began))
            counted, began = total, time.process_time()
            done()
    return found


def _next(way: Sequence[float], value: float) -> float:
    """Where the way goes on to from a value; the value itself at its end."""
    return next((later for later in way[way.index(value) :] if later != value), value)


def _pose(follower: Follower, mesh: Mesh, solution: Solution) -> Found:
    touch = solution.touch
    fx, fy = touch.on_object
    x, y = solution.positions[mesh.tip]
    return Found(
        status="contact" if touch.at.size else "free",
        force=(float(fx), float(fy)),
        tip=(float(x), float(y)),
        contacts=_contacts(mesh, touch, follower.system.contact.rough),
        max_strain=follower.system.elements.largest_strain(solution.positions),
        depth=follower.depth,
        snapped=follower.snapped,
    )


def _contacts(mesh: Mesh, touch: Touch, rough: bool) -> tuple[Place, ...]:
    """Separate contacts: touching points of one part with no free element between them."""
    part = mesh.outline.part[touch.edge]
    order = np.lexsort((touch.along, part))
    new = np.diff(part[order], prepend=-1) != 0
    new |= np.abs(np.diff(touch.along[order], prepend=np.inf)) > mesh.size
    contacts = []
    for group in np.split(order, np.flatnonzero(new)[1:]) if order.size else []:
        normal = touch.normal[group]
        if normal.sum() > _NO_CONTACT * touch.normal.sum():
            s, total = float(np.average(touch.along[group], weights=normal)), float(normal.sum())
            state: State = "stick" if normal[touch.sticking[group]].sum() > total / 2 else "slip"
            on = PARTS[part[group[0]]]
            contacts.append(Place(on=on, s=s, normal_force=total, state=state if rough else "frictionless"))
    return tuple(contacts)
