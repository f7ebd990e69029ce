"""What is largest along a motion: kept step by step, located at the end on the equilibria between.

Every step is sampled at its ends. Of each measure the highest local maxima of these samples are kept, with the steps
on both sides; at the end these are climbed (:mod:`gripper.motion.climb`). So is every step on which contacts change:
what is sharp there shows at no step's end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from gripper.arrays import Array
from gripper.motion.branch import Along, Path, branch_from
from gripper.motion.climb import MARKS, Climber, Flank, Measure, Sample, Summit, at_change
from gripper.statics.balance import Balance, cubic
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import NoEquilibriumError, Setting

_RIVALS = 3  # local maxima that are climbed
_NEARLY = 0.9  # of the highest sample: lower ones are not climbed


@dataclass(frozen=True, eq=False)
class _Step:
    first: Sample
    last: Sample
    changed: tuple[float, ...]
    leg: int
    run: list[Sample]  # what is known of its branch, growing

    @property
    def down(self) -> Flank:
        """The step, as it falls from its first sample."""
        return Flank(self.first, self.last, self.changed, self.run)

    @property
    def up(self) -> Flank:
        """The step backwards, as it rises to its last sample."""
        return Flank(self.last, self.first, self.changed[::-1], self.run)


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
    steps: list[tuple[Along, Along, tuple[float, ...]]] = field(default_factory=list)
    """Both ends of each, and where contacts changed between."""
    _stood: Along | None = None
    _broken: list[_Step] = field(default_factory=list)
    _hills: dict[str, list[tuple[float, tuple[Flank, ...]]]] = field(default_factory=dict)
    _last: _Step | None = None
    _climber: Climber | None = None

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
        self.steps.append((before, after, tuple(changed)))
        if self.touched is None:
            self.touched = changed[0] if changed else before.parameter
        self._leap(before)
        self._book(before, after, changed, order)
        self._stood = after
        heading = float(np.sign(after.parameter - before.parameter))
        first, last = self._sample(before, heading), self._sample(after, heading)
        self._follow(_Step(first, last, tuple(changed), self.leg, self._run(first, last, bool(changed))))

    def stand(self, at: Along) -> None:
        """Take in a pose, which may be reached without a step."""
        self._leap(at)
        touching = bool(at.equilibrium.state.sites)
        if touching and self.touched is None:
            self.touched = at.parameter
        if touching and not (self._last and self._last.last.at.equilibrium is at.equilibrium):
            sample = self._sample(at, self.heading)
            for name in sample.values:
                self._keep(name, Flank(sample, sample))

    def highest(self, name: str, order: int) -> Summit | None:
        """The largest value of a measure so far; None where nothing was touched."""
        self._end()
        if self._climber is None or self._climber.order != order:
            self._climber = Climber(self.setting, self.path, order)
        hills = self._hills.get(name, [])
        measure = self.measures[name]
        climbed = [flank for height, flanks in hills if height >= _NEARLY * hills[0][0] for flank in flanks]
        climbed = [flank for flank in climbed if not flank.changed]
        climbed += [step.up for step in self._broken if measure.leg in (None, step.leg)]
        best: Summit | None = None
        for flank in climbed:
            found = self._climber.highest(name, measure, flank, best.value if best else -math.inf)
            best = found if best is None or found.value > best.value else best
        return best

    # work

    @property
    def booked(self) -> bool:
        """Whether work shows in what is stored: not where loads follow the finger, or change along the motion."""
        return self.setting.loads is None or self.setting.loads.closed

    def _leap(self, to: Along) -> None:
        """Book the energy that is lost in a snap, between the last equilibrium and this one."""
        last, self._stood = self._stood, to
        if not self.booked:
            return
        if last is not None and last.parameter != to.parameter:
            self._add([], last.equilibrium.stored - to.equilibrium.stored)

    def _book(self, before: Along, after: Along, changed: Sequence[float], order: int) -> None:
        """Book the work of a step: where the drive changes its sign, energy has an extremum between the ends."""
        if not self.booked:
            return
        ends = before.equilibrium.stored, after.equilibrium.stored
        if drive(before.equilibrium) * drive(after.equilibrium) >= 0:
            self._add(ends)
            return
        parts: list[tuple[Along, Along | None]] = [(before, after)]
        if changed:
            near, far = (before, changed[0]), (after, changed[-1])
            left, right = (at_change(self.setting, self.path, *side, order) for side in (near, far))
            parts = [(before, left), (after, right)]
        between = [self._turn(first, last, order) for first, last in parts if last is not None]
        inner = list(itertools.chain(between[0], *(part[::-1] for part in between[1:]))) if between else []
        self._add([ends[0], *inner, ends[1]])

    def _turn(self, first: Along, last: Along, order: int) -> list[float]:
        """Energies at and near the extremum between two equilibria of one branch."""
        if drive(first.equilibrium) * drive(last.equilibrium) >= 0:
            return [first.equilibrium.stored, last.equilibrium.stored]
        points = [first, last]
        near = _where_extreme(first, last)
        try:
            points.insert(1, Along(near, branch_from(self.setting, self.path, first, order).at(near)))
        except NoEquilibriumError:
            pass  # the cubic over the whole part stands
        energies: list[float] = np.concatenate([_energies(*pair) for pair in itertools.pairwise(points)]).tolist()
        return energies

    def _add(self, energies: Sequence[float], lost: float = 0.0) -> None:
        """Book rises of the energy as work put in, and falls as work given back."""
        rises, old = np.diff(energies), self.balance
        put_in, given_back = float(rises[rises > 0].sum()), -float(rises[rises < 0].sum())
        self.balance = Balance(
            work=old.work + put_in - given_back,
            loss=old.loss + lost,
            put_in=old.put_in + put_in,
            given_back=old.given_back + given_back,
        )

    # samples

    def _sample(self, at: Along, heading: float) -> Sample:
        last = self._last
        if last and last.last.at.equilibrium is at.equilibrium and last.last.at.parameter == at.parameter:
            if last.last.heading == heading and last.leg == self.leg:
                return last.last
        values = {name: measure.value(at.equilibrium, heading) for name, measure in self._active().items()}
        return Sample(at, heading, values)

    def _run(self, first: Sample, last: Sample, changed: bool) -> list[Sample]:
        """The samples with the contacts that a step has from end to end; none where they change."""
        run = self._last.run if self._last and self._last.last is first else []
        if changed or first.at.equilibrium.state.kinds != last.at.equilibrium.state.kinds:
            return []
        run = run or [first]
        run.append(last)
        return run

    def _active(self) -> dict[str, Measure]:
        return {name: measure for name, measure in self.measures.items() if measure.leg in (None, self.leg)}

    def _follow(self, step: _Step) -> None:
        """Go on by a step: where it falls after a rise, there is a local maximum."""
        if self._last and (self._last.last.at.parameter != step.first.at.parameter or self._last.leg != self.leg):
            self._end()
        before = self._last
        if step.changed:
            self._broken.append(step)
        for name in self._active():
            falls = step.last.values[name] < step.first.values[name]
            if falls and before is None:
                self._keep(name, step.down)
            elif falls and before is not None and before.first.values[name] <= before.last.values[name]:
                self._keep(name, step.down, before.up)
        self._last = step

    def _end(self) -> None:
        """A run ends: what rises to its end is highest there."""
        step = self._last
        for name in step.last.values if step else ():
            if step and step.last.values[name] >= step.first.values[name]:
                self._keep(name, step.up)
        self._last = None

    def _keep(self, name: str, *flanks: Flank) -> None:
        height = max(flank.top.values[name] for flank in flanks)
        hills = [*self._hills.get(name, []), (height, flanks)]
        self._hills[name] = sorted(hills, key=lambda hill: -hill[0])[:_RIVALS]


def _energies(first: Along, last: Along) -> Array:
    """The energy between two equilibria of one branch, its slope being the drive, at marks (k,)."""
    ends = [np.array([at.equilibrium.stored, drive(at.equilibrium)]) for at in (first, last)]
    return cubic(ends[0], ends[1], last.parameter - first.parameter, MARKS)


def _where_extreme(first: Along, last: Along) -> float:
    """About where the energy is extreme between two equilibria at which the drive has different signs."""
    way = last.parameter - first.parameter
    at = float(MARKS[np.argmax(np.sign(drive(first.equilibrium) * way) * _energies(first, last))])
    return first.parameter + at * way
