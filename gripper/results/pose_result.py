"""The answer for one pose: plain data in SI units, world frame unless named otherwise."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

from gripper.results.kept import Kept
from gripper.results.record import Record, jsonable
from gripper.results.shape import Shape

Vector = tuple[float, float]
_FIRST = ("parameter", "status", "reason")
_WHERE_THERE = ("work", "dissipation", "load_energy", "loads")
_OF_FRICTION = ("singularity", "other_solutions")
Status = Literal["free", "contact", "locked", "failed"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Contact(Record):
    """One separate contact: resultant forces over its patch.

    Parameters
    ----------
    on
        Where on the finger.
    s
        Force-weighted place: arc length from the clamp (on the jaw: along its outline), in m.
    extent
        First and last touching s, in m.
    point
        The place in the world frame, in m.
    normal
        Unit normal out of the object, world frame.
    normal_force
        N, on the finger along ``normal``, in N; at least 0.
    tangential_force
        T, friction on the object, positive towards the finger's tip, in N.
    state
        Whether it sticks or slips.
    """

    on: Literal["lower", "upper", "tip", "jaw"]
    s: float
    extent: Vector
    point: Vector
    normal: Vector
    normal_force: float
    tangential_force: float = 0.0
    state: Literal["frictionless", "slip", "stick"] = "frictionless"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Applied(Record):
    """What a load of the scene does to a section of the finger.

    Parameters
    ----------
    load
        Which of the scene's loads, counted from 0.
    s
        Of the section, in m; of a load along the whole axis its weighted place.
    point
        On the neutral axis, in the world, in m.
    force
        In N, world frame.
    moment
        About that point, in N m.
    """

    load: int
    s: float
    point: Vector
    force: Vector
    moment: float


@dataclasses.dataclass(frozen=True, kw_only=True)
class Checks(Record):
    """What was verified of a pose; all None where it failed.

    Parameters
    ----------
    stationarity, force_balance
        Relative to the total contact force (and what else loads the finger).
    moment_balance
        Relative to that times L.
    stability
        Smallest eigenvalue of the reduced Hessian, relative to the strain energy's own; None where a singularity is.
    singularity
        With friction, or loads that follow the finger: smallest singular value of the reduced tangent stiffness, which
        is not symmetric, relative to the strain energy's own; 0 at a limit point. It tells of no flutter. Else None.
    other_solutions
        With friction along a motion: other answers that Coulomb's law leaves at this pose, "free" or contacts that
        might stick; none where this is the only one that was found. Else None.
    penetration_bound
        Upper bound of the depth over the whole outline, in m, at least 0.
    certificate
        "proved", or "sampled" where no bound of grad g is proved.
    """

    stationarity: float | None = None
    force_balance: float | None = None
    moment_balance: float | None = None
    stability: float | None = None
    singularity: float | None = None
    other_solutions: tuple[str, ...] | None = None
    penetration_bound: float | None = None
    certificate: Literal["proved", "sampled"] | None = None


@dataclasses.dataclass(frozen=True, kw_only=True)
class ErrorEstimate(Record):
    """How far the force may be off, relative; None where not estimated.

    Parameters
    ----------
    discretisation
        From a finer discretisation of the same equations.
    next_theory
        From the next richer beam theory.
    """

    discretisation: float | None = None
    next_theory: float | None = None


@dataclasses.dataclass(frozen=True, kw_only=True)
class PoseNumbers(Record):
    """The numbers of one pose that have derivatives: SI units, world frame unless named otherwise.

    Parameters
    ----------
    parameter
        The motion's parameter; None in a scene without motion.
    reason
        Why there are none.
    force_on_object, force_on_object_finger_frame
        Of the finger on the object, in N: world axes, and axes of the clamp.
    moment_on_object
        About the object's reference point, in N m.
    motion_force
        Work to be put in per unit of the motion's parameter, in J per unit (N, where the parameter is a length).
    clamp_moment
        EI psi'(0), in N m, of contacts and loads: positive when the object pushes towards the finger's +y.
    energy
        Strain energy (of a base that yields, too), in J.
    tip, tip_rotation
        Neutral axis at s = L, in m; psi(L) relative to the clamp, in rad.
    max_strain
        Largest abs(eps) + abs(kappa) w / 2.
    min_gap
        Smallest distance of the outlines, in m; negative: depth.
    load_energy
        Potential of the scene's loads, in J, its zero where theirs are (a dead force's: its point at the clamp); None
        where there are no loads, or one has no potential.
    """

    parameter: float | None
    reason: str | None = None
    force_on_object: Vector | None = None
    force_on_object_finger_frame: Vector | None = None
    moment_on_object: float | None = None
    motion_force: float | None = None
    clamp_moment: float | None = None
    energy: float | None = None
    tip: Vector | None = None
    tip_rotation: float | None = None
    max_strain: float | None = None
    min_gap: float | None = None
    load_energy: float | None = None


@dataclasses.dataclass(frozen=True, kw_only=True)
class PoseResult(PoseNumbers):
    """One pose: SI units, world frame unless named otherwise; every number None where it failed.

    Parameters
    ----------
    status
        "free" (no contact), "contact", "locked" (friction holds it for any force) or "failed".
    reason
        Why it failed or locked.
    work, dissipation
        With friction along a motion: work put in by the drive, and energy lost, since the motion began, in J.
    max_strain_s
        Where the strain is largest (m from the clamp; None where nothing bends it).
    contacts
        One entry a separate contact, ordered by s.
    loads
        What the scene's loads do, one entry a load and section.
    checks, error
        What was verified, and how far the force may be off.
    iterations
        Of the solver.
    seconds
        CPU time of the pose with its checks and estimates.
    shape
        For drawing; None where it failed.
    kept
        For sensitivities; None where it failed, and in a copy from another process.

    The others are those of :class:`PoseNumbers`.
    """

    status: Status
    work: float | None = None
    dissipation: float | None = None
    max_strain_s: float | None = None
    contacts: tuple[Contact, ...] = ()
    loads: tuple[Applied, ...] = ()
    checks: Checks = Checks()
    error: ErrorEstimate = ErrorEstimate()
    iterations: int = 0
    seconds: float = 0.0
    shape: Shape | None = dataclasses.field(default=None, compare=False, repr=False)
    kept: Kept | None = dataclasses.field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.status == "failed" and not self.reason:
            raise ValueError(f"reason must say why the pose failed; got {self.reason!r}")

    @classmethod
    def failed(cls, parameter: float | None, reason: str, iterations: int = 0, seconds: float = 0.0) -> PoseResult:
        """Make a pose without an answer: no number but its place, the effort spent, and why."""
        return cls(parameter=parameter, status="failed", reason=reason, iterations=iterations, seconds=seconds)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON: without the shape, which is for drawing, and without what the scene has not."""
        names = [field.name for field in dataclasses.fields(self) if field.name not in ("shape", "kept")]
        names.sort(key=(*_FIRST, *names).index)
        written = (n for n in names if n not in _WHERE_THERE or getattr(self, n) not in (None, ()))
        return {name: jsonable(getattr(self, name)) for name in written} | {"checks": _written(self.checks)}


def _written(checks: Checks) -> dict[str, Any]:
    """Checks, without those of friction where there is none."""
    whole: dict[str, Any] = jsonable(checks)
    return {name: value for name, value in whole.items() if name not in _OF_FRICTION or value is not None}
