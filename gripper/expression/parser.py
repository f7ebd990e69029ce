"""Recursive descent over the grammar of expressions."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from gripper.expression.dimensions import Dimension
from gripper.expression.terms import Term, applied, combined, constant, quantity, raised, symbol
from gripper.expression.vocabulary import ARGUMENTS, DEEPEST, FUNCTIONS, NAME, UNITS, WORDS
from gripper.names import known_names, shortened

Names: TypeAlias = Collection[str] | Mapping[str, Dimension | None]
"""Symbols that an expression may hold; in a mapping, each with its kind where that is known."""
_BLANK = r"[ \t\r\n]*"
_NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_TOKEN = re.compile(rf"(?:(?P<number>{_NUMBER})|(?P<name>{NAME.pattern})|(?P<sign>\*\*|[-+*/(),])|(?P<end>\Z)){_BLANK}")


@dataclass(frozen=True)
class _Token:
    kind: Literal["number", "name", "sign", "end"]
    text: str
    start: int


def parsed(text: str, names: Names) -> Term:
    """Read the whole text; ValueError in one line with the rule, the place and the text."""
    return _Parser(text, names).whole()


class _Parser:
    """Recursive descent: one method a rule of the grammar, each returns the value of what it read."""

    def __init__(self, text: str, names: Names) -> None:
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

    def deeper(self, rule: Callable[[], Term], token: _Token) -> Term:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.error(f"nest at most {DEEPEST} levels of brackets, signs and powers", token)
        value = rule()
        self.depth -= 1
        return value

    def computed(self, token: _Token, compute: Callable[[], Term]) -> Term:
        """Compute a node; say where, when it has no value."""
        try:
            return compute()
        except ValueError as error:
            raise self.error(str(error), token) from None

    def whole(self) -> Term:
        value = self.sum()
        if self.next.kind != "end":
            raise self.misplaced(self.next)
        return value

    def sum(self) -> Term:
        return self.chain(self.product, "+", "-")

    def product(self) -> Term:
        return self.chain(self.signed, "*", "/")

    def chain(self, rule: Callable[[], Term], *signs: str) -> Term:
        left = rule()
        while sign := self.take(*signs):
            right, text, so_far = rule(), sign.text, left
            left = self.computed(sign, lambda: combined(text, so_far, right))  # noqa: B023 - called at once
        return left

    def signed(self) -> Term:
        sign = self.take("+", "-")
        if sign is None:
            return self.power()
        value = self.deeper(self.signed, sign)
        return Term(-value.value, value.measure) if sign.text == "-" else value

    def power(self) -> Term:
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

    def operand(self) -> Term:
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

    def quantity(self) -> Term:
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

    def named(self, token: _Token) -> Term:
        if token.text in self.names:
            kind = self.names.get(token.text) if isinstance(self.names, Mapping) else None
            return symbol(token.text, kind)
        if token.text in FUNCTIONS:
            raise self.error(f"have brackets after the function {token.text}", token)
        if token.text not in WORDS:
            raise self.unknown(token)
        return constant(token.text)

    def call(self, token: _Token) -> Term:
        """Read a function's terms, its bracket being open."""
        if token.text not in FUNCTIONS:
            known = token.text in (*self.names, *WORDS)
            raise self.error(f"have * between {token.text} and a bracket", token) if known else self.unknown(token)
        terms = [self.deeper(self.sum, token)]
        while self.take(","):
            terms.append(self.deeper(self.sum, token))
        self.close(token)
        least, most = ARGUMENTS.get(token.text, (1, 1))
        if not least <= len(terms) <= most:
            count = f"{least} to {most}" if least < most else str(least)
            raise self.error(f"give {token.text} {count} argument{'s' if most > 1 else ''}, not {len(terms)}", token)
        return self.computed(token, lambda: applied(token.text, terms))

    def close(self, opening: _Token) -> None:
        if self.take(")"):
            return
        raise self.error("close every bracket", opening) if self.next.kind == "end" else self.misplaced(self.next)
