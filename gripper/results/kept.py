"""What stays with a pose in the process that solved it: never written, never compared, left behind by a pickle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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

    def __reduce__(self) -> tuple[Any, tuple[()]]:
        return _nothing, ()


def _nothing() -> None:
    """What a pickle or a deep copy holds instead."""
