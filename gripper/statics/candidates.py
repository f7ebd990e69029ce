"""Which contacts the answer of SLSQP may mean, and where it has to look next."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER
from gripper.contact.site import NARROW, Site
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Setting, State
from gripper.statics.nearby import vertex_heights
from gripper.statics.patches import DECAYED, FLUSH, PATCH, decay_length, flat_until, lies_flat, pressure_modes, spread
from gripper.statics.problem import Candidate, Problem
from gripper.statics.sampling import DEPTH
from gripper.statics.verified import NOTHING

_STRETCH = 0.05  # of L: half of a stretch about a penetration
_ACTIVE = 1e-6  # of the largest multiplier
_TOGETHER = 0.02  # of L: tangents nearer than this are one contact
_END = 1 - 1e-7  # of L: just before the tip
_TIP = 0.1  # of L: a contact this near to the tip may be the corner's


def active_sets(
    setting: Setting, problem: Problem, x: Array, multipliers: Array
) -> Iterator[tuple[tuple[Site, ...], Array]]:
    """The sets of contacts that SLSQP's answer may mean, the likeliest first."""
    gaps = problem.gaps(x) / setting.sections.length
    load = multipliers * problem.scale**2 / problem.gap_scale
    strong = load > max(_ACTIVE * float(np.max(load, initial=0.0)), NOTHING)
    chosen: list[tuple[Site, float]] = []
    for site, force, gap, active in zip(problem.sites(x), load, gaps, strong, strict=True):
        if active and gap < 1e-3:
            chosen.append((resolved(setting, site), float(force)))
    if not chosen:
        if np.all(gaps > -DEPTH):
            yield (), np.empty(0)
        return
    merged = _merged(chosen)
    yield _as_set(merged)
    yield from _alternatives(setting, merged)
    yield from _flush(setting, problem, x, merged)


def resolved(setting: Setting, site: Site) -> Site:
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


def _alternatives(setting: Setting, contacts: list[tuple[Site, float]]) -> Iterator[tuple[tuple[Site, ...], Array]]:
    """Near the tip also the corner alone, and a patch that ends in the corner."""
    for face in (LOWER, UPPER):
        number = setting.outline.tip_corner(face)
        at_tip = [c for c in contacts if _near_tip(c[0], face) or c[0].piece == number]
        if number is None or not at_tip:
            continue
        rest = [c for c in contacts if c not in at_tip]
        force = sum(f for _, f in at_tip)
        corner = Site("corner", number, ())
        yield _as_set([*rest, (corner, force)])
        if setting.theory != "bending":
            start = min([c[0].place[0] for c in at_tip if c[0].place] + [1 - 10 * PATCH])
            tail = Site("tail", face, (start, 1.0), modes=NARROW)
            yield _as_set([*rest, (tail, force / 2), (corner, force / 2)])
            last = max([c[0].place[0] for c in at_tip if c[0].place] + [start])
            patch = Site("patch", face, (2 * last - _END, _END), modes=NARROW)  # the corner lets go
            yield _as_set([*rest, (patch, force)])
    if any(site.kind == "tangent" for site, _ in contacts):
        held = [(replace(s, kind="node") if s.kind == "tangent" else s, force) for s, force in contacts]
        yield _as_set(held)  # where finger and object conform, a tangent's place is not determined


def _flush(
    setting: Setting, problem: Problem, x: Array, contacts: list[tuple[Site, float]]
) -> Iterator[tuple[tuple[Site, ...], Array]]:
    """Where a face lies on a flat, shear spreads its force from the first touch on, as far as the tip's corner."""
    faces = [c for c in contacts if c[0].kind == "tangent" and c[0].on_face]
    if setting.theory == "bending" or not faces:
        return
    for chosen in faces:
        site, force = chosen
        decay = decay_length(setting, site.place[0])
        stop = flat_until(setting, problem.obstacle, problem.state(x), site, DECAYED * decay)
        if stop - site.place[0] < FLUSH * decay and stop < 1:
            continue
        rest = [c for c in contacts if c is not chosen]
        tail = replace(site, kind="tail", place=(site.place[0] - decay / 2, stop))
        flat = lies_flat(setting, problem.obstacle, problem.state(x), tail)
        tail = replace(tail, modes=pressure_modes(setting, tail, flat=flat)[0])
        corner = setting.outline.tip_corner(site.piece)
        to_tip = flat_until(setting, problem.obstacle, problem.state(x), site, 1.0) == 1
        if to_tip and corner is not None and all(c[0].piece != corner for c in rest):
            share = force * float(np.exp(-(1 - tail.place[0]) / decay))
            yield _as_set([*rest, (tail, force - share), (Site("corner", corner, ()), share)])
        yield _as_set([*rest, (tail, force)])


def _near_tip(site: Site, face: int) -> bool:
    return site.kind == "tangent" and site.piece == face and site.place[0] > 1 - _TIP


def _as_set(chosen: list[tuple[Site, float]]) -> tuple[tuple[Site, ...], Array]:
    load = [spread(force, site) for site, force in chosen]
    return tuple(site for site, _ in chosen), np.array([value for values in load for value in values])


def violated(setting: Setting, obstacle: Obstacle, state: State, known: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
    """Candidates for the deepest penetrations: the object's corner that has sunk deepest there, or short stretches.

    Once that corner is out, the rest of its piece may be clear.
    """
    found = survey(setting, obstacle, state)
    corners = _sunken(setting, obstacle, state, found, known)
    penetrated = dict.fromkeys(piece for piece, _ in (*found.deepest, *found.sunken))
    out = [corners[piece] for piece in penetrated if piece in corners]
    for piece, u in (*found.deepest, *found.sunken):
        if piece in corners:
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
