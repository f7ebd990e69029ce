"""Where an equilibrium ends: the finger falls to the next one, or to none."""

from __future__ import annotations

import numpy as np

from gripper.motion.branch import Along, Path
from gripper.motion.events import STRUT, Change
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.snap import descend
from gripper.statics.verified import Verified

BEYOND = 2e-3
"""Of L: how far behind a limit point the descent starts."""
_ALIKE = 0.05  # of a step
_LEAVES = "the equilibrium ends here: the finger leaves for another"


def alike(start: float, one: float, other: float) -> bool:
    """Whether steps from a parameter to two others are the same but for how the path bends towards its target."""
    return abs(one - other) <= _ALIKE * abs(other - start)


class Falls:
    """The falls of a motion; a descent that came to nothing is not tried again from where it began.

    Parameters
    ----------
    setting, path
        Of the motion.
    """

    def __init__(self, setting: Setting, path: Path) -> None:
        self.setting, self.path = setting, path
        self._vain: tuple[State, float, NoEquilibriumError] | None = None

    def fallen(self, here: Along, following: float, order: int, error: NoEquilibriumError) -> tuple[Verified, Change]:
        """The equilibrium to which the finger falls, forces no longer nearly balancing a little beyond its last one.

        Raises
        ------
        NoEquilibriumError
            Where it falls to none; of a free finger the error that it was stopped by.
        """
        start = here.equilibrium.state
        if not start.sites:
            raise error
        on_end = all(self.setting.outline.place(site.piece, np.zeros(1))[0] == "tip" for site in start.sites)
        vain = self._vain
        if vain is not None and vain[0] is start and alike(here.parameter, vain[1], following):
            raise vain[2]  # at every pose beyond it would be the same descent
        try:
            found = descend(self.setting, self.setting.obstacle(self.path.frame(following)), start, order)
        except NoEquilibriumError as failure:
            told = NoEquilibriumError(f"{STRUT}; {failure}" if on_end else str(failure))
            self._vain = start, following, told
            raise told from failure
        return found, Change(here.parameter, "snap", STRUT if on_end else _LEAVES)
