"""The object as the solver sees it: g with its derivatives, its corners, what is proved of it, and its outline."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gripper.fields import check_fields
from gripper.pose import Placeable

Array: TypeAlias = NDArray[np.float64]
Box: TypeAlias = tuple[float, float, float, float]
"""(xmin, ymin, xmax, ymax), in m."""


@dataclass(frozen=True, kw_only=True)
class Object(Placeable, ABC):
    """A rigid object with an outline g(x, y) = 0, in its own frame.

    g is in m, negative inside, positive outside, finite everywhere together with its gradient (also at the
    centre), continuous, and with |grad g| = 1 on the outline where it can be. A pose moves the points that
    are asked for, never the expression.
    """

    def __post_init__(self) -> None:
        check_fields(self)

    @abstractmethod
    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """Return g and its derivatives up to ``order`` (0, 1 or 2).

        Parameters
        ----------
        points
            (n, 2), in m, in the object's own frame.
        order
            Highest derivative; the tuple has ``order + 1`` entries.

        Returns
        -------
        g (n,) in m; its gradient (n, 2); its Hessian (n, 2, 2) in 1/m.
        """

    def gap(self, points: Array) -> Array:
        """Return g (n,), in m, at points (n, 2), in m."""
        return self.evaluate(np.asarray(points, dtype=float), 0)[0]

    def gradient(self, points: Array) -> Array:
        """Return the gradient of g (n, 2) at points (n, 2), in m."""
        return self.evaluate(np.asarray(points, dtype=float), 1)[1]

    def hessian(self, points: Array) -> Array:
        """Return the Hessian of g (n, 2, 2), in 1/m, at points (n, 2), in m."""
        return self.evaluate(np.asarray(points, dtype=float), 2)[2]

    @property
    def corners(self) -> Array:
        """Convex corners of the outline (k, 2), in m, where it has no tangent; none by default."""
        return np.empty((0, 2))

    @property
    def corner_normals(self) -> Array:
        """Outward unit normals (k, 2, 2) of the two pieces of outline before and after each corner."""
        return np.empty((0, 2, 2))

    @property
    def hollows(self) -> Array:
        """Re-entrant corners of the outline (k, 2), in m; none by default."""
        return np.empty((0, 2))

    @property
    def hollow_normals(self) -> Array:
        """Outward unit normals (k, 2, 2) of the two pieces of outline before and after each re-entrant corner."""
        return np.empty((0, 2, 2))

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """Bound the derivatives of g over discs, by proof.

        Parameters
        ----------
        centers, radii
            (n, 2) and (n,), in m.

        Returns
        -------
        An upper bound of |grad g| over each disc (n,) (inf where none is known), and a lower bound of the
        smallest eigenvalue of its Hessian (n,), in 1/m (-inf where none is known; a convex kink counts as
        positive). None where nothing can be proved of this object.
        """
        return None

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """Bound the Hessian's largest eigenvalue from above, by proof: what `bounds` does for what is cut out.

        Parameters
        ----------
        centers, radii
            (n, 2) and (n,), in m.

        Returns
        -------
        (n,), in 1/m; inf where none is known (a re-entrant kink counts as negative).
        """
        return np.full(len(centers), np.inf)

    @property
    @abstractmethod
    def box(self) -> Box:
        """A box that holds the outline: (xmin, ymin, xmax, ymax), in m; infinite where the outline is."""

    @property
    @abstractmethod
    def inner_radius(self) -> float:
        """Radius of the largest disc inside, in m (an estimate; of the smallest part where there are several)."""

    @property
    @abstractmethod
    def inner_point(self) -> Array:
        """A point (2,) well inside, in m."""

    @abstractmethod
    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """Trace polylines (m, 2) with their vertices on the outline, in m; closed ones repeat their first vertex.

        Parameters
        ----------
        box
            The part wanted of an outline without bounds; a bounded outline is returned whole.
        tolerance
            Largest distance between chord and outline, in m; 1e-4 of the box's larger side by default.

        Raises
        ------
        ValueError
            The outline has no bounds and no box is given.
        """


def chord_tolerance(tolerance: float | None, size: float) -> float:
    """Return the tolerance of an outline of this size, in m: 1e-4 of it where None is given.

    Raises
    ------
    ValueError
        It is not positive.
    """
    if tolerance is None:
        return 1e-4 * size
    if not tolerance > 0:
        raise ValueError(f"tolerance must be a positive number, in m; got {tolerance!r}")
    return tolerance
