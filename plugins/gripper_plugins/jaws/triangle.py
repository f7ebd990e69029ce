"""The triangular jaw of a snap hook."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import sympy

from gripper.fields import Angle, Length, Rule
from gripper.fingers import Jaw

Corner = Annotated[Angle, Rule("lie between 0 and pi, in rad", lambda angle: 0 < angle < math.pi)]


@dataclass(frozen=True, kw_only=True)
class Triangle(Jaw):
    """Snap hook: return face next to the finger, lead face towards the far end.

    Its height is h = length / (1/tan(lead_angle) + 1/tan(return_angle)).

    Parameters
    ----------
    length
        Along the finger, in m.
    lead_angle, return_angle
        Angles between the finger's face and the two faces, inside the jaw, in rad; their sum is below pi. A
        return_angle above pi/2 undercuts.
    side
        The face of the finger on which it stands: "lower" or "upper".

    Raises
    ------
    ValueError
        The angles make no triangle.
    """

    length: Length
    lead_angle: Corner
    return_angle: Corner
    side: Literal["lower", "upper"] = "lower"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.side not in ("lower", "upper"):
            raise ValueError(f"side must be 'lower' or 'upper'; got {self.side!r}")

        if self.lead_angle + self.return_angle >= math.pi:
            got = (self.lead_angle, self.return_angle)
            raise ValueError(f"lead_angle and return_angle must add up to less than pi, in rad; got {got!r}")

    def polygon(self, thickness: float) -> tuple[tuple[float, float], ...]:
        """Corners (3, 2), in m, for a tip of this thickness (m): heel, point of the hook, far end."""
        before = _cotangent(self.return_angle)
        height = self.length / (_cotangent(self.lead_angle) + before)
        face = -thickness / 2
        corners = ((0.0, face), (height * before, face - height), (self.length, face))
        return corners if self.side == "lower" else tuple((x, -y) for x, y in corners)


def _cotangent(angle: float | sympy.Expr) -> Any:
    """Of a number, or of the symbol by which sensitivities are differentiated."""
    return 1 / sympy.tan(angle) if isinstance(angle, sympy.Expr) else 1 / math.tan(angle)
