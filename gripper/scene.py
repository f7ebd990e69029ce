"""The scene: what is given. Plain data that knows nothing of how it is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from gripper.fields import Finite, Ratio, check_fields
from gripper.fingers import Finger
from gripper.friction import Friction
from gripper.limits import Limits
from gripper.loads import Load
from gripper.objects import Object
from gripper.pose import Placed, placed
from gripper.tolerances import Tolerances

Theory = Literal["auto", "bending", "shear", "stretch"]
MOST_POSES = 100_000
"""Of a motion: a gigabyte of results."""


@dataclass(frozen=True)
class Motion:
    """The poses of a motion: the parameter's name and its values, in the order in which they are passed.

    Parameters
    ----------
    parameter
        Name of the symbol in the poses' expressions.
    values
        Its values, one a pose.
    """

    parameter: str
    values: tuple[Finite, ...]

    def __post_init__(self) -> None:
        check_fields(self)
        if not 1 <= len(self.values) <= MOST_POSES:
            raise ValueError(f"values must hold 1 to {MOST_POSES} poses; got {len(self.values)}")

    @classmethod
    def between(cls, parameter: str, start: float, stop: float, poses: int, *, back: bool = False) -> Motion:
        """Equally spaced poses from start to stop, both included; ``back`` returns the same way (turning pose once)."""
        if not 2 <= poses <= MOST_POSES:
            raise ValueError(f"poses must lie between 2 and {MOST_POSES}; got {poses!r}")
        if not math.isfinite(stop - start) or start == stop:
            raise ValueError(f"from and to must be two different finite numbers; got {start!r} and {stop!r}")
        values = [start + (stop - start) * i / (poses - 1) for i in range(poses - 1)] + [stop]
        return cls(parameter, tuple(values + values[-2::-1] if back else values))


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A finger, an object, and where they are.

    Parameters
    ----------
    finger, object
        A body, or a body placed by ``.at(x=..., y=..., angle=...)``.
    motion
        The poses to pass; None for a scene of one pose.
    approach
        Direction, in the finger frame, along which the object comes from where it is free (for a scene of one
        pose, and for a motion that starts in contact); by default from below, on to the lower face.
    friction
        Coulomb friction; None for none.
    theory
        "bending", "shear" (Timoshenko's sections, inextensible axis: the paper's), "stretch" (Simo's and Reissner's
        beam: the axis changes its length, too), or "auto": the cheapest whose forces the next one changes by no more
        than ``theory_tolerance``, the same at all poses.
    tolerance
        Asked relative discretisation error of the contact force.
    theory_tolerance
        Relative change of the contact force by the next theory up to which "auto" takes the cheaper one.
    title
        For figures and reports.
    limits
        What the design asks of the summary's numbers; judged on request.
    tolerances
        How far its numbers may be off; reckoned with on request.
    loads
        What acts on the finger besides the object.
    """

    finger: Placed[Finger] | Finger
    object: Placed[Object] | Object
    motion: Motion | None = None
    approach: tuple[Finite, Finite] = (0.0, 1.0)
    friction: Friction | None = None
    theory: Theory = "auto"
    tolerance: Ratio = 1e-4
    theory_tolerance: Ratio = 5e-3
    title: str = ""
    limits: Limits | None = None
    tolerances: Tolerances | None = None
    loads: tuple[Load, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        if self.theory not in get_args(Theory):
            raise ValueError(f"theory must be one of {', '.join(get_args(Theory))}; got {self.theory!r}")
        if not 1e-12 <= self.tolerance <= 0.1:
            raise ValueError(f"tolerance must lie between 1e-12 and 0.1; got {self.tolerance!r}")
        if math.hypot(*self.approach) == 0:
            raise ValueError(f"approach must be a direction other than (0, 0); got {self.approach!r}")
        if self.friction is not None:
            self.friction.check(placed(self.finger).body.length, moving=self.motion is not None)
        self._check_loads()
        known = {self.motion.parameter} if self.motion else set()
        for name in ("finger", "object"):
            unknown = {symbol.name for symbol in placed(getattr(self, name)).pose.parameters} - known
            if unknown:
                parameter = (
                    f"the motion's parameter {self.motion.parameter!r}" if self.motion else "no symbol (no motion)"
                )
                raise ValueError(f"{name}.pose must depend on {parameter}; got {', '.join(sorted(unknown))!r}")

    @property
    def posed(self) -> bool:
        """Whether the motion's parameter stands in a pose; where it stands in no load either, it moves nothing."""
        return any(placed(part).pose.parameters for part in (self.finger, self.object))

    def _check_loads(self) -> None:
        """Each is a load; whether it fits the finger shows when both are compiled."""
        for load in self.loads:
            if not isinstance(load, Load):
                raise ValueError(f"loads must be instances of gripper.loads.Load; got {load!r}")
