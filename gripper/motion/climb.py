"""Where a number of an equilibrium is largest on a step: climbed by polynomials through the samples about it.

Where these are few on one branch, by cubics through values and slopes, the slope being that along the tangent of the
KKT system. A step on which contacts change is climbed on both sides of the change, each on the branch of its own end.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from gripper.arrays import Array
from gripper.contact.parabola import vertex
from gripper.motion.branch import Along, Path, branch_from, nudged, pointed
from gripper.motion.through import Through
from gripper.statics.balance import cubic
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting

MARKS = np.linspace(0.0, 1.0, 129)
_CLIMBS = 8
_FEWEST = 5  # samples of one branch that a polynomial is laid through
_NODES = 6  # at most
_SMOOTH = 1e-9  # of the value: where a polynomial may hide no more than this above a known point, it is the summit
_SHARP = 1e-10  # of the value: where a cubic promises no more than this, it is a summit


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
class Sample:
    """Measures of an equilibrium, by name; heading is the sign of the way along the parameter."""

    at: Along
    heading: float
    values: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Flank:
    """A step from the highest sample of a local maximum to the next one; where contacts changed, from the top on.

    Where they did not: the samples before and after that have the same contacts.
    """

    top: Sample
    foot: Sample
    changed: tuple[float, ...] = ()
    beside: Sequence[Sample] = ()


def at_change(setting: Setting, path: Path, known: Along, parameter: float, order: int) -> Along | None:
    """The equilibrium where contacts change, on the branch of a known one; None where it is not reached."""
    if known.parameter == parameter:
        return None
    if not known.equilibrium.state.sites:
        return Along(parameter, known.equilibrium)
    try:
        near = Along(known.parameter, pointed(setting, known.equilibrium, order))
        return Along(parameter, branch_from(setting, path, near, order).at(parameter))
    except NoEquilibriumError:
        return None


@dataclass
class Climber:
    """Climbs flanks; what several measures need of one equilibrium is reckoned once.

    Parameters
    ----------
    setting, path
        Of the motion.
    order
        Of the strain fields.
    """

    setting: Setting
    path: Path
    order: int
    _further: dict[int, tuple[Along, Equilibrium, float]] = field(default_factory=dict)
    _changes: dict[tuple[int, float, float], tuple[Along, Along | None]] = field(default_factory=dict)

    def highest(self, name: str, measure: Measure, flank: Flank, known: float = -math.inf) -> Summit:
        """The highest point of a flank; where it cannot be higher than what is known, of its ends.

        Between two samples a hill rises above both by a quarter of their difference, if it is a parabola.
        """
        top, foot = flank.top.at, flank.foot.at
        if top.parameter == foot.parameter:
            return Summit(flank.top.values[name], top)
        if len(flank.beside) >= _FEWEST:
            return self._between(name, measure, flank, known)
        if flank.changed and not (top.equilibrium.state.sites and foot.equilibrium.state.sites):
            heights = [flank.top.values[name], flank.foot.values[name]]  # of which the free one's is the change's, too
            if max(heights) + abs(heights[0] - heights[1]) < known:
                return max((Summit(heights[0], top), Summit(heights[1], foot)), key=lambda summit: summit.value)
        values = {id(top): flank.top.values[name], id(foot): flank.foot.values[name]}
        pairs = [(top, foot)] if not flank.changed else []
        if flank.changed:
            near, far = self._changed(top, flank.changed[0]), self._changed(foot, flank.changed[-1])
            pairs = ([(top, near)] if near else []) + ([(far, foot)] if far else [])
            values |= {id(at): measure.value(at.equilibrium, flank.top.heading) for at in (near, far) if at}
        ends = (top, *itertools.chain(*pairs)) if flank.changed else (top,)
        found = [Summit(values[id(at)], at) for at in ends]
        for low, high in pairs:
            one, other = values[id(low)], values[id(high)]
            if max(one, other) + abs(one - other) < known:
                continue
            try:
                found.append(self._climb(measure, low, high, flank.top.heading))
            except NoEquilibriumError:
                continue  # at a limit point: the sample beside it stands
        return max(found, key=lambda summit: summit.value)

    def _between(self, name: str, measure: Measure, flank: Flank, known: float) -> Summit:
        """The highest point of a flank by the polynomial through the samples about it, and through what is found."""
        top, start = flank.top, flank.top.at.parameter
        way = flank.foot.at.parameter - start
        near = sorted(flank.beside, key=lambda sample: abs(sample.at.parameter - start - way / 2))[:_NODES]
        samples = [((sample.at.parameter - start) / way, sample.values[name]) for sample in near]
        through, branch = Through(samples), branch_from(self.setting, self.path, top.at, self.order)
        branch.know(sample.at for sample in near)
        summit = Summit(top.values[name], top.at)
        for _ in range(_CLIMBS):
            place, hope = through.highest()
            least = max(known, summit.value + _SMOOTH * abs(summit.value))
            if hope <= least or not 0 < place < 1 or through.knows(place):
                break
            try:
                found = Along(start + way * place, branch.at(start + way * place))
            except NoEquilibriumError:
                break  # the samples stand
            value = measure.value(found.equilibrium, top.heading)
            through.add(place, value)
            summit = max(summit, Summit(value, found), key=lambda summit: summit.value)
        return summit

    def _changed(self, known: Along, parameter: float) -> Along | None:
        """The equilibrium where contacts change, reckoned once for all measures."""
        key = id(known.equilibrium), known.parameter, parameter
        if key not in self._changes:
            self._changes[key] = known, at_change(self.setting, self.path, known, parameter, self.order)
        return self._changes[key][1]

    def _climb(self, measure: Measure, low: Along, high: Along, heading: float) -> Summit:
        """From an equilibrium towards another of its branch, if it rises there.

        Raises
        ------
        NoEquilibriumError
            Where the branch ends.
        """
        inner = self._rated(measure, low, heading)
        if not low.equilibrium.state.sites or inner[1] * (high.parameter - low.parameter) <= 0:
            return Summit(float(inner[0]), low)
        branch = branch_from(self.setting, self.path, low, self.order)
        outer = self._rated(measure, high, heading)
        for _ in range(_CLIMBS):
            way = high.parameter - low.parameter
            heights = cubic(inner, outer, way, MARKS)
            best = int(np.argmax(heights))
            if best in (0, MARKS.size - 1) or heights[best] - max(inner[0], outer[0]) <= _SHARP * abs(heights[best]):
                break
            where = low.parameter + way * vertex(MARKS, heights, best)[0]
            found = Along(where, branch.at(where))
            rated = self._rated(measure, found, heading)
            if rated[1] * way > 0:
                low, inner = found, rated
            else:
                high, outer = found, rated
        value, at = (inner[0], low) if inner[0] >= outer[0] else (outer[0], high)
        return Summit(float(value), at)

    def _rated(self, measure: Measure, at: Along, heading: float) -> Array:
        """A measure and its rate by the parameter, (2,)."""
        known = self._further.get(id(at.equilibrium))
        if known is None or known[0].parameter != at.parameter:
            known = at, *nudged(self.setting, self.path, at, heading)
            self._further[id(at.equilibrium)] = known  # holds the equilibrium too, whose id is not given anew
        _, further, step = known
        now = measure.value(at.equilibrium, heading)
        return np.array([now, (measure.value(further, heading) - now) / step if step else 0.0])
