"""Arrays that carry their rate in one direction: the formulas of first derivatives, run on them, give second ones.

numpy's functions are dispatched to them. What numpy would have to know of a function's curvature is refused, so that a
rate is never dropped in silence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, cast

import numpy as np

from gripper.arrays import Array


class NotFormedError(Exception):
    """Second derivatives that are not formed; says of what."""


class Jet(np.lib.mixins.NDArrayOperatorsMixin):
    """Values and their rates, of one shape.

    Parameters
    ----------
    value, rate
        Numbers or arrays; the rate is broadcast to the value's shape.
    """

    __slots__ = ("rate", "value")

    def __init__(self, value: Any, rate: Any) -> None:
        self.value, self.rate = np.asarray(value), np.asarray(rate)
        if self.rate.shape != self.value.shape:
            self.rate = np.broadcast_to(self.rate, self.value.shape)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Do what numpy's elementwise functions do, and differentiate it."""
        if method != "__call__" or options:
            return NotImplemented
        values = [value_of(item) for item in inputs]
        if ufunc in _STEPS:
            return ufunc(*values)
        if ufunc in _LINEAR:
            return Jet(ufunc(*values), ufunc(*map(rate_of, inputs)))
        if ufunc in _PRODUCTS:
            return _product(ufunc, inputs)
        if ufunc not in _RULES:
            return NotImplemented
        value = ufunc(*values)
        return Jet(value, _RULES[ufunc](value, *values, *map(rate_of, inputs)))

    def __array_function__(
        self, function: Callable[..., Any], types: Iterable[type], arguments: Any, options: dict[str, Any]
    ) -> Any:
        """Do what numpy's other functions do, and differentiate it."""
        if function is np.zeros:
            return Jet(function(*arguments, **options), function(*arguments, **options))
        if function is np.where:
            choice, *either = arguments
            return Jet(function(choice, *map(value_of, either)), function(choice, *map(rate_of, either)))
        if function in _LINEAR:
            return Jet(function(*value_of(arguments), **options), function(*_arguments(arguments), **options))
        if function in _PRODUCTS:
            first = (arguments[0],) if isinstance(arguments[0], str) else ()
            return _product(lambda *factors: function(*first, *factors, **options), arguments[len(first) :])
        return NotImplemented

    def __getitem__(self, key: Any) -> Jet:
        """Part of it."""
        return Jet(self.value[key], self.rate[key])

    def __setitem__(self, key: Any, item: Any) -> None:
        """Write part of it, with its rate: of zeros, or of a copy."""
        self.value[key], self.rate[key] = value_of(item), rate_of(item)

    def __len__(self) -> int:
        return len(self.value)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of both."""
        return self.value.shape

    @property
    def size(self) -> int:
        """How many numbers."""
        return self.value.size

    @property
    def real(self) -> Jet:
        """Real parts."""
        return Jet(self.value.real, self.rate.real)

    @property
    def imag(self) -> Jet:
        """Imaginary parts."""
        return Jet(self.value.imag, self.rate.imag)

    @property
    def T(self) -> Jet:
        """Transposed."""
        return Jet(self.value.T, self.rate.T)

    def __iadd__(self, other: Any) -> Any:
        """More of it."""
        return self + other

    def __isub__(self, other: Any) -> Any:
        """Less of it."""
        return self - other

    def conj(self) -> Jet:
        """Conjugated."""
        return Jet(self.value.conj(), self.rate.conj())

    conjugate = conj

    def sum(self, axis: Any = None) -> Jet:
        """Sums."""
        return Jet(self.value.sum(axis=axis), self.rate.sum(axis=axis))

    def copy(self) -> Jet:
        """A copy, to be written to."""
        return Jet(self.value.copy(), self.rate.copy())

    def ravel(self) -> Jet:
        """In one row."""
        return Jet(self.value.ravel(), self.rate.ravel())

    def reshape(self, *shape: Any) -> Jet:
        """In another shape."""
        return Jet(self.value.reshape(*shape), self.rate.reshape(*shape))

    def swapaxes(self, one: int, other: int) -> Jet:
        """With two axes exchanged."""
        return Jet(self.value.swapaxes(one, other), self.rate.swapaxes(one, other))


def jet(value: Any, rate: Any) -> Array:
    """Values with their rates: to whoever reckons with them, an array like any other."""
    return cast(Array, Jet(value, rate))


def value_of(item: Any) -> Any:
    """Without the rate; also of what is in lists."""
    if isinstance(item, (list, tuple)):
        return type(item)(value_of(part) for part in item)
    return item.value if isinstance(item, Jet) else item


def rate_of(item: Any) -> Any:
    """The rate of one array or number: 0 of what carries none."""
    return item.rate if isinstance(item, Jet) else np.zeros_like(item)


def _arguments(item: Any) -> Any:
    """What a function is given, by its rates; whole numbers are shapes and counts, and stay."""
    if isinstance(item, (list, tuple)):
        return type(item)(_arguments(part) for part in item)
    return item if isinstance(item, int) else rate_of(item)


def lifted(function: Callable[[Any], Array], slope: Callable[[Any], Array], at: Any) -> Array:
    """A compiled function at arrays, or at what carries a rate, by its slope."""
    if not isinstance(at, Jet):
        return function(at)
    return jet(function(at.value), slope(at.value) * at.rate)


def _product(function: Callable[..., Any], factors: Any) -> Jet:
    """Of what is linear in each factor: the rates of one after the other."""
    values = [value_of(factor) for factor in factors]
    rate: Any = 0.0
    for i, factor in enumerate(factors):
        if isinstance(factor, Jet):
            rate = rate + function(*values[:i], factor.rate, *values[i + 1 :])
    return Jet(function(*values), rate)


def _absolute(value: Any, x: Any, dx: Any) -> Any:
    return (np.conj(x) * dx).real / np.where(value == 0, 1.0, value)


_STEPS = {np.sign, np.greater, np.less, np.greater_equal, np.less_equal, np.equal, np.not_equal, np.isfinite}
_LINEAR = {
    *(np.add, np.subtract, np.negative, np.positive, np.conjugate),
    *(np.concatenate, np.stack, np.column_stack, np.reshape, np.ravel, np.sum, np.diff, np.repeat, np.swapaxes),
    *(np.broadcast_to, np.real, np.imag, np.roll, np.transpose),
}
_PRODUCTS = {np.multiply, np.matmul, np.einsum, np.outer, np.dot}
_RULES: dict[Any, Callable[..., Any]] = {
    np.divide: lambda value, x, y, dx, dy: (dx - value * dy) / y,
    np.power: lambda value, x, n, dx, dn: n * x ** (n - 1) * dx,
    np.square: lambda value, x, dx: 2 * x * dx,
    np.exp: lambda value, x, dx: value * dx,
    np.sqrt: lambda value, x, dx: dx / (2 * value),
    np.absolute: _absolute,
}
