"""The equilibria behind a motion, from which the next one is predicted."""

from __future__ import annotations

from dataclasses import dataclass, field

from gripper.motion.branch import Along
from gripper.statics.equilibrium import Setting, State
from gripper.statics.steps import extrapolated, predicted

_FURTHEST = 3.0  # of the last step: the next one may be that much longer and still bend as it did
_REMEMBERED = 6


@dataclass
class Trail:
    """The last equilibria with the same contacts, before the one where a motion is.

    Parameters
    ----------
    setting
        Of the motion.
    """

    setting: Setting
    _before: list[Along] = field(default_factory=list)  # newest first

    def step(self, old: Along, new: Along, *, changed: bool) -> None:
        """Take in a step, on which contacts changed or stayed as they are."""
        same = not changed and old.equilibrium.state.kinds == new.equilibrium.state.kinds
        self._before = [old, *self._behind(old)][:_REMEMBERED] if same else []

    def forget(self) -> None:
        """What comes is no longer on the branch, or has other unknowns."""
        self._before = []

    def predicted(self, now: Along, change: float) -> State:
        """The state a change of the parameter further.

        By the polynomial through the last equilibria; along the tangent where they are few, bent as it has turned.

        Raises
        ------
        NoEquilibriumError
            At a limit point, where the tangent is vertical.
        """
        last, behind = now.parameter, []
        for at in self._behind(now):
            if (last - at.parameter) * change <= 0:
                break  # before that the motion went the other way
            last = at.parameter
            behind.append((last, at.equilibrium))
        guess = extrapolated(self.setting, [(now.parameter, now.equilibrium), *behind], now.parameter + change)
        if guess is not None:
            return guess
        if behind and abs(change) < _FURTHEST * abs(now.parameter - behind[0][0]):
            return predicted(self.setting, now.equilibrium, change, (behind[0][1], now.parameter - behind[0][0]))
        return predicted(self.setting, now.equilibrium, change)

    def _behind(self, now: Along) -> list[Along]:
        """What is remembered, if it has the contacts of where the motion is now."""
        same = self._before and self._before[0].equilibrium.state.kinds == now.equilibrium.state.kinds
        return self._before if same else []
