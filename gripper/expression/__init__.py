"""The one parser of expressions in text: arithmetic, units and a few functions, and nothing else.

Text never reaches Python's ``eval`` or sympy's parsers: what this grammar cannot say cannot happen::

    sum     = product {("+" | "-") product}
    product = signed {("*" | "/") signed}
    signed  = ("+" | "-") signed | power
    power   = operand ["**" signed]
    operand = number [blank unit] | name | function "(" sum {"," sum} ")" | "(" sum ")"

Units that are written must fit: each other in a sum, and the quantity that is asked for (:mod:`.dimensions`).
"""

from __future__ import annotations

import sympy

from gripper.expression import values
from gripper.expression.dimensions import Dimension
from gripper.expression.parser import Names, parsed
from gripper.expression.terms import Term
from gripper.expression.vocabulary import LONGEST_TEXT, WORDS, is_name, is_reserved
from gripper.names import shortened

__all__ = ["Names", "is_name", "is_reserved", "number", "parse", "written_kind"]


def parse(text: str, names: Names = (), kind: Dimension | None = None) -> sympy.Expr:
    """Read an expression.

    Parameters
    ----------
    text
        Arithmetic with ``+ - * / **`` (as in Python), brackets, units after a number and a blank (``3.2 mm`` is
        0.0032 and binds tighter than * and /; alone, a unit is a factor: ``5 N / mm**2``), pi, and the functions
        sqrt exp log sin cos tan asin acos atan atan2 abs min max. Angles are in rad.
    names
        The symbols that it may hold; as a mapping, each with its kind where that is known.
    kind
        What it must be where a unit is written in it; None for anything. Numbers without units are in SI.

    Returns
    -------
    sympy.Expr
        In real symbols, ``sympy.Symbol(name, real=True)``, and floats.

    Raises
    ------
    ValueError
        In one line: the rule, the place in the text, and the text; also where a constant part has no finite real
        value, as 1/0 or log(-1), and where units do not fit.
    """
    return values.symbolic(_term(text, names, kind).value)


def number(text: str, kind: Dimension | None = None) -> float:
    """Read an expression without symbols: its value in SI units; ValueError as in :func:`parse`."""
    return float(_term(text, (), kind).value)


def written_kind(text: str) -> Dimension | None:
    """Tell the kind of a number in text, where a unit is written in it; ValueError as in :func:`parse`."""
    measure = _term(text, (), None).measure
    return None if measure.free or not measure.kinds or len(measure.kinds) > 1 else next(iter(measure.kinds))


def _term(text: str, names: Names, kind: Dimension | None) -> Term:
    taken = sorted(name for name in names if name in WORDS or not is_name(name))
    if taken:
        raise ValueError(f"names must be letters, digits and _, and no unit, function or pi; got {', '.join(taken)}")
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"expression must be at most {LONGEST_TEXT} characters long; got {len(text)} characters")
    term = parsed(text, names)
    if kind is not None and not term.measure.fits(kind):
        raise ValueError(f"expression must be {kind}; got {shortened(text)!r}, {term.measure}")
    return term
