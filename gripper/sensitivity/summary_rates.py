"""Derivatives of a summary's numbers, and of those without, why."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array
from gripper.pose import placed
from gripper.results.extremes import Extreme
from gripper.results.kept import Way
from gripper.results.summary import Summary
from gripper.sensitivity.gap_rates import gap_rates, meeting_rates
from gripper.sensitivity.jet import NotFormedError
from gripper.sensitivity.peaks import Peaking, Summit
from gripper.sensitivity.seeds import Seeds
from gripper.sensitivity.touching import UndifferentiatedError
from gripper.sensitivity.work_rates import Account
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import NoEquilibriumError

if TYPE_CHECKING:
    from gripper.result import Result

_NO_LOSS = 1e-6  # of the work put in: what is lost in less, without friction, is no snap
_COUNTED = ("parameter", "poses", "failed", "locked")
_ABSENT = "the summary has none"
_HELD = "it is largest where the finger snaps or a hold begins: how that place moves is not known"
_NEAREST = "where the least distance lies moves with second derivatives, which are not formed of it"
_LOST = "the equilibrium of the peak is not known"
_LIMIT = "the peak is at a limit point, where derivatives are infinite"


@dataclass(frozen=True, eq=False)
class Rows:
    """Derivatives (p,) of a summary's numbers by their names, and why others have none."""

    known: dict[str, Array] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)

    def put(self, name: str, rates: Array | None, reason: str) -> None:
        """Note derivatives, or why there are none."""
        if rates is None:
            self.reasons[name] = reason
        else:
            self.known[name] = rates


def summary_rates(result: Result, seeds: Seeds, keys: Sequence[str]) -> Rows:
    """Derivatives of a summary's numbers.

    Parameters
    ----------
    result
        A motion that was followed, or one pose.
    seeds
        Of the keys, with the motion's parameter after them where there is a motion.
    keys
        The numbers, p of them.
    """
    peaks, rows, summary = _extremes(result), Rows(), result.summary()
    writing = _Peaks(rows, seeds, result.extremes.way if result.extremes else None, np.zeros(len(keys)))
    for name, what in _PEAKS.items():
        writing.put(name, what, peaks.get(name))
    _clearance(rows, result, peaks.get("clearance"), seeds, keys)
    _ratio(rows, summary)
    _margins(rows, result, keys)
    _work(rows, result, seeds, keys)
    writing.locking(peaks.get("locking"))
    for number in dataclasses.fields(Summary):
        if number.name not in _COUNTED and getattr(summary, number.name) is None:
            rows.known.pop(number.name, None)
            rows.reasons[number.name] = _ABSENT
    return rows


_PEAKS = {
    "insertion_force": "motion_force",
    "retention_force": "motion_force",
    "strain": "max_strain",
    "force_on_object": "force",
}


def _extremes(result: Result) -> dict[str, Extreme | None]:
    """The peaks, with their equilibria: of one pose itself."""
    if result.extremes is not None:
        return {name: getattr(result.extremes, name) for name in (*_PEAKS, "clearance", "locking")}
    pose = result.poses[0]
    if len(result.poses) > 1 or pose.kept is None:
        return {}
    force = float(np.hypot(*(pose.force_on_object or (0.0, 0.0))))
    values = {"strain": pose.max_strain or 0.0, "force_on_object": force, "clearance": max(pose.min_gap or 0.0, 0.0)}
    return {name: Extreme(value=value, kept=pose.kept) for name, value in values.items()}


@dataclass(frozen=True, eq=False)
class _Peaks:
    """Writes the derivatives of peaks into rows."""

    rows: Rows
    seeds: Seeds
    way: Way | None
    none: Array  # (p,)

    def put(self, name: str, what: str, peak: Extreme | None) -> None:
        """A peak, where it is and, of the strain, where on the finger."""
        if peak is None:
            return
        if peak.value == 0 and (peak.kept is None or what == "force"):  # nothing is touched, and nothing changes
            self.rows.put(name, self.none, "")
            return
        sign = float(np.sign(drive(peak.kept.exact))) if peak.kept and what == "motion_force" else 1.0
        found = self._written(name, what, peak, sign)
        if name == "strain":
            self.rows.put("strain_s", found.along, found.missing or _HELD)

    def locking(self, peak: Extreme | None) -> None:
        """The margin against locking, where it is least; without friction it is 1."""
        if peak is None or not peak.value:
            self.rows.put("locking_margin", self.none, "")
        else:
            self._written("locking_margin", "locking", peak, -1.0)

    def _written(self, name: str, what: str, peak: Extreme, sign: float) -> Peaking:
        found = self._located(peak, what)
        reason = found.missing or _HELD
        self.rows.put(name, None if found.value is None else sign * found.value, reason)
        self.rows.put(f"{name}_at", found.place, reason)
        return found

    def _located(self, peak: Extreme, what: str) -> Peaking:
        """A peak's derivatives, or why there are none."""
        if peak.kept is None:
            return Peaking(missing=_LOST)
        try:
            return Summit(self.seeds, what, peak.value, self.way).rates(peak.kept.exact)
        except NotFormedError as error:
            return Peaking(missing=f"it changes with second derivatives, which are not formed of {error}")
        except UndifferentiatedError as error:
            return Peaking(missing=f"{error}: where it began to is not known by the scene's numbers")
        except (NoEquilibriumError, np.linalg.LinAlgError):
            return Peaking(missing=_LIMIT)


def _clearance(rows: Rows, result: Result, least: Extreme | None, seeds: Seeds, keys: Sequence[str]) -> None:
    """The least distance: 0 where the finger touches; its place is where that is least, or where it first touches."""
    motion, none = seeds.scene.motion, np.zeros(len(keys))
    if least is None:
        return
    held = motion is not None and least.parameter in (motion.values[0], min(motion.values), max(motion.values))
    if least.value > 0:
        rates = gap_rates(seeds, least.kept.exact)[: len(keys)] if least.kept else None
        rows.put("clearance", rates, _LOST)
        rows.put("clearance_at", none if held else None, _NEAREST)
        return
    rows.put("clearance", none, "")
    way = result.extremes.way if result.extremes else None
    if held or least.parameter is None:
        rows.put("clearance_at", none, "")
    elif way is not None:
        rows.put("clearance_at", meeting_rates(seeds, least.parameter, way.order), "")


def _ratio(rows: Rows, summary: Summary) -> None:
    there, back = (rows.known.get(name) for name in ("insertion_force", "retention_force"))
    if summary.retention_ratio is None or summary.insertion_force is None:
        return
    missing = next((rows.reasons[n] for n in ("insertion_force", "retention_force") if n in rows.reasons), "")
    rates = (
        None if there is None or back is None else (back - summary.retention_ratio * there) / summary.insertion_force
    )
    rows.put("retention_ratio", rates, missing)


def _margins(rows: Rows, result: Result, keys: Sequence[str]) -> None:
    """Of 1 - strain / permissible strain."""
    material = placed(result.scene.finger).body.material
    value, own = result.summary().strain, material.repeated_strain is not None
    strain = rows.known.get("strain")
    limits = {
        "strain_margin": (material.yield_strain, "material.yield_strain"),
        "repeated_strain_margin": (
            material.permissible_repeatedly,
            "material.repeated_strain" if own else "material.yield_strain",
        ),
    }
    for name, (limit, key) in limits.items():
        if limit is None or value is None:
            continue
        if strain is None:
            rows.reasons[name] = rows.reasons.get("strain", _LOST)
            continue
        margin = -strain / limit
        if key in keys:
            share = limit / (material.yield_strain or limit) if name.startswith("repeated") and not own else 1.0
            margin[keys.index(key)] += value / limit**2 * share
        rows.known[name] = margin


def _work(rows: Rows, result: Result, seeds: Seeds, keys: Sequence[str]) -> None:
    """Work put in, got back and lost."""
    names = ("work_in", "work_out", "dissipation")
    found, reason = None, _unbooked(result)
    way = result.extremes.way if result.extremes else None
    if reason is None and way is not None:
        try:
            found = Account(seeds, way).rates()
        except UndifferentiatedError as error:
            reason = f"{error}: where it began to is not known by the scene's numbers"
        except (NoEquilibriumError, np.linalg.LinAlgError) as error:
            reason = f"the motion's way is not found again: {error}"
    for name in names:
        rows.put(name, None if found is None else getattr(found, name)[: len(keys)], reason or _ABSENT)


def _unbooked(result: Result) -> str | None:
    """Why the work of a motion has no derivatives."""
    summary = result.summary()
    if summary.work_in is None or summary.dissipation is None:
        return _ABSENT
    if summary.failed or summary.locked:
        return "not all poses have an answer"
    friction = result.scene.friction
    lossless = friction is None or friction.absent
    snapped = any(event.kind == "snap" for event in result.events)
    if snapped or (lossless and summary.dissipation > _NO_LOSS * summary.work_in):
        return "the finger snaps on the way: what is lost there is not differentiated"
    return None
