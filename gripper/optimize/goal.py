"""What is wanted of a design, in the summary's names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from gripper.names import known_names
from gripper.result import Result
from gripper.results.summary import QUANTITIES

Sense = Literal["minimize", "maximize", "flatten"]


@dataclass(frozen=True)
class Goal:
    """The objective.

    Parameters
    ----------
    sense
        "minimize" or "maximize" a quantity of the summary, or "flatten" one that every pose has: make its variation
        over the poses, (largest - least) / mean, as small as can be.
    quantity
        As :class:`gripper.results.summary.Summary` names it.

    Raises
    ------
    LookupError
        A quantity that the summary does not have, or that cannot be flattened; lists the known ones.
    """

    sense: Sense
    quantity: str

    def __post_init__(self) -> None:
        if self.sense not in get_args(Sense):
            raise ValueError(f"sense must be one of {', '.join(get_args(Sense))}; got {self.sense!r}")
        from gripper.sensitivity.curves import CURVES  # heavy, and only wanted once something is sought

        known = tuple(CURVES) if self.sense == "flatten" else DIFFERENTIATED
        if self.quantity not in known:
            raise LookupError(f"unknown quantity to {self.sense} {self.quantity!r}; known: {known_names('', known)}")

    @property
    def name(self) -> str:
        """What its value is."""
        return f"variation of {self.quantity}" if self.sense == "flatten" else self.quantity

    @property
    def unit(self) -> str:
        """Of its value."""
        return "" if self.sense == "flatten" else QUANTITIES[self.quantity]

    def value(self, result: Result) -> float | None:
        """Of a result; None where it has none."""
        if self.sense != "flatten":
            found: float | None = getattr(result.summary(), self.quantity)
            return found
        from gripper.sensitivity.curves import curve

        values = curve(result, self.quantity)
        if values is None or not values.mean():
            return None
        return float((values.max() - values.min()) / abs(values.mean()))


DIFFERENTIATED = (
    *("insertion_force", "retention_force", "retention_ratio"),
    *("strain", "strain_margin", "repeated_strain_margin", "force_on_object"),
)
"""Quantities of the summary that have exact gradients."""
