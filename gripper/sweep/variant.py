"""One variant: what a worker does. Needs nothing but its arguments, and raises nothing."""

from __future__ import annotations

from collections.abc import Mapping

from gripper.parameters import replaced
from gripper.result import Result
from gripper.results.summary import Summary
from gripper.scene import Scene
from gripper.solve import solve
from gripper.trace import trace


def solved(scene: Scene, numbers: Mapping[str, float]) -> Summary | str:
    """Follow a scene with other numbers.

    Returns
    -------
    Its summary; the reason where it has none: a number that breaks a rule, or poses without an answer.
    """
    try:
        variant = replaced(scene, numbers)
        result = trace(variant) if variant.motion else solve(variant)
    except Exception as error:  # a plugin's code may raise anything; the row keeps what
        return " ".join(f"{'' if isinstance(error, ValueError) else f'{type(error).__name__}: '}{error}".split())
    return _failure(result) or result.summary()


def _failure(result: Result) -> str | None:
    if not result.failed:
        return None
    return f"{len(result.failed)} of {len(result.poses)} poses failed: {result.failed[0].reason}"
