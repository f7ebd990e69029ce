"""What an optimisation found, and every design that it tried: plain data."""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Mapping

from gripper.limits import Verdict
from gripper.optimize.goal import Goal
from gripper.result import Result
from gripper.results.summary import QUANTITIES
from gripper.scene import Scene

_NEAR = 1e-6  # of a range: nearer, a number is at its bound


@dataclasses.dataclass(frozen=True, kw_only=True)
class Trial:
    """A design that was solved.

    Parameters
    ----------
    start
        From which start it was reached, from 0.
    values
        Its free numbers, in SI units.
    objective
        Of the result; None where it has none.
    violation
        By what share the number that violates its limit most must change; 0 where all are kept.
    reason
        Why it is no answer, or None.
    """

    start: int
    values: Mapping[str, float]
    objective: float | None
    violation: float
    reason: str | None = None


@dataclasses.dataclass(frozen=True, kw_only=True)
class Optimum:
    """The best design, beside the one from which the search began.

    Parameters
    ----------
    scene, result
        Of the best design.
    before
        The result of the given scene.
    goal
        What was wanted.
    values
        The free numbers of the best design, in SI units.
    bounds
        Between which they were free.
    objective, objective_before
        Of both designs.
    verdicts
        How the best design keeps the limits.
    history
        Every design that was solved, in order.
    message
        How the search from each start ended, a line each.
    """

    scene: Scene
    result: Result
    before: Result
    goal: Goal
    values: Mapping[str, float]
    bounds: Mapping[str, tuple[float, float]]
    objective: float | None
    objective_before: float | None
    verdicts: tuple[Verdict, ...]
    history: tuple[Trial, ...]
    message: str

    @property
    def evaluations(self) -> int:
        """How many designs were solved, each with its gradients."""
        return len(self.history)

    @property
    def kept(self) -> bool:
        """Whether the best design has an answer and keeps all limits."""
        return self.objective is not None and all(verdict.passed for verdict in self.verdicts)

    def history_csv(self) -> str:
        """Write the history as a table: one row a design, empty cells where it has no answer."""
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(["start", *self.values, self.goal.name, "violation", "reason"])
        for trial in self.history:
            objective = "" if trial.objective is None else repr(trial.objective)
            row = [repr(value) for value in trial.values.values()]
            table.writerow([trial.start, *row, objective, repr(trial.violation), trial.reason or ""])
        return text.getvalue()

    def __str__(self) -> str:
        """Before and after, number by number."""
        from gripper.parameters import numbers

        old = numbers(self.before.scene)
        lines = [f"{'':32}{'before':>12}{'after':>12}   between"]
        for key, value in self.values.items():
            low, high = self.bounds[key]
            between = f"{low:.5g} and {high:.5g}{_at_bound(value, low, high)}"
            lines.append(f"{key:32}{old.get(key, 0.0):12.5g}{value:12.5g}   {between}")
        summaries = self.before.summary(), self.result.summary()
        named = {self.goal.name: (self.goal.unit, self.objective_before, self.objective)}
        for verdict in self.verdicts:
            name = verdict.quantity
            named.setdefault(name, (QUANTITIES[name], *(getattr(summary, name) for summary in summaries)))
        lines += [f"{name:32}{_shown(a):>12}{_shown(b):>12} {unit}".rstrip() for name, (unit, a, b) in named.items()]
        lines += [f"{verdict.limit} {verdict.bound:.5g}: {_judged(verdict)}" for verdict in self.verdicts]
        if not self.kept:
            lines.append("NO DESIGN WAS FOUND THAT KEEPS ALL LIMITS: this one violates them least")
        return "\n".join([*lines, f"{self.evaluations} designs solved", self.message])


def _at_bound(value: float, low: float, high: float) -> str:
    """Whether a number would go on: what a designer may want to free further."""
    near = _NEAR * (high - low)
    return ", at its least" if value - low < near else ", at its largest" if high - value < near else ""


def _judged(verdict: Verdict) -> str:
    """Whether a limit is kept, and if not, by how much."""
    if verdict.passed:
        return "kept"
    if verdict.value is None:
        return f"NOT KEPT: {verdict.reason}"
    off = abs(verdict.value - verdict.bound) / (abs(verdict.bound) or 1.0)
    side = "large" if verdict.limit.startswith("max_") else "small"
    return f"NOT KEPT: {verdict.value:.5g}, {100 * off:.3g} % too {side}"


def _shown(value: float | None) -> str:
    return "none" if value is None else f"{value:.5g}"
