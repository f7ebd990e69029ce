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


PLASTICS = {
    "POM": Plastic(
        youngs_modulus=3.1e9,
        poisson_ratio=0.35,
        once=0.06,
        repeated=0.02,
        friction_on_steel=(0.20, 0.35),
        on_itself=1.5,
        sources=(
            "Delrin 500P, data sheet, ISO 527-2",
            f"{DUPONT}: Delrin 500, 6 % once, 2 to 3 % frequently",
            f"{COVESTRO}, table 3",
        ),
    ),
    "PA66": Plastic(
        youngs_modulus=3.1e9,
        poisson_ratio=0.41,
        once=0.04,
        repeated=0.02,
        friction_on_steel=(0.30, 0.40),
        on_itself=1.5,
        sources=(
            "Zytel 103HSL, data sheet, ISO 527-1/-2, dry",
            f"{DUPONT}: Zytel 101, dry, 4 % once, 2 % frequently",
            f"{COVESTRO}, table 3",
        ),
    ),
    "PA66 conditioned": Plastic(
        youngs_modulus=1.4e9,
        poisson_ratio=0.41,
        once=0.06,
        repeated=0.03,
        friction_on_steel=(0.30, 0.40),
        on_itself=1.5,
        sources=(
            "Zytel 103HSL, data sheet, ISO 527-1/-2, conditioned",
            f"{DUPONT}: Zytel 101, 50 % relative humidity, 6 % once, 3 % frequently",
            f"{COVESTRO}, table 3",
        ),
    ),
    "PC": Plastic(
        youngs_modulus=2.4e9,
        poisson_ratio=0.38,
        once=0.04,
        repeated=0.024,
        friction_on_steel=(0.45, 0.55),
        on_itself=1.2,
        sources=(
            "Makrolon 2405, data sheet, ISO 527-1/-2",
            f"{COVESTRO}, table 2: Makrolon, 4 % once, 60 % of it frequently",
            f"{COVESTRO}, table 3",
        ),
    ),
    "ABS": Plastic(
        youngs_modulus=2.3e9,
        poisson_ratio=0.35,
        once=0.0168,
        repeated=0.01,
        friction_on_steel=(0.50, 0.65),
        on_itself=1.2,
        sources=(
            "Terluran GP-35, data sheet, ISO 527-1/-2",
            f"{COVESTRO}, part B: 70 % of an amorphous plastic's yield strain (2.4 %, as above), 60 % of it frequently",
            f"{COVESTRO}, table 3",
        ),
    ),
}
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
