"""What kind of quantity a number is: powers of SI's units; and the kinds that a piece of an expression can be.

A number without a unit stands for SI, so it fits everything; so does what is made of such numbers alone. A unit that is
written must be right.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from fractions import Fraction
from typing import NamedTuple, TypeAlias

MOST_KINDS = 64
"""Kinds that a piece of an expression is followed up to; beyond, it fits everything."""
_FACTOR = re.compile(r"\s*(?P<sign>[*/]?)\s*(?P<unit>[A-Za-z]+|1)(?:\*\*(?P<power>-?\d+))?\s*")


class Dimension(NamedTuple):
    """The kind of a quantity: powers of m, kg, s and rad."""

    m: Fraction = Fraction(0)
    kg: Fraction = Fraction(0)
    s: Fraction = Fraction(0)
    rad: Fraction = Fraction(0)

    def times(self, other: Dimension, power: Fraction | int = 1) -> Dimension:
        """Multiply by a power of another quantity."""
        return Dimension(*(a + power * b for a, b in zip(self, other, strict=True)))

    def to(self, power: Fraction) -> Dimension:
        """Raise to a power."""
        return PURE.times(self, power)

    @property
    def kinds(self) -> frozenset[Dimension]:
        """It, and where an angle is a factor also what it is without: 1 m * 2 rad is an arc of 2 m."""
        without = self._replace(rad=Fraction(0))
        return frozenset({self} if without == PURE else {self, without})

    @property
    def unit(self) -> str:
        """The SI unit, as an expression writes it; empty for a number without unit."""
        return _UNITS.get(self, "") or self._spelt()

    def _spelt(self) -> str:
        """Spell the unit by newtons, where there are any."""
        newtons = self.kg if self.s == -2 * self.kg else Fraction(0)
        rest = (self.m - newtons, self.kg - newtons, self.s + 2 * newtons, self.rad)
        powers = zip(("N", "m", "kg", "s", "rad"), (newtons, *rest), strict=True)
        return "*".join(name if power == 1 else f"{name}**{power}" for name, power in powers if power)

    @property
    def word(self) -> str:
        """In words: "a length"."""
        return _WORDS.get(self) or f"a quantity in {self.unit}"

    def __str__(self) -> str:
        """In words, with the unit: "a length, in m"."""
        return f"{self.word}, in {self.unit}" if self.unit and self in _WORDS else self.word


_ONE = Fraction(1)
PURE = Dimension()
"""A number without unit."""
METRE, KILOGRAM, SECOND, RADIAN = (Dimension(**{name: _ONE}) for name in Dimension._fields)
NEWTON = Dimension(_ONE, _ONE, Fraction(-2))
PASCAL = NEWTON.times(METRE, -2)
_OF_UNITS = {
    **{"1": PURE, "m": METRE, "um": METRE, "mm": METRE, "cm": METRE, "in": METRE, "kg": KILOGRAM, "s": SECOND},
    **{"rad": RADIAN, "deg": RADIAN, "N": NEWTON, "mN": NEWTON, "J": NEWTON.times(METRE)},
    **dict.fromkeys(("Pa", "kPa", "MPa", "GPa"), PASCAL),
}


def unit(text: str) -> Dimension:
    """Tell the kind of a unit: ``unit("N/m")`` of a spring's stiffness, ``unit("kg/m**3")``, ``unit("1/m")``.

    Raises
    ------
    ValueError
        The text is no product of units and their powers.
    """
    kind, i = PURE, 0
    while i < len(text) or not text:
        match = _FACTOR.match(text, i)
        if not match or bool(match["sign"]) != (i > 0) or match["unit"] not in _OF_UNITS:
            known = ", ".join(_OF_UNITS)
            raise ValueError(f"unit must be a product of known ones, as 'kg/m**3'; known: {known}; got {text!r}")
        power = int(match["power"] or 1)
        kind = kind.times(_OF_UNITS[match["unit"]], -power if match["sign"] == "/" else power)
        i = match.end()
    return kind


_UNITS = {PURE: "", PASCAL: "Pa", unit("N*m"): "N*m", unit("kg/m"): "kg/m", unit("kg/m**3"): "kg/m**3"} | {
    unit(text): text for text in ("1/m", "N/m", "m/s**2", "N*m/rad")
}
_WORDS = {
    **{PURE: "a number without unit", METRE: "a length", RADIAN: "an angle", NEWTON: "a force", PASCAL: "a stress"},
    **{unit("N*m"): "a moment", unit("N/m"): "a stiffness", unit("N*m/rad"): "a stiffness"},
    **{unit("m**2"): "an area", unit("1/m"): "a curvature", KILOGRAM: "a mass", unit("kg/m**3"): "a density"},
    **{unit("kg/m"): "a mass per length", unit("m/s**2"): "an acceleration"},
}

Kinds: TypeAlias = frozenset[Dimension] | None
"""Kinds that something can be; None for any."""


class Measure(NamedTuple):
    """What a piece of an expression can be.

    Parameters
    ----------
    kinds
        Its possible kinds.
    free
        Whether it stands for a number in SI of whatever kind is asked for.
    written
        Whether a unit is written in it.
    """

    kinds: Kinds
    free: bool = False
    written: bool = False

    @property
    def turned(self) -> Kinds:
        """Its kinds, an angle too where units may have cancelled: an arc over its radius."""
        return self.kinds | {RADIAN} if self.kinds and self.written and PURE in self.kinds else self.kinds

    def fits(self, kind: Dimension) -> bool:
        """Whether it can be of a kind."""
        return self.free or self.turned is None or not self.turned.isdisjoint(kind.kinds)

    def __str__(self) -> str:
        """In words, for a message."""
        kinds = self.kinds or frozenset()
        return " or ".join(sorted(kind.word for kind in (kinds - {PURE} or kinds)))


PLAIN = Measure(frozenset({PURE}), free=True)
"""A number without a unit."""


def of_unit(name: str) -> Measure:
    """Of a unit's name, alone or after a number."""
    return Measure(frozenset({_OF_UNITS[name]}), written=True)


def of_symbol(name: str, kind: Dimension | None) -> Measure:
    """Of a symbol: x, y and s are places in m; any other is of the kind given, where it is known.

    It also stands for its number of SI units: coefficients seldom have their units written.
    """
    if name in ("x", "y", "s"):
        return Measure(frozenset({METRE, PURE}), free=True)
    return Measure(None, free=True) if kind is None else Measure(frozenset({kind, PURE}))


def _made(kinds: Collection[Dimension] | None, written: bool) -> Measure:
    """Of a product: what has no unit written in it, or in which all units cancel, is a plain number."""
    if kinds is None or len(kinds) > MOST_KINDS:
        return Measure(None, free=not written, written=written)
    whole = written and set(kinds) != {PURE}
    return Measure(frozenset(kinds), free=not whole, written=whole)


def product(one: Measure, other: Measure, power: int = 1) -> Measure:
    """One times the other, or divided by it (power -1)."""
    if one.kinds is None or other.kinds is None:
        return _made(None, one.written or other.written)
    pairs = (a.times(b, power) for a in one.kinds for b in other.kinds)
    return _made({kind for pair in pairs for kind in pair.kinds}, one.written or other.written)


def total(parts: Collection[Measure]) -> Measure:
    """Of a sum, or of min and max: like with like.

    Raises
    ------
    ValueError
        The parts are of different kinds; says the rule only.
    """
    first, *others = parts
    for part in others:
        first = _like(first, part)
    return first


def _like(one: Measure, other: Measure) -> Measure:
    written = one.written or other.written
    if one.free != other.free:
        return (other if one.free else one)._replace(written=written)
    left, right = one.turned, other.turned
    if left is None or right is None:
        known = right if left is None else left
        return Measure(None if one.free else known, one.free, written)
    kinds = left | right if one.free else left & right
    if not kinds:
        raise ValueError(f"take like with like, not {one} with {other}")
    return Measure(kinds, one.free, written)


def raised(base: Measure, exponent: Measure, value: float | None) -> Measure:
    """Of a power; ``value`` is the exponent's where that is a number.

    Raises
    ------
    ValueError
        An exponent with a unit; says the rule only.
    """
    if not exponent.fits(PURE):
        raise ValueError(f"have an exponent without unit, not {exponent}")
    if base.kinds is None or value is None:
        return PLAIN if base.kinds == PLAIN.kinds else _made(None, base.written)
    power = Fraction(value).limit_denominator(100)
    return _made({kind.to(power) for kind in base.kinds}, base.written)


def applied(name: str, arguments: list[Measure]) -> Measure:
    """Of a function's value.

    Raises
    ------
    ValueError
        Arguments of a kind that it does not take; says the rule only.
    """
    if name in ("abs", "min", "max"):
        return total(arguments)
    if name == "sqrt":
        return raised(arguments[0], PLAIN, 0.5)
    if name == "atan2":
        total(arguments)
        return Measure(frozenset({PURE, RADIAN}), free=True)
    turns = name in ("sin", "cos", "tan")
    if not (arguments[0].fits(PURE) or (turns and arguments[0].fits(RADIAN))):
        raise ValueError(f"give {name} {'an angle' if turns else 'a number without unit'}, not {arguments[0]}")
    return Measure(frozenset({PURE, RADIAN}), free=True) if name.startswith("a") else PLAIN
