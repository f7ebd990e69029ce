"""Quantities of the summary pose by pose, and their peaks, with exact gradients by some numbers of the scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.motion.located import ways
from gripper.result import Result
from gripper.results.pose_result import PoseResult
from gripper.sensitivity.report import PoseSensitivity, Sensitivity, sensitivities

Read = Callable[[PoseResult], float]
Rate = Callable[[PoseResult, PoseSensitivity], float]


def _size(pose: PoseResult) -> float:
    return math.hypot(*(pose.force_on_object or (0.0, 0.0)))


def _size_rate(pose: PoseResult, by: PoseSensitivity) -> float:
    size = _size(pose)
    pairs = zip(pose.force_on_object or (0.0, 0.0), by.force_on_object or (0.0, 0.0), strict=True)
    return sum(force * rate for force, rate in pairs) / size if size else 0.0


CURVES: dict[str, tuple[Read, Rate]] = {
    "insertion_force": (lambda pose: pose.motion_force or 0.0, lambda pose, by: by.motion_force or 0.0),
    "retention_force": (lambda pose: pose.motion_force or 0.0, lambda pose, by: by.motion_force or 0.0),
    "strain": (lambda pose: pose.max_strain or 0.0, lambda pose, by: by.max_strain or 0.0),
    "force_on_object": (_size, _size_rate),
}
"""Quantities of the summary that every pose has: how they are read, and their derivatives."""


def _signs(result: Result, quantity: str) -> list[float]:
    """Of each pose the factor of a quantity; 0 where it does not count."""
    if quantity not in ("insertion_force", "retention_force"):
        return [1.0] * len(result.poses)
    found = ways([pose.parameter or 0.0 for pose in result.poses])
    leg = 1 if quantity == "retention_force" else 0
    if leg and all(way[0] == 0 for way in found):
        return [-heading for _, heading in found]  # the same way passed backwards
    return [heading if way == leg else 0.0 for way, heading in found]


def curve(result: Result, quantity: str) -> Array | None:
    """A quantity of all poses (k,); None where a pose has none."""
    if any(pose.status in ("failed", "locked") for pose in result.poses):
        return None
    read = CURVES[quantity][0]
    signs = _signs(result, quantity)
    return np.array([sign * read(pose) for sign, pose in zip(signs, result.poses, strict=True)])


@dataclass(frozen=True, eq=False)
class Curves:
    """A result with its sensitivities.

    Parameters
    ----------
    result
        Whose poses all have an answer.
    found
        Its sensitivities by each number.
    """

    result: Result
    found: tuple[Sensitivity, ...]

    def along(self, quantity: str) -> tuple[Array, Array]:
        """A quantity of all poses (k,), and its gradients (k, n)."""
        values, rate = curve(self.result, quantity), CURVES[quantity][1]
        if values is None:
            raise ValueError("every pose must have an answer; got one without")
        signs = _signs(self.result, quantity)
        poses = self.result.poses
        slopes = [
            [sign * rate(pose, by.poses[i]) for by in self.found]
            for i, (sign, pose) in enumerate(zip(signs, poses, strict=True))
        ]
        return values, np.array(slopes).reshape(len(values), len(self.found))

    def peak(self, quantity: str) -> tuple[float, Array]:
        """A quantity of the summary and its gradient (n,): where that of the peak is not known, the nearest pose's.

        Raises
        ------
        ValueError
            Where the summary does not have it.
        """
        value = getattr(self.result.summary(), quantity)
        slopes = [by.summary.get(quantity) for by in self.found]
        if value is None:
            raise ValueError(f"{quantity} must be known of every design; got None")
        if all(slope is not None for slope in slopes):
            return float(value), np.array(slopes, dtype=float)
        if quantity == "retention_ratio":
            back, there = (self.peak(name) for name in ("retention_force", "insertion_force"))
            return float(value), (back[1] - value * there[1]) / there[0]
        if quantity not in CURVES:
            raise ValueError(f"the gradient of {quantity} must be known; got None")
        values, each = self.along(quantity)
        return float(value), np.asarray(each[int(np.argmax(values))])


def curves(result: Result, keys: Sequence[str]) -> Curves:
    """The curves of a result, by some numbers of its scene."""
    found = sensitivities(result, keys) if keys else {}
    return Curves(result, tuple(found[key] for key in keys))
