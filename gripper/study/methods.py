"""The methods of a work-precision diagram: each makes itself ready for a pose, then solves it cold or warm."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import sympy
from scipy.optimize import OptimizeResult, minimize

from gripper.arrays import Array
from gripper.assemble import assemble, first_order, setting
from gripper.contact.kinematics import Kinematics
from gripper.contact.linear import linearise
from gripper.motion.approach import approach
from gripper.motion.tracker import Tracker
from gripper.pose import placed
from gripper.scene import Motion, Scene
from gripper.solve import solve
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.nearby import near
from gripper.statics.problem import Problem
from gripper.study.cost import shifted
from gripper.study.ipopt import Transcription, available
from gripper.study.outcome import NoOutcomeError, Outcome, counted, of_nodes, of_strains
from gripper.study.published import Gradients, PublishedProblem, PublishedResult, Shear, Start, solve_as_published

NEAR = 0.01
"""How far (of L) the pose lies whose answer a warm pose starts from."""
_REACH = 0.1  # of L: stretches of outline this near to the object may touch
_FTOL = 1e-6  # of a chain: its axis kinks at every node, on which a finer SLSQP hops to and fro
_PATIENCE = 60


@dataclass(frozen=True)
class Prepared:
    """A method that is ready for one pose: set-up is done.

    Parameters
    ----------
    cold, warm
        Solve it from nothing, or from the answer of a neighbouring pose (found at the first call); None where that
        makes no difference.
    outcome
        The answer with its work counted; not timed. Raises NoOutcomeError where there is none.
    unknowns
        That the optimiser sees.
    """

    cold: Callable[[], object]
    warm: Callable[[], object] | None
    outcome: Callable[[], Outcome]
    unknowns: int


@dataclass(frozen=True)
class Method:
    """A way to solve a pose.

    Parameters
    ----------
    name
        As the table says it.
    symbol, grid
        What its resolutions are called (N or tolerance), and their values.
    prepare
        Makes it ready for a scene of one pose at a resolution.
    """

    name: str
    symbol: str
    grid: tuple[float, ...]
    prepare: Callable[[Scene, float], Prepared]


def methods(scene: Scene, *, quick: bool = False) -> tuple[Method, ...]:
    """The methods that suit a scene: without shear the paper's scheme needs no cure.

    Parameters
    ----------
    scene
        Its theory decides.
    quick
        Few and coarse resolutions.
    """
    bending = setting(scene).theory == "bending"
    cured: Shear = "none" if bending else "element"
    slow, many = ((8, 16), (12, 24)) if quick else ((15, 30, 60), (15, 30, 60, 90, 180))
    found = []
    if not bending:
        found.append(Method("paper as published", "N", slow, published("averaged", "differences")))
        found.append(Method("paper as published, exact gradients", "N", many, published("averaged", "exact")))
    name = "paper as published" if bending else "paper, shear cured"
    found.append(Method(name, "N", slow, published(cured, "differences")))
    found.append(Method(f"{name}, exact gradients", "N", many, published(cured, "exact")))
    chains, tolerances = ((8, 16), (1e-3, 1e-6)) if quick else ((8, 16, 32, 64, 128), (1e-2, 1e-3, 1e-4, 1e-6, 1e-8))
    found.append(Method("gripper, p = 0", "N", chains, _chain))
    found.append(Method("gripper", "tolerance", tolerances, _gripper))
    if available():
        finer = many if quick else (*many, 360, 720)
        found.append(Method("CasADi/IPOPT, the paper's problem", "N", finer, _ipopt))
        found.append(Method("CasADi/IPOPT as a whole (model built)", "N", finer, _whole))
    return tuple(found)


def published(shear: Shear, gradients: Gradients) -> Callable[[Scene, float], Prepared]:
    """The paper's scheme with its shear as it stands or cured."""

    def prepare(scene: Scene, N: float) -> Prepared:
        problem = PublishedProblem(scene, None, int(N), shear)

        def run(start: Start | Array = "arc", at: Scene = scene) -> PublishedResult:
            return solve_as_published(at, None, N=int(N), shear=shear, gradients=gradients, start=start)

        def outcome() -> Outcome:
            result = run()
            if not result.success:
                raise NoOutcomeError("SLSQP does not report success")
            return _of_nodes(scene, problem, result.x, result.multipliers, (result.iterations, result.evaluations))

        near = functools.cache(lambda: run(at=shifted(scene, -NEAR)).x)
        return Prepared(cold=run, warm=lambda: run(near()), outcome=outcome, unknowns=problem.size)

    return prepare


def _of_nodes(scene: Scene, problem: PublishedProblem, x: Array, multipliers: Array, work: tuple[int, int]) -> Outcome:
    psi, start, stop = problem.angles(x)
    steps = (np.exp(1j * start) + np.exp(1j * stop)) * (problem.h / 2)
    points = problem.contact_points(x)
    forces = multipliers * problem.obstacle.slope(points)[1]
    axis, energy = np.concatenate([[0], np.cumsum(steps)]), problem.energy(x)[0]
    counts = work[0], work[1] * len(points)
    return of_nodes(setting(scene), problem.obstacle, axis, psi, points, forces, energy, counts)


def _ipopt(scene: Scene, N: float) -> Prepared:
    built = Transcription(scene, int(N), shear=setting(scene).theory != "bending")
    start = built.problem.start("arc")

    def outcome() -> Outcome:
        x, multipliers, *work = built.solve(start)
        return _of_nodes(scene, built.problem, x, multipliers, (work[0], work[1]))

    @functools.cache
    def near() -> Array:
        beside = Transcription(shifted(scene, -NEAR), int(N), shear=setting(scene).theory != "bending")
        return beside.solve(beside.problem.start("arc"))[0]

    return Prepared(
        cold=lambda: built.solve(start),
        warm=lambda: built.solve(near()),
        outcome=outcome,
        unknowns=built.problem.size + built.ties,
    )


def _whole(scene: Scene, N: float) -> Prepared:
    """A user's pose by IPOPT: its model has to be built for it, which takes longer than its solution."""
    built = _ipopt(scene, N)
    return replace(built, cold=lambda: _ipopt(scene, N).cold(), warm=None)


def _approached(scene: Scene, fixed: Setting, order: int) -> Outcome:
    fixed, points = counted(fixed)
    try:
        answer, _ = approach(fixed, Kinematics(scene, fixed.sections.length).frame(0.0), scene.approach, order)
    except NoEquilibriumError as error:
        raise NoOutcomeError(str(error)) from error
    found = answer.verified.equilibrium
    return of_strains(fixed, found.obstacle, found.state, found.linear, (answer.iterations, sum(points)))


def _gripper(scene: Scene, tolerance: float) -> Prepared:
    """This project as a user calls it, checks, certificate and error estimate included."""
    asked = replace(scene, tolerance=tolerance)
    fixed, order = setting(asked), first_order(tolerance)
    tracker = functools.cache(lambda: _Beside(asked, fixed, order))

    def cold() -> None:
        pose = solve(asked).poses[0]
        if pose.reason:
            raise NoOutcomeError(pose.reason)

    def outcome() -> Outcome:
        cold()
        return _approached(asked, fixed, order)

    unknowns = fixed.beam((), order).size * 2  # a contact cuts the finger in two
    return Prepared(cold=cold, warm=lambda: tracker().step(), outcome=outcome, unknowns=unknowns)


def _chain(scene: Scene, N: float) -> Prepared:
    """Order 0: a chain of circular arcs with one shear angle each, contact places moving between nodes; SLSQP alone."""
    fixed = setting(scene)
    kinks = tuple(sorted({*fixed.sections.kinks, *(i / N for i in range(1, int(N)))}))
    fixed = replace(fixed, sections=replace(fixed.sections, kinks=kinks))

    def problem(at: Scene, fixed: Setting = fixed, start: State | None = None) -> Problem:
        smooth = assemble(at)
        begin = start or smooth.state(smooth.x0).on(fixed.beam((), 0))
        obstacle = fixed.obstacle(smooth.obstacle.frame)
        return Problem(fixed, obstacle, begin, near(fixed, obstacle, begin, survey(fixed, obstacle, begin), _REACH))

    def solved(ready: Problem) -> OptimizeResult:
        found = minimize(**ready.scipy(_FTOL, _PATIENCE))
        if not found.success:
            raise NoOutcomeError(f"SLSQP: {found.message}")
        return found

    def outcome() -> Outcome:
        counting, points = counted(fixed)
        ready = problem(scene, counting)
        found = solved(ready)
        state, load = ready.state(found.x), found.multipliers * ready.scale**2 / ready.gap_scale
        sites = ready.sites(found.x)
        lin = linearise(state.beam, state.z, fixed.outline, ready.obstacle, sites, load, kinks=False)
        return of_strains(fixed, ready.obstacle, state, lin, (int(found.nit), sum(points)))

    def beside() -> State:
        ready = problem(shifted(scene, -NEAR))
        return ready.state(solved(ready).x)

    beside_once = functools.cache(beside)
    return Prepared(
        cold=lambda: solved(problem(scene)),
        warm=lambda: solved(problem(scene, start=beside_once())),
        outcome=outcome,
        unknowns=fixed.beam((), 0).size,
    )


class _Beside:
    """An equilibrium of a neighbouring pose, from which a warm pose starts again and again."""

    def __init__(self, scene: Scene, fixed: Setting, order: int) -> None:
        q = sympy.Symbol("q", real=True)
        finger, target = placed(scene.finger), placed(scene.object)
        angle, length = float(finger.pose.angle), fixed.sections.length
        pose = replace(
            target.pose, x=target.pose.x + q * np.cos(angle) * length, y=target.pose.y + q * np.sin(angle) * length
        )
        moving = replace(scene, object=replace(target, pose=pose), motion=Motion("q", (-NEAR, 0.0)))
        self.fixed, self.path = fixed, Kinematics(moving, length)
        answer, self.order = approach(fixed, self.path.frame(-NEAR), scene.approach, order)
        self.start = answer.verified

    def step(self) -> None:
        """Follow the object to its pose."""
        Tracker.resume(self.fixed, self.path, -NEAR, self.order, self.start).advance(0.0)
