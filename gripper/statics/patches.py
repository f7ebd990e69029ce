"""With shear a force spreads: points of contact become patches, patches points, and the pressure gets its modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.beam.legendre import legendre
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER
from gripper.contact.site import NARROW, WIDE, Site
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State

PATCH = 2e-5  # of L: narrower patches are points (the mean tangent's error falls with the square of the width)
FLUSH = 2.0  # of sqrt(EI / GA): where a patch would be wider, the finger lies flush on a flat
_WIDTHS = (
    (0.3, NARROW),
    (0.8, 3),
    (2.2, 4),
    (5.0, 6),
    (np.inf, WIDE),
)  # modes of a patch by its width over sqrt(EI / GA)
_FLAT_WIDTHS = ((0.3, NARROW + 1), (7.0, WIDE), (np.inf, 12))
# the same on a flat, where it falls to nothing at the far end
_STRAIGHT = 1e-9  # curvature times L
DECAYED = 10.5  # of sqrt(EI / GA): as far as a pressure that decays is followed (what is left bends the rest by 1e-7)
_LOOSE = 1.4  # by as much more or less a tail may reach before it is cut anew
_LOOKS = 3  # each 32 times as close
_AT_BREAK = 1e-6  # of L: a point this near to the end of a segment is there
_TURNED = 1e-3  # rad: a flat that turns by more has ended


def fit_patches(setting: Setting, equilibrium: Equilibrium) -> tuple[Site, ...]:
    """The contacts with patches where shear makes them wide enough, points where it does not.

    A point force N leaves gamma with a jump N / GA, over which the object's outline bends the finger's: it touches
    over about N / (GA g''), g'' being the curvature of the gap. On a flat the finger lies flush beyond the point, and
    the pressure decays over sqrt(EI / GA).
    """
    if setting.theory == "bending":
        return equilibrium.state.sites
    sites, column, after, row, below = [], 0, 0, 0, 0
    for site in equilibrium.state.sites:
        column, after, row, below = after, after + site.unknowns, below, below + site.multipliers
        if site.kind == "tangent" and site.on_face:
            steepness = abs(complex(equilibrium.linear.force_multipliers[row]))  # g need not be a distance
            force = steepness * abs(float(equilibrium.state.multipliers[row]))
            curvature = float(equilibrium.linear.residual_slopes[column, column]) / steepness
            site = _patch(setting, equilibrium, site, force, curvature)
        elif site.kind == "patch" and site.place[1] - site.place[0] < PATCH / 2:
            site = replace(site, kind="tangent", place=(site.middle,), modes=1)
        elif site.spreads:
            flat = site.kind != "patch" and lies_flat(setting, equilibrium.obstacle, equilibrium.state, site)
            site = _reaching(setting, equilibrium, site) if flat and site.vertex < 0 else site
            modes, fewer = pressure_modes(setting, site, flat=flat)
            if modes > site.modes or fewer < site.modes:  # down later than up
                site = replace(site, modes=modes)
        sites.append(site)
    return tuple(sites)


def _reaching(setting: Setting, equilibrium: Equilibrium, site: Site) -> Site:
    """A tail whose far end is where its pressure has decayed, or where its flat ends."""
    reach = DECAYED * decay_length(setting, site.place[0])
    width = site.place[1] - site.place[0]
    if reach / _LOOSE <= width <= reach * _LOOSE:
        return site
    stop = flat_until(setting, equilibrium.obstacle, equilibrium.state, site, reach)
    longer = stop - site.place[0] > width * _LOOSE
    return replace(site, place=(site.place[0], stop)) if longer or width > reach else site


def pressure_modes(setting: Setting, site: Site, *, flat: bool = False) -> tuple[int, int]:
    """How many pressure modes a patch needs, and how many it may keep: the pressure varies over sqrt(EI / GA)."""
    width = (site.place[1] - site.place[0]) / decay_length(setting, site.middle)
    widths = _FLAT_WIDTHS if flat else _WIDTHS
    return _modes(widths, width), _modes(widths, width * _LOOSE)


def _modes(widths: tuple[tuple[float, int], ...], width: float) -> int:
    """The modes of the first limit that a width stays below: the last one is infinite."""
    for limit, modes in widths:
        if width < limit:
            return modes
    raise NoEquilibriumError("a patch has no width")


def lies_flat(setting: Setting, obstacle: Obstacle, state: State, site: Site) -> bool:
    """Whether the object has no curvature where a contact begins."""
    place, piece = np.array(site.place[:1]), np.array([site.piece])
    points, *_ = setting.outline.trace(state.axis, piece, place, state.beam.segment_of(place))
    return float(np.abs(obstacle.curvature(points)[2]).max()) < _STRAIGHT


def flushed(setting: Setting, obstacle: Obstacle, state: State) -> State:
    """The state with its last contact told whether the face lies on a flat from there on, in bending with friction.

    With shear a pressure of its own tells (a tail); other contacts, or loads, beyond it bend the face there.
    """
    sites = state.sites
    if setting.theory != "bending" or setting.loads is not None or sites[0].grip is None:
        return state
    last = max(range(len(sites)), key=lambda i: (sites[i].piece > UPPER, sites[i].middle))
    site = sites[last]
    lies = site.kind in ("tangent", "node") and site.on_face and setting.sections.rest is None
    lies = lies and 0 < site.middle < 1 and lies_flat(setting, obstacle, state, site)
    new = [
        replace(s, grip=replace(s.grip, flush=lies and i == last))
        if s.grip is not None and s.grip.flush != (lies and i == last)
        else s
        for i, s in enumerate(sites)
    ]
    return replace(state, sites=tuple(new))


def decay_length(setting: Setting, s: float) -> float:
    """sqrt(EI / GA) at a section, by L."""
    at = np.array([min(s, 1.0)])
    bending, shear, _ = setting.sections.stiffness(at)
    return float(np.sqrt(bending / shear)[0])


def _patch(setting: Setting, equilibrium: Equilibrium, site: Site, force: float, curvature: float) -> Site:
    """The patch that a point force on a face spreads to, or the point itself."""
    place = np.array(site.place)
    rigidity = float(setting.sections.GA(place)[0])
    decay = decay_length(setting, site.place[0])
    if force > rigidity * max(curvature, 0.0) * FLUSH * decay:
        stop = flat_until(setting, equilibrium.obstacle, equilibrium.state, site, DECAYED * decay)
        if stop - site.place[0] > FLUSH * decay:
            tail = replace(site, kind="tail", place=(site.place[0] - decay / 2, stop))
            return replace(tail, modes=pressure_modes(setting, tail, flat=True)[0])
        return site
    width = force / (rigidity * curvature)
    if width < PATCH:
        return site
    start, stop = site.place[0] - width / 2, site.place[0] + width / 2
    return replace(site, kind="patch", place=(max(start, 1e-6), stop), modes=NARROW)


def flat_until(setting: Setting, obstacle: Obstacle, state: State, site: Site, reach: float) -> float:
    """How far along its face a contact's flat goes on, within reach."""
    start, stop = site.place[0], min(site.place[0] + reach, 1.0)
    for _ in range(_LOOKS):
        u = np.linspace(start, stop, 33)
        points, *_ = setting.outline.trace(state.axis, np.full(u.size, site.piece), u, state.beam.segment_of(u))
        _, normal = obstacle.slope(points)
        turned = np.abs(normal / np.abs(normal) - normal[0] / abs(normal[0])) > _TURNED
        if not turned.any():
            return stop
        start, stop = float(u[np.argmax(turned) - 1]), float(u[np.argmax(turned)])
    return start


def spread_out(setting: Setting, state: State, sites: tuple[Site, ...]) -> State:
    """The state with points spread to patches, over which strains go from those before the point to those behind it."""
    old, found = state.beam, with_sites(state, sites)
    beam = setting.beam(sites, old.order)
    s, segment = beam.gauss, old.segment_of(beam.gauss)
    strains = old.strains(state.z, s, segment)
    for point, patch in zip(state.sites, sites, strict=True):
        if point.kind != "tangent" or patch.kind != "patch":
            continue
        behind = min(range(1, old.segments), key=lambda i: abs(old.breaks[i] - point.place[0]), default=0)
        within = (s > patch.place[0]) & (s < patch.place[1])
        if not behind or abs(old.breaks[behind] - point.place[0]) > _AT_BREAK:
            continue
        along = (s[within] - patch.place[0]) / (patch.place[1] - patch.place[0])
        before, after = (old.strains(state.z, s[within], np.full(along.size, i)) for i in (behind - 1, behind))
        strains[:, within] = (1 - along) * before + along * after
    return replace(found, beam=beam, z=beam.fit(strains, old.base_turn(state.z)))


def with_sites(state: State, sites: tuple[Site, ...]) -> State:
    """The state with contacts of other kinds at the same places: multipliers carried over."""
    multipliers: list[float] = []
    first = 0
    for old, new in zip(state.sites, sites, strict=True):
        mine = state.multipliers[first : first + old.multipliers]
        first += old.multipliers
        kept = mine.tolist()[: new.multipliers] + [0.0] * (new.multipliers - old.multipliers)
        multipliers += kept if (new.kind, new.place) == (old.kind, old.place) else spread(float(mine[0]), new)
    return replace(state, sites=sites, multipliers=np.array(multipliers))


def spread(force: float, site: Site) -> list[float]:
    """First multipliers of a contact that carries a force: even over a short patch, decaying over a wide one."""
    if site.modes <= 4:
        return [force] + [0.0] * (site.modes - 1)
    x, weights = np.polynomial.legendre.leggauss(24)
    decaying = np.exp(-DECAYED * (x + 1) / 2)
    modes = (2 * np.arange(site.modes) + 1) * (legendre(x, site.modes).T @ (weights * decaying))
    return [float(value) for value in force * modes / modes[0]]
