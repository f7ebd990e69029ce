"""A design solved, with the values and gradients that an optimiser needs of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array
from gripper.limits import Limits, judged
from gripper.optimize.goal import Goal
from gripper.optimize.optimum import Trial
from gripper.parameters import replaced
from gripper.result import Result
from gripper.scene import Scene
from gripper.solve import solve
from gripper.trace import trace

if TYPE_CHECKING:
    from gripper.sensitivity.curves import Curves

_RECENT = 4


@dataclass(frozen=True, eq=False)
class Design:
    """A design, with the curves of its result; none where it has no answer."""

    curves: Curves | None
    trial: Trial


class Evaluator:
    """Solves designs, each once.

    Parameters
    ----------
    scene
        Whose numbers are changed.
    bounds
        Of the free numbers, by key, in SI units.
    goal, limits
        What is wanted.
    exact
        Whether its curves have gradients.
    """

    def __init__(
        self, scene: Scene, bounds: Mapping[str, tuple[float, float]], goal: Goal, limits: Limits, exact: bool = True
    ) -> None:
        self.scene, self.goal, self.limits = replace(scene, limits=limits, tolerances=None), goal, limits
        self.keys = tuple(bounds)
        self.by = self.keys if exact else ()
        self.low, self.high = np.array(list(bounds.values()), dtype=float).T
        self.history: list[Trial] = []
        self.start = 0
        self._known: dict[bytes, Design] = {}

    @property
    def span(self) -> Array:
        """What gradients by free numbers are multiplied by, to be by x."""
        return (self.high - self.low)[: len(self.by)]

    def values(self, x: Array) -> dict[str, float]:
        """Numbers of a design x in [0, 1]."""
        inside = np.clip(x, 0.0, 1.0)
        return dict(zip(self.keys, (self.low + (self.high - self.low) * inside).tolist(), strict=True))

    def at(self, x: Array) -> Design:
        """The design of free numbers x (n,), each from 0 to 1 between its bounds."""
        key = np.round(np.clip(x, 0.0, 1.0), 14).tobytes()
        if key not in self._known:
            found = self._solved(self.values(x))
            self.history.append(found.trial)
            recent = _RECENT + len(self.keys) - len(self.by)  # their results are large
            kept = list(self._known.items())[1 - recent :]
            self._known = dict([*kept, (key, found)])
        return self._known[key]

    def _solved(self, values: Mapping[str, float]) -> Design:
        try:
            scene = replaced(self.scene, values)
        except ValueError as error:  # a rule between numbers, as the sum of two angles
            return self._without(values, str(error))
        result = trace(scene) if scene.motion else solve(scene)
        objective, over = self.goal.value(result), violation(self.limits, result)
        reason = _reason(result) or (None if np.isfinite(over) else "a limit is on what the result does not have")
        if reason or objective is None:
            return self._without(values, reason or f"the result has no {self.goal.name}")
        from gripper.sensitivity.curves import curves  # heavy, and only wanted once something is sought

        found = curves(result, self.by)
        trial = Trial(start=self.start, values=values, objective=objective, violation=over)
        return Design(found, trial)

    def _without(self, values: Mapping[str, float], reason: str) -> Design:
        trial = Trial(start=self.start, values=values, objective=None, violation=float("inf"), reason=reason)
        return Design(None, trial)


def _reason(result: Result) -> str | None:
    """Why a result is no answer: a pose that failed or is locked."""
    for pose in result.poses:
        if pose.status in ("failed", "locked"):
            return f"{pose.status}: {pose.reason}"
    return None


def violation(limits: Limits, result: Result) -> float:
    """The largest violation of a limit, relative to its bound; 0 where all are kept."""
    worst = 0.0
    for verdict in judged(limits, result.summary()):
        if verdict.value is None:
            worst = worst if verdict.passed else float("inf")
            continue
        over = verdict.value - verdict.bound if verdict.limit.startswith("max_") else verdict.bound - verdict.value
        worst = max(worst, over / (abs(verdict.bound) or 1.0))
    return worst
