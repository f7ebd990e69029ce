"""The answer: plain data. Knows nothing of how it was found; writes itself as JSON, CSV and text."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from gripper.describe import describe
from gripper.results import report
from gripper.results.extremes import Extremes
from gripper.results.loop import Loop
from gripper.results.pose_result import (
    Checks,
    Contact,
    ErrorEstimate,
    PoseResult,
    Status,
    Vector,
)
from gripper.results.record import Record, jsonable
from gripper.results.shape import Shape
from gripper.results.summary import Summary, summarised
from gripper.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from gripper.plot import Axis
    from gripper.sensitivity import Sensitivity

__all__ = [
    "Checks",
    "Contact",
    "ErrorEstimate",
    "Event",
    "LeftOut",
    "Model",
    "PoseResult",
    "Result",
    "Shape",
    "Status",
    "Vector",
]

SCHEMA = 1
EventKind = Literal["touch", "release", "change", "stick", "slip", "snap"]
_PACKAGES = ("gripper", "numpy", "scipy", "sympy")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Event(Record):
    """Something that changed along the motion.

    Parameters
    ----------
    parameter
        Where, in the motion's parameter.
    kind
        touch, release, change (of face, corner or edge), stick, slip or snap.
    detail
        In words.
    """

    parameter: float
    kind: EventKind
    detail: str = ""


@dataclasses.dataclass(frozen=True, kw_only=True)
class LeftOut:
    """A part of the model that this scene did not need: what, and why."""

    what: str
    why: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Model:
    """What was solved: the beam theory, what was left out of it and why, what no theory here holds, where it ends."""

    theory: str
    left_out: tuple[LeftOut, ...] = ()
    not_modelled: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True, kw_only=True)
class Result:
    """Every pose of a scene.

    Parameters
    ----------
    scene
        What was given.
    model
        What was solved.
    poses
        One entry a pose, in the motion's order.
    events
        In the motion's order.
    title
        For figures and reports; the scene's by default.
    loop
        Of a motion with friction: peak forces there and back, work and dissipation; else None.
    extremes
        What is largest or least on the way, located between the poses; None where it was not followed.

    A result of one pose gives that pose's numbers itself: ``result.force_on_object`` is
    ``result.poses[0].force_on_object``. Where there are several poses, or the only one failed, these raise
    ValueError.
    """

    scene: Scene
    model: Model
    poses: tuple[PoseResult, ...]
    events: tuple[Event, ...] = ()
    title: str = ""
    loop: Loop | None = None
    extremes: Extremes | None = None

    def __post_init__(self) -> None:
        if not self.poses:
            raise ValueError("poses must hold at least one pose; got none")
        object.__setattr__(self, "poses", tuple(self.poses))
        object.__setattr__(self, "events", tuple(self.events))
        object.__setattr__(self, "title", self.title or self.scene.title)

    @property
    def parameter(self) -> str | None:
        """The name of the motion's parameter; None in a scene without motion."""
        return self.scene.motion.parameter if self.scene.motion else None

    @property
    def failed(self) -> tuple[PoseResult, ...]:
        """The poses without an answer."""
        return tuple(pose for pose in self.poses if pose.status == "failed")

    @property
    def pose(self) -> PoseResult:
        """The only pose; ValueError where there are several or where it failed."""
        if len(self.poses) > 1:
            raise ValueError(f"result must hold one pose (of several use result.poses[i]); got {len(self.poses)}")
        if self.poses[0].status == "failed":
            raise ValueError(f"result must hold a pose with an answer; got {self.poses[0].reason}")
        return self.poses[0]

    @property
    def force_on_object(self) -> Vector:
        """Force of the finger on the object, in N, world frame (one pose)."""
        return _known(self.pose.force_on_object)

    @property
    def moment_on_object(self) -> float:
        """Moment about the object's reference point, in N m (one pose)."""
        return _known(self.pose.moment_on_object)

    @property
    def clamp_moment(self) -> float:
        """EI psi'(0), in N m (one pose)."""
        return _known(self.pose.clamp_moment)

    @property
    def energy(self) -> float:
        """Strain energy, in J (one pose)."""
        return _known(self.pose.energy)

    @property
    def tip(self) -> Vector:
        """Neutral axis at s = L, in m, world frame (one pose)."""
        return _known(self.pose.tip)

    @property
    def max_strain(self) -> float:
        """Largest strain (one pose)."""
        return _known(self.pose.max_strain)

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts, ordered by s (one pose)."""
        return self.pose.contacts

    def sensitivity(self, key: str) -> Sensitivity:
        """Exact derivatives of everything by one number of the scene.

        Parameters
        ----------
        key
            As a scene file names it: ``"finger.tip_thickness"``, ``"object.pose.y"``, ``"friction.coefficient"``.

        Raises
        ------
        LookupError
            The scene has no number of this key; lists the known ones.
        ValueError
            A result whose equilibria are not known (from another process), or what cannot be differentiated.
        """
        return self.sensitivities([key])[key]

    def sensitivities(self, keys: Sequence[str] | None = None) -> dict[str, Sensitivity]:
        """Exact derivatives by several numbers of the scene at once, which costs little more than by one.

        Parameters
        ----------
        keys
            As :meth:`sensitivity` takes them; by default all of :func:`gripper.parameters.numbers`.
        """
        import gripper.sensitivity as exact  # here, because it reads results

        return exact.sensitivities(self, keys)

    def summary(self) -> Summary:
        """The numbers of the whole motion, peaks located between its poses."""
        return summarised(self)

    def to_dict(self) -> dict[str, Any]:
        """Write the contents of result.json: SI units, None where there is no answer, never NaN."""
        loop = {"loop": jsonable(self.loop)} if self.loop else {}
        return {
            "schema": SCHEMA,
            "title": self.title,
            "scene": describe(self.scene),
            "versions": {name: version(name) for name in _PACKAGES},
            "model": jsonable(self.model),
            "poses": [pose.to_dict() for pose in self.poses],
            "events": jsonable(self.events),
            "summary": jsonable(self.summary()),
        } | loop

    def curve_csv(self) -> str:
        """Write the contents of curve.csv: one row a pose, units in the column names, empty cells where it failed."""
        return report.as_csv(self)

    def plot(self) -> Figure:
        """Draw it: one pose, or a filmstrip of the motion. Needs no display."""
        return self.filmstrip()

    def filmstrip(
        self,
        poses: Iterable[int] | Mapping[int, str] | None = None,
        *,
        mirror: Axis | None = None,
        width: float | None = None,
    ) -> Figure:
        """Draw poses of the motion beside each other, to one scale: see `gripper.plot.filmstrip`."""
        from gripper.plot import filmstrip  # here, so that `import gripper` does not load matplotlib

        return filmstrip(self, poses, mirror=mirror, width=width)

    def curve(self, quantity: str = "force_on_object", *, width: float | None = None) -> Figure:
        """Draw the force on the object, or another number, along the motion: see `gripper.plot.curve`."""
        from gripper.plot import PAGE, curve

        return curve(self, quantity, width=width or PAGE)

    def animate(
        self,
        path: str | PathLike[str],
        *,
        seconds: float = 5.0,
        pixels: int = 720,
        mirror: Axis | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Path:
        """Write the motion as a film, .gif or .mp4: see `gripper.plot.animate`."""
        from gripper.plot import animate

        return animate(self, path, seconds=seconds, pixels=pixels, mirror=mirror, progress=progress)

    def __str__(self) -> str:
        return report.as_text(self)

    def _repr_html_(self) -> str:
        return report.as_html(self)


Value = TypeVar("Value")


def _known(value: Value | None) -> Value:
    if value is None:
        raise ValueError("result must hold a pose that friction does not lock, to have this number; got a locked one")
    return value
