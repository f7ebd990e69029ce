"""What stays with a pose in the process that solved it: never written, never compared, left behind by a pickle."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gripper.motion.branch import Along, Path
    from gripper.statics.equilibrium import Equilibrium, Setting


@dataclass(frozen=True, eq=False, repr=False)
class Kept:
    """The equilibrium behind a pose's numbers, from which its sensitivities follow.

    Parameters
    ----------
    setting
        Finger, theory, object.
    equilibrium
        Converged, with its linearisation.
    """

    setting: Setting
    equilibrium: Equilibrium

    @functools.cached_property
    def exact(self) -> Equilibrium:
        """The equilibrium to round-off, as derivatives need it.

        Raises
        ------
        NoEquilibriumError
            At a limit point.
        """
        from gripper.statics.newton import polished  # results are read without the solver

        return polished(self.setting, self.equilibrium)

    def __reduce__(self) -> tuple[Any, tuple[()]]:
        return _nothing, ()


@dataclass(frozen=True, eq=False, repr=False)
class Way:
    """The steps of a motion in contact, from which the sensitivities of its work follow.

    Parameters
    ----------
    setting, path
        Finger, theory, object; where the object is.
    order
        Of the strain fields at its end.
    steps
        Their ends, and where contacts changed between, in the motion's order.
    """

    setting: Setting
    path: Path
    order: int
    steps: tuple[tuple[Along, Along, tuple[float, ...]], ...]

    def __reduce__(self) -> tuple[Any, tuple[()]]:
        return _nothing, ()


def _nothing() -> None:
    """What a pickle or a deep copy holds instead."""
