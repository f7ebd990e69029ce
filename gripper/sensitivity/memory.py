"""What contacts that stick remember, and how the numbers of a scene change it."""

from __future__ import annotations

import cmath
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.grip import Anchor
from gripper.contact.outline import dot
from gripper.sensitivity.flow import Change
from gripper.sensitivity.tangent import Rates
from gripper.sensitivity.touching import Span, Touching, UndifferentiatedError
from gripper.statics.equilibrium import Equilibrium

if TYPE_CHECKING:
    from gripper.sensitivity.seeds import FrameRates, Seeds

_TOUCHED = 1e-3  # of L: a contact that was decided within this of where it was met began there


class UnknownPastError(UndifferentiatedError):
    """What a contact remembers cannot be traced back to the scene's numbers; says why."""


@dataclass(frozen=True, eq=False)
class AnchorRates:
    """Rates of an anchor (:class:`gripper.contact.grip.Anchor`), by each number: (d, q)."""

    points: Complex
    tangents: Complex
    u: Array
    stretches: Array
    weights: Array


def anchor_rates(t: Touching, span: Span, found: Rates, frames: FrameRates) -> AnchorRates:
    """Rates of where a contact is, as an anchor."""
    at = span.queries
    frame, moved = t.obstacle.frame, found.flow
    back = cmath.exp(-1j * frame.angle)
    presses, leans = t.press[at], moved.presses[:, at]
    lengths = np.abs(presses)
    turning = (presses.conj() * leans).imag / lengths**2
    units = -1j * presses / lengths
    forces = t.weights[at] * lengths
    pressing = t.weights[at] * dot(presses, leans) / lengths
    if found.change.weights is not None:
        pressing += found.change.weights[:, at] * lengths
    parts = forces / forces.sum()
    angle = frames.angle[:, None]
    return AnchorRates(
        (moved.points[:, at] - frames.origin[:, None] - 1j * angle * (t.points[at] - frame.origin)) * back,
        1j * units * back * (turning - angle),
        found.change.queries[:, at],
        dot(1j * units * turning, t.tangents[at]) + dot(units, moved.tangents[:, at]),
        (pressing - parts * pressing.sum(axis=1, keepdims=True)) / forces.sum(),
    )


class Memory:
    """Where contacts began to stick, by the numbers of a scene."""

    def __init__(self, seeds: Seeds) -> None:
        self.seeds = seeds

    def change(self, t: Touching, change: Change, frames: FrameRates) -> None:
        """Contacts that stick remember where they began to, which the numbers change too."""
        turn = np.exp(1j * t.obstacle.frame.angle)
        for span in t.spans:
            if not span.sticks:
                continue
            stick, moved, at = t.stick(span), self.anchors(t, span), span.queries
            angle = 1j * frames.angle[:, None]
            tangents = stick.tangents * angle + turn * moved.tangents
            starts = angle * stick.anchor.points * turn + turn * moved.points + frames.origin[:, None]
            away = t.points[at] - stick.starts
            stretches = (moved.stretches + dot(tangents, t.tangents[at])) / 2
            slips = dot(tangents, away) - dot(starts, stick.tangents) + moved.u * stick.stretches
            slips -= stick.ways * stretches
            slip = dot(stick.tangents, away) - stick.ways * stick.stretches
            change.slips[:, span.ratio] = slips @ stick.weights + moved.weights @ slip

    def anchors(self, t: Touching, span: Span) -> AnchorRates:
        """Rates of where a contact began to stick.

        Raises
        ------
        UnknownPastError
            Where the equilibrium in which it began to is not known, or follows a snap.
        """
        grip = span.site.grip
        known = grip.anchor if grip else None
        if known is None or known.origin is None:
            raise UnknownPastError("a contact sticks across a change of face, edge or corner")
        equilibrium, number = known.origin
        moved = self._moved(equilibrium, number)
        size = span.queries.stop - span.queries.start
        return moved if known.u.size == size else _gathered(known, moved)

    def _moved(self, equilibrium: Equilibrium, number: int) -> AnchorRates:
        """Rates of where a contact was in an equilibrium, at the place of the motion that belongs to it.

        Where slip ends, or the motion turns, that place may be held: the slip that it would add is 0. A contact that
        sticks from its first touch on began where the object met it, and that place moves: its force stays.
        """
        known = self.seeds.solved(equilibrium)
        span = known.touching.spans[number]
        moved = anchor_rates(known.touching, span, known.rates, known.frames)
        motion, met = self.seeds.scene.motion, np.zeros(len(self.seeds.keys))
        grip, parameter = span.site.grip, equilibrium.obstacle.frame.parameter
        if motion and grip is not None and grip.hold == "open" and parameter != motion.values[0]:
            met = self._met(equilibrium, span, known.rates)
        for field in fields(moved):
            values = getattr(moved, field.name)
            values += met[:, None] * values[-1]
            if motion:
                values[-1] = 0.0  # the motion goes on, its past stays
        return moved

    @staticmethod
    def _met(equilibrium: Equilibrium, span: Span, found: Rates) -> Array:
        """How the place of the motion moves at which a contact was met."""
        force, loading = float(equilibrium.state.multipliers[span.row]), found.multipliers[:, span.row]
        speed = float(np.max(np.abs(equilibrium.obstacle.velocities(equilibrium.linear.points[0]))))
        if abs(force) * speed > _TOUCHED * abs(loading[-1]):
            raise UnknownPastError("a contact sticks since the finger snapped")
        moved: Array = -loading / loading[-1]
        moved[-1] = 0.0
        return moved


def _gathered(anchor: Anchor, moved: AnchorRates) -> AnchorRates:
    """Rates of an anchor that is held in its middle (:meth:`gripper.contact.grip.Anchor.over`)."""

    def mean(values: Any, changes: Any) -> Any:
        return (moved.weights @ values + changes @ anchor.weights)[:, None]

    turn = complex(anchor.weights @ anchor.tangents)
    turning = (turn.conjugate() * mean(anchor.tangents, moved.tangents)).imag / abs(turn) ** 2
    return AnchorRates(
        mean(anchor.points, moved.points),
        1j * turn / abs(turn) * turning,
        mean(anchor.u, moved.u),
        mean(anchor.stretches, moved.stretches),
        np.zeros((len(moved.u), 1)),
    )
