"""What a scene needs and what it does not: unknowns, terms, constraints, packages, and the estimate behind each."""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from gripper.assemble import assemble, first_order
from gripper.beam.strains import BeamTheory
from gripper.contact.outline import Outline
from gripper.fingers import Finger
from gripper.pose import placed
from gripper.result import PoseResult, Result
from gripper.scene import Motion, Scene
from gripper.solve import solve
from gripper.statics.contact_forces import NO_FORCE
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.statics.ladder import RUNGS, richer, theory_difference
from gripper.statics.problem import Problem
from gripper.trace import trace

_ADDS = {"bending": "curvature kappa", "shear": "shear strain gamma", "stretch": "stretch of the axis eps"}
_PACKAGES = ("sympy", "numpy", "scipy", "shapely", "matplotlib", "pydantic", "typer", "rich", "casadi")


@dataclass(frozen=True)
class Decision:
    """One part of the model and why it is there or not.

    Parameters
    ----------
    what
        The part.
    needed
        Whether this scene has it.
    why
        With the number behind it.
    """

    what: str
    needed: bool
    why: str


@dataclass(frozen=True)
class Explanation:
    """What is solved for a scene.

    Parameters
    ----------
    title
        Of the scene.
    pose
        At which pose sizes are read, in words.
    decisions
        Terms of the energy, friction, jaw, and the parts of the outline.
    sizes
        Of the problems, in words.
    packages
        That solving it imports, and those of this project's that it does not.
    warnings
        Of its result.
    """

    title: str
    pose: str
    decisions: tuple[Decision, ...]
    sizes: tuple[str, ...]
    packages: tuple[tuple[str, ...], tuple[str, ...]]
    warnings: tuple[str, ...] = ()

    def __str__(self) -> str:
        def block(head: str, lines: list[str]) -> list[str]:
            return [head, *(f"  {line}" for line in lines), ""] if lines else []

        kept, left = ([f"{d.what}: {d.why}" for d in self.decisions if d.needed == wanted] for wanted in (True, False))
        used, unused = (", ".join(names) or "none" for names in self.packages)
        lines = [self.title] if self.title else []
        lines += block(f"sizes, {self.pose}", list(self.sizes))
        lines += block("needed", kept) + block("left out", left) + block("warnings", list(self.warnings))
        return "\n".join([*lines, "packages", f"  solving imports: {used}", f"  not needed for it: {unused}"])


def explain(scene: Scene) -> Explanation:
    """Solve a scene once and say what it needed; sizes are read where its contact force is largest.

    Raises
    ------
    ValueError
        As `gripper.solve` and `gripper.trace`.
    """
    result = trace(scene) if scene.motion else solve(scene)
    pose = max(result.poses, key=lambda p: np.hypot(*(p.force_on_object or (-1.0, 0.0))))
    fixed = pose.kept.setting if pose.kept else None
    decisions = [*_terms(scene, result, pose), *_parts(scene, result)]
    sizes = [_problem(scene, result.model.theory, pose)]
    if pose.kept is not None and fixed is not None:
        sizes.append(_system(fixed, pose.kept.equilibrium, pose))
    where = "at its only pose" if pose.parameter is None else f"where the force is largest ({pose.parameter:.6g})"
    if pose.reason is not None:
        where, sizes = "at the first pose", [*sizes, f"no pose has an answer: {pose.reason}"]
    return Explanation(
        title=scene.title,
        pose=where,
        decisions=tuple(decisions),
        sizes=tuple(sizes),
        packages=packages(scene),
        warnings=result.model.warnings,
    )


def _terms(scene: Scene, result: Result, pose: PoseResult) -> list[Decision]:
    """The strains, each with what it changes; friction."""
    chosen = RUNGS.index(result.model.theory)
    asked = f"{100 * scene.theory_tolerance:.2g} % is asked" if scene.theory == "auto" else f"theory = {scene.theory!r}"
    law, whitened = placed(scene.finger).body.material.law, "the finger bends; whitened, V = |z|^2 / 2"
    out = [Decision(_ADDS[RUNGS[0]], True, f"{whitened}{'' if law == 'linear' else ' where strains are small'}")]
    answer = "linear: sections answer by EI, GA and EA alone" if law == "linear" else f"{law}: {_strained(result)}"
    out.append(Decision("material law", law != "linear", answer))
    for below, theory in pairwise(RUNGS):
        change = _change(scene, below, pose.parameter)
        known = "what it changes is not known" if change is None else f"it changes forces by {100 * change:.2g} %"
        out.append(Decision(_ADDS.get(theory, theory), RUNGS.index(theory) <= chosen, f"{known} ({asked})"))
    rough = scene.friction is not None and not scene.friction.absent
    mu = "no coefficient is given" if scene.friction is None else "the coefficient is 0"
    model = scene.friction.model if scene.friction else ""
    out.append(Decision("friction", rough, f"Coulomb's, as asked ({model})" if rough else mu))
    kinds = ", ".join(dict.fromkeys(type(load).__name__ for load in scene.loads))
    out.append(Decision("loads", bool(scene.loads), f"as given: {kinds}" if kinds else "none are given"))
    return [*out, *_finger(placed(scene.finger).body)]


def _finger(finger: Finger) -> list[Decision]:
    """What the finger may have: a shape at rest, and a base that yields."""
    bent = bool(finger.rest_curvature)
    return [
        Decision("shape at rest", bent, "rest_curvature is given" if bent else "the unloaded finger is straight"),
        Decision("base that yields", finger.base is not None, _held(finger)),
    ]


def _held(finger: Finger) -> str:
    """What holds the finger."""
    if finger.base is None:
        return "the clamp is rigid: none is given"
    return f"one unknown more; it turns by {1 / finger.base.rotational_stiffness:.3g} rad per N m"


def _strained(result: Result) -> str:
    """What a law of its own is needed for."""
    largest = max((pose.max_strain or 0.0 for pose in result.poses), default=0.0)
    return f"fibres' energies are integrated over the thickness, strains reach {largest:.2g}"


def _change(scene: Scene, theory: BeamTheory, parameter: float | None) -> float | None:
    """What the theory after this one changes at a pose, to first order."""
    bare = replace(scene, theory=theory, friction=None)
    if scene.motion is not None and parameter is not None:
        values = tuple(dict.fromkeys((scene.motion.values[0], parameter)))
        bare = replace(bare, motion=Motion(scene.motion.parameter, values))
    pose = (trace(bare) if bare.motion else solve(bare)).poses[-1]
    return theory_difference(pose.kept.setting, pose.kept.equilibrium) if pose.kept and richer(theory) else None


def _parts(scene: Scene, result: Result) -> list[Decision]:
    """Parts of the outline: touched ones are constrained, the rest is only certified to be clear."""
    outline = next((pose.kept.setting.outline for pose in result.poses if pose.kept), None)
    if outline is None:
        return []
    touched = {contact.on for pose in result.poses for contact in pose.contacts}
    names = {"lower": "lower face", "upper": "upper face", "tip": "end face and its corners", "jaw": "jaw"}
    out = []
    for on in dict.fromkeys([*(piece.on for piece in outline.pieces), *(corner.on for corner in outline.corners)]):
        poses = sum(any(contact.on == on for contact in pose.contacts) for pose in result.poses)
        why = f"carries force at {poses} of {len(result.poses)} poses" if on in touched else _idle(outline, result)
        out.append(Decision(f"contact on the {names[on]}", on in touched, why))
    if placed(scene.finger).body.jaw is None:
        out.append(Decision("jaw", False, "the finger has none"))
    return out


def _idle(outline: Outline, result: Result) -> str:
    kinds = {pose.checks.certificate for pose in result.poses if pose.checks.certificate}
    return f"never touched: no constraint, only certified to be clear ({', '.join(sorted(kinds)) or 'nothing solved'})"


def _problem(scene: Scene, theory: str, pose: PoseResult) -> str:
    """What SLSQP sees at the pose."""
    asked = replace(scene, theory=theory)  # type: ignore[arg-type]  # a model's theory is one of a scene's
    problem: Problem = assemble(asked, pose.parameter)
    kinds = [candidate.kind for candidate in problem.candidates]
    words = {
        "stretch": ("minimum of g along a stretch", "minima of g along stretches"),
        "corner": ("corner of the outline", "corners of the outline"),
        "vertex": ("corner of the object", "corners of the object"),
        "node": ("fixed place", "fixed places"),
    }
    parts = ", ".join(_counted(kinds.count(kind), *words[kind]) for kind in dict.fromkeys(kinds))
    return (
        f"SLSQP sees {_counted(problem.size, 'unknown')} and {_counted(len(kinds), 'constraint')} "
        f"({parts or 'nothing is near'}), "
        "only where contacts are not known: at a touch or a change"
    )


def _system(fixed: Setting, equilibrium: Equilibrium, pose: PoseResult) -> str:
    """The system that Newton finishes on."""
    state, lin = equilibrium.state, equilibrium.linear
    beam = state.beam
    strains = " and ".join(_ADDS[theory] for theory in RUNGS[: beam.fields])
    order = f"order {beam.order} (from order {first_order(fixed.tolerance)} for a tolerance of {fixed.tolerance:.0e}"
    estimate = pose.error.discretisation or 0.0
    free = "" if abs(equilibrium.force) > NO_FORCE else "; nothing touches"
    return (
        f"Newton finishes on {beam.size} + {len(lin.values)} + {len(lin.residuals)} unknowns: {strains} of {order}, "
        f"estimated error {estimate:.1e}) on {_counted(beam.segments, 'segment')}, "
        f"contact pressures, contact places{free}"
    )


def _counted(number: int, name: str, several: str | None = None) -> str:
    return f"{number} {name if number == 1 else several or name + 's'}"


_IMPORTS = """
import pickle, sys
scene = pickle.load(sys.stdin.buffer)
import gripper
gripper.trace(scene) if scene.motion else gripper.solve(scene)
print(*sorted({name.split(".")[0] for name in sys.modules}))
"""


def packages(scene: Scene) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Third-party packages that a fresh interpreter has imported once it has solved the scene's first pose, and not."""
    first = replace(scene, motion=Motion(scene.motion.parameter, scene.motion.values[:1])) if scene.motion else scene
    done = subprocess.run([sys.executable, "-c", _IMPORTS], input=pickle.dumps(first), capture_output=True, check=True)
    loaded = set(done.stdout.decode().split())
    return tuple(p for p in _PACKAGES if p in loaded), tuple(p for p in _PACKAGES if p not in loaded)
