"""How the contact equations change as the object moves on: z, multipliers and places held."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gripper.contact.linearisation import Rates
from gripper.contact.outline import dot

if TYPE_CHECKING:
    from gripper.contact.rows import System


def rates(system: System) -> Rates:
    """Rates of the equations of all contacts with the motion's parameter, and of the loads on z."""
    stations, obstacle = system.stations, system.obstacle
    passing = -obstacle.velocities(stations.points)
    gap = dot(system.normal, passing)
    turned = system.curved(passing) + 1j * obstacle.frame.spin * system.normal  # d(grad g)/dq
    lifting = dot(turned, stations.tangents)
    pulled = system.weights * turned if system.turns is None else system.weights * system.turns * turned
    values, residuals = np.zeros(len(system.values)), np.zeros(len(system.residuals))
    loads = (pulled.conj() @ stations.gradients).real
    for span, levers in system.levers:
        loads -= ((-1j * system.weights[span] * turned[span]).conj() @ levers).real
    for site, (span, row, column) in zip(system.sites, system.layout, strict=True):
        first = span.start
        if site.kind == "vertex":
            n, turning, _, force = system.corners[first]
            t = complex(stations.tangents[first])
            velocity = complex(obstacle.velocities(obstacle.corners[site.vertex]))
            slipping = (t.conjugate() * velocity).real / abs(t)
            values[row], residuals[column] = -(n.conjugate() * velocity).real, -slipping
            loads += force * slipping * turning
        elif site.spreads:
            x, mean = system.rule(site)
            last = first + x.size
            values[row : row + site.modes] = mean @ gap[first:last]
            columns = slice(column, column + site.unknown_places)
            residuals[columns] = lifting[last] if site.lifts_off else gap[last : span.stop]
        else:
            values[row] = gap[first]
            if site.kind == "tangent":
                residuals[column] = lifting[first]
    for column, rate in system.anchored.items():
        residuals[column] = rate
    return values, residuals, loads
