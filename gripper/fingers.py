"""The finger: material, profile w(s) and b(s), rigid jaw. Knows no particular profile."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from typing import Annotated, Literal, get_args

import sympy

from gripper.expression.dimensions import PASCAL, PURE, unit
from gripper.fields import Finite, Length, LengthProfile, Positive, Profile, Ratio, Rule, Stress, check_fields
from gripper.kinks import kinks_of
from gripper.pose import Placeable

S = sympy.Symbol("s", real=True)
"""Arc length along the undeflected neutral axis, from the clamp, in m."""

REPEATED = 0.6
"""Permissible strain of repeated use, over that of a single use."""

LawName = Literal["linear", "secant", "logarithmic", "st_venant_kirchhoff", "neo_hookean"]
"""Laws of a material."""

CurvePoint = tuple[Annotated[Finite, PURE], Annotated[Finite, PASCAL]]
"""Strain, and nominal stress in Pa."""
PoissonRatio = Annotated[float, PURE, Rule("lie above -1 and at most at 0.5", lambda v: -1 < v <= 0.5)]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Material:
    """Elastic, isotropic material: linear, unless it has a law of its own.

    Parameters
    ----------
    youngs_modulus
        E, in Pa.
    poisson_ratio
        nu, without unit.
    shear_modulus
        G, in Pa; E / (2 (1 + nu)) when it is not given.
    plane
        "stress" (a finger that is narrow out of plane) or "strain" (wide: E / (1 - nu^2) in bending).
    yield_strain
        Largest permissible strain of a single use, without unit; gives the strain margin of a result.
    repeated_strain
        Largest permissible strain of repeated use; 60 % of ``yield_strain`` when it is not given (the rule of
        Bayer MaterialScience, Snap-Fit Joints for Plastics, part C).
    law
        "linear" in the strains; "secant": a curve of stress over strain (``table``); "logarithmic" (Hencky),
        "st_venant_kirchhoff", "neo_hookean": for large strain. All begin with E and nu (:mod:`gripper.laws`).
    table
        Of law "secant": (strain, nominal stress in Pa) of a tensile test, rising, E being the slope at 0. Strains above
        0 alone: compression mirrors tension. In plane strain all stresses are 1 / (1 - nu^2) times as large.
    """

    youngs_modulus: Stress
    poisson_ratio: PoissonRatio
    shear_modulus: Stress | None = None
    plane: Literal["stress", "strain"] = "stress"
    yield_strain: Ratio | None = None
    repeated_strain: Ratio | None = None
    law: LawName = "linear"
    table: tuple[CurvePoint, ...] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if self.law not in get_args(LawName):
            raise ValueError(f"law must be one of {', '.join(get_args(LawName))}; got {self.law!r}")
        if (self.law == "secant") != (self.table is not None):
            raise ValueError(
                f"table must be given with law 'secant', and only there; got {self.table!r} with {self.law!r}"
            )
        if self.table is not None:
            from gripper.laws.secant import check_table  # here: the interpolation is imported where it is needed

            check_table(self.table, self.youngs_modulus)
        if self.plane not in ("stress", "strain"):
            raise ValueError(f"plane must be 'stress' or 'strain'; got {self.plane!r}")

    @property
    def permissible_repeatedly(self) -> float | None:
        """Largest permissible strain of repeated use; None where none is given."""
        if self.repeated_strain is not None or self.yield_strain is None:
            return self.repeated_strain
        return REPEATED * self.yield_strain

    @property
    def G(self) -> float:
        """Shear modulus, in Pa."""
        if self.shear_modulus is not None:
            return self.shear_modulus
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def bending_modulus(self) -> float:
        """The modulus of bending, in Pa: E in plane stress, E / (1 - nu^2) in plane strain."""
        if self.plane == "strain":
            return self.youngs_modulus / (1 - self.poisson_ratio**2)
        return self.youngs_modulus

    @property
    def shear_coefficient(self) -> float:
        """Kaneko's coefficient of the rectangle, (5 + 5 nu) / (6 + 5 nu) (Kaneko 1975; Lan & Lee eq 23)."""
        return (5 + 5 * self.poisson_ratio) / (6 + 5 * self.poisson_ratio)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Jaw(ABC):
    """A rigid jaw that moves with the finger's end section.

    Jaw frame: origin on the neutral axis at s = L, x along the finger, y across it.
    """

    def __post_init__(self) -> None:
        check_fields(self)

    @abstractmethod
    def polygon(self, thickness: float) -> tuple[tuple[float, float], ...]:
        """Vertices of the jaw in the jaw frame, in m, for a finger of this tip thickness (m)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Base:
    """What holds the finger at s = 0: its place is fixed, and it turns by M / k.

    Parameters
    ----------
    rotational_stiffness
        k, in N m per rad.
    """

    rotational_stiffness: Annotated[Positive, unit("N*m/rad")]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Finger(Placeable, ABC):
    """A flexible finger, held at s = 0; a plugin writes its thickness w(s).

    Parameters
    ----------
    length
        L, in m.
    width
        b, out of plane, in m: a number or an expression in s.
    material
        What it is made of.
    jaw
        A rigid jaw at its end, or None.
    rest_curvature
        Curvature kappa0(s) of the unloaded axis, in 1/m: a number or an expression in s, positive towards the upper
        face; None for a straight finger.
    base
        What it is clamped in, where that yields; None for a rigid clamp.
    """

    length: Length
    width: LengthProfile
    material: Material
    jaw: Jaw | None = None
    rest_curvature: Annotated[Profile, unit("1/m")] | None = None
    base: Base | None = None

    def __post_init__(self) -> None:
        check_fields(self)

    @abstractmethod
    def w(self, s: sympy.Expr) -> sympy.Expr:
        """In-plane thickness w(s), in m, as an expression in the arc length s (m)."""

    def b(self, s: sympy.Expr) -> sympy.Expr:
        """Out-of-plane width b(s), in m."""
        return sympy.sympify(self.width).subs(S, s)

    def kinks(self) -> tuple[float, ...]:
        """Arc lengths (m), rising between 0 and L, where w or b or their slopes jump: found from the expressions."""
        profiles = sympy.sympify(self.w(S)), sympy.sympify(self.b(S))
        return tuple(sorted({place for profile in profiles for place in kinks_of(profile, S, self.length)}))
