"""The search: SLSQP from several starts, peaks in epigraph form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from scipy.optimize import minimize as scipy_minimize

from gripper.arrays import Array
from gripper.limits import Limits, judged
from gripper.optimize.evaluation import Design, Evaluator
from gripper.optimize.goal import DIFFERENTIATED, Goal
from gripper.optimize.optimum import Optimum
from gripper.parameters import number, replaced
from gripper.scene import Scene
from gripper.solve import solve
from gripper.trace import trace

if TYPE_CHECKING:
    from gripper.sensitivity.curves import Curves

_PRICE = 100.0  # of the slack: more than a limit's multiplier, objective and limits being relative
_UNSOLVED = -10.0  # what every constraint is where a design has no answer: a line search turns back
_SLACK = 1e-4  # relative: a limit violated by less is kept, to the optimiser's tolerance
_INSIDE = 2e-4  # relative: how much inside the limits the optimiser is asked to stay
_STEP = 1e-6  # of a free number's range, for differences: peaks are located to 1e-9
Progress = Callable[[int, float | None], None]


def optimize(
    scene: Scene,
    free: Mapping[str, tuple[float, float]],
    *,
    minimize: str | None = None,
    maximize: str | None = None,
    flatten: str | None = None,
    limits: Limits | Mapping[str, float] | None = None,
    starts: int = 3,
    seed: int = 0,
    iterations: int = 40,
    gradients: Literal["exact", "differences"] = "exact",
    progress: Progress | None = None,
) -> Optimum:
    """Find the numbers with which a scene does best.

    Parameters
    ----------
    scene
        Where the first start is; its limits count too, unless others are given.
    free
        Least and largest value of each free number by its key, in SI units.
    minimize, maximize, flatten
        One of them: the quantity of the summary that is wanted small or large, or the one whose variation over the
        poses, (largest - least) / mean, is wanted small.
    limits
        On quantities of the summary, as in a scene.
    starts
        How many: the scene itself, then points of a Latin hypercube between the bounds.
    seed
        Of that hypercube.
    iterations
        Of SLSQP, at most, from each start.
    gradients
        "differences" takes those of SciPy instead of the exact ones: to compare with, it is no use otherwise.
    progress
        Called after each design with their number so far and the best objective.

    Raises
    ------
    LookupError
        An unknown number, quantity or limit; lists the known ones.
    ValueError
        Not one objective; bounds that are none; a scene that cannot be differentiated.
    """
    goal = _goal(minimize=minimize, maximize=maximize, flatten=flatten)
    wanted = _limits(scene, limits)
    bounds = {key: _bounds(scene, key, pair) for key, pair in free.items()}
    if not bounds:
        raise ValueError("free must hold at least one number; got none")
    evaluator = Evaluator(scene, bounds, goal, wanted, exact=gradients == "exact")
    messages = []
    for start, x in enumerate(_starts(evaluator, scene, starts, seed)):
        evaluator.start = start
        messages.append(_descend(evaluator, x, iterations, progress))
    return _best(evaluator, scene, bounds, messages)


def _goal(**wanted: str | None) -> Goal:
    given = [(sense, quantity) for sense, quantity in wanted.items() if quantity is not None]
    if len(given) != 1:
        raise ValueError(f"one of minimize, maximize and flatten must be given; got {len(given)} of them")
    return Goal(*given[0])  # type: ignore[arg-type]  # the keywords are the senses


def _limits(scene: Scene, limits: Limits | Mapping[str, float] | None) -> Limits:
    """The limits that count, each on a quantity with a gradient."""
    found = (
        limits if isinstance(limits, Limits) else Limits(limits) if limits is not None else scene.limits or Limits({})
    )
    for name, _ in found.bounds:
        if name[4:] not in DIFFERENTIATED:
            raise ValueError(f"limits must be on {', '.join(DIFFERENTIATED)}, to be optimised within; got {name!r}")
    return found


def _bounds(scene: Scene, key: str, pair: tuple[float, float]) -> tuple[float, float]:
    number(scene, key)
    low, high = map(float, pair)
    if not low < high:
        raise ValueError(f"bounds of {key} must be two numbers, the first smaller, in SI units; got {pair!r}")
    return low, high


def _starts(evaluator: Evaluator, scene: Scene, count: int, seed: int) -> list[Array]:
    values = np.array([number(scene, key) for key in evaluator.keys])
    first = np.clip((values - evaluator.low) / (evaluator.high - evaluator.low), 0.0, 1.0)
    from scipy.stats import qmc  # heavy, and only wanted once something is sought

    others = qmc.LatinHypercube(d=len(first), rng=seed).random(max(count - 1, 0))
    return [first, *others]


@dataclass(frozen=True, eq=False)
class _Rows:
    """Constraints that must be at least 0, and their gradients by the free numbers (x) and by the levels (t)."""

    values: Array
    by_x: Array
    by_t: Array


class _Program:
    """The smooth problem in x, levels t and a slack v: minimise the upper level (less the lower one), peaks below it.

    The slack lets limits be violated at a price, so that a start that keeps none of them leads to where all are kept.

    Everything is relative: curves by the objective at the start, limits by their bounds.
    """

    def __init__(self, evaluator: Evaluator, start: Design) -> None:
        self.evaluator, self.goal = evaluator, evaluator.goal
        self.levels = 2 if self.goal.sense == "flatten" else 1
        objective = start.trial.objective or 1.0
        self.unit = 1.0 if self.goal.sense == "flatten" else abs(objective) or 1.0
        self.last = self._rows(start)

    def rows(self, y: Array) -> _Rows:
        """All constraints at (x, t)."""
        n = len(self.evaluator.keys)
        design = self.evaluator.at(y[:n])
        if design.curves is None:
            return _Rows(np.full(len(self.last.values), _UNSOLVED), self.last.by_x, self.last.by_t)
        self.last = found = self._rows(design)
        return _Rows(found.values + found.by_t @ y[n:], found.by_x, found.by_t)

    @property
    def weights(self) -> Array:
        """Of the levels and the slack in what is minimised."""
        return np.array([*[1.0, -1.0][: self.levels], _PRICE])

    def start(self, x: Array) -> Array:
        """Where to begin: the levels just around what the start has."""
        signs, offsets = self.last.by_t, self.last.values
        if self.levels == 2:
            upper, lower = signs[:, 0] > 0, signs[:, 1] < 0
            levels = [float(np.max(-offsets[upper])), float(np.min(offsets[lower]))]
        else:
            levels = [float(np.max(-offsets[signs[:, 0] > 0]))]
        slack = float(np.max(-offsets[signs[:, -1] > 0], initial=0.0))
        return np.append(x, [*levels, slack])

    def _rows(self, design: Design) -> _Rows:
        curves = design.curves
        if curves is None:
            raise ValueError(f"a start must have an answer; got {design.trial.reason}")
        parts = [self._objective(curves)]
        parts += [self._limit(name, bound, curves) for name, bound in self.evaluator.limits.bounds]
        return _Rows(*(np.concatenate([getattr(part, f) for part in parts]) for f in ("values", "by_x", "by_t")))

    def _objective(self, curves: Curves) -> _Rows:
        """Levels against the curve: t >= f for all poses and the located peak; t_low <= f."""
        span = self.evaluator.span
        if self.goal.sense == "flatten":
            values, slopes = curves.along(self.goal.quantity)
            mean = values.mean()
            shape = values / mean
            by_x = (slopes - shape[:, None] * slopes.mean(axis=0)) / mean * span
            ones = np.ones((len(values), 1))
            by_t = np.block([[ones, 0 * ones, 0 * ones], [0 * ones, -ones, 0 * ones]])
            return _Rows(np.concatenate([-shape, shape]), np.concatenate([-by_x, by_x]), by_t)
        sign = -1.0 if self.goal.sense == "maximize" else 1.0
        values, slopes = self._peaks(curves, self.goal.quantity, sign > 0)
        by_x = -sign * slopes * span / self.unit
        return _Rows(-sign * values / self.unit, by_x, np.tile([1.0, 0.0], (len(values), 1)))

    @staticmethod
    def _peaks(curves: Curves, quantity: str, every: bool) -> tuple[Array, Array]:
        """The located peak and, where a largest value is to be kept down, what all poses have."""
        value, slope = curves.peak(quantity)
        from gripper.sensitivity.curves import CURVES

        if not every or quantity not in CURVES:
            return np.array([value]), slope[None]
        values, slopes = curves.along(quantity)
        return np.append(values, value), np.concatenate([slopes, slope[None]])

    def _limit(self, name: str, bound: float, curves: Curves) -> _Rows:
        size, span = abs(bound) or 1.0, self.evaluator.span
        sign = -1.0 if name.startswith("max_") else 1.0
        values, slopes = self._peaks(curves, name[4:], sign < 0)
        rows = sign * (values - bound) / size - _INSIDE
        by_t = np.zeros((len(values), self.levels + 1))
        by_t[:, -1] = 1.0
        return _Rows(rows, sign * slopes * span / size, by_t)


def _descend(evaluator: Evaluator, x: Array, iterations: int, progress: Progress | None) -> str:
    """SLSQP from one start; how it ended."""
    first = evaluator.at(x)
    if first.curves is None:
        return f"start {evaluator.start} has no answer: {first.trial.reason}"
    program = _Program(evaluator, first)
    n, levels = len(x), program.levels
    weights = np.concatenate([np.zeros(n), program.weights])

    def told(_: Array) -> None:
        if progress is not None:
            progress(len(evaluator.history), _best_trial(evaluator)[1])

    constraint: dict[str, Any] = {"type": "ineq", "fun": lambda y: program.rows(y).values}
    if evaluator.by:
        constraint["jac"] = lambda y: np.hstack([(found := program.rows(y)).by_x, found.by_t])
    answer = scipy_minimize(
        lambda y: (float(weights @ y), weights),
        program.start(x),
        jac=True,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * n + [(None, None)] * levels + [(0.0, None)],
        constraints=[constraint],
        callback=told,
        options={"ftol": 1e-5, "maxiter": iterations, "eps": _STEP},
    )
    return f"start {evaluator.start}: {answer.message.lower()} after {answer.nit} iterations"


def _best_trial(evaluator: Evaluator) -> tuple[int, float | None]:
    """The design with the best objective among those that keep the limits, or else the one that violates them least."""
    sign = -1.0 if evaluator.goal.sense == "maximize" else 1.0
    known = [(i, t) for i, t in enumerate(evaluator.history) if t.objective is not None]
    if not known:
        return -1, None
    keeping = [(i, t) for i, t in known if t.violation <= _SLACK]
    if keeping:
        best = min(keeping, key=lambda item: sign * (item[1].objective or 0.0))
    else:
        best = min(known, key=lambda item: item[1].violation)
    return best[0], best[1].objective


def _best(
    evaluator: Evaluator, scene: Scene, bounds: Mapping[str, tuple[float, float]], messages: list[str]
) -> Optimum:
    before = trace(scene) if scene.motion else solve(scene)
    i, objective = _best_trial(evaluator)
    if i < 0:
        reasons = "; ".join(messages)
        raise ValueError(f"free must allow a design that has an answer; got none: {reasons}")
    values = evaluator.history[i].values
    best = replaced(evaluator.scene, values)
    result = trace(best) if best.motion else solve(best)
    return Optimum(
        scene=best,
        result=result,
        before=before,
        goal=evaluator.goal,
        values=values,
        bounds=bounds,
        objective=objective,
        objective_before=evaluator.goal.value(before),
        verdicts=judged(evaluator.limits, result.summary()),
        history=tuple(evaluator.history),
        message="; ".join(messages),
    )
