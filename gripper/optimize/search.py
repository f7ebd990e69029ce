"""The search for the best design: several starts, interrupted or not, and what it found."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gripper.arrays import Array
from gripper.limits import Limits, judged
from gripper.optimize.descent import Descent
from gripper.optimize.evaluation import Evaluator, Gradients, Progress
from gripper.optimize.goal import DIFFERENTIATED, Goal
from gripper.optimize.optimum import Optimum
from gripper.optimize.scale import Scale
from gripper.parameters import number
from gripper.result import Result
from gripper.scene import Scene
from gripper.solve import solve
from gripper.trace import trace


class Interrupted(KeyboardInterrupt):
    """A search was interrupted; ``optimum`` holds the best design so far, and the history."""

    def __init__(self, optimum: Optimum) -> None:
        super().__init__(f"{optimum.evaluations} designs are solved")
        self.optimum = optimum


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
    gradients: Gradients = "exact",
    progress: Progress | None = None,
) -> Optimum:
    """Find the numbers with which a scene does best.

    Parameters
    ----------
    scene
        Where the first start is; its limits count too, unless others are given. A search from a start ends where less
        than its ``tolerance`` is foretold to be gained.
    free
        Least and largest value of each free number by its key, in SI units.
    minimize, maximize, flatten
        One of them: the quantity of the summary that is wanted small or large, or the one whose variation over the
        poses, (largest - least) / mean, is wanted small.
    limits
        On quantities of the summary, as in a scene. Where no design keeps them all, the one that violates them least
        is found, and ``kept`` is False.
    starts
        How many: the scene itself, then points of a Latin hypercube between the bounds.
    seed
        Of that hypercube.
    iterations
        Steps, at most, from each start.
    gradients
        "forward" or "central" takes differences between designs, each of which counts, instead of the exact
        gradients: to compare with, it is no use otherwise.
    progress
        Called after each design with their number so far and the best objective.

    Raises
    ------
    LookupError
        An unknown number, quantity or limit; lists the known ones.
    ValueError
        Not one objective; bounds that are none; a scene that cannot be differentiated.
    Interrupted
        By Ctrl-C, once a design has an answer: a KeyboardInterrupt that holds what was found.
    """
    goal = _goal(minimize=minimize, maximize=maximize, flatten=flatten)
    wanted = _limits(scene, limits)
    bounds = {key: _bounds(scene, key, pair) for key, pair in free.items()}
    if not bounds:
        raise ValueError("free must hold at least one number; got none")
    evaluator = Evaluator(scene, Scale.of(bounds), goal, wanted, gradients, progress)
    descent = Descent(evaluator, scene.tolerance, iterations)
    before = trace(scene) if scene.motion else solve(scene)
    messages: list[str] = []
    try:
        for start, x in enumerate(_starts(evaluator.scale, scene, starts, seed)):
            evaluator.start = start
            messages.append(f"start {start}: {descent(x)}")
    except KeyboardInterrupt:
        if evaluator.best is None:
            raise
        raise Interrupted(_found(evaluator, before, bounds, [*messages, "interrupted"])) from None
    return _found(evaluator, before, bounds, messages)


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


def _starts(scale: Scale, scene: Scene, count: int, seed: int) -> list[Array]:
    first = scale.place(np.array([number(scene, key) for key in scale.keys]))
    from scipy.stats import qmc  # heavy, and only wanted once something is sought

    others = qmc.LatinHypercube(d=len(first), rng=seed).random(max(count - 1, 0))
    return [first, *others]


def _found(
    evaluator: Evaluator, before: Result, bounds: Mapping[str, tuple[float, float]], messages: list[str]
) -> Optimum:
    best = evaluator.best
    if best is None:
        reasons = "; ".join(messages)
        raise ValueError(f"free must allow a design that has an answer; got none: {reasons}")
    return Optimum(
        scene=best.result.scene,
        result=best.result,
        before=before,
        goal=evaluator.goal,
        values=best.trial.values,
        bounds=bounds,
        objective=best.trial.objective,
        objective_before=evaluator.goal.value(before),
        verdicts=judged(evaluator.limits, best.result.summary()),
        history=tuple(evaluator.history),
        message="\n".join(messages),
    )
