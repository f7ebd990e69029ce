"""The contact equations at a state with their derivatives, finished: what Newton's method and all judges read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gripper.arrays import Array, Complex, Index

if TYPE_CHECKING:
    from gripper.contact.rubbing import Rubbing
    from gripper.statics.acting import Push

Rates = tuple[Array, Array, Array]
"""Rates with the motion's parameter: dC/dq (m,), dR/dq (k,), d(C_z^T lambda)/dq (n,), z and places held."""


@dataclass(frozen=True, eq=False)
class Linearisation:
    """The contact equations at a state, with all first derivatives and the second ones that Newton needs.

    m constraints, k unknown places, n unknowns of the beam.
    """

    values: Array  # C, (m,)
    gradients: Array  # C_z, (m, n)
    value_slopes: Array  # C_u, (m, k)
    residuals: Array  # equations of the places R, (k,)
    residual_gradients: Array  # R_z, (k, n)
    residual_slopes: Array  # R_u, (k, k)
    load_slopes: Array  # d(C_z^T lambda)/du, (n, k)
    carried_slopes: Array  # the same with V's part, where the ends of the segments are carried along by the places
    hessian: Array  # sum lambda C_zz at fixed places, (n, n)
    rated: Callable[[], Rates]  # of the contacts alone, evaluated where a tangent is asked for
    force_gradient: Complex  # d(total force on the finger)/dz, (n,)
    force_multipliers: Complex  # the same by the multipliers, (m,)
    force_places: Complex  # the same by the places, (k,)
    points: tuple[Complex, ...]  # per site, where its force acts, (j,)
    forces: tuple[Complex, ...]  # per site, force on the finger at those points, (j,)
    stations: tuple[Array, ...]  # per site, the place u of those points, (j,)
    loads: Array  # unit loads of the multipliers on z: C_z, and friction's part, (m, n)
    rubbing: Rubbing | None = None
    push: Push | None = None  # what else loads the finger; its part is in hessian
    kept: Index | None = None  # the unknowns kept of those that were linearised; None: all

    def pushed(self, push: Push) -> Linearisation:
        """The same with what else loads the finger."""
        return replace(self, hessian=self.hessian + push.slopes, push=push)

    def keeping(self, kept: Index) -> Linearisation:
        """The same without friction and other loads, in some of the beam's unknowns only."""
        gradients = self.gradients[:, kept]
        return Linearisation(
            self.values,
            gradients,
            self.value_slopes,
            self.residuals,
            self.residual_gradients[:, kept],
            self.residual_slopes,
            self.load_slopes[kept],
            self.carried_slopes[kept],
            self.hessian[kept[:, None], kept],
            self.rated,
            self.force_gradient[kept],
            self.force_multipliers,
            self.force_places,
            self.points,
            self.forces,
            self.stations,
            gradients,
            kept=kept,
        )

    def rates(self) -> Rates:
        """What the object's motion, and that of the loads, changes of the equations."""
        values, residuals, loads = self.rated()
        if self.kept is not None:
            loads = loads[self.kept]
        return values, residuals, loads if self.push is None else loads + self.push.rates

    def load(self, multipliers: Array) -> Array:
        """All that bends the finger: generalised forces on z, (n,)."""
        contacts: Array = self.loads.T @ multipliers
        return contacts if self.push is None else contacts + self.push.force
