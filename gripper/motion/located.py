"""What is largest along a motion, from what was watched of it, as plain numbers in SI units."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from gripper.contact.outline import dot
from gripper.motion.climb import Measure
from gripper.motion.watch import Watch
from gripper.results.extremes import Extreme, Extremes
from gripper.results.kept import Kept, Way
from gripper.results.loop import Loop
from gripper.results.pose_result import PoseResult
from gripper.scene import Scene
from gripper.statics.certificate import survey
from gripper.statics.clearance import clearance
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import Equilibrium, Setting, State
from gripper.statics.newton import settle
from gripper.statics.profile import largest_strain
from gripper.statics.verified import Verified

Number = Callable[[Equilibrium], float]
_NO_LOSS = 1e-6  # of the work put in: what is lost in less is no snap
_SHARP = 1e-6  # of the way between poses: where a distance is least
_LEGS = ("insertion_force", "retention_force")


def measures(scene: Scene, fixed: Setting) -> Mapping[str, Measure]:
    """What is watched of a scene's motion: strain and forces; with friction its locking, as the loop has the drive.

    Dimensionless: forces over EI(0) / L^2, the drive's over EI(0) / L.
    """
    force, power = _published(scene, fixed) or (lambda equilibrium: abs(equilibrium.force), drive)
    found = {
        "force_on_object": Measure(lambda equilibrium, heading: force(equilibrium)),
        "strain": Measure(lambda equilibrium, heading: largest_strain(fixed, equilibrium)[0]),
    }
    if fixed.friction is not None:
        from gripper.motion.locking import nearness

        return found | {"locking": Measure(lambda equilibrium, heading: nearness(fixed, equilibrium, heading))}
    return found | {
        "insertion_force": Measure(lambda equilibrium, heading: heading * power(equilibrium), leg=0),
        "retention_force": Measure(lambda equilibrium, heading: heading * power(equilibrium), leg=1),
        "backwards": Measure(lambda equilibrium, heading: -heading * power(equilibrium), leg=0),
    }


def _published(scene: Scene, fixed: Setting) -> tuple[Number, Number] | None:
    """Force and power with the published friction; None where it is not asked for. Poses without an answer have 0."""
    if scene.friction is None or not scene.friction.published:
        return None
    from gripper.contact.law import Law
    from gripper.statics.splitting import split_forces

    rule = Law.of(scene.friction, fixed.outline, fixed.sections.length)

    def forces(equilibrium: Equilibrium) -> np.ndarray:
        found = split_forces(rule, equilibrium) if len(equilibrium.state.sites) == 1 else None
        return found[0] if found else np.zeros(0, dtype=complex)

    def power(equilibrium: Equilibrium) -> float:
        found = forces(equilibrium)
        velocities = equilibrium.obstacle.velocities(np.concatenate(equilibrium.linear.points)) if found.size else found
        return float(np.sum(dot(found, velocities)))

    return lambda equilibrium: float(abs(forces(equilibrium).sum())), power


def ways(values: Sequence[float]) -> list[tuple[int, float]]:
    """How often a motion has turned before each of its poses, and the sign of the way there (of the first: on)."""
    headings = [float(np.sign(after - before)) for before, after in itertools.pairwise(values)]
    leg, heading = 0, next((h for h in headings if h), 0.0)
    found = [(leg, heading)]
    for way in headings:
        leg += heading * way < 0
        heading = way or heading
        found.append((leg, heading))
    return found


@dataclass(frozen=True, eq=False)
class Course:
    """How a motion went.

    Parameters
    ----------
    scene, fixed
        What was given: finger, theory, object.
    watch
        What was kept of its steps.
    order
        Of the strain fields at its end.
    poses
        As they came out.
    buckled
        Whether the finger met the object head-on on the way, as a strut.
    loop
        Of a motion with friction.
    locked
        Friction's nearness to locking where it locks the finger.
    peaks
        Equilibria at the peaks of the loop, where they are known.
    """

    scene: Scene
    fixed: Setting
    watch: Watch
    order: int
    poses: Sequence[PoseResult]
    buckled: bool
    loop: Loop | None = None
    locked: Extreme | None = None
    peaks: Sequence[Equilibrium | None] = ()

    def extremes(self) -> Extremes:
        """What is largest or least, in SI units; None what is not known."""
        if all(pose.status == "failed" for pose in self.poses):
            return Extremes()
        work_in, work_out, dissipation = self._work()
        return Extremes(
            insertion_force=self._force(0),
            retention_force=self._force(1),
            strain=self._strain(),
            force_on_object=self._highest("force_on_object", self.fixed.sections.force_scale),
            clearance=self._clearance(),
            locking=self.locked or (self._highest("locking", 1.0) if self.fixed.friction else None),
            work_in=work_in,
            work_out=work_out,
            dissipation=dissipation,
            way=Way(self.fixed, self.watch.path, self.order, tuple(self.watch.steps)),
        )

    def _highest(self, name: str, unit: float) -> Extreme:
        summit = self.watch.highest(name, self.order)
        if summit is None or summit.value <= 0:
            return Extreme(value=0.0)
        kept = Kept(self.fixed, summit.at.equilibrium)
        return Extreme(value=summit.value * unit, parameter=summit.at.parameter, kept=kept)

    def _force(self, leg: int) -> Extreme | None:
        """The largest force of the drive on a leg; None where it is not known, or has no end (locked)."""
        turned = ways([pose.parameter or 0.0 for pose in self.poses])
        on = [pose for pose, way in zip(self.poses, turned, strict=True) if way[0] == leg]
        moves = turned[-1][1] != 0
        if leg == 1 and not on and moves and self._reversible():
            return self._highest("backwards", self.fixed.sections.energy_scale)
        if not moves or not on or all(pose.status == "failed" for pose in on):
            return None
        if any(pose.status == "locked" for pose in on):
            return None
        return self._looped(leg) if self.fixed.friction else self._highest(_LEGS[leg], self.fixed.sections.energy_scale)

    def _reversible(self) -> bool:
        """Whether the way back is known to have the same curve."""
        frictionless = self.fixed.friction is None and not self._published
        booked = self.watch.balance
        snapped = self.buckled or booked.loss > _NO_LOSS * booked.put_in
        known = self.watch.booked and all(pose.status != "failed" for pose in self.poses)
        return frictionless and known and not snapped

    @property
    def _published(self) -> bool:
        return self.scene.friction is not None and self.scene.friction.published

    def _looped(self, leg: int) -> Extreme:
        """The same from the loop of a motion with friction."""
        loop = self.loop
        if loop is None:
            return Extreme(value=0.0)
        value, at = (
            (loop.peak_retention_force, loop.peak_retention_parameter)
            if leg
            else (loop.peak_insertion_force, loop.peak_insertion_parameter)
        )
        return Extreme(value=value, parameter=at, kept=self._peak(leg)) if value and value > 0 else Extreme(value=0.0)

    def _peak(self, leg: int) -> Kept | None:
        found = self.peaks[leg] if leg < len(self.peaks) else None
        return Kept(self.fixed, found) if found else None

    def _strain(self) -> Extreme:
        """Of contact, located between the poses; loads strain a free finger, too: this is looked at in the poses."""
        touching = self._touching_strain()
        if self.fixed.loads is None:
            return touching
        most = max(self.poses, key=lambda pose: pose.max_strain or 0.0)
        if most.max_strain is None or most.max_strain <= touching.value:
            return touching
        return Extreme(value=most.max_strain, parameter=most.parameter, s=most.max_strain_s, kept=most.kept)

    def _touching_strain(self) -> Extreme:
        summit = self.watch.highest("strain", self.order)
        if summit is None or not summit.at.equilibrium.state.sites:
            return Extreme(value=0.0)
        value, s = largest_strain(self.fixed, summit.at.equilibrium)
        kept = Kept(self.fixed, summit.at.equilibrium)
        return Extreme(value=value, parameter=summit.at.parameter, s=s * self.fixed.sections.length, kept=kept)

    def _clearance(self) -> Extreme | None:
        if self.watch.touched is not None:
            return Extreme(value=0.0, parameter=self.watch.touched)
        known = [i for i, pose in enumerate(self.poses) if pose.min_gap is not None]
        if not known:
            return None
        best = min(known, key=lambda i: self.poses[i].min_gap or 0.0)
        around = [self.poses[i].parameter for i in (best - 1, best, best + 1) if 0 <= i < len(self.poses)]
        return self._nearest([place for place in around if place is not None])

    def _nearest(self, places: Sequence[float]) -> Extreme:
        """Where the straight finger is nearest to the object, at some places of the motion or between."""
        fixed = self.fixed
        beam = fixed.beam((), self.order)

        def free(parameter: float) -> Equilibrium:
            obstacle = fixed.obstacle(self.watch.path.frame(parameter))
            return settle(fixed, obstacle, State(beam, np.zeros(beam.size)), self.order)

        def distance(parameter: float) -> float:
            straight = free(parameter)
            return clearance(fixed, Verified(straight, survey(fixed, straight.obstacle, straight.state, brief=True)))

        low, high = min(places), max(places)
        within = [low, high]
        if low < high:
            xatol = _SHARP * (high - low)
            within.append(float(minimize_scalar(distance, bounds=within, method="bounded", options={"xatol": xatol}).x))
        found = [(distance(place), place) for place in (*within, *places)]
        least, place = min(found)
        return Extreme(value=least * fixed.sections.length, parameter=place, kept=Kept(fixed, free(place)))

    def _work(self) -> tuple[float | None, ...]:
        """Work put in, got back and lost, in J: none with the published friction, whose shape does no such work."""
        if self.loop:
            return self.loop.work_in, self.loop.work_out, self.loop.dissipation
        if self._published or not self.watch.booked:
            return None, None, None
        unit, booked = self.fixed.sections.energy_scale, self.watch.balance
        return booked.put_in * unit, booked.given_back * unit, booked.loss * unit
