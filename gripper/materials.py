"""A small table of plastics: moduli, permissible strains and coefficients of friction, each with its source.

Guide values at 23 degrees Celsius for a first design; a grade's data sheet is better. E is the tensile modulus of the
data sheet: at strains of a few percent the secant modulus is lower, and so are the forces. Poisson's ratio is typical
of its class; it enters through the shear modulus and, in plane strain, E / (1 - nu^2).
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from gripper.fingers import Material
from gripper.names import known_names

COVESTRO = "Covestro (Bayer MaterialScience), Snap-Fit Joints for Plastics: A Design Guide"
DUPONT = "DuPont, General Design Principles for Engineering Polymers, table 10.06"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Plastic:
    """A row of the table.

    Parameters
    ----------
    youngs_modulus, poisson_ratio
        E in Pa, and nu.
    once, repeated
        Permissible strain of a single use and of repeated use.
    friction_on_steel
        Least and largest coefficient of friction on steel.
    on_itself
        Factor on it for friction on the same plastic.
    sources
        Of E, of the strains, of friction.
    """

    youngs_modulus: float
    poisson_ratio: float
    once: float
    repeated: float
    friction_on_steel: tuple[float, float]
    on_itself: float
    sources: tuple[str, str, str]


_MODULI = {
    "POM": (3.1e9, 0.35, "Delrin 500P, data sheet, ISO 527-2"),
    "PA66": (3.1e9, 0.41, "Zytel 103HSL, data sheet, ISO 527-1/-2, dry"),
    "PA66 conditioned": (1.4e9, 0.41, "Zytel 103HSL, data sheet, ISO 527-1/-2, conditioned"),
    "PC": (2.4e9, 0.38, "Makrolon 2405, data sheet, ISO 527-1/-2"),
    "ABS": (2.3e9, 0.35, "Terluran GP-35, data sheet, ISO 527-1/-2"),
}
_YIELD = "70 % of an amorphous plastic's yield strain (2.4 %, as above), 60 % of it frequently"
_STRAINS = {
    "POM": (0.06, 0.02, f"{DUPONT}: Delrin 500, 6 % once, 2 to 3 % frequently"),
    "PA66": (0.04, 0.02, f"{DUPONT}: Zytel 101, dry, 4 % once, 2 % frequently"),
    "PA66 conditioned": (0.06, 0.03, f"{DUPONT}: Zytel 101, 50 % relative humidity, 6 % once, 3 % frequently"),
    "PC": (0.04, 0.024, f"{COVESTRO}, table 2: Makrolon, 4 % once, 60 % of it frequently"),
    "ABS": (0.0168, 0.01, f"{COVESTRO}, part B: {_YIELD}"),
}
_FRICTION = {
    "POM": (0.20, 0.35, 1.5),
    "PA66": (0.30, 0.40, 1.5),
    "PA66 conditioned": (0.30, 0.40, 1.5),
    "PC": (0.45, 0.55, 1.2),
    "ABS": (0.50, 0.65, 1.2),
}
"""Of each plastic on steel, from and to; factor on it for the same plastic. All of Covestro's table 3."""


def _row(name: str) -> Plastic:
    modulus, ratio, of_modulus = _MODULI[name]
    once, repeated, of_strains = _STRAINS[name]
    least, largest, factor = _FRICTION[name]
    return Plastic(
        youngs_modulus=modulus,
        poisson_ratio=ratio,
        once=once,
        repeated=repeated,
        friction_on_steel=(least, largest),
        on_itself=factor,
        sources=(of_modulus, of_strains, f"{COVESTRO}, table 3"),
    )


PLASTICS = {name: _row(name) for name in _MODULI}
"""Plastics by name."""


def plastic(name: str) -> Plastic:
    """Look a plastic up; LookupError lists the known ones."""
    if name not in PLASTICS:
        raise LookupError(f"unknown material {name!r}; known: {known_names(name, PLASTICS)}")
    return PLASTICS[name]


def material(name: str, plane: Literal["stress", "strain"] = "stress") -> Material:
    """Make a plastic of the table; its yield strain is the permissible strain of a single use.

    Parameters
    ----------
    name
        As "POM".
    plane
        See :class:`gripper.fingers.Material`.

    Raises
    ------
    LookupError
        No such plastic; lists the known ones.
    """
    row = plastic(name)
    return Material(
        youngs_modulus=row.youngs_modulus,
        poisson_ratio=row.poisson_ratio,
        plane=plane,
        yield_strain=row.once,
        repeated_strain=row.repeated,
    )


def friction_range(name: str, other: str = "steel") -> tuple[float, float]:
    """Least and largest coefficient of friction of a plastic on steel or on itself.

    Raises
    ------
    LookupError
        No such plastic, or no value for the pair: guide values for two different plastics lie at or below the lower
        of their values on steel.
    """
    row = plastic(name)
    if other not in ("steel", name):
        raise LookupError(f"unknown partner {other!r} of {name!r}; known: steel, {name}")
    factor = 1.0 if other == "steel" else row.on_itself
    low, high = row.friction_on_steel
    return round(factor * low, 4), round(factor * high, 4)
