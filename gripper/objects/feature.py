"""An outline made of features: pieces of curve and the corners between them; g is the signed distance to it."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gripper.objects.base import Array, Box, Object, chord_tolerance
from gripper.objects.chain import Chain
from gripper.objects.closed import check_pieces, check_simple
from gripper.objects.compiled import PerInstance
from gripper.objects.distance import Distance


@dataclass(frozen=True, kw_only=True)
class FeatureSurface(Object):
    """An object whose plugin writes the pieces of its closed outline; g is the exact signed distance.

    shapely's STRtree picks the nearest piece; the formulas of pieces and corners are sympy's.

    Raises
    ------
    ValueError
        The outline crosses or touches itself, or encloses nothing.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        names = " and ".join(field.name for field in dataclasses.fields(self))
        check_pieces(names, self.pieces())
        check_simple(names, self.chain.polygon)

    @abstractmethod
    def pieces(self) -> Array:
        """Coefficients (m, degree + 1, 2), in m, of the pieces q_i(t) = sum_k c_ik t^k, t in [0, 1].

        Each piece ends where the next begins, the last one where the first does, in either sense.
        """

    def piece_rates(self) -> Mapping[str, Array]:
        """Rates of :meth:`pieces` (m, degree + 1, 2) by the object's numbers, by key: ``vertices[0][1]``.

        None by default: the object then has no sensitivities by its own numbers.
        """
        return {}

    @property
    def chain(self) -> Chain:
        """The pieces, with what they enclose on their left."""
        return _distance(self).chain

    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """See `Object.evaluate`."""
        return _distance(self).evaluate(points, order)

    @property
    def corners(self) -> Array:
        """See `Object.corners`."""
        chain = self.chain
        return chain.vertex[chain.convex_corner]

    @property
    def corner_normals(self) -> Array:
        """See `Object.corner_normals`."""
        chain = self.chain
        return chain.normals[chain.convex_corner]

    @property
    def hollows(self) -> Array:
        """See `Object.hollows`."""
        chain = self.chain
        return chain.vertex[chain.corner & ~chain.convex_corner]

    @property
    def hollow_normals(self) -> Array:
        """See `Object.hollow_normals`."""
        chain = self.chain
        return chain.normals[chain.corner & ~chain.convex_corner]

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array]:
        """See `Object.bounds`: a distance's slope is 1."""
        return np.ones(len(centers)), _distance(self).least_curvature(centers, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """See `Object.largest_curvature`."""
        return _distance(self).largest_curvature(centers, radii)

    @property
    def box(self) -> Box:
        """See `Object.box`."""
        return self.chain.box

    @property
    def inner_radius(self) -> float:
        """See `Object.inner_radius`."""
        return self.chain.inner_disc[1]

    @property
    def inner_point(self) -> Array:
        """See `Object.inner_point`."""
        return self.chain.inner_disc[0]

    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """See `Object.outline`."""
        chain = self.chain
        return chain.polylines(chord_tolerance(tolerance, chain.size))


_distance: PerInstance[FeatureSurface, Distance] = PerInstance(lambda surface: Distance(Chain(surface.pieces())))
