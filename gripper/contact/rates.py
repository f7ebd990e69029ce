"""How the contact equations change as the object moves on: z, multipliers and places held."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.linearisation import Rates
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import dot
from gripper.contact.site import Site, pressure_rule


class Passing(NamedTuple):
    """What is kept of a linearisation for the day that its rates are asked for; k places are looked at."""

    obstacle: Obstacle
    order: int
    sites: tuple[Site, ...]
    layout: list[tuple[slice, int, int]]  # of each site: its places, first row, first column
    points: Complex  # (k,)
    tangents: Complex  # (k,)
    gradients: Complex  # of the points by z, (k, n)
    normals: Complex  # grad g, (k,)
    hessian: tuple[Array, Complex]  # of g, each (k,)
    weights: Complex  # forces by grad g, friction's part among them, (k,)
    corners: dict[int, tuple[complex, Array, float, float]]  # of the object: see System
    anchored: dict[int, float]  # rates of the residuals of contacts that stick
    levers: list[tuple[slice, Complex]]  # of friction that acts at the axis, times its force: places, (places, n)

    def rates(self) -> Rates:
        """Rates of the equations of all contacts with the motion's parameter, and of the loads on z."""
        obstacle, (a, b) = self.obstacle, self.hessian
        passing = -obstacle.velocities(self.points)
        gap = dot(self.normals, passing)
        turned = a * passing + b * passing.conj() + 1j * obstacle.frame.spin * self.normals  # d(grad g)/dq
        lifting = dot(turned, self.tangents)
        loads = ((self.weights * turned).conj() @ self.gradients).real
        for span, levers in self.levers:
            loads -= ((-1j * turned[span]).conj() @ levers).real
        values = np.zeros(sum([site.modes for site in self.sites]))
        residuals = np.zeros(sum([site.unknowns for site in self.sites]))
        for site, (span, row, column) in zip(self.sites, self.layout, strict=True):
            first = span.start
            if site.kind == "vertex":
                n, turning, _, force = self.corners[first]
                t = complex(self.tangents[first])
                velocity = complex(obstacle.velocities(obstacle.corners[site.vertex]))
                slipping = (t.conjugate() * velocity).real / abs(t)
                values[row], residuals[column] = -(n.conjugate() * velocity).real, -slipping
                loads += force * slipping * turning
            elif site.spreads:
                x, mean = pressure_rule(site.modes, self.order)
                last = first + x.size
                values[row : row + site.modes] = mean @ gap[first:last]
                columns = slice(column, column + site.unknown_places)
                residuals[columns] = lifting[last] if site.lifts_off else gap[last : span.stop]
            else:
                values[row] = gap[first]
                if site.kind == "tangent":
                    residuals[column] = lifting[first]
        for column, rate in self.anchored.items():
            residuals[column] = rate
        return values, residuals, loads
