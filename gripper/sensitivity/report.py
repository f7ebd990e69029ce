"""Sensitivities as plain data: of each pose, by each number of the scene."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gripper.parameters import number, numbers
from gripper.pose import placed
from gripper.results.kept import Kept
from gripper.results.pose_result import PoseNumbers, PoseResult, Vector
from gripper.results.record import Record, jsonable
from gripper.scene import Scene
from gripper.sensitivity.limits import refusal, side
from gripper.sensitivity.memory import UnknownPastError
from gripper.sensitivity.numbers import Reading, Table
from gripper.sensitivity.object_rates import object_rates
from gripper.sensitivity.opened import NotOpenError
from gripper.sensitivity.seeds import Seeds
from gripper.sensitivity.summary_rates import Rows, summary_rates
from gripper.sensitivity.touching import UndifferentiatedError
from gripper.statics.equilibrium import NoEquilibriumError

if TYPE_CHECKING:
    from gripper.result import Result

_SAME = 1e-9  # of L


@dataclasses.dataclass(frozen=True, kw_only=True)
class PoseSensitivity(PoseNumbers):
    """Derivatives of a pose's numbers by one number of the scene: SI units, world frame unless named otherwise.

    Parameters
    ----------
    kind
        "exact"; "one-sided" where the contacts or their holds change at this very pose: on the other side of the
        change derivatives differ; "none" where there is no derivative, and all are None.
    reason
        Why it is one-sided or none.

    The numbers are derivatives of what :class:`gripper.results.pose_result.PoseNumbers` calls so.
    """

    kind: Literal["exact", "one-sided", "none"] = "exact"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sensitivity(Record):
    """Exact derivatives of a result by one number of its scene.

    Parameters
    ----------
    key
        The number.
    value
        What it is, in SI units.
    poses
        One entry a pose.
    summary
        Derivatives of :meth:`gripper.Result.summary`'s numbers by their names; None where there is none.
    reasons
        Why, by the same names: the summary does not have the number, the finger snaps there, ...

    Of a result of one pose, that pose's derivatives are its own: ``sensitivity.energy``.
    """

    key: str
    value: float
    poses: tuple[PoseSensitivity, ...]
    summary: Mapping[str, float | None] = dataclasses.field(default_factory=dict)
    reasons: Mapping[str, str] = dataclasses.field(default_factory=dict)

    @property
    def pose(self) -> PoseSensitivity:
        """The only pose; ValueError where there are several or where it has no derivative."""
        if len(self.poses) > 1:
            raise ValueError(f"sensitivity must hold one pose (of several, use .poses[i]); got {len(self.poses)}")
        if self.poses[0].kind == "none":
            raise ValueError(f"sensitivity must hold a pose with derivatives; got {self.poses[0].reason}")
        return self.poses[0]

    @property
    def energy(self) -> float | None:
        """Of the strain energy (one pose)."""
        return self.pose.energy

    @property
    def force_on_object(self) -> Vector | None:
        """Of the force on the object (one pose)."""
        return self.pose.force_on_object

    @property
    def max_strain(self) -> float | None:
        """Of the largest strain (one pose)."""
        return self.pose.max_strain

    def to_dict(self) -> dict[str, object]:
        """Plain data, ready for JSON."""
        found: dict[str, object] = jsonable(self)
        return found


def sensitivities(result: Result, keys: Sequence[str] | None = None) -> dict[str, Sensitivity]:
    """Exact derivatives of a result, by key.

    Parameters
    ----------
    result
        From :func:`gripper.solve` or :func:`gripper.trace` in this process.
    keys
        Numbers of its scene; by default all by which it can be differentiated: not those of an object's own shape
        where no formula in sympy gives it (polygons, splines, unions).

    Raises
    ------
    LookupError
        An unknown number; lists the known ones.
    ValueError
        A result whose equilibria are not known, or a scene that cannot be differentiated.
    """
    scene = result.scene
    known = numbers(scene)
    keys = _differentiable(scene, known) if keys is None else list(dict.fromkeys(keys))
    values = {key: known[key] if key in known else number(scene, key) for key in keys}
    refusal(scene)
    kept = [_kept(pose) for pose in result.poses]
    summary = Rows()
    first = next((k for k in kept if k is not None), None)
    if first is None:
        tables: list[list[PoseSensitivity]] = [[_none(pose, pose.reason) for _ in keys] for pose in result.poses]
    else:
        seeds = Seeds(scene, first.setting, keys)
        tables = [_of_pose(result, seeds, pose, k) for pose, k in zip(result.poses, kept, strict=True)]
        summary = summary_rates(result, seeds, keys)
    return {
        key: Sensitivity(
            key=key,
            value=values[key],
            poses=tuple(table[i] for table in tables),
            summary={name: float(rates[i]) for name, rates in summary.known.items()}
            | dict.fromkeys(summary.reasons, None),
            reasons=summary.reasons,
        )
        for i, key in enumerate(keys)
    }


def _differentiable(scene: Scene, known: Mapping[str, float]) -> list[str]:
    """All numbers, without an object's own where its formula is none of sympy's, and without places of loads that meet.

    Two loads on one section, or one on a kink of the profile: the finger is cut there for both.
    """
    own = {key.split(".", 1)[1]: v for key, v in known.items() if key.startswith("object.")}
    own = {key: value for key, value in own.items() if not key.startswith("pose.")}
    whole = not own or _opens(scene, own)
    left_out = set() if whole else {key for key, value in own.items() if not _opens(scene, {key: value})}
    finger = placed(scene.finger).body
    cut = [finger.length, *finger.kinks(), *(s for load in scene.loads for s in load.stations(finger) or ())]

    def fits(key: str) -> bool:
        if key.startswith("loads["):
            return sum(abs(known[key] - s) < _SAME * finger.length for s in cut) < 2
        return key.removeprefix("object.") not in left_out or not key.startswith("object.")

    return [key for key in known if fits(key)]


def _opens(scene: Scene, own: Mapping[str, float]) -> bool:
    """Whether the object can be differentiated by some of its own numbers."""
    try:
        object_rates(placed(scene.object).body, own)
    except NotOpenError:
        return False
    return True


def _kept(pose: PoseResult) -> Kept | None:
    if pose.status in ("contact", "free") and pose.kept is None:
        raise ValueError(
            "result must come from gripper.solve or gripper.trace in this process: its equilibria are never written "
            "or pickled; got one without"
        )
    return pose.kept if pose.status in ("contact", "free") else None


def _of_pose(result: Result, seeds: Seeds, pose: PoseResult, kept: Kept | None) -> list[PoseSensitivity]:
    """The derivatives of one pose by all numbers."""
    if kept is None:
        return [_none(pose, pose.reason)] * len(seeds.keys)
    kind, reason = side(result, pose, kept)
    if kind != "none":
        try:
            return _rows(Reading(seeds, kept.exact).table(), pose, seeds, kind, reason)
        except (NoEquilibriumError, np.linalg.LinAlgError):
            reason = "the equilibrium is at a limit point, where its derivatives are infinite"
        except UnknownPastError as error:
            reason = f"{error}: where it began to is not known by the scene's numbers"
        except UndifferentiatedError as error:
            reason = str(error)
    return [_none(pose, reason)] * len(seeds.keys)


def _none(pose: PoseResult, reason: str | None) -> PoseSensitivity:
    return PoseSensitivity(parameter=pose.parameter, kind="none", reason=reason)


def _rows(
    table: Table, pose: PoseResult, seeds: Seeds, kind: Literal["exact", "one-sided"], reason: str | None
) -> list[PoseSensitivity]:
    fields = {f.name for f in dataclasses.fields(PoseSensitivity)}
    known = [name for name in table if name in fields]
    rows = zip(*(table[name].tolist() for name in known), strict=True)
    same: dict[str, Any] = {"parameter": pose.parameter, "kind": kind, "reason": reason}
    return [PoseSensitivity(**same, **dict(zip(known, row, strict=True))) for row in rows]
