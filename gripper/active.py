"""One pose: SLSQP finds the active set, the exact KKT system finishes, and the answer verifies itself."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from gripper.arrays import Array
from gripper.assemble import Candidate, Problem, least_gaps, near, vertex_heights
from gripper.beam import legendre
from gripper.certificate import DEPTH, Survey, survey
from gripper.contact import NARROW, WIDE, Site, linearise
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, anchored, settle
from gripper.grip import dressed, grouped
from gripper.obstacle import Obstacle
from gripper.outline import LOWER, UPPER

_ROUNDS = 5
_STRETCH = 0.05  # of L: half of a stretch about a penetration
_PATIENCE = 40  # SLSQP takes 8 to 15 iterations where it gets somewhere
_COARSE = 1e-6  # SLSQP only has to tell who touches: Newton does the rest
_ACTIVE = 1e-6  # of the largest multiplier
_PATCH = 2e-5  # of L: narrower patches are points (the mean tangent's error falls with the square of the width)
_POINTLIKE = 5 * _PATCH
_FLUSH = 2.0  # of sqrt(EI / GA): where a patch would be wider, the finger lies flush on a flat
_WIDTHS = (
    (0.3, NARROW),
    (0.8, 3),
    (2.2, 4),
    (5.0, 6),
    (np.inf, WIDE),
)  # modes of a patch by its width over sqrt(EI / GA)
_DECAYED = 6.0  # of sqrt(EI / GA): as far as a pressure that decays is followed
_TURNED = 1e-3  # rad: a flat that turns by more has ended
_RIPPLE = 3e-2  # of the largest pressure: what a polynomial may leave where the pressure has decayed
_ACROSS = np.linspace(-1.0, 1.0, 17)
_TOGETHER = 0.02  # of L: tangents nearer than this are one contact
_END = 1 - 1e-7  # of L: just before the tip
_TIP = 0.1  # of L: a contact this near to the tip may be the corner's
_GRAZING = 1e-12  # of L: a gap's round-off
_FLAT = 1e-4  # curvature of the gap, times L: below it a tangent's place is held by the next order
_NOTHING = 1e-13  # over EI / L^2: the round-off of no force
_PULL = 1e-9  # relative: multipliers this negative are round-off
REACH = 0.05
"""Stretches of outline this near to the object (by L) are candidates from the start; the survey adds others."""


@dataclass(frozen=True, eq=False)
class Verified:
    """An equilibrium and the survey that found it clear."""

    equilibrium: Equilibrium
    survey: Survey
    stability: float = 1.0


def untouched(setting: Setting, free: Verified) -> bool:
    """Whether a finger without contacts is not even grazed."""
    equilibrium, found = free.equilibrium, free.survey
    if found.least > 0 or not found.clear:
        return found.clear
    gaps = least_gaps(setting, equilibrium.obstacle, equilibrium.state, found)
    return min((gap for gap, _ in gaps), default=found.min_gap) >= -_GRAZING


def fit_patches(setting: Setting, equilibrium: Equilibrium) -> tuple[Site, ...]:
    """The contacts with patches where shear makes them wide enough, points where it does not.

    A point force N leaves gamma with a jump N / GA, over which the object's outline bends the finger's: it touches
    over about N / (GA g''), g'' being the curvature of the gap. On a flat the finger lies flush beyond the point, and
    the pressure decays over sqrt(EI / GA).
    """
    if setting.theory == "bending":
        return equilibrium.state.sites
    sites, column, after = [], 0, 0
    for i, site in enumerate(equilibrium.state.sites):
        column, after = after, after + site.unknowns
        if site.kind == "tangent" and site.on_face:
            force = abs(complex(equilibrium.linear.forces[i].sum()))
            curvature = float(equilibrium.linear.residual_slopes[column, column])
            site = _patch(setting, equilibrium, site, force, curvature)
        elif site.kind == "patch" and site.place[1] - site.place[0] < _PATCH / 2:
            site = replace(site, kind="tangent", place=(site.middle,), modes=1)
        elif site.kind in ("patch", "tail"):
            modes = _modes(setting, site)
            if modes > site.modes or _modes(setting, site, slack=1.4) < site.modes:  # down later than up
                site = replace(site, modes=modes)
        sites.append(site)
    return tuple(sites)


def _modes(setting: Setting, site: Site, slack: float = 1.0) -> int:
    """How many pressure modes a patch needs: the pressure varies over sqrt(EI / GA)."""
    width = (site.place[1] - site.place[0]) / _decay(setting, site.middle) * slack
    return next(modes for limit, modes in _WIDTHS if width < limit)


def _decay(setting: Setting, s: float) -> float:
    """sqrt(EI / GA) at a section, by L."""
    at = np.array([min(s, 1.0)])
    return float(np.sqrt(setting.sections.EI(at) / setting.sections.GA(at))[0])


def _patch(setting: Setting, equilibrium: Equilibrium, site: Site, force: float, curvature: float) -> Site:
    """The patch that a point force on a face spreads to, or the point itself."""
    place = np.array(site.place)
    rigidity = float(setting.sections.GA(place)[0])
    decay = _decay(setting, site.place[0])
    if force > rigidity * max(curvature, 0.0) * _FLUSH * decay:
        stop = _flat_until(setting, equilibrium.obstacle, equilibrium.state, site, _DECAYED * decay)
        if stop - site.place[0] > _FLUSH * decay:
            return replace(site, kind="tail", place=(site.place[0] - decay / 2, stop), modes=WIDE)
        return site
    width = force / (rigidity * curvature)
    if width < _PATCH:
        return site
    start, stop = site.place[0] - width / 2, site.place[0] + width / 2
    return replace(site, kind="patch", place=(max(start, 1e-6), stop), modes=NARROW)


def _flat_until(setting: Setting, obstacle: Obstacle, state: State, site: Site, reach: float) -> float:
    """How far along its face a contact's flat goes on, within reach."""
    u = np.linspace(site.place[0], min(site.place[0] + reach, 1.0), 33)
    piece = np.full(u.size, site.piece)
    points, *_ = setting.outline.trace(state.axis, piece, u, state.beam.segment_of(u))
    _, normal = obstacle.slope(points)
    turned = np.abs(normal / np.abs(normal) - normal[0] / abs(normal[0])) > _TURNED
    return float(u[np.argmax(turned) - 1]) if turned.any() else float(u[-1])


def with_sites(state: State, sites: tuple[Site, ...]) -> State:
    """The state with contacts of other kinds at the same places: multipliers carried over."""
    multipliers: list[float] = []
    first = 0
    for old, new in zip(state.sites, sites, strict=True):
        mine = state.multipliers[first : first + old.multipliers]
        first += old.multipliers
        kept = mine.tolist()[: new.multipliers] + [0.0] * (new.multipliers - old.multipliers)
        multipliers += kept if new.kind == old.kind else _spread(float(mine[0]), new)
    return replace(state, sites=sites, multipliers=np.array(multipliers))


def _spread(force: float, site: Site) -> list[float]:
    """First multipliers of a contact that carries a force: even over a short patch, decaying over a wide one."""
    if site.modes <= 4:
        return [force] + [0.0] * (site.modes - 1)
    x, weights = np.polynomial.legendre.leggauss(24)
    decaying = np.exp(-_DECAYED * (x + 1) / 2)
    modes = (2 * np.arange(site.modes) + 1) * (legendre(x, site.modes).T @ (weights * decaying))
    return [float(value) for value in force * modes / modes[0]]


def settle_contacts(setting: Setting, obstacle: Obstacle, state: State, order: int) -> Equilibrium:
    """Settle, and again where a point must become a patch or a patch a point.

    Raises
    ------
    NoEquilibriumError
        Where Newton does not converge.
    """
    foreseen = _foreseen(setting, obstacle, state)
    try:
        found = settle(setting, obstacle, foreseen, order)
    except NoEquilibriumError:
        if foreseen is state:
            raise
        found = settle(setting, obstacle, state, order)
    sites = fit_patches(setting, found)
    if [(s.kind, s.modes) for s in sites] == [(s.kind, s.modes) for s in found.state.sites]:
        return found
    try:
        again = settle(setting, obstacle, with_sites(found.state, sites), order)
    except NoEquilibriumError:
        if any(old.kind != new.kind and not _pointlike(new) for old, new in zip(found.state.sites, sites, strict=True)):
            raise
        return found  # a patch so narrow that Newton's method does not find its ends: a point is as good
    total = found.iterations + again.iterations
    return replace(again, iterations=total, correction=found.correction + again.correction)


def _pointlike(site: Site) -> bool:
    """Whether a patch is so narrow that the mean tangent of a point is as good."""
    return site.kind == "patch" and site.place[1] - site.place[0] < _POINTLIKE


def _foreseen(setting: Setting, obstacle: Obstacle, state: State) -> State:
    """Points on faces as the short patches that they are going to be, so that Newton need not find the points first."""
    if setting.theory == "bending" or not any(s.kind == "tangent" and s.on_face for s in state.sites):
        return state
    lin = linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers, kinks=False)
    sites = fit_patches(setting, Equilibrium(state, obstacle, lin, 0))
    return with_sites(state, sites) if all(site.kind != "tail" for site in sites) else state


def objection(setting: Setting, equilibrium: Equilibrium) -> str | None:
    """Why an equilibrium of these contacts is none of the real ones, or None: pull, or a contact off its piece."""
    state, first = equilibrium.state, 0
    loads = [state.multipliers[0:0]]
    for site in state.sites:
        loads.append(state.multipliers[first : first + site.multipliers])
        first += site.multipliers
    largest = float(np.max(np.abs(state.multipliers), initial=0.0))
    if state.sites and largest < _NOTHING:
        return "no contact carries anything"
    for site, load in zip(state.sites, loads[1:], strict=True):
        pressure = legendre(_ACROSS, site.modes) @ load
        allowed = _PULL * largest if site.modes <= NARROW else _RIPPLE * float(np.max(pressure))
        if float(np.min(pressure)) < -allowed:
            return "a contact would have to pull"
        if site.place and not 0 <= site.place[0] <= site.place[-1] <= setting.outline.pieces[site.piece].length:
            return "a contact has left its face or edge"
    return None


def verify(setting: Setting, equilibrium: Equilibrium) -> Verified:
    """The equilibrium with its survey.

    Raises
    ------
    NoEquilibriumError
        Where a contact pulls, lies off its piece, something penetrates elsewhere, or the equilibrium is unstable.
    """
    reason = objection(setting, equilibrium)
    if reason:
        raise NoEquilibriumError(reason)
    found = survey(setting, equilibrium.obstacle, equilibrium.state)
    if not found.clear:
        raise NoEquilibriumError("the object penetrates the finger elsewhere")
    stiffness = stability(equilibrium)
    if stiffness <= 0:
        raise NoEquilibriumError("the equilibrium is unstable")
    return Verified(equilibrium, found, stiffness)


def stability(equilibrium: Equilibrium) -> float:
    """Smallest eigenvalue of the Hessian reduced to the motions that the contacts leave free (V's own: 1).

    With friction, whose stiffness is not symmetric: its :func:`singularity`.
    """
    lin = equilibrium.linear
    if not len(lin.values):
        return 1.0
    if lin.rubbing is not None:
        return singularity(equilibrium)
    # places follow the motion: eliminate them where the gap is curved (points); where it is flat the tangent itself
    # is held; a patch is held by its pressures
    hessian, held = np.eye(lin.gradients.shape[1]) - lin.hessian, [lin.gradients]
    column = 0
    for site in equilibrium.state.sites:
        if site.kind in ("tangent", "vertex"):
            slide, curvature = lin.residual_gradients[column], float(lin.residual_slopes[column, column])
            if abs(curvature) < _FLAT:
                held.append(slide[None])
            else:
                hessian += np.outer(lin.load_slopes[:, column], slide) / curvature
        column += site.unknown_places
    constraints = np.concatenate(held)
    q = np.linalg.qr(constraints.T, mode="complete")[0][:, len(constraints) :]
    reduced = q.T @ hessian @ q
    return float(np.linalg.eigvalsh((reduced + reduced.T) / 2)[0])


def singularity(equilibrium: Equilibrium) -> float:
    """With friction: how far the tangent stiffness of the free motions is from singular (V's own: 1).

    It is the smallest singular value, less than 0 where the determinant has changed its sign since mu = 0. As mu
    vanishes it becomes the smallest eigenvalue of the reduced Hessian.

    The free motions keep the contacts; what the contact forces may do in reply spans other directions than the
    constraints' gradients, so that the stiffness is taken between the complements of both.
    """
    lin = equilibrium.linear
    hessian = np.eye(lin.gradients.shape[1]) - lin.hessian
    rows, columns = list(lin.gradients), list(lin.loads)
    at = 0
    for site in equilibrium.state.sites:
        stuck, turned = at + site.unknown_places, 0.0
        if site.kind in ("tangent", "vertex"):
            slide, curvature = lin.residual_gradients[at], float(lin.residual_slopes[at, at])
            if abs(curvature) < _FLAT:
                rows.append(slide)
                columns.append(lin.load_slopes[:, at])
            else:
                hessian += np.outer(lin.load_slopes[:, at], slide) / curvature
                turned = 1 / curvature
        if site.unknowns > site.unknown_places:
            rolled = turned * lin.residual_slopes[stuck, at] * lin.residual_gradients[at] if turned else 0.0
            rows.append(lin.residual_gradients[stuck] - rolled)
            columns.append(lin.load_slopes[:, stuck])
        at += site.unknowns
    free = np.linalg.qr(np.array(rows).T, mode="complete")[0][:, len(rows) :]
    left = np.linalg.qr(np.array(columns).T, mode="complete")[0][:, len(rows) :]
    stiffness = left.T @ hessian @ free
    sign = np.linalg.slogdet(stiffness)[0] * np.linalg.slogdet(left.T @ free)[0]
    return float(sign * np.min(np.linalg.svd(stiffness, compute_uv=False), initial=1.0))


def held(setting: Setting, obstacle: Obstacle, start: State, guess: State) -> State:
    """A guess whose contacts hold as those of the start that they continue; they stick from where that had them."""
    if setting.friction is None or not guess.sites:
        return guess
    sites = dressed(setting.friction, start.sites, guess.sites)
    before = replace(start, sites=sites, multipliers=guess.multipliers)
    lin = linearise(start.beam, start.z, setting.outline, obstacle, sites, guess.multipliers)
    return replace(guess, sites=anchored(before, lin).sites)


def find(setting: Setting, obstacle: Obstacle, start: State, order: int, known: Survey | None = None) -> Verified:
    """Equilibrium from a start whose contacts are not known: SLSQP for the active set, Newton to round-off.

    Raises
    ------
    NoEquilibriumError
        Where none is found that verifies.
    """
    state = State(start.beam, start.z)
    found = known or survey(setting, obstacle, state, brief=True)
    candidates = near(setting, obstacle, state, found, REACH)
    reason, iterations = "no candidate for a contact", 0
    for _ in range(_ROUNDS):
        problem = Problem(setting, obstacle, state, candidates)
        answer = minimize(**problem.scipy(_COARSE, _PATIENCE))
        iterations += int(answer.nit)
        relaxed = problem.state(answer.x)
        for sites, multipliers in _active_sets(setting, problem, answer.x, np.atleast_1d(answer.multipliers)):
            try:
                guess = held(setting, obstacle, start, State(relaxed.beam, relaxed.z, sites, multipliers))
                settled = _loaded(setting, settle_contacts(setting, obstacle, guess, order), order)
                verified = verify(setting, settled)
            except NoEquilibriumError as error:
                reason = str(error)
                continue
            total = replace(verified.equilibrium, iterations=iterations + settled.iterations)
            return replace(verified, equilibrium=total)
        more = _violated(setting, obstacle, relaxed, candidates)
        if not more:
            raise NoEquilibriumError(reason)
        candidates += more
    raise NoEquilibriumError(reason)


def _loaded(setting: Setting, settled: Equilibrium, order: int) -> Equilibrium:
    """The equilibrium without the contacts that turn out to carry nothing."""
    state, first, kept = settled.state, 0, []
    largest = float(np.max(np.abs(state.multipliers), initial=0.0))
    keep = np.ones(len(state.multipliers), dtype=bool)
    for site in state.sites:
        load = slice(first, first + site.multipliers)
        first += site.multipliers
        if np.max(np.abs(state.multipliers[load])) < _PULL * largest:
            keep[load] = False
        else:
            kept.append(site)
    if len(kept) == len(state.sites):
        return settled
    sites = grouped(setting.outline, tuple(kept))  # one that others followed may be gone
    return settle(setting, settled.obstacle, State(state.beam, state.z, sites, state.multipliers[keep]), order)


def _violated(
    setting: Setting, obstacle: Obstacle, state: State, known: tuple[Candidate, ...]
) -> tuple[Candidate, ...]:
    """Candidates for the deepest penetrations: the object's corner that has sunk deepest there, or a short stretch."""
    found = survey(setting, obstacle, state)
    corners = _sunken(setting, obstacle, state, found, known)
    out: list[Candidate] = []
    for piece, u in (*found.deepest, *found.sunken):
        if piece in corners:
            out.append(corners.pop(piece))
            continue
        length = setting.outline.pieces[piece].length
        start, stop = max(u - _STRETCH, 0.0), min(u + _STRETCH, length)
        mine = [c for c in (*known, *out) if c.kind == "stretch" and c.piece == piece]
        if any(c.start <= u <= c.stop and c.stop - c.start < 2.5 * _STRETCH for c in mine):
            start = stop = u  # a second penetration beside a stretch's least gap: they conform
        out.append(Candidate("node" if start == stop else "stretch", piece, start, stop))
    return tuple(out)


def _sunken(
    setting: Setting, obstacle: Obstacle, state: State, found: Survey, known: tuple[Candidate, ...]
) -> dict[int, Candidate]:
    """For each piece the object's corner that has sunk deepest through it and is no candidate yet."""
    if not len(obstacle.corners) or not (found.deepest or found.sunken):
        return {}
    out = {}
    for piece, heights in vertex_heights(setting, obstacle, state.axis, found).items():
        for number in [c.vertex for c in known if c.kind == "vertex" and c.piece == piece]:
            heights[number] = np.inf
        number = int(np.argmin(heights))
        if heights[number] < -DEPTH / 2:
            out[piece] = Candidate("vertex", piece, 0.0, setting.outline.pieces[piece].length, number)
    return out


def _active_sets(
    setting: Setting, problem: Problem, x: Array, multipliers: Array
) -> list[tuple[tuple[Site, ...], Array]]:
    """The sets of contacts that SLSQP's answer may mean, the likeliest first."""
    gaps = problem.gaps(x) / setting.sections.length
    load = multipliers * problem.scale**2 / problem.gap_scale
    strong = load > max(_ACTIVE * float(np.max(load, initial=0.0)), _NOTHING)
    chosen: list[tuple[Site, float]] = []
    for site, candidate, force, gap, active in zip(
        problem.sites(x), problem.candidates, load, gaps, strong, strict=True
    ):
        if active and gap < 1e-3:
            chosen.append((_resolved(setting, site, candidate), float(force)))
    if not chosen:
        return [((), np.empty(0))] if np.all(gaps > -DEPTH) else []
    merged = _merged(chosen)
    return _alternatives(setting, merged) + _flush(setting, problem, x, merged)


def _resolved(setting: Setting, site: Site, candidate: Candidate) -> Site:
    """A stretch whose least gap is at the end of its piece is the corner there."""
    if site.kind != "tangent":
        return site
    corner = setting.outline.corner_at(site.piece, site.place[0])
    return site if corner is None else Site("corner", corner, ())


def _merged(chosen: list[tuple[Site, float]]) -> list[tuple[Site, float]]:
    """One contact for neighbours: both sides of a kink, or a corner found twice."""
    out: list[tuple[Site, float]] = []
    for site, force in sorted(chosen, key=lambda item: (item[0].kind, item[0].piece, item[0].vertex, item[0].place)):
        last = out[-1][0] if out else None
        same = last is not None and (last.kind, last.piece, last.vertex) == (site.kind, site.piece, site.vertex)
        same = same and site.kind != "node"
        if same and last is not None and (not site.place or site.place[0] - last.place[0] < _TOGETHER):
            total = out[-1][1] + force
            if site.place:
                middle = (last.place[0] * out[-1][1] + site.place[0] * force) / total
                last = replace(last, place=(middle,))
            out[-1] = (last, total)
        else:
            out.append((site, force))
    return out


def _alternatives(setting: Setting, contacts: list[tuple[Site, float]]) -> list[tuple[tuple[Site, ...], Array]]:
    """The set as found; near the tip also the corner alone, and a patch that ends in the corner."""
    sets = [contacts]
    for face in (LOWER, UPPER):
        number = setting.outline.tip_corner(face)
        at_tip = [c for c in contacts if _near_tip(c[0], face) or c[0].piece == number]
        if number is None or not at_tip:
            continue
        rest = [c for c in contacts if c not in at_tip]
        force = sum(f for _, f in at_tip)
        corner = Site("corner", number, ())
        sets.append([*rest, (corner, force)])
        if setting.theory != "bending":
            start = min([c[0].place[0] for c in at_tip if c[0].place] + [1 - 10 * _PATCH])
            tail = Site("tail", face, (start, 1.0), modes=NARROW)
            sets.append([*rest, (tail, force / 2), (corner, force / 2)])
            last = max([c[0].place[0] for c in at_tip if c[0].place] + [start])
            patch = Site("patch", face, (2 * last - _END, _END), modes=NARROW)  # the corner lets go
            sets.append([*rest, (patch, force)])
    if any(site.kind == "tangent" for site, _ in contacts):
        held = [(replace(s, kind="node") if s.kind == "tangent" else s, force) for s, force in contacts]
        sets.append(held)  # where finger and object conform, a tangent's place is not determined
    return [_as_set(chosen) for chosen in sets]


def _flush(
    setting: Setting, problem: Problem, x: Array, contacts: list[tuple[Site, float]]
) -> list[tuple[tuple[Site, ...], Array]]:
    """Where a face lies on a flat, shear spreads its force from the first touch on, as far as the tip's corner."""
    out = []
    faces = [c for c in contacts if c[0].kind == "tangent" and c[0].on_face]
    if setting.theory == "bending" or not faces:
        return []
    for chosen in faces:
        site, force = chosen
        decay = _decay(setting, site.place[0])
        stop = _flat_until(setting, problem.obstacle, problem.state(x), site, _DECAYED * decay)
        if stop - site.place[0] < _FLUSH * decay and stop < 1:
            continue
        rest = [c for c in contacts if c is not chosen]
        tail = replace(site, kind="tail", place=(site.place[0] - decay / 2, stop))
        tail = replace(tail, modes=_modes(setting, tail))
        out.append(_as_set([*rest, (tail, force)]))
        corner = setting.outline.tip_corner(site.piece)
        if stop == 1 and corner is not None and all(c[0].piece != corner for c in rest):
            out.append(_as_set([*rest, (tail, force / 2), (Site("corner", corner, ()), force / 2)]))
    return out


def _near_tip(site: Site, face: int) -> bool:
    return site.kind == "tangent" and site.piece == face and site.place[0] > 1 - _TIP


def _as_set(chosen: list[tuple[Site, float]]) -> tuple[tuple[Site, ...], Array]:
    load = [_spread(force, site) for site, force in chosen]
    return tuple(site for site, _ in chosen), np.array([value for values in load for value in values])
