"""The one parser of expressions in text: arithmetic, units and a few functions, and nothing else.

Text never reaches Python's ``eval`` or sympy's parsers: what this grammar cannot say cannot happen::

    sum     = product {("+" | "-") product}
    product = signed {("*" | "/") signed}
    signed  = ("+" | "-") signed | power
    power   = operand ["**" signed]
    operand = number [blank unit] | name | function "(" sum {"," sum} ")" | "(" sum ")"
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any, Literal

import sympy

from gripper.expression.values import Value, applied, combined, quantity, raised, symbolic
from gripper.expression.vocabulary import (
    ARGUMENTS,
    CONSTANTS,
    DEEPEST,
    FUNCTIONS,
    LONGEST_TEXT,
    NAME,
    UNITS,
    WORDS,
    is_name,
    is_reserved,
)
from gripper.names import known_names, shortened

__all__ = ["is_name", "is_reserved", "number", "parse"]

_BLANK = r"[ \t\r\n]*"
_NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_TOKEN = re.compile(rf"(?:(?P<number>{_NUMBER})|(?P<name>{NAME.pattern})|(?P<sign>\*\*|[-+*/(),])|(?P<end>\Z)){_BLANK}")


def parse(text: str, names: Collection[str] = ()) -> sympy.Expr:
    """Read an expression.

    Parameters
    ----------
    text
        Arithmetic with ``+ - * / **`` (as in Python), brackets, units after a number and a blank (``3.2 mm`` is
        0.0032 and binds tighter than * and /; alone, a unit is a factor: ``5 N / mm**2``), pi, and the functions
        sqrt exp log sin cos tan asin acos atan atan2 abs min max. Angles are in rad.
    names
        The symbols that it may hold.

    Returns
    -------
    sympy.Expr
        In real symbols, ``sympy.Symbol(name, real=True)``, and floats.

    Raises
    ------
    ValueError
        In one line: the rule, the place in the text, and the text; also where a constant part has no finite real
        value, as 1/0 or log(-1).
    """
    return symbolic(_value(text, names))


def number(text: str) -> float:
    """Read an expression without symbols: its value in SI units; ValueError as in :func:`parse`."""
    return float(_value(text, ()))


def _value(text: str, names: Collection[str]) -> Value:
    taken = sorted(name for name in names if name in WORDS or not is_name(name))
    if taken:
        raise ValueError(f"names must be letters, digits and _, and no unit, function or pi; got {', '.join(taken)}")
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"expression must be at most {LONGEST_TEXT} characters long; got {len(text)} characters")
    return _Parser(text, names).whole()


@dataclass(frozen=True)
class _Token:
    kind: Literal["number", "name", "sign", "end"]
    text: str
    start: int


class _Parser:
    """Recursive descent: one method a rule of the grammar, each returns the value of what it read."""

    def __init__(self, text: str, names: Collection[str]) -> None:
        self.text = text
        self.names = names
        self.tokens = self.tokenised()
        self.i = 0
        self.depth = 0

    def tokenised(self) -> list[_Token]:
        tokens: list[_Token] = []
        i = len(self.text) - len(self.text.lstrip(" \t\r\n"))
        while not tokens or tokens[-1].kind != "end":
            match = _TOKEN.match(self.text, i)
            if match is None:
                raise self.unreadable(_Token("sign", self.text[i], i))
            kind: Any = match.lastgroup
            tokens.append(_Token(kind, match[kind], i))
            i = match.end()
        return tokens

    def error(self, rule: str, token: _Token) -> ValueError:
        return ValueError(f"expression must {rule} (character {token.start + 1}); got {shortened(self.text)!r}")

    def unreadable(self, token: _Token) -> ValueError:
        if token.text == "^":
            return self.error("use ** for powers, not ^", token)
        allowed = "numbers, names, brackets, commas and + - * / **"
        return self.error(f"hold nothing but {allowed}, not {token.text!r}", token)

    def unknown(self, token: _Token) -> ValueError:
        known = known_names(token.text, [*self.names, *WORDS])
        return self.error(f"hold known names only, not {shortened(token.text)!r}; known: {known}", token)

    def misplaced(self, token: _Token) -> ValueError:
        if token.kind == "name" and token.text not in (*self.names, *WORDS):
            return self.unknown(token)
        if token.text in UNITS:
            rule = f"have * between factors (only a number takes a unit without it, and only one): * {token.text}"
            return self.error(rule, token)
        if token.kind in ("name", "number") or token.text == "(":
            return self.error(f"have an operator before {shortened(token.text)!r}", token)
        return self.error(f"have no {token.text!r} here", token)

    @property
    def next(self) -> _Token:
        return self.tokens[self.i]

    def take(self, *signs: str) -> _Token | None:
        """Pass the next token if it is one of these signs."""
        token = self.next
        if token.kind != "sign" or token.text not in signs:
            return None
        self.i += 1
        return token

    def deeper(self, rule: Callable[[], Value], token: _Token) -> Value:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.error(f"nest at most {DEEPEST} levels of brackets, signs and powers", token)
        value = rule()
        self.depth -= 1
        return value

    def computed(self, token: _Token, compute: Callable[[], Value]) -> Value:
        """Compute a node; say where, when it has no value."""
        try:
            return compute()
        except ValueError as error:
            raise self.error(str(error), token) from None

    def whole(self) -> Value:
        value = self.sum()
        if self.next.kind != "end":
            raise self.misplaced(self.next)
        return value

    def sum(self) -> Value:
        return self.chain(self.product, "+", "-")

    def product(self) -> Value:
        return self.chain(self.signed, "*", "/")

    def chain(self, rule: Callable[[], Value], *signs: str) -> Value:
        left = rule()
        while sign := self.take(*signs):
            right, text, so_far = rule(), sign.text, left
            left = self.computed(sign, lambda: combined(text, so_far, right))  # noqa: B023 - called at once
        return left

    def signed(self) -> Value:
        sign = self.take("+", "-")
        if sign is None:
            return self.power()
        value = self.deeper(self.signed, sign)
        return -value if sign.text == "-" else value

    def power(self) -> Value:
        first = self.next
        base = self.operand()
        has_unit = first.kind == "number" and self.tokens[self.i - 1].kind == "name"
        sign = self.take("**")
        if sign is None:
            return base
        if has_unit:  # (2 mm)**2 and 2 * mm**2 differ by a factor 2: ask which
            raise self.error("have brackets in a power of a quantity: (2 mm)**2, or 2 * mm**2", sign)
        exponent = self.deeper(self.signed, sign)
        return self.computed(sign, lambda: raised(base, exponent))

    def operand(self) -> Value:
        token = self.next
        if token.kind == "number":
            return self.quantity()
        if token.kind == "name":
            self.i += 1
            return self.call(token) if self.take("(") else self.named(token)
        if self.take("("):
            value = self.deeper(self.sum, token)
            self.close(token)
            return value
        raise self.error("have a number, a name or a bracket here", token)

    def quantity(self) -> Value:
        """Read a number, with the unit that follows it after a blank."""
        token, unit = self.tokens[self.i : self.i + 2]
        self.i += 1
        if unit.kind != "name":
            return self.computed(token, lambda: quantity(token.text))
        if unit.start == token.start + len(token.text):
            both = shortened(f"{token.text} {unit.text}")
            raise self.error(f"have a blank between a number and its unit, or * before a name ({both})", unit)
        if unit.text not in UNITS:
            raise self.misplaced(unit)
        self.i += 1
        return self.computed(token, lambda: quantity(token.text, unit.text))

    def named(self, token: _Token) -> Value:
        if token.text in self.names:
            return sympy.Symbol(token.text, real=True)
        if token.text in FUNCTIONS:
            raise self.error(f"have brackets after the function {token.text}", token)
        if token.text not in WORDS:
            raise self.unknown(token)
        return CONSTANTS.get(token.text) or UNITS[token.text]

    def call(self, token: _Token) -> Value:
        """Read a function's arguments, its bracket being open."""
        if token.text not in FUNCTIONS:
            known = token.text in (*self.names, *WORDS)
            raise self.error(f"have * between {token.text} and a bracket", token) if known else self.unknown(token)
        values = [self.deeper(self.sum, token)]
        while self.take(","):
            values.append(self.deeper(self.sum, token))
        self.close(token)
        least, most = ARGUMENTS.get(token.text, (1, 1))
        if not least <= len(values) <= most:
            count = f"{least} to {most}" if least < most else str(least)
            raise self.error(f"give {token.text} {count} argument{'s' if most > 1 else ''}, not {len(values)}", token)
        return self.computed(token, lambda: applied(token.text, values))

    def close(self, opening: _Token) -> None:
        if self.take(")"):
            return
        raise self.error("close every bracket", opening) if self.next.kind == "end" else self.misplaced(self.next)
