"""A work-precision study as data, CSV and table."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

from gripper.scene import Scene
from gripper.study.outcome import QUANTITIES

_FINER = 10.0  # how much finer than an error the reference must be to tell it
_SHOWN = ("force", "energy", "place", "depth")


@dataclass(frozen=True)
class Work:
    """One point of the diagram.

    Parameters
    ----------
    method, point
        Which method, and its resolution in words.
    unknowns, iterations, evaluations
        Of its optimiser; points at which g was evaluated.
    setup, cold, warm
        CPU time, in s: getting ready (a model that is built), a pose from nothing and from its neighbour's answer
        (medians); None where it failed.
    median, worst
        Errors by quantity over the shifts that were answered.
    failures
        Reasons, one a shift that was not answered.
    warm_failure
        Why the neighbour's answer leads nowhere; empty where it does.
    """

    method: str
    point: str
    unknowns: int
    iterations: int
    evaluations: int
    setup: float
    cold: float | None
    warm: float | None
    median: dict[str, float]
    worst: dict[str, float]
    failures: tuple[str, ...]
    warm_failure: str = ""


@dataclass(frozen=True)
class WorkPrecision:
    """A work-precision study of one pose.

    Parameters
    ----------
    scene
        Of one pose.
    works
        In the order of the methods.
    uncertainty
        Of the reference, by quantity. It tells errors from ten times that on; smaller ones stand as that, with a "<".
    start_up
        CPU time, in s, of an interpreter that imports gripper, and of compiling this finger and object.
    repeats, shifts
        How often each call was timed, and how many places of the object the errors are over.
    notes
        What was left aside.
    """

    scene: Scene
    works: tuple[Work, ...]
    uncertainty: dict[str, float]
    start_up: tuple[float, float]
    repeats: int
    shifts: int
    notes: tuple[str, ...]

    @property
    def floor(self) -> dict[str, float]:
        """The least error that the reference can tell, by quantity."""
        return {name: _FINER * value for name, value in self.uncertainty.items()}

    def told(self, errors: dict[str, float]) -> dict[str, float]:
        """Errors, none less than the reference can tell."""
        return {name: max(value, self.floor[name]) for name, value in errors.items()}

    def csv(self) -> str:
        """Write one row a point, units in the column names; empty cells where there is no answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        pairs = [f"{name}_error_{kind}" for name in QUANTITIES for kind in ("median", "worst")]
        times = ["setup_ms", "cold_ms", "warm_ms"]
        counts = ["unknowns", "iterations", "evaluations"]
        writer.writerow(["method", "point", *counts, *times, *pairs, "below_reference", "failed", "why"])
        for work in self.works:
            cells = [f"{1e3 * t:.4g}" if t is not None else "" for t in (work.setup, work.cold, work.warm)]
            for name in QUANTITIES:
                cells += [f"{d[name]:.3e}" if name in d else "" for d in map(self.told, (work.median, work.worst))]
            below = " ".join(name for name, value in work.median.items() if value < self.floor[name])
            warm = [f"warm: {work.warm_failure}"] if work.warm_failure else []
            reasons = "; ".join(dict.fromkeys([*work.failures, *warm]))
            head = [work.method, work.point, work.unknowns, work.iterations, work.evaluations]
            writer.writerow([*head, *cells, below, len(work.failures), reasons])
        return text.getvalue()

    def table(self) -> str:
        """Write the points as a Markdown table."""
        columns = ["method", "at", "unknowns", "iterations", "set-up ms", "cold ms", "warm ms", *_SHOWN]
        return "\n".join([f"| {' | '.join(columns)} |", "|---" * len(columns) + "|", *map(self._row, self.works)])

    def _row(self, work: Work) -> str:
        times = [f"{1e3 * t:.3g}" if t is not None else "" for t in (work.setup, work.cold, work.warm)]
        times[2] = "failed" if work.warm_failure else times[2]
        cells = ["failed", "", "", ""]
        if work.median:
            cells = [_spread(work.median[n], work.worst[n], self.floor[n]) for n in _SHOWN]
        failed = f" ({len(work.failures)} of {self.shifts} failed)" if work.failures and work.median else ""
        counts = [str(work.unknowns), str(work.iterations)]
        return "| " + " | ".join([work.method + failed, work.point, *counts, *times, *cells]) + " |"

    def __str__(self) -> str:
        known = ", ".join(f"{name} {value:.0e}" for name, value in self.uncertainty.items() if name != "depth")
        begun, compiled = self.start_up
        text = [
            f"errors as median (worst) over {self.shifts} places of the object; CPU time as median of {self.repeats}",
            "force and energy relative, place of contact and depth by L",
            f"reference: shooting, uncertain by: {known}; it tells errors from ten times that on",
            f"once an interpreter: {begun:.2f} s to import, {1e3 * compiled:.0f} ms to compile finger and object",
            *self.notes,
        ]
        return "\n".join([self.table(), "", *text])


def _spread(median: float, worst: float, floor: float) -> str:
    """Both, where the reference can tell them."""
    return f"<{floor:.0e}" if worst < floor else f"{_told(median, floor)} ({worst:.0e})"


def _told(value: float, floor: float) -> str:
    return f"<{floor:.0e}" if value < floor else f"{value:.0e}"
