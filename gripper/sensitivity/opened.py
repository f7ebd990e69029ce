"""Parts of a scene with symbols in the place of their numbers, so that sympy differentiates what plugins write."""

from __future__ import annotations

import copy
import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

import sympy

from gripper.fingers import Finger, S
from gripper.kinks import beside_kinks, switches
from gripper.objects.compiled import X, Y, compiled

Part = TypeVar("Part")


class _Open(sympy.Dummy):  # type: ignore[misc]
    """A symbol that knows its number: plugins may compare it (the larger of two semi-axes) as they would that."""

    value: float

    @classmethod
    def of(cls, name: str, value: float) -> _Open:
        symbol: _Open = cls(name, positive=True) if value > 0 else cls(name, real=True)
        symbol.value = value
        return symbol

    def __lt__(self, other: Any) -> bool:
        return self.value < getattr(other, "value", other)

    def __le__(self, other: Any) -> bool:
        return self.value <= getattr(other, "value", other)

    def __gt__(self, other: Any) -> bool:
        return self.value > getattr(other, "value", other)

    def __ge__(self, other: Any) -> bool:
        return self.value >= getattr(other, "value", other)


def symbol(key: str, value: float) -> sympy.Symbol:
    """The symbol of a number in expressions that are kept: the same for all scenes in which it has the same sign."""
    return sympy.Symbol(key, positive=True) if value > 0 else sympy.Symbol(key, real=True)


class NotOpenError(ValueError):
    """A plugin's formula does not take symbols."""


class Opened:
    """A part with symbols in the place of some of its numbers.

    Parameters
    ----------
    part
        A frozen dataclass: a finger, a jaw, an object.
    values
        Its numbers by their keys, without the part's own name: ``semi_axes[0]``, ``jaw.lead_angle``.
    """

    def __init__(self, part: Any, values: Mapping[str, float]) -> None:
        self.name = type(part).__name__
        self._values = dict(values)
        self.symbols = {key: symbol(key, value) for key, value in values.items()}
        inner = {key: _Open.of(key, value) for key, value in values.items()}
        self._outer = {inner[key]: self.symbols[key] for key in values}
        self.part = _grafted(part, "", inner)

    def values(self) -> Iterator[tuple[sympy.Symbol, float]]:
        """The symbols and their numbers."""
        return ((self.symbols[key], value) for key, value in self._values.items())

    def read(self, formula: Any) -> Any:
        """What a plugin's formula gives for the opened part: expressions of the keys' symbols.

        Raises
        ------
        NotOpenError
            Where it does not take symbols.
        """
        try:
            found = formula(self.part)
        except (TypeError, AttributeError) as error:
            rule = "be written so that its formulas take sympy's symbols, to be differentiated"
            raise NotOpenError(f"{self.name} must {rule}; got {error}") from error
        return self._closed(found)

    def _closed(self, found: Any) -> Any:
        if isinstance(found, (tuple, list)):
            return tuple(self._closed(item) for item in found)
        return sympy.sympify(found).xreplace(self._outer)


def _grafted(part: Any, path: str, symbols: Mapping[str, _Open]) -> Any:
    """A copy with symbols for numbers; what its class derived when it was made stays as it is."""
    if path in symbols:
        if isinstance(part, sympy.Expr):
            return part + symbols[path] - symbols[path].value
        return symbols[path]
    if isinstance(part, tuple):
        return tuple(_grafted(item, f"{path}[{i}]", symbols) for i, item in enumerate(part))
    if not dataclasses.is_dataclass(part) or not any(key.startswith(path) for key in symbols):
        return part
    clone = copy.copy(part)
    for field in dataclasses.fields(part):
        name = f"{path}.{field.name}" if path else field.name
        object.__setattr__(clone, field.name, _grafted(getattr(part, field.name), name, symbols))
    return clone


@dataclasses.dataclass(frozen=True)
class Profile:
    """Formulas of a finger's sections in s and its numbers: w, EI, kappa_s GA, EA, in SI units; its kinks; its jaw."""

    thickness: sympy.Expr
    bending: sympy.Expr
    shear: sympy.Expr
    stretch: sympy.Expr
    kinks: tuple[sympy.Expr, ...]
    jaw: tuple[tuple[sympy.Expr, sympy.Expr], ...]


@functools.lru_cache(maxsize=256)
def profile(finger: Finger, values: tuple[tuple[str, float], ...]) -> tuple[Profile, dict[str, sympy.Symbol]]:
    """A finger's formulas, and the symbols of its numbers (``material.shear_modulus`` also where it follows from E).

    Opened once a finger.

    Raises
    ------
    NotOpenError
        Where the finger or its jaw does not take symbols.
    """
    given = dict(values)
    derived = given.pop("material.shear_modulus", None) if finger.material.shear_modulus is None else None
    opened = Opened(finger, given)
    symbols = dict(opened.symbols)

    def stiffness(part: Finger) -> tuple[Any, ...]:
        w, b, material = part.w(S), part.b(S), part.material
        modulus = material.bending_modulus
        return w, modulus * b * w**3 / 12, material.shear_coefficient * b * w, modulus * b * w

    w, bending, area, stretch = opened.read(stiffness)
    rigidity = opened.read(lambda part: part.material.G)
    if derived is not None:
        symbols["material.shear_modulus"] = extra = symbol("material.shear_modulus", derived)
        rigidity += extra - derived
    jaw: Any = ()
    if finger.jaw is not None:
        tip = opened.read(lambda part: part.w(part.length))
        jaw = _jaw(opened, tip)
    return Profile(w, bending, rigidity * area, stretch, _kinks(finger, opened), jaw), symbols


def _kinks(finger: Finger, opened: Opened) -> tuple[sympy.Expr, ...]:
    """The kinks of a profile, as expressions: those that a plugin writes, or roots of what changes over there."""
    places = finger.kinks()
    if not places:
        return ()
    if type(finger).kinks is not Finger.kinks:
        written: tuple[sympy.Expr, ...] = opened.read(lambda part: part.kinks())
        return written
    at = dict(opened.values())
    found = {change for profile in opened.read(lambda part: (part.w(S), part.b(S))) for change in switches(profile)}
    return tuple(_root(place, found, at, finger.length) for place in places)


def _root(place: float, changes: set[sympy.Expr], at: Mapping[sympy.Symbol, float], length: float) -> sympy.Expr:
    """Where one of these is 0, to first order in the numbers: one step of Newton's from there."""
    for change in changes:
        slope = float(sympy.diff(change, S).subs(at).subs(S, place))
        if slope and abs(float(change.subs(at).subs(S, place))) < 1e-9 * abs(slope) * length:
            return sympy.Float(place) - change.subs(S, place) / slope
    return sympy.Float(place)


_TIP = sympy.Symbol("tip thickness", positive=True)


def _jaw(opened: Opened, tip: sympy.Expr) -> tuple[tuple[sympy.Expr, sympy.Expr], ...]:
    polygon = opened.read(lambda part: part.jaw.polygon(_TIP))
    return tuple((x.xreplace({_TIP: tip}), y.xreplace({_TIP: tip})) for x, y in polygon)


@functools.lru_cache(maxsize=256)
def derivatives(
    expressions: tuple[sympy.Expr, ...], by: tuple[sympy.Symbol, ...], arguments: tuple[sympy.Symbol, ...]
) -> Any:
    """Expressions followed by their derivatives (by each symbol, all expressions), as one numpy function."""
    flat = [*expressions, *(sympy.diff(e, p) for p in by for e in expressions)]
    return compiled(arguments, tuple(beside_kinks(sympy.sympify(e)) for e in flat))


def surface(g: sympy.Expr, by: tuple[sympy.Symbol, ...]) -> Any:
    """The derivatives of g, g_x and g_y by numbers, as a function of x, y and all numbers."""
    return derivatives((g, sympy.diff(g, X), sympy.diff(g, Y)), by, (X, Y, *by))
