"""The numbers of a scene that a designer asks for, one name each: limits, sweeps and the optimiser use the same."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from gripper.pose import placed
from gripper.results.extremes import Extreme, Extremes
from gripper.results.pose_result import PoseResult
from gripper.results.record import Record

if TYPE_CHECKING:
    from gripper.result import Result
    from gripper.results.nothing import Least


@dataclasses.dataclass(frozen=True, kw_only=True)
class Summary(Record):
    """A motion, or one pose, in a few numbers, SI units; None what the scene does not have or what is not known.

    Peaks are located between the poses, and ``..._at`` is the motion's parameter there. Forces of insertion and
    retention are the motion's: work to be put in per unit of the way along the parameter (N, where that is a length).

    Parameters
    ----------
    insertion_force, insertion_force_at
        Largest force against the motion, up to its first turning; 0 where none is needed, None where friction locks.
    retention_force, retention_force_at
        The same on the way back. Where the motion does not come back, and has neither friction nor snaps: that of the
        same way passed backwards.
    retention_ratio
        Retention over insertion.
    work_in, work_out, dissipation
        Work that the drive puts in, and gets back, and what friction and snaps lose, over the whole motion, in J.
    locking_margin, locking_margin_at
        1 - mu / (the coefficient from which on friction holds the finger), where least: 1 without friction; 0 or less
        where it locks.
    strain, strain_at, strain_s
        Largest strain, and where on the finger (m from the clamp, on its faces).
    strain_margin, repeated_strain_margin
        1 - strain / permissible strain, for single use (the material's ``yield_strain``) and for repeated use.
    clearance, clearance_at
        Least distance of finger and object, in m: 0 where they touch.
    force_on_object, force_on_object_at
        Largest force on the object, in N.
    parameter
        Name of the motion's parameter; None in a scene without motion.
    poses, failed, locked
        How many poses there are, how many have no answer, and how many friction locks. With some that failed, the
        numbers are those of the others.
    """

    insertion_force: float | None = None
    insertion_force_at: float | None = None
    retention_force: float | None = None
    retention_force_at: float | None = None
    retention_ratio: float | None = None
    work_in: float | None = None
    work_out: float | None = None
    dissipation: float | None = None
    locking_margin: float | None = None
    locking_margin_at: float | None = None
    strain: float | None = None
    strain_at: float | None = None
    strain_s: float | None = None
    strain_margin: float | None = None
    repeated_strain_margin: float | None = None
    clearance: float | None = None
    clearance_at: float | None = None
    force_on_object: float | None = None
    force_on_object_at: float | None = None
    parameter: str | None = None
    poses: int
    failed: int
    locked: int

    def place(self, name: str) -> float | None:
        """The motion's parameter where a quantity has its value; None where it is of no single pose."""
        of = {"strain_margin": "strain", "repeated_strain_margin": "strain"}.get(name, name)
        return getattr(self, f"{of}_at", None)

    def __str__(self) -> str:
        """One line a quantity: value, unit, and where."""
        lines = self.lines(QUANTITIES)
        if self.parameter and self.insertion_force is not None:
            lines.append(f"(insertion and retention: work per unit of {self.parameter}; N, where that is a length)")
        if self.locked:
            lines.append(f"locked: friction holds the finger for any force at {self.locked} of {self.poses} poses")
        if self.failed:
            lines.append(f"WARNING: {self.failed} of {self.poses} poses failed; these are the numbers of the others")
        return "\n".join(lines)

    def rounded(self, least: Least) -> Summary:
        """The same; what is nothing is 0."""
        none = {"N": least.force, "J": least.energy, "m": least.length, "": least.ratio}
        known = {name: getattr(self, name) for name in QUANTITIES if getattr(self, name) is not None}
        small: dict[str, Any] = {name: 0.0 for name, x in known.items() if abs(x) < none[QUANTITIES[name]]}
        return dataclasses.replace(self, **small)

    def lines(self, names: Iterable[str]) -> list[str]:
        """One line for each of these quantities that is known."""
        return [line for name in names if (line := self._line(name))]

    def _line(self, name: str) -> str:
        value, at = getattr(self, name), self.place(name)
        if value is None:
            return ""
        where = [f"s = {self.strain_s:.4g} m"] if name == "strain" and self.strain_s is not None else []
        where += [f"{self.parameter} = {at:.6g}"] if at is not None else []
        place = f"at {', '.join(where)}" if where else ""
        return f"{name.replace('_', ' '):24}{value:>10.4g} {QUANTITIES[name]:3}{place}".rstrip()


QUANTITIES: dict[str, str] = {
    "insertion_force": "N",
    "retention_force": "N",
    "retention_ratio": "",
    "work_in": "J",
    "work_out": "J",
    "dissipation": "J",
    "locking_margin": "",
    "strain": "",
    "strain_margin": "",
    "repeated_strain_margin": "",
    "clearance": "m",
    "force_on_object": "N",
}
"""Names of the summary's quantities, with their units."""


def summarised(result: Result) -> Summary:
    """The summary of a result."""
    poses = result.poses
    known = result.extremes or _sampled(poses)
    strain, material = known.strain, placed(result.scene.finger).body.material
    locking = known.locking
    return Summary(
        **_placed("insertion_force", known.insertion_force),
        **_placed("retention_force", known.retention_force),
        retention_ratio=_ratio(known),
        work_in=known.work_in,
        work_out=known.work_out,
        dissipation=known.dissipation,
        locking_margin=1 - locking.value if locking else _unlocked(result),
        locking_margin_at=locking.parameter if locking else None,
        **_placed("strain", strain),
        strain_s=strain.s if strain else None,
        strain_margin=_margin(strain, material.yield_strain),
        repeated_strain_margin=_margin(strain, material.permissible_repeatedly),
        **_placed("clearance", known.clearance),
        **_placed("force_on_object", known.force_on_object),
        parameter=result.parameter,
        poses=len(poses),
        failed=len(result.failed),
        locked=sum(pose.status == "locked" for pose in poses),
    )


def _placed(name: str, extreme: Extreme | None) -> dict[str, float | None]:
    return {name: extreme.value, f"{name}_at": extreme.parameter} if extreme else {}


def _ratio(known: Extremes) -> float | None:
    there, back = known.insertion_force, known.retention_force
    return back.value / there.value if there and back and there.value > 0 else None


def _margin(strain: Extreme | None, permissible: float | None) -> float | None:
    return 1 - strain.value / permissible if strain and permissible else None


def _unlocked(result: Result) -> float | None:
    """The margin without friction; with it, of what was not followed, none is known."""
    friction = result.scene.friction
    return 1.0 if friction is None or friction.absent else None


def _sampled(poses: tuple[PoseResult, ...]) -> Extremes:
    """Extremes of poses that were not followed: of one pose alone, or of poses put together by hand."""
    known = [pose for pose in poses if pose.status not in ("failed", "locked")]
    if not known:
        return Extremes()
    strained = max(known, key=lambda pose: pose.max_strain or 0.0)
    nearest = min(known, key=lambda pose: pose.min_gap or 0.0)
    loaded = max(known, key=_force)
    clearance = 0.0 if nearest.status == "contact" else nearest.min_gap or 0.0
    return Extremes(
        strain=Extreme(value=strained.max_strain or 0.0, parameter=strained.parameter, s=strained.max_strain_s),
        clearance=Extreme(value=clearance, parameter=nearest.parameter),
        force_on_object=Extreme(value=_force(loaded), parameter=loaded.parameter),
    )


def _force(pose: PoseResult) -> float:
    return math.hypot(*pose.force_on_object) if pose.force_on_object else 0.0
