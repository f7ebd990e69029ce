"""Derivatives of a motion's work: put in, got back, lost.

Without friction the work is what is stored more, so that it changes as the stored energy does where that turns: at the
motion's ends and turnings, whose places are held, and where the drive vanishes, where the energy is stationary. With
friction it is an integral of the drive, whose derivative is integrated on each stretch without a change of contacts or
holds; where these change the drive is continuous, and what their places' rates add cancels.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.motion.branch import Along, Branch
from gripper.motion.climb import at_change
from gripper.results.kept import Way
from gripper.sensitivity.numbers import Reading
from gripper.sensitivity.seeds import Seeds
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import Equilibrium

_STEPS = 4  # of a stretch that is integrated at once
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_ROUNDS = 8  # of Newton's method
_SHARP = 1e-10  # of a step: where the drive vanishes
_ROUND_OFF = 1e-12  # of the largest energy
_SHORT = 1e-9  # of the longest step: what is shorter has no work


@dataclass(frozen=True, eq=False)
class Work:
    """Rates of work put in, got back and lost, in J, (p,) each."""

    work_in: Array
    work_out: Array
    dissipation: Array


@dataclass(frozen=True, eq=False)
class _Stretch:
    """A part of the motion on one branch: where it starts and stops, and what is known of it."""

    start: float
    stop: float
    known: tuple[Along, ...]


class Account:
    """The work of a motion without snaps, by numbers of its scene.

    Parameters
    ----------
    seeds
        Of the numbers.
    way
        The motion's steps.
    """

    def __init__(self, seeds: Seeds, way: Way) -> None:
        self.seeds, self.way = seeds, way
        self.none = np.zeros(len(seeds.keys))
        self.longest = max((abs(after.parameter - before.parameter) for before, after, _ in way.steps), default=0.0)

    def rates(self) -> Work:
        """All rates.

        Raises
        ------
        NoEquilibriumError, UndifferentiatedError, LinAlgError
            Where the way is not found again, a contact's past or the rates of its force are not known, or at a limit
            point.
        """
        if not self.way.steps:
            return Work(self.none, self.none, self.none)
        if self.way.setting.friction is None:
            return Work(*self._turned(), self.none)
        put_in, given_back = self._integrated()
        first, last = self.way.steps[0][0], self.way.steps[-1][1]
        more = self._stored(last.equilibrium) - self._stored(first.equilibrium)
        return Work(put_in, given_back, put_in - given_back - more)

    def _stored(self, equilibrium: Equilibrium) -> Array:
        """Rates of strain energy and the loads' potential, in J."""
        reading = Reading(self.seeds, equilibrium)
        return reading.energy() + reading.load_energy()

    # without friction

    def _turned(self) -> tuple[Array, Array]:
        """Rates of all rises of the stored energy, and of all falls."""
        points = [at for step in self.way.steps for at in self._points(*step)]
        energies = np.array([at.equilibrium.stored for at in points])
        least = _ROUND_OFF * np.abs(energies).max()
        kept = np.flatnonzero(np.append(True, np.abs(np.diff(energies)) > least))  # where a step begins the last ended
        points, changes = [points[i] for i in kept], np.diff(energies[kept])
        return self._summed(points, changes > 0), -self._summed(points, changes < 0)

    def _summed(self, points: list[Along], counted: Array) -> Array:
        """Rates of the differences between neighbours that count: of the energy where they begin and end to."""
        total = self.none
        weights = -np.diff(counted.astype(float), prepend=0.0, append=0.0)
        for at, weight in zip(points, weights.tolist(), strict=True):
            if weight:
                total = total + weight * self._stored(at.equilibrium)
        return total

    def _points(self, before: Along, after: Along, changed: tuple[float, ...]) -> list[Along]:
        """A step's ends, and where between the drive vanishes."""
        if drive(before.equilibrium) * drive(after.equilibrium) >= 0:
            return [before, after]
        pairs = [(before, after)]
        if changed:
            setting, path, order = self.way.setting, self.way.path, self.way.order
            left, right = (
                at_change(setting, path, near, at, order) for near, at in ((before, changed[0]), (after, changed[-1]))
            )
            pairs = [(near, far) for near, far in ((before, left), (after, right)) if far is not None]
        for near, far in pairs:
            if drive(near.equilibrium) * drive(far.equilibrium) < 0:
                return [before, self._vanishing((near, far)), after]
        return [before, after]

    def _vanishing(self, between: tuple[Along, Along]) -> Along:
        """Where the drive vanishes between two equilibria of a branch: Newton's method, within its bracket."""
        one, other = between
        branch = Branch(self.way.setting, self.way.path, one, self.way.order)
        powers = drive(one.equilibrium), drive(other.equilibrium)
        way, scale = other.parameter - one.parameter, self.way.setting.sections.energy_scale
        at = one.parameter + way * powers[0] / (powers[0] - powers[1])
        low, high = sorted((one.parameter, other.parameter))
        for _ in range(_ROUNDS):
            found = branch.at(at)
            step = -drive(found) * scale / float(Reading(self.seeds, found).drive()[-1])
            if abs(step) < _SHARP * abs(way):
                break
            at = min(max(at + step, low), high)
        return Along(at, branch.at(at))

    # with friction

    def _integrated(self) -> tuple[Array, Array]:
        """Rates of the work where the drive works, and where it is driven."""
        put_in, given_back = self.none, self.none
        for stretch in self._stretches():
            work, rates = self._work(stretch)
            put_in, given_back = (put_in + rates, given_back) if work > 0 else (put_in, given_back - rates)
        return put_in, given_back

    def _work(self, stretch: _Stretch) -> tuple[float, Array]:
        """Work of a stretch, dimensionless, and its rates, in J: Gauss' rule."""
        branch = Branch(self.way.setting, self.way.path, stretch.known[0], self.way.order)
        branch.know(stretch.known)
        half, middle = (stretch.stop - stretch.start) / 2, (stretch.stop + stretch.start) / 2
        work, rates = 0.0, self.none
        for x, weight in zip(_NODES.tolist(), (_WEIGHTS * half).tolist(), strict=True):
            found = branch.at(middle + half * x)
            work, rates = work + weight * drive(found), rates + weight * Reading(self.seeds, found).drive()
        return work, rates

    def _stretches(self) -> Iterator[_Stretch]:
        """The motion in stretches on one branch, with one sign of the drive, of a few steps each."""
        steps = [part for step in self.way.steps for part in self._parts(*step)]
        for _, group in itertools.groupby(steps, key=lambda part: _branch_of(part.known[-1])):
            run = list(group)
            for first in range(0, len(run), _STEPS):
                parts = run[first : first + _STEPS]
                known = tuple(at for part in parts for at in part.known)
                yield from self._signed(_Stretch(parts[0].start, parts[-1].stop, known))

    def _parts(self, before: Along, after: Along, changed: tuple[float, ...]) -> list[_Stretch]:
        """A step, up to where contacts change, and from there."""
        start, stop = before.parameter, after.parameter
        parts = [_Stretch(start, stop, (before, after))]
        if changed:
            parts = [_Stretch(start, changed[0], (before,)), _Stretch(changed[-1], stop, (after,))]
        held = _SHORT * self.longest
        return [p for p in parts if p.known[0].equilibrium.state.sites and abs(p.stop - p.start) > held]

    def _signed(self, stretch: _Stretch) -> Iterator[_Stretch]:
        """A stretch, cut where the drive changes its sign."""
        for one, other in itertools.pairwise(stretch.known):
            if drive(one.equilibrium) * drive(other.equilibrium) < 0:
                root = self._vanishing((one, other))
                yield replace(stretch, stop=root.parameter)
                yield from self._signed(replace(stretch, start=root.parameter, known=_beyond(stretch.known, other)))
                return
        yield stretch


def _beyond(known: tuple[Along, ...], first: Along) -> tuple[Along, ...]:
    return known[next(i for i, at in enumerate(known) if at is first) :]


def _branch_of(at: Along) -> tuple[object, ...]:
    """What stays the same along a branch: contacts, their holds, and the unknowns."""
    state = at.equilibrium.state
    holds = tuple((s.grip.hold, s.grip.sense) if s.grip else None for s in state.sites)
    return (
        tuple((s.kind, s.piece, s.vertex, s.modes) for s in state.sites),
        holds,
        state.z.size,
    )
