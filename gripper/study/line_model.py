"""The finger as a line, the paper's one-dimensional model: its thickness bends and shears, but nothing touches it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy

from gripper.fingers import Finger, Jaw
from gripper.pose import placed
from gripper.scene import Scene

THIN = 1e-4
"""What is left of the thickness."""


@dataclass(frozen=True, kw_only=True)
class Line(Finger):
    """A finger with a ten-thousandth of the thickness of another, and its stiffness.

    Parameters
    ----------
    body
        The finger that it stands for.
    """

    body: Finger

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Thickness w(s), in m."""
        return THIN * self.body.w(s)

    def b(self, s: sympy.Expr) -> sympy.Expr:
        """Out-of-plane width b(s), in m."""
        return self.body.b(s)

    def kinks(self) -> tuple[float, ...]:
        """The body's."""
        return self.body.kinks()


@dataclass(frozen=True, kw_only=True)
class _Jaw(Jaw):
    """A jaw where the thick finger has it."""

    body: Jaw

    def polygon(self, thickness: float) -> tuple[tuple[float, float], ...]:
        """Vertices in the jaw frame, in m."""
        return self.body.polygon(thickness / THIN)


def as_line(scene: Scene) -> Scene:
    """The scene with its finger as a line: E I and G A are kept, E and G being as much larger, and the law linear."""
    finger = placed(scene.finger)
    body, material = finger.body, replace(finger.body.material, law="linear", table=None)
    stiff = replace(material, youngs_modulus=material.youngs_modulus / THIN**3, shear_modulus=material.G / THIN)
    jaw = None if body.jaw is None else _Jaw(body=body.jaw)
    bent = body.rest_curvature
    line = Line(length=body.length, width=body.width, material=stiff, jaw=jaw, rest_curvature=bent, body=body)
    return replace(scene, finger=replace(finger, body=line))
