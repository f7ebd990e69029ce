"""The loop of a motion with friction: peak forces there and back, located on the parameter, and where the work went."""

from __future__ import annotations

import dataclasses

from gripper.results.record import Record


@dataclasses.dataclass(frozen=True, kw_only=True)
class Loop(Record):
    """Insertion, up to the first turning of the motion, and extraction, from there to the next.

    Forces are the motion's: work to be put in per unit of the way along the parameter (N, where that is a length),
    positive against the motion. Without a return, retention is None.

    Parameters
    ----------
    peak_insertion_force, peak_insertion_parameter
        The largest force on the way there, and where.
    peak_retention_force, peak_retention_parameter
        The largest force on the way back, and where.
    ratio
        Retention over insertion; None where either is missing or no force is needed to insert.
    work_in, work_out
        Work that the drive puts in where it works, and gets back where it is driven, over the whole motion, in J.
    dissipation
        Energy lost in friction over the whole motion, in J: work in less work out, less the strain energy left.
    """

    peak_insertion_force: float
    peak_insertion_parameter: float
    peak_retention_force: float | None = None
    peak_retention_parameter: float | None = None
    ratio: float | None = None
    work_in: float
    work_out: float
    dissipation: float
