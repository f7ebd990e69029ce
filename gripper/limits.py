"""Limits on the summary's numbers, and whether a result keeps them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

from gripper.fields import Finite, check_fields
from gripper.names import known_names
from gripper.results.summary import QUANTITIES, Summary

LIMITS = tuple(f"{side}_{name}" for name in QUANTITIES for side in ("max", "min"))
"""Names of all limits: max_ or min_ before a quantity of the summary."""
_NOTHING = 0.01  # of what is asked for: less of it counts as this


@dataclasses.dataclass(frozen=True)
class Limits:
    """Largest and least values that a design asks for.

    Parameters
    ----------
    bounds
        By name, in SI units: ``{"max_insertion_force": 6.0, "min_retention_force": 12.0}``; the names are
        ``max_`` or ``min_`` and a quantity of :class:`gripper.results.summary.Summary`.

    Raises
    ------
    LookupError
        A name that is none; lists the known ones.
    """

    bounds: tuple[tuple[str, Finite], ...]

    def __init__(self, bounds: Mapping[str, float] | tuple[tuple[str, float], ...]) -> None:
        pairs = tuple(bounds.items()) if isinstance(bounds, Mapping) else tuple(bounds)
        object.__setattr__(self, "bounds", pairs)
        check_fields(self)
        for name, _ in pairs:
            if name not in LIMITS:
                raise LookupError(f"unknown limit {name!r}; known: {known_names(name, LIMITS)}")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Verdict:
    """Whether one limit is kept.

    Parameters
    ----------
    limit, bound
        Its name and value.
    passed
        Whether it is known to be kept.
    value, at
        Of the quantity, and the motion's parameter of the pose that decides; None where not known, or of no pose.
    reason
        Why it is passed or failed without a value, or failed in spite of it.
    """

    limit: str
    bound: float
    passed: bool
    value: float | None = None
    at: float | None = None
    reason: str | None = None

    @property
    def quantity(self) -> str:
        """Name of the quantity."""
        return self.limit[4:]

    @property
    def excess(self) -> float:
        """By what share the value must still fall or rise; 0 where the limit is kept, infinite where it is not known.

        Twice what is allowed and half of what is asked for are both 1; of a margin it is the strain that must fall.
        """
        if self.value is None:
            return 0.0 if self.passed else math.inf
        largest, value, bound = self.limit.startswith("max_"), self.value, self.bound
        if self.quantity.endswith("margin"):
            largest, value, bound = not largest, 1 - value, 1 - bound
        if bound <= 0:
            return max((value - bound) * (1 if largest else -1), 0.0) / (abs(bound) or 1.0)
        share = value / bound
        return max(share - 1 if largest else 1 / max(share, _NOTHING) - 1, 0.0)


def judged(limits: Limits, summary: Summary) -> tuple[Verdict, ...]:
    """Judge each limit; one that cannot be shown to be kept, as where poses failed, is not passed."""
    return tuple(_verdict(name, bound, summary) for name, bound in limits.bounds)


def _verdict(name: str, bound: float, summary: Summary) -> Verdict:
    value, at = getattr(summary, name[4:]), summary.place(name[4:])
    if value is None:
        passed, why = _without_value(name, summary)
        return Verdict(limit=name, bound=bound, passed=passed, reason=why)
    kept = value <= bound if name.startswith("max_") else value >= bound
    unshown = summary.failed > 0 and kept
    reason = f"not shown: {summary.failed} of {summary.poses} poses failed" if unshown else None
    return Verdict(limit=name, bound=bound, passed=kept and not unshown, value=value, at=at, reason=reason)


def _without_value(name: str, summary: Summary) -> tuple[bool, str]:
    """Judge what has no number: a finger that is locked in holds against any force."""
    locked_in = summary.locked > 0 and summary.insertion_force is not None
    if locked_in and name in ("min_retention_force", "min_retention_ratio"):
        return True, "locked: no force pulls it out"
    if summary.locked > 0 and name[4:] in ("insertion_force", "retention_force", "retention_ratio"):
        return False, "locked: friction holds the finger for any force"
    return False, f"not known: {_WHY.get(name[4:], 'the scene has none')}"


_WHY = {
    "retention_force": "the motion does not come back (back = true)",
    "retention_ratio": "the motion does not come back (back = true), or needs no force to insert",
    "insertion_force": "the scene has no motion, or no pose of it has an answer",
    "strain_margin": "the material has no yield_strain",
    "repeated_strain_margin": "the material has no yield_strain",
}
