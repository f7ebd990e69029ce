"""Material laws of the plane: strain energy as a function of two squared lengths, all derivatives exact.

With p = (F11 + F22, F21 - F12) and q = (F11 - F22, F21 + F12), any isotropic law of the plane depends on a = |p|^2 and
b = |q|^2 alone: the principal stretches are (sqrt a +- sqrt b) / 2, and J = (a - b) / 4. With principal strains e1, e2
of the law's own measure,

    W = M / 4 ((1 + nu) (e1 + e2)^2 + (1 - nu) (e1 - e2)^2),

M = E / (1 - nu^2) in plane stress; plane strain is the same with E / (1 - nu^2) and nu / (1 - nu). A law is the sum and
the squared difference of its strains; the neo-Hookean one is a function of a + b and J. The four agree at small strain;
none needs eigenvectors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from gripper.fingers import Material
from gripper.objects import Array

LawName = Literal["svk", "biot", "hencky", "neo_hookean"]
Jet: TypeAlias = tuple[Array, Array, Array, Array, Array, Array]
"""A function of a and b: value, first derivatives (a, b), second derivatives (aa, ab, bb)."""

_A = np.array([[1.0, 0, 0, 1], [0, 1, -1, 0], [0, -1, 1, 0], [1, 0, 0, 1]])
_B = np.array([[1.0, 0, 0, -1], [0, 1, 1, 0], [0, 1, 1, 0], [-1, 0, 0, 1]])
_SERIES = 1e-3  # below this b / a the series is exact to round-off


class InvertedError(ArithmeticError):
    """A place of the finger is turned inside out (det F <= 0)."""


def squared_lengths(gradients: Array) -> tuple[Array, Array]:
    """a and b (n,) of deformation gradients (n, 4), ordered F11, F12, F21, F22."""
    f11, f12, f21, f22 = np.moveaxis(gradients, -1, 0)
    return (f11 + f22) ** 2 + (f21 - f12) ** 2, (f11 - f22) ** 2 + (f21 + f12) ** 2


def _svk(a: Array, b: Array) -> tuple[Jet, Jet]:
    """Green's strain, (stretch^2 - 1) / 2: St. Venant-Kirchhoff."""
    zero, quarter = np.zeros_like(a), np.full_like(a, 0.25)
    return ((a + b) / 4 - 1, quarter, quarter, zero, zero, zero), (a * b / 4, b / 4, a / 4, zero, quarter, zero)


def _biot(a: Array, b: Array) -> tuple[Jet, Jet]:
    """Biot's strain, stretch - 1: linear in the stretch, the beam's counterpart."""
    zero, root = np.zeros_like(a), np.sqrt(a)
    return (root - 2, 0.5 / root, zero, -0.25 / (a * root), zero, zero), (b, zero, zero + 1, zero, zero, zero)


def _hencky(a: Array, b: Array) -> tuple[Jet, Jet]:
    """Hencky's strain, the logarithm of the stretch: e1 + e2 = log J, e1 - e2 = 2 artanh sqrt(b / a)."""
    j = a - b
    total = (np.log(j / 4), 1 / j, -1 / j, -1 / j**2, 1 / j**2, -1 / j**2)
    x = b / a
    h, h1, h2 = _squared_artanh(x)
    xa, xb, xaa, xab = -x / a, 1 / a, 2 * x / a**2, -1 / a**2
    first, second = (h1 * xa, h1 * xb), (h2 * xa**2 + h1 * xaa, h2 * xa * xb + h1 * xab, h2 * xb**2)
    return total, tuple(4 * v for v in (h, *first, *second))  # type: ignore[return-value]  # six of them


def _squared_artanh(x: Array) -> tuple[Array, Array, Array]:
    """artanh(sqrt x)^2 and its first two derivatives; smooth also at x = 0."""
    large = np.where(x > _SERIES, x, 0.25)
    root = np.sqrt(large)
    powers = [x**k for k in range(7)]
    t = np.where(x > _SERIES, np.arctanh(root) / root, sum(p / (2 * k + 1) for k, p in enumerate(powers)))
    series = sum((k + 1) * p / (2 * k + 3) for k, p in enumerate(powers[:6]))
    slope = np.where(x > _SERIES, (1 / (1 - large) - t) / (2 * large), series)
    return x * t**2, t / (1 - x), (slope * (1 - x) + t) / (1 - x) ** 2


LAWS: dict[str, Callable[[Array, Array], tuple[Jet, Jet]]] = {"svk": _svk, "biot": _biot, "hencky": _hencky}
"""Sum and squared difference of the principal strains, by name, of laws that have a strain of their own."""


@dataclass(frozen=True)
class Law:
    """A material law with its two constants.

    Parameters
    ----------
    name
        "svk" (St. Venant-Kirchhoff), "biot" (linear in the stretch), "hencky" (logarithmic) or "neo_hookean".
    modulus
        M, in Pa.
    ratio
        nu of the plane, without unit.
    """

    name: LawName
    modulus: float
    ratio: float

    @classmethod
    def of(cls, material: Material, name: LawName) -> Law:
        """The law of a finger's material: E and nu; a shear modulus of its own is not read.

        Raises
        ------
        LookupError
            An unknown law.
        ValueError
            An incompressible material in plane strain.
        """
        if name not in get_args(LawName):
            raise LookupError(f"unknown law {name!r}; known: {', '.join(get_args(LawName))}")
        E, nu = material.youngs_modulus, material.poisson_ratio
        shear, given = E / (2 * (1 + nu)), nu
        if material.plane == "strain":
            if nu > 0.499:
                raise ValueError(f"poisson_ratio must be at most 0.499 in plane strain (elements lock); got {nu!r}")
            E, nu = E / (1 - nu**2), nu / (1 - nu)
        if name == "neo_hookean":
            return NeoHookean(name, E / (1 - nu**2), nu, shear, given, material.plane == "stress")
        return cls(name, E / (1 - nu**2), nu)

    def respond(self, gradients: Array) -> tuple[Array, Array, Array]:
        """Strain energy and its derivatives by F.

        Parameters
        ----------
        gradients
            Deformation gradients F (n, 4), ordered F11, F12, F21, F22.

        Returns
        -------
        W (n,), first Piola-Kirchhoff stress (n, 4), both in Pa, and its derivative by F (n, 4, 4), in Pa.

        Raises
        ------
        InvertedError
            Where det F is not positive.
        """
        a, b = squared_lengths(gradients)
        if not np.all(a > b):
            raise InvertedError("an element is inverted")
        w, wa, wb, waa, wab, wbb = self.energy(a, b)
        fa, fb = gradients @ _A, gradients @ _B
        stress = 2 * (wa[:, None] * fa + wb[:, None] * fb)
        left, right = np.stack([fa, fb], axis=2), np.stack([fa, fb], axis=1)
        second = 4 * np.stack([np.stack([waa, wab], -1), np.stack([wab, wbb], -1)], -2)
        stiffness = left @ (second @ right) + 2 * (wa[:, None, None] * _A + wb[:, None, None] * _B)
        return w, stress, stiffness

    def energy(self, a: Array, b: Array) -> Jet:
        """W as a function of a and b."""
        total, difference = LAWS[self.name](a, b)
        s, sa, sb, saa, sab, sbb = total
        add, cut = self.modulus / 4 * (1 + self.ratio), self.modulus / 4 * (1 - self.ratio)
        d, da, db, daa, dab, dbb = (cut * v for v in difference)
        return (
            add * s**2 + d,
            2 * add * s * sa + da,
            2 * add * s * sb + db,
            2 * add * (sa**2 + s * saa) + daa,
            2 * add * (sa * sb + s * sab) + dab,
            2 * add * (sb**2 + s * sbb) + dbb,
        )


@dataclass(frozen=True)
class NeoHookean(Law):
    """W = mu / 2 (I1 - 3 - 2 ln J) + lambda / 2 (ln J)^2 in three dimensions.

    Parameters
    ----------
    shear_modulus
        mu, in Pa.
    poisson_ratio
        nu, of three dimensions.
    thins
        Whether the third direction is free of stress (plane stress); else it is held.
    """

    shear_modulus: float
    poisson_ratio: float
    thins: bool

    def energy(self, a: Array, b: Array) -> Jet:
        """W as a function of a and b: mu / 4 (a + b) + h(J)."""
        J, mu, quarter = (a - b) / 4, self.shear_modulus, np.full_like(a, self.shear_modulus / 4)
        h, h1, h2 = self._thinning(J) if self.thins else self._held(J)
        first, second = mu * h1 / 4, mu * h2 / 16
        return mu * ((a + b) / 4 + h), quarter + first, quarter - first, second, -second, second

    def _thinning(self, J: Array) -> tuple[Array, Array, Array]:
        """h over mu and its slopes; u, the square of the third stretch, leaves no stress along it."""
        nu, log = self.poisson_ratio, np.zeros_like(J)  # ln u
        for _ in range(_NEWTON):
            u = np.exp(log)
            left = (1 - 2 * nu) * (u - 1) + 2 * nu * (np.log(J) + log / 2)
            log = log - left / ((1 - 2 * nu) * u + nu)
        u, volume = np.exp(log), np.log(J) + log / 2
        slope = -2 * nu / J / (1 - 2 * nu + nu / u)
        return (u - 3) / 2 - volume - (u - 1) * volume / 2, -u / J, u / J**2 - slope / J

    def _held(self, J: Array) -> tuple[Array, Array, Array]:
        """h over mu and its slopes where the third stretch is 1."""
        lame, volume = 2 * self.poisson_ratio / (1 - 2 * self.poisson_ratio), np.log(J)
        slope = (lame * volume - 1) / J
        return lame * volume**2 / 2 - volume - 1, slope, (lame - lame * volume + 1) / J**2


_NEWTON = 8
