"""From a verified equilibrium to plain numbers: forces, checks, the error estimate, the shape. SI, world frame."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from gripper.arrays import Array, Complex
from gripper.beam import Beam
from gripper.clearance import clearance
from gripper.contact import linearise
from gripper.contact_rows import Linearisation
from gripper.equilibrium import Equilibrium, Setting, State, kkt_step
from gripper.features import conform
from gripper.grip import tipward
from gripper.kept import Kept
from gripper.kinematics import Placement
from gripper.outline import Part, dot
from gripper.parabola import vertex
from gripper.result import Checks, Contact, ErrorEstimate, PoseResult, Shape
from gripper.site import Site
from gripper.verified import Verified

NO_FORCE = 1e-9
"""Total contact force, over EI / L^2, below which a pose is free (grazing is free)."""
STATIONARY = 1e-8
BALANCED = 1e-2
_DRAWN = np.linspace(0.0, 1.0, 81)
_ALONG = np.linspace(0.0, 1.0, 13)
_each = functools.cache(np.arange)
_STATES = {"open": "slip", "slip": "slip", "stick": "stick"}


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
    return _checked(setting, verified, _Profile.of(setting, verified.equilibrium.state))


def _checked(setting: Setting, verified: Verified, seen: _Profile) -> Checks:
    equilibrium, survey = verified.equilibrium, verified.survey
    state, lin = equilibrium.state, equilibrium.linear
    stationarity = force = moment = 0.0
    if state.sites:
        load = lin.loads.T @ state.multipliers
        total = max(float(np.abs(loads(equilibrium)[1]).sum()), NO_FORCE)
        stationarity = float(np.linalg.norm(state.z - load)) / max(float(np.linalg.norm(load)), NO_FORCE)
        force, moment = (missing / total for missing in _imbalance(setting, equilibrium, seen))
    return Checks(
        stationarity=stationarity,
        force_balance=force,
        moment_balance=moment,
        stability=verified.stability if lin.rubbing is None else None,
        singularity=None if lin.rubbing is None else verified.stability,
        penetration_bound=survey.penetration_bound * setting.sections.length,
        certificate="proved" if survey.proved else "sampled",
    )


def _imbalance(setting: Setting, equilibrium: Equilibrium, seen: _Profile) -> tuple[float, float]:
    """Force and moment at the clamp that the strains carry beyond the contact forces'.

    EI kappa between the clamp and the first contact, less the contact forces' moments about the same sections, is
    fitted by a couple and a force across the chord (a nearly straight finger tells nothing of one along it). It is
    read at the zeros of P_(p+1), where the error of a projection on polynomials of order p is of higher order.
    """
    points, forces = loads(equilibrium)
    position = seen.position[seen.balance]
    applied = ((points[None, :] - position[:, None]).conj() @ forces[:, None]).imag[:, 0]
    missing = seen.stiffness[seen.balance] * seen.kappa[seen.balance] - applied
    arms = -dot(position, position[-1] / abs(position[-1]))
    middle = arms - arms.mean()
    across = float(middle @ missing / (middle @ middle)) if len(arms) > 1 else 0.0
    couple = float(missing.mean() - across * arms.mean())
    return abs(across), abs(couple)


@functools.cache
def _zeros(count: int) -> Array:
    """The zeros of P_count."""
    return np.polynomial.legendre.leggauss(count)[0]


@dataclass(frozen=True, eq=False)
class _Profile:
    """A deflected finger, read once at all stations that a result needs; lengths by L, stiffness EI over EI(0)."""

    s: Array
    position: Complex
    psi: Array
    kappa: Array
    half: Array  # w / 2
    stiffness: Array
    drawn: slice
    balance: slice
    strain: slice

    @classmethod
    def of(cls, setting: Setting, state: State) -> _Profile:
        """Read the shape, where the balance is checked, and where strains are looked at."""
        beam = state.beam
        drawn = np.unique(np.concatenate([_DRAWN, beam.breaks]))
        balance = beam.breaks[1] * (_zeros(beam.modes) + 1) / 2
        strain = (beam.starts[:, None] + beam.lengths[:, None] * _ALONG).ravel()
        s = np.concatenate([drawn, balance, strain])
        clamped, along = np.zeros(balance.size, dtype=np.intp), np.repeat(_each(beam.segments), _ALONG.size)
        segment = np.concatenate([beam.segment_of(drawn), clamped, along])
        position, psi, _, kappa = state.axis.values(s, segment)
        half, stiffness = setting.sections.thickness(s) / 2, setting.sections.EI(s)
        first, second = drawn.size, drawn.size + balance.size
        spans = slice(0, first), slice(first, second), slice(second, s.size)
        return cls(s, position, psi, kappa, half, stiffness, *spans)


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
    seen = _Profile.of(setting, answer.verified.equilibrium.state)
    checks = _checked(setting, answer.verified, seen)
    reason = shortcoming(checks)
    if reason:
        return PoseResult.failed(parameter, reason, answer.iterations, answer.seconds)
    scales, equilibrium = setting.sections, answer.verified.equilibrium
    state = equilibrium.state
    force = -equilibrium.force * scales.force_scale
    turn = placement.turn
    points, forces = loads(equilibrium)
    free = float(np.max(np.abs(forces), initial=0.0)) <= NO_FORCE
    moment = -cross(points - equilibrium.obstacle.frame.origin, forces)
    tip = seen.drawn.stop - 1
    strain, strain_s = _largest_strain(equilibrium, seen)
    return PoseResult(
        parameter=parameter,
        status="free" if free else "contact",
        force_on_object=_vector(turn * force),
        force_on_object_finger_frame=_vector(force),
        moment_on_object=moment * scales.energy_scale,
        motion_force=None if parameter is None else drive(equilibrium) * scales.energy_scale,
        clamp_moment=cross(points, forces) * scales.energy_scale,
        energy=state.energy * scales.energy_scale,
        tip=_vector(placement.origin + turn * complex(seen.position[tip]) * scales.length),
        tip_rotation=float(seen.psi[tip]),
        max_strain=strain,
        max_strain_s=None if free else strain_s * scales.length,
        min_gap=clearance(setting, answer.verified) * scales.length,
        contacts=() if free else contacts(setting, equilibrium, placement),
        checks=checks,
        error=ErrorEstimate(discretisation=answer.error),
        iterations=answer.iterations,
        seconds=answer.seconds,
        shape=_shape(setting, seen, placement),
        kept=Kept(setting, equilibrium),
    )


def _vector(value: complex) -> tuple[float, float]:
    return float(value.real), float(value.imag)


def loads(equilibrium: Equilibrium) -> tuple[Complex, Complex]:
    """All contact points and the forces on the finger there."""
    lin, none = equilibrium.linear, np.zeros(0, dtype=complex)
    return np.concatenate([none, *lin.points]), np.concatenate([none, *lin.forces])


def drive(equilibrium: Equilibrium) -> float:
    """Work that the object puts into the finger per unit of the parameter: -(F . v + M omega)."""
    points, forces = loads(equilibrium)
    return float(np.sum(dot(forces, equilibrium.obstacle.velocities(points))))


def largest_strain(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Largest abs(eps) + abs(kappa) w / 2 and its s (by L), both from the contact forces beyond each section.

    The forces and their moment are as good as the forces; the strain fields are right in the mean only.
    """
    return _largest_strain(equilibrium, _Profile.of(setting, equilibrium.state))


def _largest_strain(equilibrium: Equilibrium, seen: _Profile) -> tuple[float, float]:
    state, lin = equilibrium.state, equilibrium.linear
    if not state.sites:
        return 0.0, 0.0
    position, s = seen.position[seen.strain], seen.s[seen.strain]
    # which side of a force at a break a sample is on
    middle = s - np.tile((_ALONG - 0.5) * 1e-9, state.beam.segments)
    on_face = zip(state.sites, lin.stations, strict=True)
    places = np.concatenate([u if site.on_face else np.full(u.size, 2.0) for site, u in on_face])
    points, forces = loads(equilibrium)
    moments = ((points - position[:, None]).conj() * forces).imag
    beyond = places > middle[:, None]
    moment = np.sum(moments * beyond, axis=1)
    strain = np.abs(moment) / seen.stiffness[seen.strain] * seen.half[seen.strain]
    if state.beam.stretches:
        along = dot(np.exp(1j * seen.psi[seen.strain]), beyond @ forces)
        strain += np.abs(along) / state.beam.sections.EA(s)
    place, value = vertex(s, strain, int(np.argmax(strain)))
    return value, place


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
        elif last >= 0 and conform(sites[last], site):
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


def _places(setting: Setting, sites: list[Site], stations: list[Array]) -> tuple[Part, Array]:
    """Which part of the finger, and s (by L) of each of its contact points."""
    places = [setting.outline.place(site.piece, u) for site, u in zip(sites, stations, strict=True)]
    return places[0][0], np.concatenate([s for _, s in places])


def _extent(setting: Setting, site: Site) -> Array:
    return setting.outline.place(site.piece, np.array(site.place or (0.0,)))[1]


def _shape(setting: Setting, seen: _Profile, placement: Placement) -> Shape:
    length, jaw = setting.sections.length, setting.outline.jaw
    position, half = seen.position[seen.drawn], seen.half[seen.drawn]
    section = np.exp(1j * seen.psi[seen.drawn])
    across = 1j * half * section

    def world(points: Complex) -> Array:
        placed = placement.origin + placement.turn * length * points
        return placed.view(float).reshape(-1, 2)

    return Shape(
        axis=world(position),
        lower=world(position - across),
        upper=world(position + across),
        strain=np.abs(seen.kappa[seen.drawn]) * half,
        jaw=None if jaw is None else world(position[-1] + jaw * section[-1]),
        clamp_pose=placement.clamp,
        object_pose=placement.object,
    )
