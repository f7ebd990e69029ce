"""Derivatives of what is largest along a motion.

Where a number f is stationary along the motion q, its place may be held (the envelope theorem), and moves as f_q = 0
asks: q_p = -f_qp / f_qq (:mod:`gripper.sensitivity.second`). Where it is largest because something changes there (a
contact reaches the end of its edge, a hold is lost), the place moves with what changes: f_p + f_q q_p, q_p from the
condition of the change.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.outline import LOWER, UPPER
from gripper.contact.site import Site
from gripper.motion.branch import Along, Branch
from gripper.results.kept import Way
from gripper.sensitivity.jet import Jet, NotFormedError, value_of
from gripper.sensitivity.limits import FEEBLE, at_end
from gripper.sensitivity.locking_rates import nearness_rates
from gripper.sensitivity.numbers import Reading
from gripper.sensitivity.second import along_motion
from gripper.sensitivity.seeds import Seeds
from gripper.sensitivity.tangent import Rates
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.statics.holds import coefficient
from gripper.statics.newton import settle
from gripper.statics.profile import largest_strain

_STATIONARY = 1e-3  # of a number, over 1 % of the motion: what a peak that was located may still rise
_SHARP = 1e-8  # the same, where it is sharp enough
_CLIMBS = 4
_MEETING = 1e-5  # of L: how far a contact's twin on the next edge may be from the edge's end


@dataclass(frozen=True, eq=False)
class Peaking:
    """Derivatives of what is largest, (p,) each; None where they are not known."""

    value: Array | None = None
    place: Array | None = None
    """Of the motion's parameter there."""
    along: Array | None = None
    """Of the place on the finger, in m."""
    missing: str | None = None
    """Why some are not."""


class Summit:
    """What is largest at an equilibrium of a motion, and its rates.

    Parameters
    ----------
    seeds
        Of the numbers, with the motion's parameter after them where there is a motion.
    name
        What is largest: "motion_force", "max_strain", "force" or "locking".
    value
        About what it is: of locking, which several contacts have.
    way
        The motion's steps, from which the other side of a change is known; None where they are not.
    """

    def __init__(self, seeds: Seeds, name: str, value: float = 0.0, way: Way | None = None) -> None:
        self.seeds, self.name, self.value, self.way = seeds, name, value, way
        motion = seeds.scene.motion
        self.ends = (min(motion.values), max(motion.values)) if motion else None

    def rates(self, equilibrium: Equilibrium) -> Peaking:
        """Derivatives of the largest value by the numbers, and of its place."""
        here = self._read(equilibrium)
        parameter = equilibrium.obstacle.frame.parameter
        if parameter is None or self.ends is None:
            return Peaking(here, None, self._along(equilibrium, None))
        if parameter in self.ends:
            held = np.zeros(here.size - 1)
            return Peaking(here[:-1], held, self._along(equilibrium, held))
        moving = self._moving(equilibrium, parameter)
        if moving is not None:
            return Peaking(here[:-1] + moving * here[-1], moving, self._along(equilibrium, moving))
        if self._rise(here, equilibrium) > _STATIONARY:
            return Peaking()
        return self._smooth(equilibrium, parameter)

    def _smooth(self, equilibrium: Equilibrium, parameter: float) -> Peaking:
        """Of a number that is stationary along the motion, where second derivatives tell how its place moves."""
        top, rates, missing = self._climbed(equilibrium, parameter)
        along = self._along(top, None)
        if isinstance(rates, Jet):
            moving = -rates.rate[:-1] / rates.rate[-1]
            return Peaking(rates.value[:-1], moving, self._along(top, moving))
        held = along is not None and not along[-1]  # at the clamp, wherever the motion is
        why = f"where a smooth peak lies moves with second derivatives, which are not formed of {missing}"
        return Peaking(rates[:-1], None, along[:-1] if along is not None and held else None, why)

    def _moving(self, equilibrium: Equilibrium, parameter: float) -> Array | None:
        """How the place of a change moves along the motion with each number; None where nothing is seen to change."""
        seeds = self.seeds
        for known in itertools.chain([equilibrium], _twins(seeds.setting, equilibrium), self._before(parameter)):
            margin = _margin(seeds, known, seeds.solved(known).rates)
            if margin is not None and margin[-1]:
                moved: Array = -margin[:-1] / margin[-1]
                return moved
        return None

    def _before(self, parameter: float) -> Iterable[Equilibrium]:
        """The equilibria in which steps end there: with the hold that a contact had until it began to slip."""
        return (after.equilibrium for _, after, _ in self.way.steps if after.parameter == parameter) if self.way else ()

    def _along(self, equilibrium: Equilibrium, moving: Array | None) -> Array | None:
        """Derivatives of where on the finger the strain is largest, in m, as the place of the motion moves."""
        found = Reading(self.seeds, equilibrium).strain_place() if self.name == "max_strain" else None
        return found if found is None or moving is None else found[:-1] + moving * found[-1]

    def _read(self, equilibrium: Equilibrium) -> Array:
        if self.name == "locking":
            return nearness_rates(self.seeds, equilibrium, self.value)
        return self._number(Reading(self.seeds, equilibrium))

    def _number(self, reading: Reading) -> Array:
        named = {"motion_force": reading.drive, "max_strain": reading.strain, "force": reading.size}
        return named[self.name]()

    def _twice(self, equilibrium: Equilibrium) -> tuple[Array, str | None]:
        """The rates, carrying their own along the motion where these are formed, and for what they are not."""
        if self.name == "locking":
            return self._read(equilibrium), "locking, whose limit has second derivatives itself"
        try:
            return self._number(along_motion(self.seeds, equilibrium)), None
        except NotFormedError as error:
            return self._read(equilibrium), str(error)

    def _rise(self, here: Array, equilibrium: Equilibrium) -> float:
        """How much the number rises over 1 % of the motion, relative."""
        scales = self.seeds.setting.sections
        speed, force = abs(equilibrium.obstacle.frame.velocity), abs(equilibrium.force)
        sizes = {"force": force * scales.force_scale, "motion_force": force * speed * scales.energy_scale}
        size = sizes.get(self.name) or self.value or largest_strain(self.seeds.setting, equilibrium)[0]
        low, high = self.ends or (0.0, 0.0)
        return float(abs(here[-1]) * 1e-2 * (high - low) / size)

    def _climbed(self, equilibrium: Equilibrium, parameter: float) -> tuple[Equilibrium, Array, str | None]:
        """The equilibrium nearer to where the number is stationary, and its rates there: Newton's method on its slope.

        Where second derivatives are not formed, secants.
        """
        low, high = self.ends or (0.0, 0.0)
        setting, order = self.seeds.setting, equilibrium.state.beam.order
        branch = Branch(setting, self.seeds.kinematics, Along(parameter, equilibrium), order)
        (here, missing), place, step = self._twice(equilibrium), parameter, 1e-3 * (high - low)
        top, best = equilibrium, here
        for _ in range(_CLIMBS):
            if isinstance(here, Jet):
                step = -here.value[-1] / here.rate[-1]
            if self._rise(value_of(here), equilibrium) < _SHARP or not 0 < abs(step) < 1e-2 * (high - low):
                break
            try:
                found = branch.at(place + step)
            except NoEquilibriumError:
                break  # the branch ends: the peak is as near as it gets
            last, place, here = here, place + step, self._twice(found)[0]
            if missing:
                step *= here[-1] / (last[-1] - here[-1]) if last[-1] != here[-1] else 0.0
            if abs(value_of(here)[-1]) < abs(value_of(best)[-1]):
                top, best = found, here
        return top, best, missing


def _margin(seeds: Seeds, equilibrium: Equilibrium, found: Rates) -> Array | None:
    """Rates of what vanishes at a change: the way to an edge's end, a contact's force, what is left of mu."""
    outline, state = seeds.setting.outline, equilibrium.state
    largest = float(np.max(np.abs(state.multipliers), initial=0.0))
    row = column = 0
    for i, site in enumerate(state.sites):
        if at_end(site, outline):
            last = column + site.unknown_places - 1
            if site.place[0] < outline.pieces[site.piece].length / 2:
                return found.places[:, column]
            return found.places[:, last] - _length_rates(seeds, site)
        if state.multipliers[row] <= FEEBLE * largest:
            return found.multipliers[:, row]
        if site.grip is not None and site.grip.unknown:
            mu = coefficient(equilibrium, i)
            if mu - abs(site.grip.ratio) <= FEEBLE * mu:
                sign = float(np.sign(site.grip.ratio))
                return sign * found.places[:, column + site.unknown_places] - seeds.friction_rates(site)
        row, column = row + site.multipliers, column + site.unknowns
    return None


def _length_rates(seeds: Seeds, site: Site) -> Array:
    """Rates of the length of a contact's piece."""
    if site.piece in (LOWER, UPPER):
        return np.zeros(len(seeds.keys))
    return seeds.spread(seeds.finger.lengths()[:, site.piece - (UPPER + 1)])


def _twins(setting: Setting, equilibrium: Equilibrium) -> list[Equilibrium]:
    """The same equilibrium with a corner read as the end of an edge beside it: where an edge hands over to a corner."""
    outline, state = setting.outline, equilibrium.state
    out = []
    for i, site in enumerate(state.sites):
        if site.kind != "corner":
            continue
        corner = outline.corners[site.piece - len(outline.pieces)].point
        for number, piece in enumerate(outline.pieces):
            if number <= UPPER:
                ends = {setting.sections.thickness(np.ones(1))[0] / 2 * (1j if number == UPPER else -1j): 1.0}
            else:
                ends = {piece.start: 0.0, piece.start + piece.length * piece.direction: piece.length}
            place = next((u for end, u in ends.items() if abs(end - corner) < 1e-9), None)
            if place is None:
                continue
            twin = replace(site, kind="tangent", piece=number, place=(place,), grip=None)
            if setting.friction:
                (twin,) = setting.friction.dressed((site,), (twin,))
            sites = (*state.sites[:i], twin, *state.sites[i + 1 :])
            try:
                found = settle(setting, equilibrium.obstacle, replace(state, sites=sites), state.beam.order)
            except NoEquilibriumError:
                continue  # no such edge touches here
            settled = found.state.sites[i]
            if abs(settled.place[0] - place) < _MEETING:
                held = replace(settled, place=(place,))
                out.append(replace(found, state=replace(found.state, sites=(*sites[:i], held, *sites[i + 1 :]))))
    return out
