"""Coulomb's law on one finger: mu along its outline, and which contacts share one hold.

Contacts that conform, those on one rigid edge, and a patch with the tip's corner in which it ends hold together: rigid
sticking would leave each one's part of the friction undetermined. So do all that stick to what is rigid, the jaw and
the end section: where one sticks there no other can slip, and of all parts that they may have equal ratios stay within
mu the longest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import sympy

from gripper.contact.features import conform
from gripper.contact.grip import Grip
from gripper.contact.outline import UPPER, Outline
from gripper.contact.site import Site
from gripper.fingers import S
from gripper.friction import Friction

_SENSES = {"tipward": 1, "baseward": -1, None: 0}

Sites = tuple[Site, ...]


class Law:
    """Coulomb's law on one finger.

    Parameters
    ----------
    finger
        mu on the finger, a number or an expression in s (m).
    jaw
        mu on the jaw.
    outline
        The finger's.
    length
        L, in m.
    tipward
        The way that every contact slips, where it is given: 1 when friction on the object points to the finger's tip,
        -1 to its base; 0 when the motion decides.
    """

    def __init__(self, finger: float | sympy.Expr, jaw: float, outline: Outline, length: float, tipward: int) -> None:
        self.jaw, self.outline, self.tipward = jaw, outline, tipward
        expression = sympy.sympify(finger)
        self._varies = bool(expression.free_symbols)
        self._constant = 0.0 if self._varies else float(expression)
        if self._varies:
            along = expression.subs({symbol: S * length for symbol in expression.free_symbols})
            self._function: Callable[[float], list[float]] = sympy.lambdify([S], [along, sympy.diff(along, S)], "math")

    @classmethod
    def of(cls, friction: Friction, outline: Outline, length: float) -> Law:
        """The law that a scene gives, on a finger of this outline and length (m)."""
        return cls(friction.finger, friction.on_jaw(length), outline, length, _SENSES[friction.sense])

    def at(self, piece: int, u: float) -> tuple[float, float]:
        """Mu at a place of the outline and its slope along the piece."""
        pieces = self.outline.pieces
        on = pieces[piece].on if piece < len(pieces) else self.outline.corners[piece - len(pieces)].on
        if on == "jaw":
            return self.jaw, 0.0
        if not self._varies:
            return self._constant, 0.0
        mu, slope = self._function(min(max(u, 0.0), 1.0) if on in ("lower", "upper") else 1.0)
        return float(mu), float(slope) if on in ("lower", "upper") else 0.0

    def side(self, site: Site) -> int:
        """1 where t points to the finger's tip (seen from the contact's section), -1 where to its base."""
        if site.piece <= 1:
            return 1 if site.piece == 0 else -1
        pieces = self.outline.pieces
        if site.piece < len(pieces):
            return 1 if pieces[site.piece].direction.real > -1e-9 else -1
        return 1 if self.outline.corners[site.piece - len(pieces)].point.imag <= 0 else -1

    # which contacts hold as one

    def dressed(self, old: Sites, new: Sites) -> Sites:
        """New contacts with the holds of the old ones that they continue; open where they continue none."""
        before = self._continued(old, new)
        out = [replace(site, grip=self._taken_over(site, before.get(i))) for i, site in enumerate(new)]
        return self.grouped(tuple(out))

    def grouped(self, sites: Sites) -> Sites:
        """Contacts that conform share one hold: that of the first; a patch with the tip's corner that of the corner."""
        firsts = [self._first(sites, i) for i in range(len(sites))]
        grips = [site.grip or Grip(self) for site in sites]
        for i, first in enumerate(firsts):
            if first != i and grips[first].hold == "open":
                grips[first] = replace(grips[i], anchor=None)
        out = []
        for i, (site, first) in enumerate(zip(sites, firsts, strict=True)):
            same = grips[i].hold == grips[first].hold
            anchor = grips[i].anchor if same else None
            grip = grips[i] if first == i else replace(grips[first], anchor=anchor)
            out.append(replace(site, grip=replace(grip, follows=first != i)))
        return tuple(out)

    def leader(self, sites: Sites, i: int) -> int:
        """The number of the contact whose ratio a contact has: once they share a hold, also while they move apart."""
        site = sites[i]
        if site.grip is None or not site.grip.follows:
            return i
        piece = self.outline.tip_corner(site.piece) if site.kind == "tail" else site.piece
        leading = [j for j, other in enumerate(sites) if other.grip and not other.grip.follows]
        hosts = [j for j in leading if sites[j].piece == piece] or [j for j in leading if rigid(site, sites[j])]
        return min(hosts, key=lambda j: abs(sites[j].middle - site.middle), default=i)

    def shared(self, sites: Sites) -> Sites:
        """Contacts that follow another in stick take its ratio over."""
        out = list(sites)
        for i, site in enumerate(sites):
            if site.grip is not None and site.grip.follows and site.grip.hold == "stick":
                first = sites[self.leader(sites, i)].grip
                out[i] = replace(site, grip=replace(site.grip, ratio=first.ratio if first else 0.0))
        return tuple(out)

    def _taken_over(self, site: Site, before: Site | None) -> Grip:
        if self.tipward:
            return Grip(self).slipping(self.tipward * self.side(site))
        if before is None or before.grip is None:
            return Grip(self)
        same = _alike(before, site)  # an anchor is the matter's, not the patch's
        ratio = before.grip.ratios(before.piece, before.middle)[0]
        return before.grip if same else replace(before.grip, anchor=None, ratio=ratio, follows=False)

    def _continued(self, old: Sites, new: Sites) -> dict[int, Site]:
        """The old contacts that new ones continue: the same, the nearest first, or neighbours along the outline."""
        left, out = list(range(len(old))), {}
        pairs = [(i, j) for i, site in enumerate(new) for j, s in enumerate(old) if _alike(site, s)]
        for i, j in sorted(pairs, key=lambda pair: abs(new[pair[0]].middle - old[pair[1]].middle)):
            if i not in out and j in left:
                out[i] = old[j]
                left.remove(j)
        for i, site in enumerate(new):
            near = [j for j in left if old[j].vertex == site.vertex >= 0 or self.outline.meet(old[j].piece, site.piece)]
            if i not in out and near:
                out[i] = old[near[0]]
                left.remove(near[0])
        return out

    def _first(self, sites: Sites, i: int) -> int:
        """The number of the contact whose hold a contact shares, by where they lie: itself where it is alone."""
        site = sites[i]
        if site.kind == "tail":
            corner = self.outline.tip_corner(site.piece)
            return next((j for j, other in enumerate(sites) if other.piece == corner), i)
        for j, other in enumerate(sites[:i]):
            if (other.piece == site.piece and (site.piece > 1 or conform(other, site))) or rigid(other, site):
                return self._first(sites, j)
        return i


def rigid(one: Site, other: Site) -> bool:
    """Whether both stick to the same rigid part of the finger."""
    stuck = all(site.grip is not None and site.grip.hold == "stick" for site in (one, other))
    return stuck and min(one.piece, other.piece) > UPPER


def _alike(one: Site, other: Site) -> bool:
    """Whether both are on the same piece, or at the same corner of the object there."""
    return (one.piece, one.vertex) == (other.piece, other.vertex)
