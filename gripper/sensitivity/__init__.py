"""Exact derivatives of a result by the numbers of its scene.

Forward mode through the discrete equilibrium (:mod:`gripper.sensitivity.tangent`); plugins' formulas are
differentiated by sympy. No differences anywhere.
"""

from gripper.sensitivity.report import PoseSensitivity, Sensitivity, sensitivities

__all__ = ["PoseSensitivity", "Sensitivity", "sensitivities"]
