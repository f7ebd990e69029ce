"""The signed distance to a chain, with its derivatives and what is proved of them."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gripper.objects.base import Array
from gripper.objects.chain import Chain
from gripper.objects.concavity import Concavity
from gripper.objects.formulas import away, corner

HAIR = 1e-15  # of the outline's size


class Distance:
    """Signed distance to a chain, negative on its left."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain

    def evaluate(self, points: Array, order: int) -> tuple[Array, ...]:
        """Return the distance and its derivatives, as `gripper.objects.Object.evaluate`."""
        chain = self.chain
        nearest = chain.nearest(points)
        values = chain.span.evaluate(points, order, nearest.t, chain.coefficients[nearest.piece])
        at = nearest.corner >= 0
        if at.any():
            i = nearest.corner[at]
            vertex = chain.vertex[i]
            sign = np.where(chain.convex_corner[i], 1.0, -1.0)
            beside = away(points[at], vertex, sign[:, None] * chain.bisector[i], HAIR * chain.size)
            for value, replacement in zip(values, corner()(beside, order, *vertex.T, sign), strict=True):
                value[at] = replacement
        return values

    def least_curvature(self, centers: Array, radii: Array) -> Array:
        """Bound the Hessian's smallest eigenvalue from below over discs (n, 2), (n,): (n,), in 1/m."""
        return self._concavity.bound(centers, radii, self.evaluate(centers, 0)[0])

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """Bound the Hessian's largest eigenvalue from above over discs (n, 2), (n,): (n,), in 1/m."""
        return -self._hollowness.bound(centers, radii, -self.evaluate(centers, 0)[0])

    @cached_property
    def _concavity(self) -> Concavity:
        return Concavity(self.chain)

    @cached_property
    def _hollowness(self) -> Concavity:
        return Concavity(self.chain, inside_out=True)
