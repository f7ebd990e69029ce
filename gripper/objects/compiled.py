"""From sympy to numpy: g and its derivatives, differentiated and compiled once."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar

import numpy as np
import sympy
from sympy.printing.numpy import NumPyPrinter

from gripper.objects.base import Array

X = sympy.Symbol("x", real=True)
Y = sympy.Symbol("y", real=True)

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class PerInstance(Generic[Key, Value]):
    """A cache by equality with a quick way in by identity: hashing 500 vertices costs more than using them."""

    def __init__(self, build: Callable[[Key], Value]) -> None:
        self._build = functools.lru_cache(maxsize=256)(build)
        self._seen: dict[int, tuple[weakref.ref[Any], Value]] = {}

    def __call__(self, instance: Key) -> Value:
        """Return the value built for this instance, or for one equal to it."""
        key = id(instance)
        seen = self._seen.get(key)
        if seen is not None and seen[0]() is instance:
            return seen[1]
        value = self._build(instance)
        self._seen[key] = (weakref.ref(instance, lambda _: self._seen.pop(key, None)), value)
        return value


def smooth(expression: sympy.Expr) -> sympy.Expr:
    """Drop the delta functions that kinks leave in second derivatives: the value beside a kink."""
    return expression.replace(sympy.DiracDelta, lambda *_: sympy.Integer(0))


def second_derivatives(gradient: tuple[sympy.Expr, sympy.Expr]) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
    """Return the entries xx, xy, yy of the Hessian, with the delta functions of kinks."""
    return sympy.diff(gradient[0], X), sympy.diff(gradient[0], Y), sympy.diff(gradient[1], Y)


def second_derivatives_beside_kinks(
    gradient: tuple[sympy.Expr, sympy.Expr],
) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
    """Return the entries xx, xy, yy of the Hessian beside kinks, where the gradient's steps are constants.

    The delta functions are not even made: those of a maximum of ten take a minute.
    """
    steps = set[sympy.Expr]().union(*(entry.atoms(sympy.Heaviside, sympy.sign) for entry in gradient))
    held = {step: sympy.Dummy() for step in steps}
    again = {constant: step for step, constant in held.items()}
    along_x, along_y = (entry.xreplace(held) for entry in gradient)
    xx, xy, yy = second_derivatives((along_x, along_y))
    return xx.xreplace(again), xy.xreplace(again), yy.xreplace(again)


@functools.lru_cache(maxsize=1024)
def compiled(arguments: tuple[sympy.Symbol, ...], expressions: tuple[sympy.Expr, ...]) -> Callable[..., Any]:
    """Compile all expressions into one numpy function, common subexpressions shared."""
    return sympy.lambdify(arguments, expressions, modules="numpy", cse=True, printer=_Printer)


class _Printer(NumPyPrinter):  # type: ignore[misc]
    """numpy's pairwise minimum and maximum, and its step, instead of arrays of all cases, for their speed."""

    def _pairwise(self, function: str, expression: sympy.Expr) -> str:
        arguments = [str(self._print(argument)) for argument in expression.args]
        return functools.reduce(lambda a, b: f"{function}({a}, {b})", arguments)

    def _print_Min(self, expression: sympy.Expr) -> str:
        return self._pairwise("minimum", expression)

    def _print_Max(self, expression: sympy.Expr) -> str:
        return self._pairwise("maximum", expression)

    def _print_Heaviside(self, expression: sympy.Expr) -> str:
        return f"heaviside({self._print(expression.args[0])}, 0.5)"


class Derivatives:
    """g, its gradient and its Hessian as numpy functions of x, y and of coefficients, each made when it is asked for.

    Parameters
    ----------
    g, gradient
        Expressions in ``X``, ``Y`` and the coefficients.
    hessian
        Its entries xx, xy, yy; those of the gradient beside kinks by default.
    coefficients
        Symbols that each point gives its own value.
    """

    def __init__(
        self,
        g: sympy.Expr,
        gradient: tuple[sympy.Expr, sympy.Expr],
        hessian: tuple[sympy.Expr, sympy.Expr, sympy.Expr] | None = None,
        coefficients: tuple[sympy.Symbol, ...] = (),
    ) -> None:
        self._arguments = (X, Y, *coefficients)
        self._g, self._gradient, self._hessian = g, gradient, hessian
        self._functions: dict[int, Callable[..., Any]] = {}

    def _compiled(self, order: int) -> Callable[..., Any]:
        if order < 2:
            return compiled(self._arguments, (self._g, *self._gradient)[: 1 + 2 * order])
        hessian = self._hessian or second_derivatives_beside_kinks(self._gradient)
        return compiled(self._arguments, (self._g, *self._gradient, *hessian))

    def __call__(self, points: Array, order: int, *coefficients: Array) -> tuple[Array, ...]:
        """Return g (n,), the gradient (n, 2) and the Hessian (n, 2, 2) at points (n, 2), up to ``order``."""
        function = self._functions.get(order)
        if function is None:
            function = self._functions[order] = self._compiled(order)
        values = function(points[:, 0], points[:, 1], *coefficients)
        n = len(points)
        g = np.empty(n)
        g[...] = values[0]  # a constant fills its array
        if order == 0:
            return (g,)
        gradient = np.empty((n, 2))
        gradient[:, 0], gradient[:, 1] = values[1], values[2]
        if order == 1:
            return g, gradient
        hessian = np.empty((n, 2, 2))
        hessian[:, 0, 0], hessian[:, 1, 1] = values[3], values[5]
        hessian[:, 0, 1] = hessian[:, 1, 0] = values[4]
        return g, gradient, hessian
