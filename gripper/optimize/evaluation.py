"""A design solved, with the rows and gradients that an optimiser needs of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gripper.arrays import Array
from gripper.limits import Limits, judged
from gripper.optimize.goal import Goal
from gripper.optimize.optimum import Trial
from gripper.optimize.rows import Asked, Rows
from gripper.optimize.scale import Scale
from gripper.parameters import replaced
from gripper.result import Result
from gripper.scene import Scene
from gripper.solve import solve
from gripper.trace import trace

Gradients = Literal["exact", "forward", "central"]
Progress = Callable[[int, float | None], None]
SLACK = 1e-4  # relative: a limit violated by less is kept, to the optimiser's tolerance
_STEP = 1e-6  # of a free number's range, for differences: peaks are located to 1e-9


@dataclass(frozen=True, eq=False)
class Best:
    """The best design so far."""

    trial: Trial
    result: Result


class Evaluator:
    """Solves designs, and keeps what came of each.

    Parameters
    ----------
    scene
        Whose numbers are changed.
    scale
        Of the free numbers.
    goal, limits
        What is wanted.
    gradients
        Where they are from: the sensitivities, or differences between designs, each of which counts.
    progress
        Called after each design with their number so far and the best objective.
    """

    def __init__(
        self,
        scene: Scene,
        scale: Scale,
        goal: Goal,
        limits: Limits,
        gradients: Gradients = "exact",
        progress: Progress | None = None,
    ) -> None:
        self.scene, self.goal, self.limits = replace(scene, limits=limits, tolerances=None), goal, limits
        self.scale, self.gradients, self.progress = scale, gradients, progress
        self.history: list[Trial] = []
        self.best: Best | None = None
        self.start = 0
        self.asked: Asked | None = None

    def at(self, x: Array) -> tuple[Rows | None, Trial]:
        """Rows of the design x (n,), each number from 0 to 1 between its bounds; None where it has no answer."""
        result, trial = self._solved(x)
        if result is None:
            return None, trial
        if self.asked is None:
            self.asked = Asked(self.goal, self.limits, abs(trial.objective or 0.0) or 1.0)
        if self.gradients == "exact":
            return self._rows(result, x, self.scale.keys), trial
        return self._differenced(self._rows(result, x), x), trial

    def _rows(self, result: Result, x: Array, by: tuple[str, ...] = ()) -> Rows:
        from gripper.sensitivity.curves import curves  # heavy, and only wanted once something is sought

        if self.asked is None:
            raise ValueError("a design must be solved before its rows are asked for; got none")
        return self.asked.rows(curves(result, by), self.scale.slopes(x)[: len(by)])

    def _differenced(self, here: Rows, x: Array) -> Rows:
        """The rows with slopes from designs beside; level where one of these has no answer."""
        slopes = np.zeros((len(here.values), len(x)))
        for i in range(len(x)):
            step = np.zeros(len(x))
            step[i] = _STEP if x[i] < 1 - _STEP else -_STEP
            sides = [x + step, x - step] if self.gradients == "central" and x[i] >= _STEP else [x + step]
            results = [self._solved(side)[0] for side in sides]
            if None not in results:
                values = [self._rows(result, x).values for result in results if result is not None]
                base = values[1] if len(values) == 2 else here.values
                slopes[:, i] = (values[0] - base) / (len(values) * step[i])
        return replace(here, slopes=slopes)

    def _solved(self, x: Array) -> tuple[Result | None, Trial]:
        numbers = dict(zip(self.scale.keys, self.scale.values(x).tolist(), strict=True))
        result, trial = self._tried(numbers)
        self.history.append(trial)
        if result is not None and (self.best is None or self._key(trial) < self._key(self.best.trial)):
            self.best = Best(trial, result)
        if self.progress is not None:
            self.progress(len(self.history), self.best.trial.objective if self.best else None)
        return result, trial

    def _key(self, trial: Trial) -> tuple[float, float]:
        """What is less for the better design: keeping the limits comes first."""
        sign = -1.0 if self.goal.sense == "maximize" else 1.0
        return (trial.violation if trial.violation > SLACK else 0.0, sign * (trial.objective or 0.0))

    def _tried(self, numbers: Mapping[str, float]) -> tuple[Result | None, Trial]:
        try:
            scene = replaced(self.scene, numbers)
        except ValueError as error:  # a rule between numbers, as the sum of two angles
            return None, self._without(numbers, str(error))
        result = trace(scene) if scene.motion else solve(scene)
        objective, over = self.goal.value(result), violation(self.limits, result)
        reason = _reason(result) or (None if np.isfinite(over) else "a limit is on what the result does not have")
        if reason or objective is None:
            return None, self._without(numbers, reason or f"the result has no {self.goal.name}")
        return result, Trial(start=self.start, values=numbers, objective=objective, violation=over)

    def _without(self, numbers: Mapping[str, float], reason: str) -> Trial:
        return Trial(start=self.start, values=numbers, objective=None, violation=float("inf"), reason=reason)


def _reason(result: Result) -> str | None:
    """Why a result is no answer: a pose that failed or is locked."""
    for pose in result.poses:
        if pose.status in ("failed", "locked"):
            return f"{pose.status}: {pose.reason}"
    return None


def violation(limits: Limits, result: Result) -> float:
    """By what share the number that violates its limit most must change; 0 where all are kept."""
    return max((verdict.excess for verdict in judged(limits, result.summary())), default=0.0)
