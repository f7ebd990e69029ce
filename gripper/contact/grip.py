"""How a contact holds: whether it slips, and which way, or sticks, and where it began to.

The normal force on the finger at a contact is N n, n pointing out of the object; with t = -i n (n turned clockwise)
the friction force on the finger is rho N t. The ratio rho of both is -mu where the finger slips along t, mu where it
slips against t; a contact that sticks has the ratio that lets it not slip.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gripper.arrays import Array, Complex

if TYPE_CHECKING:
    from gripper.contact.law import Law

Hold = Literal["open", "slip", "stick"]


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
    flush
        Whether the face lies on a flat from here on. Friction that would bend it away from the flat before the
        contact cannot do so: the pressure spreads along the flat (in bending as exp(-s / h), h being the ratio times
        half the thickness) until normal force and friction have no moment about the axis at the contact.
    """

    law: Law
    hold: Hold = "open"
    sense: int = 0
    ratio: float = 0.0
    anchor: Anchor | None = None
    follows: bool = False
    flush: bool = False

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
