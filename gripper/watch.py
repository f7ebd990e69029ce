"""What is largest along a motion: kept step by step, located at the end on the equilibria between.

Every step is sampled at its ends and where its contacts change. Of each measure the highest local maxima of these
samples are kept, with the steps on both sides. At the end each is climbed: by cubics through values and slopes, the
slope being that along the tangent of the KKT system.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from gripper.answer import drive
from gripper.arrays import Array
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.events import Along, Branch, Path, pointed
from gripper.work import Balance, cubic, nudged

_MARKS = np.linspace(0.0, 1.0, 129)
_CLIMBS = 8
_SHARP = 1e-10  # of the value: where a cubic promises no more than this, it is a summit
_RIVALS = 3  # local maxima that are climbed
_NEARLY = 0.9  # of the highest sample: lower ones are not climbed


@dataclass(frozen=True)
class Measure:
    """A number of an equilibrium whose largest value is wanted.

    Parameters
    ----------
    value
        Of an equilibrium, and the sign of the way along the parameter.
    leg
        The leg of the motion on which it counts, from 0; None for all.
    """

    value: Callable[[Equilibrium, float], float]
    leg: int | None = None


@dataclass(frozen=True, eq=False)
class Summit:
    """Where a measure is largest: its value, and the equilibrium there."""

    value: float
    at: Along


@dataclass(frozen=True, eq=False)
class _Sample:
    at: Along
    heading: float
    values: Mapping[str, float]


Flank = tuple[_Sample, _Sample]
"""From the highest sample of a local maximum to the next."""


Part = tuple[_Sample, _Sample]
"""A step, or a part of one on which the contacts stay."""


@dataclass
class Watch:
    """Watches the steps of a motion.

    Parameters
    ----------
    setting, path
        Of the motion.
    measures
        What to watch, by name.
    """

    setting: Setting
    path: Path
    measures: Mapping[str, Measure]
    leg: int = 0
    heading: float = 0.0
    """Turnings of the motion so far, and the sign of its way: whoever leads it tells."""
    balance: Balance = field(default_factory=Balance)
    """Work so far, of a motion without friction: what the drive puts in and gets back, and what is lost in snaps."""
    touched: float | None = None
    """Where the first contact was met."""
    _stood: Along | None = None
    _hills: dict[str, list[tuple[float, tuple[Flank, ...]]]] = field(default_factory=dict)
    _last: tuple[_Sample, _Sample, int] | None = None

    def note(self, before: Along, after: Along, changed: Sequence[float], order: int) -> None:
        """Take in a step.

        Parameters
        ----------
        before, after
            Its ends.
        changed
            Where contacts changed on it, in the order in which they did.
        order
            Of the strain fields.
        """
        if before.parameter == after.parameter:
            return
        if self.touched is None:
            self.touched = changed[0] if changed else before.parameter
        self._leap(before)
        parts = self._parts(before, after, changed, order)
        self._book([before.equilibrium.state.energy, *self._energies(parts, order), after.equilibrium.state.energy])
        self._stood = after
        for first, last in parts:
            self._follow(first, last)

    def stand(self, at: Along) -> None:
        """Take in a pose, which may be reached without a step."""
        self._leap(at)
        last = self._last
        touching = bool(at.equilibrium.state.sites)
        if touching and self.touched is None:
            self.touched = at.parameter
        if touching and not (last and last[1].at.equilibrium is at.equilibrium):
            sample = self._sample(at, self.heading)
            for name in sample.values:
                self._keep(name, (sample, sample))

    def _leap(self, to: Along) -> None:
        """Book the energy that is lost in a snap, between the last equilibrium and this one."""
        last = self._stood
        self._stood = to
        if last is not None and last.parameter != to.parameter:
            self._add(0.0, 0.0, last.equilibrium.state.energy - to.equilibrium.state.energy)

    def highest(self, name: str, order: int) -> Summit | None:
        """The largest value of a measure so far; None where nothing was touched."""
        self._end()
        hills = sorted(self._hills.get(name, []), key=lambda hill: -hill[0])
        summits = [self._climbed(name, flanks, order) for height, flanks in hills if height >= _NEARLY * hills[0][0]]
        return max(summits, key=lambda summit: summit.value, default=None)

    def _book(self, energies: Sequence[float]) -> None:
        """Book the work of a step: energies at its ends, where contacts change, and where they have extrema."""
        rises = np.diff(energies)
        self._add(float(rises[rises > 0].sum()), -float(rises[rises < 0].sum()), 0.0)

    def _energies(self, parts: Sequence[Part], order: int) -> list[float]:
        """Energies where contacts change, and at the extrema between: there the drive changes its sign."""
        found = []
        for first, last in parts:
            found += [first.at.equilibrium.state.energy, *self._turn(first.at, last.at, order)]
            found.append(last.at.equilibrium.state.energy)
        return found

    def _turn(self, first: Along, last: Along, order: int) -> list[float]:
        """Energies at and near the extremum between two equilibria of one branch."""
        if drive(first.equilibrium) * drive(last.equilibrium) >= 0:
            return []
        points = [first, last]
        near = _where_extreme(first, last)
        try:
            points.insert(1, Along(near, Branch(self.setting, self.path, first, order).at(near)))
        except NoEquilibriumError:
            pass  # the cubic over the whole part stands
        return np.concatenate([_cubic_energies(*pair) for pair in itertools.pairwise(points)]).tolist()

    def _add(self, put_in: float, given_back: float, lost: float) -> None:
        old = self.balance
        self.balance = Balance(
            work=old.work + put_in - given_back,
            loss=old.loss + lost,
            put_in=old.put_in + put_in,
            given_back=old.given_back + given_back,
        )

    def _parts(self, before: Along, after: Along, changed: Sequence[float], order: int) -> list[Part]:
        """A step in parts on which the contacts stay, as far as they are known."""
        heading = float(np.sign(after.parameter - before.parameter))
        first, last = self._sample(before, heading), self._sample(after, heading)
        if not changed:
            return [(first, last)]
        left, right = self._at_change(before, changed[0], order), self._at_change(after, changed[-1], order)
        parts = [(first, self._sample(left, heading))] if left else []
        return parts + ([(self._sample(right, heading), last)] if right else [])

    def _at_change(self, known: Along, parameter: float, order: int) -> Along | None:
        """The equilibrium where contacts change, on the branch of a known one; None where it is not reached."""
        if known.parameter == parameter:
            return None
        if not known.equilibrium.state.sites:
            return Along(parameter, known.equilibrium)
        try:
            near = Along(known.parameter, pointed(self.setting, known.equilibrium, order))
            return Along(parameter, Branch(self.setting, self.path, near, order).at(parameter))
        except NoEquilibriumError:
            return None

    def _sample(self, at: Along, heading: float) -> _Sample:
        last = self._last[1] if self._last else None
        if last and last.at.equilibrium is at.equilibrium and last.at.parameter == at.parameter:
            if last.heading == heading:
                return last
        values = {name: measure.value(at.equilibrium, heading) for name, measure in self._active().items()}
        return _Sample(at, heading, values)

    def _active(self) -> dict[str, Measure]:
        return {name: measure for name, measure in self.measures.items() if measure.leg in (None, self.leg)}

    def _follow(self, first: _Sample, last: _Sample) -> None:
        """Go on by a part: where it falls after a rise, there is a local maximum."""
        if self._last and (self._last[1].at.parameter != first.at.parameter or self._last[2] != self.leg):
            self._end()
        before = self._last
        for name in self._active():
            falls = last.values[name] < first.values[name]
            if falls and before is None:
                self._keep(name, (first, last))
            elif falls and before is not None and before[0].values[name] <= before[1].values[name]:
                self._keep(name, (first, last), (before[1], before[0]))
        self._last = first, last, self.leg

    def _end(self) -> None:
        """A run ends: what rises to its end is highest there."""
        if self._last:
            first, last, _ = self._last
            for name in last.values:
                if last.values[name] >= first.values[name]:
                    self._keep(name, (last, first))
        self._last = None

    def _keep(self, name: str, *flanks: Flank) -> None:
        height = max(top.values[name] for top, _ in flanks)
        hills = [*self._hills.get(name, []), (height, flanks)]
        self._hills[name] = sorted(hills, key=lambda hill: -hill[0])[:_RIVALS]

    def _climbed(self, name: str, flanks: tuple[Flank, ...], order: int) -> Summit:
        """The highest point of a local maximum."""
        summits = [Summit(top.values[name], top.at) for top, _ in flanks]
        for top, foot in flanks:
            try:
                summits.append(self._climb(self.measures[name], top, foot, order))
            except NoEquilibriumError:
                continue  # at a limit point: the sample beside it stands
        return max(summits, key=lambda summit: summit.value)

    def _climb(self, measure: Measure, top: _Sample, foot: _Sample, order: int) -> Summit:
        """From the highest sample up the flank, if it rises there.

        Raises
        ------
        NoEquilibriumError
            Where the branch ends.
        """
        low, high = top.at, foot.at
        inner = self._rated(measure, low, top.heading)
        if not low.equilibrium.state.sites or inner[1] * (high.parameter - low.parameter) <= 0:
            return Summit(float(inner[0]), low)
        branch = Branch(self.setting, self.path, low, order)
        outer = self._rated(measure, high, top.heading)
        for _ in range(_CLIMBS):
            way = high.parameter - low.parameter
            heights = cubic(inner, outer, way, _MARKS)
            best = int(np.argmax(heights))
            if best in (0, _MARKS.size - 1) or heights[best] - max(inner[0], outer[0]) <= _SHARP * abs(heights[best]):
                break
            where = low.parameter + way * float(_MARKS[best])
            found = Along(where, branch.at(where))
            rated = self._rated(measure, found, top.heading)
            if rated[1] * way > 0:
                low, inner = found, rated
            else:
                high, outer = found, rated
        value, at = (inner[0], low) if inner[0] >= outer[0] else (outer[0], high)
        return Summit(float(value), at)

    def _rated(self, measure: Measure, at: Along, heading: float) -> Array:
        """A measure and its rate by the parameter, (2,)."""
        further, step = nudged(self.setting, self.path, at, heading)
        now = measure.value(at.equilibrium, heading)
        return np.array([now, (measure.value(further, heading) - now) / step if step else 0.0])


def _cubic_energies(first: Along, last: Along) -> Array:
    """The energy between two equilibria of one branch, its slope being the drive, at marks (k,)."""
    ends = [np.array([at.equilibrium.state.energy, drive(at.equilibrium)]) for at in (first, last)]
    return cubic(ends[0], ends[1], last.parameter - first.parameter, _MARKS)


def _where_extreme(first: Along, last: Along) -> float:
    """About where the energy is extreme between two equilibria at which the drive has different signs."""
    energies, sign = (
        _cubic_energies(first, last),
        np.sign(drive(first.equilibrium) * (last.parameter - first.parameter)),
    )
    at = float(_MARKS[np.argmax(sign * energies)])
    return first.parameter + at * (last.parameter - first.parameter)
