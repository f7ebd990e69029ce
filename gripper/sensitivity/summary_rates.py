"""Derivatives of a summary's numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gripper.arrays import Array
from gripper.pose import placed
from gripper.results.extremes import Extreme
from gripper.sensitivity.memory import UnknownPastError
from gripper.sensitivity.peaks import Summit
from gripper.sensitivity.seeds import Seeds
from gripper.statics.contact_forces import drive

if TYPE_CHECKING:
    from gripper.result import Result

Rows: TypeAlias = dict[str, Array | None]
_FORCES = ("insertion_force", "retention_force")


def summary_rates(result: Result, seeds: Seeds, keys: Sequence[str]) -> Rows:
    """Derivatives (p,) of a summary's peaks, ratio and margins by their names; None where none is known.

    Parameters
    ----------
    result
        A motion that was followed, or one pose.
    seeds
        Of the keys, with the motion's parameter after them where there is a motion.
    keys
        The numbers.
    """
    known = _extremes(result)
    out: Rows = {name: _force(known.get(name), seeds, len(keys)) for name in _FORCES}
    there, back = (out[name] for name in _FORCES)
    ratio = result.summary().retention_ratio
    if there is not None and back is not None and ratio is not None:
        first = known["insertion_force"]
        out["retention_ratio"] = (back - ratio * there) / (first.value if first else np.nan)
    out["force_on_object"] = _largest(known.get("force_on_object"), "force", seeds, len(keys))
    out["strain"] = strain = _largest(known.get("strain"), "max_strain", seeds, len(keys))
    return out | _margins(result, strain, keys)


def _extremes(result: Result) -> dict[str, Extreme | None]:
    """The peaks, with their equilibria: of one pose itself."""
    names = ("insertion_force", "retention_force", "strain", "force_on_object")
    if result.extremes is not None:
        return {name: getattr(result.extremes, name) for name in names}
    pose = result.poses[0]
    if len(result.poses) > 1 or pose.kept is None:
        return {}
    force = float(np.hypot(*(pose.force_on_object or (0.0, 0.0))))
    strain = Extreme(value=pose.max_strain or 0.0, kept=pose.kept)
    return {"strain": strain, "force_on_object": Extreme(value=force, kept=pose.kept)}


def _rates(peak: Extreme | None, name: str, seeds: Seeds) -> Array | None:
    if peak is None or peak.kept is None:
        return None
    try:
        return Summit(seeds, name).rates(peak.kept.exact)
    except (UnknownPastError, np.linalg.LinAlgError):
        return None  # the finger snaps there, or a contact remembers what no number of the scene says


def _nothing(peak: Extreme | None, count: int) -> Array | None:
    """Of a peak that is 0: nothing is touched, and nothing changes."""
    return np.zeros(count) if peak is not None and peak.value == 0 and peak.kept is None else None


def _force(peak: Extreme | None, seeds: Seeds, count: int) -> Array | None:
    found = _rates(peak, "motion_force", seeds)
    if found is None or peak is None or peak.kept is None:
        return _nothing(peak, count)
    signed: Array = found * np.sign(drive(peak.kept.equilibrium))
    return signed


def _largest(peak: Extreme | None, name: str, seeds: Seeds, count: int) -> Array | None:
    found = _rates(peak, name, seeds)
    return _nothing(peak, count) if found is None else found


def _margins(result: Result, strain: Array | None, keys: Sequence[str]) -> Rows:
    """Of 1 - strain / permissible strain."""
    material = placed(result.scene.finger).body.material
    value, own = result.summary().strain, material.repeated_strain is not None
    limits = {
        "strain_margin": (material.yield_strain, "material.yield_strain"),
        "repeated_strain_margin": (
            material.permissible_repeatedly,
            "material.repeated_strain" if own else "material.yield_strain",
        ),
    }
    out: Rows = {}
    for name, (limit, key) in limits.items():
        if limit is None or strain is None or value is None:
            continue
        margin = -strain / limit
        if key in keys:
            share = limit / (material.yield_strain or limit) if name.startswith("repeated") and not own else 1.0
            margin[keys.index(key)] += value / limit**2 * share
        out[name] = margin
    return out
