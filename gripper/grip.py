"""How a contact holds: the coefficient of friction, and whether the contact slips, and which way, or sticks.

The normal force on the finger at a contact is N n, n pointing out of the object; with t = -i n (n turned clockwise)
the friction force on the finger is rho N t. The ratio rho of both is -mu where the finger slips along t, mu where it
slips against t; a contact that sticks has the ratio that lets it not slip.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.features import conform
from gripper.fingers import S

if TYPE_CHECKING:
    from gripper.outline import Outline
    from gripper.site import Site

Hold = Literal["open", "slip", "stick"]


class Law:
    """Coulomb's law on one finger: mu along its faces and on its jaw.

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


@dataclass(frozen=True, eq=False)
class Anchor:
    """Where a contact was when it began to stick: one point, or those of its patch.

    Parameters
    ----------
    points, tangents
        The contact (q,) and the unit vectors t there, in the object's own axes, lengths by L.
    u
        The places along the finger's piece, (q,).
    stretches
        c' along t there: length of the outline per unit of u, (q,).
    weights
        Parts of the normal force, (q,): friction of one ratio does no work where the slip is 0 in their mean.
    origin
        The equilibrium in which it began to stick, and the contact's number there; None where that is not known.
    """

    points: Complex
    tangents: Complex
    u: Array
    stretches: Array
    weights: Array
    origin: tuple[Any, int] | None = None

    def over(self, weights: Array) -> tuple[Anchor, Array]:
        """The anchor of a contact with so many points (q,), and their parts of the force.

        Its own, as long as it is the same patch; one whose pressure is resolved otherwise by now is held in its middle,
        its parts being the given weights.
        """
        return (self, self.weights) if self.u.size == weights.size else (self._gathered(), weights)

    def _gathered(self) -> Anchor:
        turn = complex(self.weights @ self.tangents)
        means = (self.weights @ values for values in (self.u, self.stretches))
        u, stretches = (np.array([mean]) for mean in means)
        points = np.array([self.weights @ self.points])
        return Anchor(points, np.array([turn / abs(turn)]), u, stretches, np.ones(1))


@dataclass(frozen=True)
class Grip:
    """The hold of one contact.

    Parameters
    ----------
    law
        Gives mu.
    hold
        "slip", "stick", or "open": not yet decided, without friction.
    sense
        1 when the finger slips along t, -1 when against it.
    ratio
        rho of a contact that sticks.
    anchor
        Where a contact that sticks began to; None: where it is now.
    follows
        Whether it shares the ratio of a neighbour that it conforms with.
    """

    law: Law
    hold: Hold = "open"
    sense: int = 0
    ratio: float = 0.0
    anchor: Anchor | None = None
    follows: bool = False

    @property
    def unknown(self) -> bool:
        """Whether the ratio is an unknown of the equilibrium."""
        return self.hold == "stick" and not self.follows

    def ratios(self, piece: int, u: float) -> tuple[float, float]:
        """Rho at a place and its slope along the piece."""
        if self.hold != "slip":
            return self.ratio, 0.0
        mu, slope = self.law.at(piece, u)
        return -self.sense * mu, -self.sense * slope

    def slipping(self, sense: int) -> Grip:
        """The same contact in slip."""
        return replace(self, hold="slip", sense=sense, ratio=0.0, anchor=None)

    def sticking(self, ratio: float, anchor: Anchor | None) -> Grip:
        """The same contact in stick."""
        return replace(self, hold="stick", sense=0, ratio=ratio, anchor=anchor)


def tipward(site: Site, outline: Outline) -> int:
    """1 where t points to the finger's tip (seen from the contact's section), -1 where to its base."""
    if site.piece <= 1:
        return 1 if site.piece == 0 else -1
    pieces = outline.pieces
    if site.piece < len(pieces):
        return 1 if pieces[site.piece].direction.real > -1e-9 else -1
    return 1 if outline.corners[site.piece - len(pieces)].point.imag <= 0 else -1


def dressed(law: Law | None, old: tuple[Site, ...], new: tuple[Site, ...]) -> tuple[Site, ...]:
    """New contacts with the holds of the old ones that they continue; open where they continue none."""
    if law is None:
        return new
    left = list(old)
    out = []
    for site in new:
        before = _continued(site, left, law.outline)
        if before is not None:
            left.remove(before)
        out.append(replace(site, grip=_taken_over(site, before, law)))
    return grouped(law.outline, tuple(out))


def _taken_over(site: Site, before: Site | None, law: Law) -> Grip:
    if law.tipward:
        return Grip(law).slipping(law.tipward * tipward(site, law.outline))
    if before is None or before.grip is None:
        return Grip(law)
    same = (before.piece, before.vertex) == (site.piece, site.vertex)  # an anchor is the matter's, not the patch's
    ratio = before.grip.ratios(before.piece, before.middle)[0]
    return before.grip if same else replace(before.grip, anchor=None, ratio=ratio, follows=False)


def _continued(site: Site, old: list[Site], outline: Outline) -> Site | None:
    """The old contact that a new one continues: the same, or a neighbour along the outline."""
    same = [s for s in old if (s.piece, s.vertex) == (site.piece, site.vertex)]
    if same:
        return min(same, key=lambda s: abs(s.middle - site.middle))
    near = [s for s in old if _adjoin(s, site, outline)]
    return near[0] if near else None


def _adjoin(one: Site, other: Site, outline: Outline) -> bool:
    """Whether two contacts lie on pieces or corners that meet, or touch the same corner of the object."""
    if one.vertex == other.vertex >= 0:
        return True
    return bool(ends(one.piece, outline) & ends(other.piece, outline))


def ends(piece: int, outline: Outline) -> set[tuple[float, float]]:
    """Ends of a piece in the end section's frame, rounded; a corner's is itself (the clamp's end has none)."""
    pieces = outline.pieces
    if piece >= len(pieces):
        points = [outline.corners[piece - len(pieces)].point]
    elif piece <= 1:
        points = [complex(outline.offsets(np.array([piece]), np.ones(1))[1][0])]
    else:
        start = pieces[piece].start
        points = [start, start + pieces[piece].length * pieces[piece].direction]
    return {(round(p.real, 9), round(p.imag, 9)) for p in points}


def grouped(outline: Outline, sites: tuple[Site, ...]) -> tuple[Site, ...]:
    """Contacts that conform share one hold: that of the first; a patch that ends in the tip's corner the corner's."""
    if any(site.grip is None for site in sites):
        return sites
    firsts = [_first(outline, sites, i) for i in range(len(sites))]
    grips = [site.grip for site in sites if site.grip is not None]
    for i, first in enumerate(firsts):
        if first != i and grips[first].hold == "open":
            grips[first] = replace(grips[i], anchor=None)
    out = []
    for i, (site, first) in enumerate(zip(sites, firsts, strict=True)):
        same = grips[i].hold == grips[first].hold
        lead = grips[first]
        anchor = grips[i].anchor if same else None
        grip = grips[i] if first == i else replace(lead, anchor=anchor)
        out.append(replace(site, grip=replace(grip, follows=first != i)))
    return tuple(out)


def _first(outline: Outline, sites: tuple[Site, ...], i: int) -> int:
    """The number of the contact whose hold a contact shares, by where they lie: itself where it is alone."""
    site = sites[i]
    if site.kind == "tail":
        corner = outline.tip_corner(site.piece)
        return next((j for j, other in enumerate(sites) if other.piece == corner), i)
    for j, other in enumerate(sites[:i]):
        if other.piece == site.piece and (site.piece > 1 or conform(other, site)):
            return _first(outline, sites, j)
    return i


def leader(outline: Outline, sites: tuple[Site, ...], i: int) -> int:
    """The number of the contact whose ratio a contact has: once they share a hold, also while they move apart."""
    site = sites[i]
    if site.grip is None or not site.grip.follows:
        return i
    piece = outline.tip_corner(site.piece) if site.kind == "tail" else site.piece
    hosts = [j for j, other in enumerate(sites) if other.piece == piece and other.grip and not other.grip.follows]
    return min(hosts, key=lambda j: abs(sites[j].middle - site.middle), default=i)
