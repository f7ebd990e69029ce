"""The account of a motion with friction: work and loss, step by step, and the largest force of each leg."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gripper.motion.branch import Along, Path, branch_from, pointed, speed
from gripper.motion.peaks import Peak
from gripper.motion.work import BESIDE, REST, Pace, booked, drawn, pace
from gripper.results.loop import Loop
from gripper.statics.balance import Balance
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting

BALANCED = 5e-5
"""What may be missing of the energies of a step."""
_ASIDE = 2e-4  # of L
_KEPT = 3  # paces: of a step's ends, and of one that was too long

Part = tuple[float, Pace, float, Pace]


@dataclass(frozen=True)
class Entry:
    """What a step brings.

    Parameters
    ----------
    balance
        Behind it.
    peaks
        Its largest forces.
    off
        What is missing of its energies, relative to them.
    """

    balance: Balance
    peaks: tuple[Peak, ...]
    off: float


class Ledger:
    """Books the steps of a motion.

    Parameters
    ----------
    setting, path
        Of the motion.
    """

    balance = Balance()
    """Work put in and energy lost so far."""
    peaks: tuple[Peak, ...] = ()
    """The largest force of the drive, one a leg of the motion."""

    def __init__(self, setting: Setting, path: Path) -> None:
        self.setting, self.path = setting, path
        self._known: list[tuple[Along, float, Pace]] = []

    def pace(self, at: Along, heading: float) -> Pace:
        """The pace of an equilibrium, reckoned once.

        Raises
        ------
        NoEquilibriumError
            At a limit point.
        """
        if not at.equilibrium.state.sites:
            return REST
        for known, sign, found in self._known:
            if known.equilibrium is at.equilibrium and (known.parameter, sign) == (at.parameter, heading):
                return found
        found = pace(self.setting, self.path, at, heading)
        self._known = [*self._known[1 - _KEPT :], (at, heading, found)]
        return found

    def drawn_up(self, before: Along, after: Along, broken: list[float], heading: float, order: int) -> Entry:
        """What is to be booked of a step, and where contacts changed on it, in the order in which they did.

        Raises
        ------
        NoEquilibriumError
            At a limit point.
        """
        start, stop = self.pace(before, heading), self.pace(after, heading)
        parts: list[Part] = [(before.parameter, start, after.parameter, stop)]
        if broken:  # there the rates jump
            first = self._side(broken[0], before, start, heading, order)
            last = self._side(broken[-1], after, stop, heading, order)
            parts = [(before.parameter, start, broken[0], first), (broken[-1], last, after.parameter, stop)]
        balance, peaks = self.balance, []
        for begin, one, end, other in parts:
            following = booked(balance, one, other, end - begin)
            if not broken:
                following = self._checked(following, before, after, (one, other))
            balance = following
            peaks.append(Peak.of(begin, one, end, other, before if begin == before.parameter else after))
        stored = after.equilibrium.stored - before.equilibrium.stored
        size = abs(stored) + balance.loss - self.balance.loss
        return Entry(balance, tuple(peaks), abs(balance.imbalance(self.balance, stored)) / (size or 1.0))

    def enter(self, entry: Entry) -> None:
        """Take a step in."""
        self.balance = entry.balance
        for peak in entry.peaks:
            self._note(peak)

    def _checked(self, following: Balance, before: Along, after: Along, paces: tuple[Pace, Pace]) -> Balance:
        """The balance after a step; without the paces' rates where these are off.

        Where a contact is about to leave its edge, the rates are of what comes behind it.
        """
        stored = after.equilibrium.stored - before.equilibrium.stored
        off = abs(following.imbalance(self.balance, stored))
        if off <= BALANCED * (abs(stored) + following.loss - self.balance.loss):
            return following
        start, stop = (one.steady for one in paces)
        plain = booked(self.balance, start, stop, after.parameter - before.parameter)
        return plain if abs(plain.imbalance(self.balance, stored)) < off else following

    def fall(self, before: Along, after: Along, heading: float) -> None:
        """Take in a snap: the finger falls at once, then goes with its object; what it has lost by then is lost.

        Where it stands higher than before, it has not fallen: the drive has pushed it over an edge to which it stuck.

        Raises
        ------
        NoEquilibriumError
            At a limit point.
        """
        stop, way = self.pace(after, heading), after.parameter - before.parameter
        with_object = booked(Balance(), stop.carried(-way), stop, way)
        spilt = before.equilibrium.stored - (after.equilibrium.stored - with_object.work + with_object.loss)
        following = booked(self.balance, stop.carried(-way), stop, way)
        pushed = max(-spilt, 0.0)
        self.balance = replace(
            following,
            loss=following.loss + max(spilt, 0.0),
            work=following.work + pushed,
            put_in=following.put_in + pushed,
        )

    def loop(self, order: int) -> tuple[Loop | None, list[Equilibrium | None]]:
        """The loop so far, and the equilibria at its peaks, where they are known; None without contact."""
        unit, balance = self.setting.sections.energy_scale, self.balance
        tops = [peak.located(self.setting, self.path, order) for peak in self.peaks[:2]]
        if not tops:
            return None, []
        there, back = tops[0], tops[1] if len(tops) > 1 else None
        loop = Loop(
            peak_insertion_force=there.force * unit,
            peak_insertion_parameter=there.parameter,
            peak_retention_force=back.force * unit if back else None,
            peak_retention_parameter=back.parameter if back else None,
            ratio=back.force / there.force if back and there.force > 0 else None,
            work_in=balance.put_in * unit,
            work_out=balance.given_back * unit,
            dissipation=balance.loss * unit,
        )
        return loop, [top.equilibrium for top in tops]

    def _note(self, peak: Peak) -> None:
        """Keep the largest force of each leg of the motion."""
        if not peak.heading:
            return
        if not self.peaks or peak.heading != self.peaks[-1].heading:
            self.peaks = (*self.peaks, peak)
        elif peak.force > self.peaks[-1].force:
            self.peaks = (*self.peaks[:-1], peak)

    def _side(self, at: float, near: Along, known: Pace, heading: float, order: int) -> Pace:
        """The pace on one side of a change, on the branch of the step's end there.

        On a face it is drawn from a little aside of the change, where no segment of the finger is all but gone.
        """
        if not near.equilibrium.state.sites:
            return REST
        fast, way = speed(near.equilibrium), near.parameter - at
        if abs(way) * fast <= max(BESIDE) * _ASIDE:
            return known.carried(-way)
        part = float(np.sign(way)) * _ASIDE / fast
        try:
            near = replace(near, equilibrium=pointed(self.setting, near.equilibrium, order))
            branch = branch_from(self.setting, self.path, near, order)
            if not any(site.on_face for site in near.equilibrium.state.sites):
                return pace(self.setting, self.path, Along(at, branch.at(at)), heading)
            found = {parts: branch.at(at + parts * part) for parts in BESIDE[::-1]}
            return drawn([found[parts] for parts in BESIDE], part, heading)
        except NoEquilibriumError:
            return known.carried(-way)
