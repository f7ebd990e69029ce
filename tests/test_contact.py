"""The contact equations: every kind, on every part of the outline, with every derivative that Newton needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

import gripper as gr
from gripper.beam.axis import Axis
from gripper.beam.sections import sections
from gripper.beam.strains import Beam
from gripper.contact.linear import linearise
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Frame, Obstacle
from gripper.contact.outline import LOWER, UPPER, Outline
from gripper.contact.site import Site
from gripper_plugins.jaws.polygon import PolygonJaw
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.polygon import Polygon
from tests.scenes import STRAIGHT, TAPERED, unit_finger

H = 1e-6
TIP = 2
PLATE = PolygonJaw(vertices=((-0.01, -0.1), (0.2, -0.12), (0.25, 0.1), (-0.01, 0.1)))
SMOOTH = {
    "ellipse": Ellipse(semi_axes=(0.13, 0.07)),
    "superellipse": Implicit(expression="(x/0.12)**4 + (y/0.08)**4 + x*y - 1", extent=0.4),
}
SHARP = Polygon(vertices=((-0.1, -0.1), (0.12, -0.07), (0.02, 0.11)))
CORNERED, HOOKED, PLATED = (Outline(sections(finger)) for finger in (TAPERED, STRAIGHT, unit_finger(jaw=PLATE)))


def edges(outline: Outline) -> list[int]:
    return [i for i, piece in enumerate(outline.pieces) if piece.on == "jaw"]


def corners(outline: Outline) -> list[int]:
    return [outline.corner_piece(i) for i in range(len(outline.corners))]


def cases() -> list[tuple[str, Outline, Site]]:
    found = []
    for face, name in ((LOWER, "lower"), (UPPER, "upper")):
        found += [
            (f"tangent on {name}", CORNERED, Site("tangent", face, (0.55,))),
            (f"tangent at the kink on {name}", CORNERED, Site("tangent", face, (0.7,))),
            (f"node on {name}", CORNERED, Site("node", face, (0.55,))),
            (f"vertex on {name}", CORNERED, Site("vertex", face, (0.55,), 1)),
            (f"patch on {name}", CORNERED, Site("patch", face, (0.45, 0.65))),
            (f"tail on {name}", CORNERED, Site("tail", face, (0.85, 1.0))),
        ]
    found += [("tangent on the end face", CORNERED, Site("tangent", TIP, (0.03,)))]
    found += [("vertex on the end face", CORNERED, Site("vertex", TIP, (0.03,), 2))]
    found += [(f"corner {i} of the tip", CORNERED, Site("corner", i, ())) for i in corners(CORNERED)]
    for name, outline in (("hook", HOOKED), ("plate", PLATED)):
        for i in edges(outline):
            place = (0.4 * outline.pieces[i].length,)
            found += [(f"tangent on edge {i} of the {name}", outline, Site("tangent", i, place))]
            found += [(f"vertex on edge {i} of the {name}", outline, Site("vertex", i, place, 0))]
        found += [(f"corner {i} of the {name}", outline, Site("corner", i, ())) for i in corners(outline)]
    return found


@dataclass(frozen=True)
class At:
    """A point of the space in which everything is differentiated."""

    z: np.ndarray
    multipliers: np.ndarray
    places: np.ndarray
    rate: float = 0.0

    def moved(self, name: str, direction: np.ndarray, step: float) -> At:
        return replace(self, **{name: getattr(self, name) + step * direction})


class Situation:
    """A finger deflected at random with an object near to one site; a second site makes the blocks visible."""

    def __init__(self, outline: Outline, site: Site, body: gr.Object, theory: str, seed: int = 3) -> None:
        random = np.random.default_rng(seed)
        self.outline, self.body = outline, body
        self.beam = Beam(outline.sections, (0.0, 0.3, 0.7, 1.0), 3, theory)
        self.sites = (Site("node" if body is SHARP else "tangent", LOWER, (0.21,)), site)
        modes = np.tile(np.arange(self.beam.modes), self.beam.segments * self.beam.fields)
        z = random.normal(size=self.beam.size) / 4.0 ** (modes + 1)  # as smooth as a finger
        u = np.array([site.middle if site.place else 0.0])
        segment = self.beam.segment_of(u) if site.on_face else np.array([2])
        point = outline.trace(Axis.of(self.beam, z), np.array([site.piece]), u, segment)[0][0]
        self.origin = point + 0.1 * np.exp(1j * random.uniform(0, 6))
        if site.kind == "vertex":  # exact on contact; off it terms are left out that vanish there
            self.origin = point - complex(*SHARP.corners[site.vertex]) * np.exp(0.4j)
        places = np.array([p for s in self.sites for p in s.place[: s.unknown_places]])
        count = sum(s.multipliers for s in self.sites)
        self.at = At(z, random.uniform(0.5, 2, count), places)
        self.random = random

    def linear(self, at: At) -> Linearisation:
        velocity, spin = 0.3 - 0.8j, 0.7
        frame = Frame(self.origin + velocity * at.rate, 0.4 + spin * at.rate, velocity, spin)
        obstacle = Obstacle(self.body, 1.0, frame)
        sites, first = [], 0
        for site in self.sites:
            sites.append(site.moved(at.places[first : first + site.unknown_places]))
            first += site.unknown_places
        return linearise(self.beam, at.z, self.outline, obstacle, tuple(sites), at.multipliers)

    def difference(self, name: str, quantity: Callable[[Linearisation, At], np.ndarray]) -> tuple:
        """A random direction in one argument, and the central difference of a quantity along it."""
        value = getattr(self.at, name)
        direction = self.random.normal(size=np.shape(value))
        direction = direction / max(float(np.linalg.norm(direction)), 1e-300)
        ends = [self.at.moved(name, direction, step) for step in (H, -H)]
        high, low = (quantity(self.linear(end), end) for end in ends)
        return direction, (high - low) / (2 * H)


def load(lin: Linearisation, at: At) -> np.ndarray:
    return lin.gradients.T @ at.multipliers


def total(lin: Linearisation, at: At) -> np.ndarray:
    return np.array([sum(f.sum() for f in lin.forces)])


QUANTITIES = {
    "values": lambda lin, at: lin.values,
    "residuals": lambda lin, at: lin.residuals,
    "load": load,
    "force": total,
}
DERIVATIVES = {
    ("values", "z"): lambda lin: lin.gradients,
    ("values", "places"): lambda lin: lin.value_slopes,
    ("values", "rate"): lambda lin: lin.rates()[0],
    ("residuals", "z"): lambda lin: lin.residual_gradients,
    ("residuals", "places"): lambda lin: lin.residual_slopes,
    ("residuals", "rate"): lambda lin: lin.rates()[1],
    ("load", "z"): lambda lin: lin.hessian,
    ("load", "places"): lambda lin: lin.load_slopes,
    ("load", "rate"): lambda lin: lin.rates()[2],
    ("load", "multipliers"): lambda lin: lin.gradients.T,
    ("force", "z"): lambda lin: lin.force_gradient[None],
    ("force", "places"): lambda lin: lin.force_places[None],
    ("force", "multipliers"): lambda lin: lin.force_multipliers[None],
}


@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
@pytest.mark.parametrize(("name", "outline", "site"), cases(), ids=[name for name, *_ in cases()])
def test_every_derivative_of_the_contact_equations_is_exact(
    name: str, outline: Outline, site: Site, theory: str
) -> None:
    bodies = [SHARP] if site.kind == "vertex" else list(SMOOTH.values())
    for body in bodies:
        situation = Situation(outline, site, body, theory)
        lin = situation.linear(situation.at)
        for (quantity, argument), derivative in DERIVATIVES.items():
            direction, difference = situation.difference(argument, QUANTITIES[quantity])
            exact = derivative(lin) * direction if argument == "rate" else derivative(lin) @ direction
            scale = max(1.0, float(np.abs(difference).max(initial=0.0)))
            assert exact == pytest.approx(difference, abs=2e-7 * scale), f"d {quantity} / d {argument}"


@pytest.mark.parametrize("theory", ["bending", "shear", "stretch"])
@pytest.mark.parametrize(("name", "outline", "site"), cases(), ids=[name for name, *_ in cases()])
def test_the_load_is_the_virtual_work_of_the_contact_forces(
    name: str, outline: Outline, site: Site, theory: str
) -> None:
    """On a contact at its place (C = R = 0) C_z^T lambda dz is the work of the reported forces at their points."""
    body = SHARP if site.kind == "vertex" else SMOOTH["ellipse"]
    situation = Situation(outline, site, body, theory)
    situation.sites = (site,)
    at = At(situation.at.z, situation.at.multipliers[-site.multipliers :], np.array(site.place[: site.unknown_places]))
    lin = situation.linear(at)
    direction, _ = situation.difference("z", QUANTITIES["values"])
    moved = [situation.linear(at.moved("z", direction, step)).points[0] for step in (H, -H)]
    velocity = (moved[0] - moved[1]) / (2 * H)
    work = float(np.sum((lin.forces[0].conj() * velocity).real))
    assert load(lin, at) @ direction == pytest.approx(work, abs=1e-7)


@pytest.mark.parametrize(("name", "outline", "site"), cases(), ids=[name for name, *_ in cases()])
def test_a_force_acts_along_the_normal(name: str, outline: Outline, site: Site) -> None:
    """Along grad g; at the object's corner along the normal of the finger's face, into the finger."""
    body = SHARP if site.kind == "vertex" else SMOOTH["superellipse"]
    situation = Situation(outline, site, body, "shear")
    lin = situation.linear(situation.at)
    points, forces = lin.points[1], lin.forces[1]
    if site.kind != "vertex":
        _, normals = Obstacle(body, 1.0, Frame(situation.origin, 0.4, 0j, 0.0)).slope(points)
        assert (forces.conj() * normals).imag == pytest.approx(0, abs=1e-12)
        return
    segment = situation.beam.segment_of(np.array(site.place)) if site.on_face else np.array([2])
    axis = Axis.of(situation.beam, situation.at.z)
    piece, u = np.array([site.piece]), np.array(site.place)
    tangent = outline.trace(axis, piece, u, segment)[1]
    assert (forces.conj() * tangent).real == pytest.approx(0, abs=1e-12)
    inward = 1j * tangent * (-1 if site.piece == UPPER else 1)
    assert (forces.conj() * inward).real > 0


def test_a_finger_that_touches_nothing_has_no_equations() -> None:
    beam = Beam(CORNERED.sections, (0.0, 1.0), 3, "shear")
    lin = linearise(beam, np.zeros(beam.size), CORNERED, Obstacle(SHARP, 1.0, Frame(0j, 0, 0j, 0)), (), np.zeros(0))
    assert lin.values.size == lin.residuals.size == 0
    assert lin.hessian.shape == (beam.size, beam.size) and not lin.hessian.any()


def test_a_contact_at_a_break_takes_the_mean_of_both_sides_and_without_kinks_its_own() -> None:
    situation = Situation(CORNERED, Site("tangent", LOWER, (0.7,)), SMOOTH["ellipse"], "shear")
    obstacle = Obstacle(situation.body, 1.0, Frame(situation.origin, 0.4, 0j, 0.0))
    arguments = (situation.beam, situation.at.z, CORNERED, obstacle)
    tangent = (Site("tangent", LOWER, (0.7,)),)
    slope = {kinks: linearise(*arguments, tangent, np.ones(1), kinks=kinks).residuals[0] for kinks in (True, False)}
    axis, piece, u = Axis.of(*arguments[:2]), np.array([LOWER]), np.array([0.7])
    sides = []
    for segment in (1, 2):
        point, direction, _ = CORNERED.trace(axis, piece, u, np.array([segment]))
        sides.append(float((obstacle.slope(point)[1].conj() * direction).real[0]))
    assert slope[True] == pytest.approx(np.mean(sides))
    assert slope[False] == pytest.approx(sides[1])
    assert sides[0] != pytest.approx(sides[1])
