"""From a verified equilibrium to plain numbers: forces, checks, the error estimate, the shape. SI, world frame."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from gripper.active import Verified
from gripper.arrays import Array, Complex
from gripper.beam import Beam
from gripper.clearance import clearance
from gripper.contact import Linearisation, Site, linearise
from gripper.equilibrium import Equilibrium, Setting, kkt_step
from gripper.grip import tipward
from gripper.kept import Kept
from gripper.kinematics import Placement
from gripper.outline import Axis, Part, dot
from gripper.result import Checks, Contact, ErrorEstimate, PoseResult, Shape

NO_FORCE = 1e-9
"""Total contact force, over EI / L^2, below which a pose is free (grazing is free)."""
STATIONARY = 1e-8
BALANCED = 1e-2
_DRAWN = 81
_STATES = {"open": "slip", "slip": "slip", "stick": "stick"}
_CONFORMING = 0.06  # of L: nodes nearer to one another than this are one contact


def cross(a: Complex, b: Complex) -> float:
    """Sum of the cross products of vectors."""
    return float(np.sum((a.conj() * b).imag))


def discretisation_error(setting: Setting, equilibrium: Equilibrium) -> float:
    """Relative error of the force vector: one Newton step of the system enriched by two orders, contacts fixed."""
    state = equilibrium.state
    if not state.sites:
        return 0.0
    finer = Beam(setting.sections, state.beam.breaks, state.beam.order + 2, setting.theory)
    enriched = dataclasses.replace(state, beam=finer, z=finer.embed(state.beam, state.z))
    lin = linearise(finer, enriched.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    dz, dmultipliers, dplaces = kkt_step(enriched, lin)
    change = lin.force_gradient @ dz + lin.force_multipliers @ dmultipliers + lin.force_places @ dplaces
    return float(abs(change) / max(abs(equilibrium.force), NO_FORCE))


def check(setting: Setting, verified: Verified) -> Checks:
    """Stationarity, balance of forces and moments, stability, penetration (PHYSICS: what a right answer satisfies).

    The balance compares the moments that the strains carry with those of the contact forces (Lan & Lee eq 6, for any
    number of contacts).
    """
    equilibrium, survey = verified.equilibrium, verified.survey
    state, lin = equilibrium.state, equilibrium.linear
    bound = survey.penetration_bound * setting.sections.length
    certificate: Literal["proved", "sampled"] = "proved" if survey.proved else "sampled"
    if not state.sites:
        return Checks(
            stationarity=0.0,
            force_balance=0.0,
            moment_balance=0.0,
            stability=1.0,
            penetration_bound=bound,
            certificate=certificate,
        )
    load = lin.loads.T @ state.multipliers
    total = max(float(np.sum(np.abs(np.concatenate(lin.forces)))), NO_FORCE)
    force, moment = _imbalance(setting, equilibrium)
    return Checks(
        stationarity=float(np.linalg.norm(state.z - load)) / max(float(np.linalg.norm(load)), NO_FORCE),
        force_balance=force / total,
        moment_balance=moment / total,
        stability=verified.stability if lin.rubbing is None else None,
        penetration_bound=bound,
        certificate=certificate,
    )


def _imbalance(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Force and moment at the clamp that the strains carry beyond the contact forces'.

    EI kappa between the clamp and the first contact, less the contact forces' moments about the same sections, is
    fitted by a couple and a force across the chord (a nearly straight finger tells nothing of one along it). It is
    read at the zeros of P_(p+1), where the error of a projection on polynomials of order p is of higher order.
    """
    state, lin = equilibrium.state, equilibrium.linear
    x = np.polynomial.legendre.leggauss(state.beam.modes)[0]
    s = state.beam.breaks[1] * (x + 1) / 2
    position, _, _, kappa = Axis.of(state.beam, state.z).values(s, np.zeros(s.size, dtype=np.intp))
    points, forces = np.concatenate(lin.points), np.concatenate(lin.forces)
    applied = np.sum(((points[None, :] - position[:, None]).conj() * forces).imag, axis=1)
    missing = setting.sections.EI(s) * kappa - applied
    chord = position[-1] / abs(position[-1])
    arms = np.column_stack([np.ones(s.size), -dot(position, chord)])
    couple, across = np.linalg.lstsq(arms, missing)[0]
    return abs(float(across)), abs(float(couple))


def shortcoming(checks: Checks) -> str | None:
    """Which check fails, in words, or None."""
    if (checks.stationarity or 0.0) > STATIONARY:
        return f"not stationary: {checks.stationarity:.1e} of the contact force is unbalanced"
    worst = max(checks.force_balance or 0.0, checks.moment_balance or 0.0)
    if worst > BALANCED:
        return f"forces and moments do not balance: {worst:.1e} of the contact force is missing"
    return None


@dataclass(frozen=True, eq=False)
class Answer:
    """A pose's verified equilibrium with its error estimate."""

    verified: Verified
    error: float
    seconds: float
    iterations: int


def pose_result(setting: Setting, answer: Answer, parameter: float | None, placement: Placement) -> PoseResult:
    """The plain numbers of a pose; failed where a check is not met."""
    checks = check(setting, answer.verified)
    reason = shortcoming(checks)
    if reason:
        return PoseResult.failed(parameter, reason, answer.iterations, answer.seconds)
    scales, equilibrium = setting.sections, answer.verified.equilibrium
    state = equilibrium.state
    force = -equilibrium.force * scales.force_scale
    turn = placement.turn
    points, forces = _loads(equilibrium)
    free = float(np.max(np.abs(forces), initial=0.0)) <= NO_FORCE
    moment = -cross(points - equilibrium.obstacle.frame.origin, forces)
    position, psi, _, _ = Axis.of(state.beam, state.z).values(np.ones(1), np.array([state.beam.segments - 1]))
    strain, strain_s = largest_strain(setting, equilibrium)
    return PoseResult(
        parameter=parameter,
        status="free" if free else "contact",
        force_on_object=_vector(turn * force),
        force_on_object_finger_frame=_vector(force),
        moment_on_object=moment * scales.energy_scale,
        motion_force=None if parameter is None else drive(equilibrium) * scales.energy_scale,
        clamp_moment=cross(points, forces) * scales.energy_scale,
        energy=state.energy * scales.energy_scale,
        tip=_vector(placement.origin + turn * complex(position[0]) * scales.length),
        tip_rotation=float(psi[0]),
        max_strain=strain,
        max_strain_s=None if free else strain_s * scales.length,
        min_gap=clearance(setting, answer.verified) * scales.length,
        contacts=() if free else contacts(setting, equilibrium, placement),
        checks=checks,
        error=ErrorEstimate(discretisation=answer.error),
        iterations=answer.iterations,
        seconds=answer.seconds,
        shape=_shape(setting, equilibrium, placement),
        kept=Kept(setting, equilibrium),
    )


def _vector(value: complex) -> tuple[float, float]:
    return float(value.real), float(value.imag)


def _loads(equilibrium: Equilibrium) -> tuple[Complex, Complex]:
    """All contact points and the forces on the finger there."""
    lin, none = equilibrium.linear, np.zeros(0, dtype=complex)
    return np.concatenate([none, *lin.points]), np.concatenate([none, *lin.forces])


def drive(equilibrium: Equilibrium) -> float:
    """Work that the object puts into the finger per unit of the parameter: -(F . v + M omega)."""
    points, forces = _loads(equilibrium)
    return float(np.sum(dot(forces, equilibrium.obstacle.velocities(points))))


def largest_strain(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Largest abs(kappa) w / 2, kappa from the moment of the contact forces beyond each section, and its s (by L).

    The moment of the forces is as good as the forces; kappa of the strain fields is right in the mean only.
    """
    beam, state, lin = equilibrium.state.beam, equilibrium.state, equilibrium.linear
    along = np.linspace(0.0, 1.0, 13)
    s = (np.array(beam.breaks[:-1])[:, None] + beam.lengths[:, None] * along).ravel()
    segment = np.repeat(np.arange(beam.segments), along.size)
    position = Axis.of(beam, state.z).values(s, segment)[0]
    middle = s - np.tile((along - 0.5) * 1e-9, beam.segments)  # which side of a force at a break a sample is on
    moment = np.zeros(s.size)
    for site, u, points, forces in zip(state.sites, lin.stations, lin.points, lin.forces, strict=True):
        places = u if site.on_face else np.full(u.size, 2.0)
        beyond = places[None, :] > middle[:, None]
        moment += np.sum(beyond * ((points[None, :] - position[:, None]).conj() * forces).imag, axis=1)
    strain = np.abs(moment) / setting.sections.EI(s) * setting.sections.thickness(s) / 2
    return _vertex(s, strain, int(np.argmax(strain)))


def _vertex(x: Array, y: Array, i: int) -> tuple[float, float]:
    """The largest value near the largest sample and its place: a parabola's, where neighbours are on both sides."""
    if not (0 < i < x.size - 1 and x[i - 1] < x[i] < x[i + 1]):
        return float(y[i]), float(x[i])
    fall, rise = y[i] - y[i - 1], y[i] - y[i + 1]
    off = (fall - rise) / (2 * (fall + rise)) if fall + rise else 0.0
    return float(y[i] + (fall - rise) * off / 4), float(x[i] + off * (x[i + 1] - x[i]))


def contacts(setting: Setting, equilibrium: Equilibrium, placement: Placement) -> tuple[Contact, ...]:
    """One entry a separate contact, ordered by s; a patch that ends in the tip's corner is one with it."""
    lin, sites = equilibrium.linear, equilibrium.state.sites
    tails = {setting.outline.tip_corner(site.piece) for site in sites if site.kind == "tail"}
    groups: dict[object, list[int]] = {}
    last = -1
    for i in sorted(range(len(sites)), key=lambda i: (sites[i].piece, sites[i].place)):
        site = sites[i]
        corner = setting.outline.tip_corner(site.piece) if site.kind == "tail" else site.piece
        if corner in tails:
            groups.setdefault(("tail", corner), []).append(i)
        elif last >= 0 and _conform(sites[last], site):
            next(members for members in groups.values() if last in members).append(i)
        else:
            groups[i] = [i]
        last = i
    length = setting.sections.length
    out = []
    for members in groups.values():
        points = np.concatenate([lin.points[i] for i in members])
        forces = np.concatenate([lin.forces[i] / _incline(lin, i) for i in members])  # normal forces
        weights = np.abs(forces)
        total = complex(forces.sum())
        if abs(total) <= NO_FORCE:
            continue
        on, places = _places(setting, [sites[i] for i in members], [lin.stations[i] for i in members])
        extent = [s for i in members for s in _extent(setting, sites[i])]
        rubbing = complex(sum(lin.forces[i].sum() for i in members)) - total
        out.append(
            Contact(
                on=on,
                s=float(places @ weights / weights.sum()) * length,
                extent=(min(extent) * length, max(extent) * length),
                point=_vector(placement.origin + placement.turn * complex(weights @ points / weights.sum()) * length),
                normal=_vector(placement.turn * total / abs(total)),
                normal_force=abs(total) * setting.sections.force_scale,
                **_friction(setting, sites[members[0]], rubbing, total),
            )
        )
    return tuple(sorted(out, key=lambda contact: contact.s))


def _incline(lin: Linearisation, i: int) -> complex:
    """From the normal force to the force at a contact: 1 - i rho."""
    return 1.0 if lin.rubbing is None else 1 - 1j * lin.rubbing.ratios[i]


def _friction(setting: Setting, site: Site, rubbing: complex, normal: complex) -> dict[str, Any]:
    """Friction on the object towards the tip, and whether the contact sticks."""
    if site.grip is None:
        return {}
    along = (1j * normal.conjugate() / abs(normal) * rubbing).real * tipward(site, setting.outline)
    return {"tangential_force": -along * setting.sections.force_scale, "state": _STATES[site.grip.hold]}


def _conform(one: Site, other: Site) -> bool:
    """Whether neighbouring contacts on one piece belong to one stretch that conforms to the object."""
    if one.piece != other.piece or "node" not in (one.kind, other.kind):
        return False
    return other.place[0] - one.place[-1] < _CONFORMING


def _places(setting: Setting, sites: list[Site], stations: list[Array]) -> tuple[Part, Array]:
    """Which part of the finger, and s (by L) of each of its contact points."""
    places = [setting.outline.place(site.piece, u) for site, u in zip(sites, stations, strict=True)]
    return places[0][0], np.concatenate([s for _, s in places])


def _extent(setting: Setting, site: Site) -> Array:
    return setting.outline.place(site.piece, np.array(site.place or (0.0,)))[1]


def _shape(setting: Setting, equilibrium: Equilibrium, placement: Placement) -> Shape:
    state, length = equilibrium.state, setting.sections.length
    beam = state.beam
    s = np.union1d(np.linspace(0.0, 1.0, _DRAWN), beam.breaks)
    position, psi, _, kappa = Axis.of(beam, state.z).values(s, beam.segment_of(s))
    half, section = setting.sections.thickness(s) / 2, np.exp(1j * psi)

    def world(points: Complex) -> Array:
        placed = placement.origin + placement.turn * points * length
        return np.column_stack([placed.real, placed.imag])

    jaw = setting.outline.jaw
    return Shape(
        axis=world(position),
        lower=world(position - 1j * half * section),
        upper=world(position + 1j * half * section),
        strain=np.abs(kappa) * half,
        jaw=None if jaw is None else world(position[-1] + jaw * section[-1]),
        clamp_pose=placement.clamp,
        object_pose=placement.object,
    )
