"""What is largest or least along a motion, and where: plain data."""

from __future__ import annotations

import dataclasses

from gripper.results.kept import Kept, Way
from gripper.results.record import Record


@dataclasses.dataclass(frozen=True, kw_only=True)
class Extreme(Record):
    """A largest or least value, and where it is.

    Parameters
    ----------
    value
        In SI units.
    parameter
        The motion's parameter there; None in a scene without motion.
    s
        Place on the finger (m from the clamp), where the value is that of a place.
    kept
        The equilibrium there, for sensitivities; None where none is known.
    """

    value: float
    parameter: float | None = None
    s: float | None = None
    kept: Kept | None = dataclasses.field(default=None, compare=False, repr=False)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Extremes(Record):
    """What is largest or least along a motion, located between its poses; None where there is none.

    Parameters
    ----------
    insertion_force
        The motion's force where it is largest on the way there, up to the first turning; 0 where none is needed.
    retention_force
        The same on the way back, up to the next turning. Without a way back, and without friction and snaps, that of
        the same way passed backwards, which has the same curve.
    strain
        The finger's largest strain.
    force_on_object
        The largest force on the object.
    clearance
        Least distance of finger and object: 0 where they touch.
    locking
        Friction's coefficient over the one from which on friction holds the finger, where that is largest.
    work_in, work_out
        Work that the drive puts in where it works, and gets back where it is driven, over the whole motion, in J.
    dissipation
        Energy lost in friction and snaps over the whole motion, in J.
    way
        Its steps, for sensitivities of the work; None where they are not known.
    """

    insertion_force: Extreme | None = None
    retention_force: Extreme | None = None
    strain: Extreme | None = None
    force_on_object: Extreme | None = None
    clearance: Extreme | None = None
    locking: Extreme | None = None
    work_in: float | None = None
    work_out: float | None = None
    dissipation: float | None = None
    way: Way | None = dataclasses.field(default=None, compare=False, repr=False)
