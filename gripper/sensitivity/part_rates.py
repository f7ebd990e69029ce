"""What the numbers of an object's parts change: of unions, intersections, differences, and of grown objects."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.outline import dot
from gripper.objects import Combined, Offset
from gripper.objects.combined import whole_of
from gripper.objects.offset import grown_of
from gripper.objects.part import Member
from gripper.sensitivity.object_rates import object_rates

_POSES = ("pose.x", "pose.y", "pose.angle")
_AT = 1e-8  # of the whole's size: what is that near is on an outline, or is one corner


def _complex(vectors: Array) -> Complex:
    """Vectors (..., 2) as complex numbers."""
    found: Complex = vectors[..., 0] + 1j * vectors[..., 1]
    return found


class _PartRates:
    """Derivatives of a part by some numbers of the whole, all in the whole's frame.

    Parameters
    ----------
    member
        The part.
    name
        How its numbers' keys begin: ``parts[1]``.
    values
        The whole's numbers, p of them; those of other parts do not change this one.
    """

    def __init__(self, member: Member, name: str, values: Mapping[str, float]) -> None:
        own = {key.removeprefix(f"{name}."): value for key, value in values.items() if key.startswith(f"{name}.")}
        keys = list(values)
        self.member, self.count = member, len(keys)
        body = {key: value for key, value in own.items() if key not in _POSES}
        self.rows = np.array([keys.index(f"{name}.{key}") for key in body], dtype=np.intp)
        self.poses = {keys.index(f"{name}.{key}"): key for key in own if key in _POSES}
        self.body = object_rates(member.body, body)
        self.turn = complex(member.turn[0, 0], member.turn[1, 0])

    def at(self, points: Array) -> tuple[Array, Complex]:
        """Rates of the part's g times its sign and of its gradient, (p, k) each."""
        g, gradient = np.zeros((self.count, len(points))), np.zeros((self.count, len(points)), dtype=complex)
        own = self.body.at(self.member.local(points))
        g[self.rows], gradient[self.rows] = self.member.sign * own[0], self.member.sign * self.turn * own[1]
        if self.poses:
            _, slope, hessian = self.member.evaluate(points, 2)
            for row, name in self.poses.items():
                moving = self._moving(name, points)
                g[row] = -(slope * moving).sum(axis=1)
                gradient[row] = -_complex((hessian @ moving[..., None])[..., 0])
                if name == "pose.angle":
                    gradient[row] += 1j * _complex(slope)
        return g, gradient

    def corners(self, points: Array) -> Complex:
        """Rates of the part's corners at points (k, 2)."""
        out = np.zeros((self.count, len(points)), dtype=complex)
        out[self.rows] = self.turn * self.body.corners(self.member.local(points))
        for row, name in self.poses.items():
            out[row] = _complex(self._moving(name, points))
        return out

    def _moving(self, name: str, points: Array) -> Array:
        """How the part's matter at points moves with its pose, (k, 2)."""
        if name == "pose.angle":
            away = points - self.member.origin
            return np.column_stack([-away[:, 1], away[:, 0]])
        return np.broadcast_to([float(name == "pose.x"), float(name == "pose.y")], points.shape)


class CombinedRates:
    """Derivatives of a union, an intersection or a difference by its parts' numbers: those of the part that counts."""

    def __init__(self, body: Combined, values: Mapping[str, float]) -> None:
        self.whole = whole_of(body)
        self.parts = [_PartRates(member, f"parts[{i}]", values) for i, member in enumerate(self.whole.members)]

    def _counting(self, points: Array) -> Array:
        g = np.stack([member.evaluate(points, 0)[0] for member in self.whole.members])
        return np.asarray(self.whole.counting(g))

    def at(self, points: Array) -> tuple[Array, Complex]:
        """See `ObjectRates.at`."""
        which, every = self._counting(points), np.arange(len(points))
        rates = [part.at(points) for part in self.parts]
        g, gradient = (np.stack(table)[which, :, every].T for table in zip(*rates, strict=True))
        return g, gradient

    def corners(self, points: Array) -> Complex:
        """See `ObjectRates.corners`: a part's own, or where two parts cross."""
        found = [self._corner(point[None]) for point in points]
        return np.concatenate(found, axis=1) if found else np.zeros((self.parts[0].count, 0), dtype=complex)

    def _corner(self, point: Array) -> Complex:
        near = _AT * self.whole.size
        for part in self.parts:
            own = part.member.corners[0]
            if len(own) and np.abs(own - point).max(axis=1).min() < near:
                return part.corners(point)
        read = [(member.evaluate(point, 1), part) for member, part in zip(self.whole.members, self.parts, strict=True)]
        off = [abs(g[0]) / np.linalg.norm(slope) for (g, slope), _ in read]
        one, other = (read[i] for i in np.argsort(off)[:2])
        slopes = np.array([one[0][1][0], other[0][1][0]])
        rates = np.column_stack([one[1].at(point)[0][:, 0], other[1].at(point)[0][:, 0]])
        return _complex(-np.linalg.solve(slopes, rates.T).T)[:, None]


class OffsetRates:
    """Derivatives of a grown object: of the distance to its part's outline, less its own.

    Where the foot on the outline lies on g = 0 of the part, the outline moves out by -g_p / |grad g|, the distance
    falls by as much, and its gradient turns with the slope of that along the outline. Where it is a corner, this moves.
    """

    def __init__(self, body: Offset, values: Mapping[str, float]) -> None:
        self.base = grown_of(body).base
        self.part = _PartRates(Member(body.part), "part", values)
        self.own = np.array([float(key == "distance") for key in values])

    def at(self, points: Array) -> tuple[Array, Complex]:
        """See `ObjectRates.at`."""
        nearest = self.base.chain.nearest(points)
        distance, slope = self.base.evaluate(points, 1)
        normal, feet = _complex(slope), points - distance[:, None] * slope
        g, gradient = self._beside(feet, distance, normal)
        cornered = nearest.corner >= 0
        if cornered.any():
            moved = self.part.corners(self.base.chain.vertex[nearest.corner[cornered]])
            n, away = normal[cornered], distance[cornered]
            g[:, cornered] = -dot(n, moved)
            gradient[:, cornered] = (n * dot(n, moved) - moved) / away
        return g - self.own[:, None], gradient

    def _beside(self, feet: Array, distance: Array, normal: Complex) -> tuple[Array, Complex]:
        """The same where the feet are no corners."""
        _, slope, hessian = self.part.member.evaluate(feet, 2)
        g, gradient = self.part.at(feet)
        tangent, steep = 1j * normal, np.linalg.norm(slope, axis=1)
        bent = _complex((hessian @ np.column_stack([tangent.real, tangent.imag])[..., None])[..., 0])
        along = dot(tangent, gradient) / steep - g * dot(normal, bent) / steep**2
        return g / steep, tangent * along / (1 + distance * dot(tangent, bent) / steep)

    def corners(self, points: Array) -> Complex:
        """See `ObjectRates.corners`: a grown object has no convex ones."""
        return np.zeros((len(self.own), len(points)), dtype=complex)
