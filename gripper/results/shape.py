"""The outline of a pose, for drawing."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gripper.results.record import plain


def _points(values: ArrayLike) -> NDArray[np.float64]:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Shape:
    """The outline of a pose in the world frame, for drawing: read-only arrays, in m.

    One made by :meth:`later` is drawn when its arrays are first asked for.

    Parameters
    ----------
    axis, lower, upper
        Neutral axis and both faces, from clamp to tip, (n, 2) each.
    strain
        Bending strain of the faces, |kappa| w / 2, (n,).
    jaw
        The jaw's polygon, (m, 2), or None.
    clamp_pose, object_pose
        x, y (m) and angle (rad).
    """

    axis: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    strain: NDArray[np.float64]
    # by factories, which leave no value on the class: what a shape has not yet is asked of __getattr__
    jaw: NDArray[np.float64] | None = dataclasses.field(default_factory=lambda: None)
    clamp_pose: tuple[float, float, float] = dataclasses.field(default_factory=lambda: (0.0, 0.0, 0.0))
    object_pose: tuple[float, float, float] = dataclasses.field(default_factory=lambda: (0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        for name in ("axis", "lower", "upper", "strain", "jaw"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else _points(value))
        for name in ("clamp_pose", "object_pose"):
            object.__setattr__(self, name, plain(getattr(self, name)))
        expected = (len(self.axis), 2)
        for name in ("axis", "lower", "upper"):
            if getattr(self, name).shape != expected:
                raise ValueError(f"{name} must have shape {expected}, in m; got {getattr(self, name).shape}")
        if self.strain.shape != expected[:1]:
            raise ValueError(f"strain must have shape {expected[:1]}; got {self.strain.shape}")

    @classmethod
    def later(cls, draw: Callable[[], Mapping[str, Any]], turning: float) -> Self:
        """A shape that is drawn when it is asked for: most are not.

        Parameters
        ----------
        draw
            Gives its fields.
        turning
            How far its sections turn.
        """
        shape = object.__new__(cls)
        shape.__dict__.update(_draw=draw, turning=turning)
        return shape

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name not in Shape.__dataclass_fields__ or "_draw" not in self.__dict__:
                raise AttributeError(f"a shape has no {name!r}")
            draw = self.__dict__.pop("_draw")
            Shape.__init__(self, **draw())
            return getattr(self, name)

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    @functools.cached_property
    def turning(self) -> float:
        """How far sections turn against each other, in rad, to about what a taper and shear turn a face by."""
        along = np.diff(self.lower, axis=0)
        return float(np.ptp(np.unwrap(np.arctan2(along[:, 1], along[:, 0]))))

    @property
    def outline(self) -> NDArray[np.float64]:
        """The finger's closed outline: lower face, end face, upper face back to the clamp, (2 n, 2), in m."""
        return np.concatenate([self.lower, self.upper[::-1]])
