"""What of a result can be drawn along its motion, with its unit and its values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gripper.plot.units import Unit, force_unit, labelled, length_unit, parameter_unit
from gripper.result import Result
from gripper.results.nothing import least

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """What can be drawn: its name on the axis, its kind, its unit for the largest value, its components' names."""

    name: str
    kind: Literal["force", "moment", "energy", "length", "ratio"]
    unit: Callable[[float], Unit]
    components: tuple[str, ...] = ("",)


def _fixed(name: str, factor: float = 1.0) -> Callable[[float], Unit]:
    return lambda largest: Unit(name, factor)


def _energy(largest: float) -> Unit:
    return Unit("J", 1.0) if largest >= 0.1 or largest == 0 else Unit("mJ", 1e3)


def _moment(largest: float) -> Unit:
    return Unit("N m", 1.0) if largest >= 0.1 or largest == 0 else Unit("N mm", 1e3)


_DRIVING = {"deg": ("driving moment", Unit("N m", 1.0)), "": ("driving work", Unit("J", 1.0))}
"""Work to put in per unit of a parameter that is no length: its name and unit."""
QUANTITIES = {
    "force_on_object": Quantity("force on the object", "force", force_unit, ("along x", "along y")),
    "force_on_object_finger_frame": Quantity(
        "force on the object, finger frame", "force", force_unit, ("along x", "along y")
    ),
    "moment_on_object": Quantity("moment on the object", "moment", _moment),
    "motion_force": Quantity("driving force", "force", force_unit),
    "clamp_moment": Quantity("clamp moment", "moment", _moment),
    "energy": Quantity("strain energy", "energy", _energy),
    "tip": Quantity("tip", "length", length_unit, ("x", "y")),
    "tip_rotation": Quantity("rotation of the tip", "ratio", _fixed("deg", 180 / np.pi)),
    "max_strain": Quantity("largest strain", "ratio", _fixed("%", 100.0)),
    "min_gap": Quantity("smallest gap", "length", length_unit),
}
"""What :func:`curve` draws, by its name in a result."""


@dataclass(frozen=True)
class Scales:
    """What a curve's axes are called, with units: along the motion, across, and each component; and the units."""

    x: str
    y: str
    components: dict[str, str]
    along: Unit
    across: Unit


@dataclass(frozen=True, eq=False)
class Series:
    """A number of a result along its motion, in a figure's units.

    Parameters
    ----------
    result
        Whose it is.
    place
        Values of the motion's parameter (n,).
    values
        (n, components); NaN where there is none.
    """

    result: Result
    place: Array
    values: Array

    @property
    def turns(self) -> list[int]:
        """Indices of the poses at which the motion turns back."""
        steps = np.sign(np.diff(self.place))
        return [i + 1 for i in range(len(steps) - 1) if steps[i] * steps[i + 1] < 0]

    @property
    def sticking(self) -> NDArray[np.bool_]:
        """At which poses a contact sticks (n,)."""
        return np.array([any(c.state == "stick" for c in pose.contacts) for pose in self.result.poses])

    def ways(self, component: int) -> list[tuple[Array, Array]]:
        """Give x and y of the way there, of the way back and so on; each is broken where the finger snaps."""
        found, snaps = [], self._snaps
        for first, last in pairwise([0, *self.turns, len(self.place) - 1]):
            cuts = [j + 1 - first for j in snaps if first <= j < last]
            x, y = (np.insert(v[first : last + 1], cuts, np.nan) for v in (self.place, self.values[:, component]))
            found.append((x, y))
        return found

    @property
    def _snaps(self) -> list[int]:
        """Indices of the poses after which, before the next, the finger snaps. Events stand in the motion's order."""
        place = [float(pose.parameter or 0.0) for pose in self.result.poses]
        found, i = [], 0
        for event in self.result.events:
            while i < len(place) - 2 and not min(place[i : i + 2]) <= event.parameter <= max(place[i : i + 2]):
                i += 1
            if event.kind == "snap":
                found.append(i)
        return found


def gather(results: Sequence[Result], quantity: str) -> tuple[Scales, list[Series]]:
    """Give a number of these results along their motions, in one unit.

    Raises
    ------
    ValueError
        A scene without motion.
    LookupError
        An unknown quantity.
    """
    if quantity not in QUANTITIES:
        raise LookupError(f"unknown quantity {quantity!r}; known: {', '.join(QUANTITIES)}")
    if any(result.scene.motion is None for result in results):
        raise ValueError("result must hold a motion, of several poses, for a curve; got one pose without motion")
    what, along = QUANTITIES[quantity], parameter_unit(results[0].scene)
    values = [_values(result, quantity, len(what.components)) for result in results]
    largest = max(float(np.abs(each[np.isfinite(each)]).max(initial=0.0)) for each in values)
    name, unit = what.name, what.unit(largest)
    if quantity == "motion_force":
        name, unit = _DRIVING.get(along.name, (name, unit))
        name += f" along {results[0].parameter}"
    parts = {part: labelled(f"{name}, {part}" if part else name, unit) for part in what.components}
    scales = Scales(labelled(results[0].parameter or "", along), labelled(name, unit), parts, along, unit)
    places = [along.factor * np.array([pose.parameter for pose in result.poses], dtype=float) for result in results]
    return scales, [
        Series(result, place, unit.factor * each) for result, place, each in zip(results, places, values, strict=True)
    ]


def _values(result: Result, quantity: str, components: int) -> Array:
    """Give the number at every pose, (n, components); NaN where there is none, 0 for next to nothing."""
    none = (np.nan,) * components
    values = [getattr(pose, quantity) for pose in result.poses]
    found = np.array([none if value is None else np.atleast_1d(value) for value in values], dtype=float)
    small = np.abs(found) < getattr(least(result.scene), QUANTITIES[quantity].kind)
    return np.where(small, 0.0, found)
