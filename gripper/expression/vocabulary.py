"""What an expression may hold: units, functions, names, and how much of them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import sympy

LONGEST_TEXT = 2000
"""Characters of an expression."""
DEEPEST = 32
"""Levels of brackets, signs and powers inside each other (sympy's cost of nested abs and max grows as its cube)."""
LARGEST_EXPONENT = 100
"""Largest magnitude of a constant exponent."""
MOST_ARGUMENTS = 10
"""Arguments of one min or max (sympy compares each with each)."""

SCALES = {
    **{"um": "1e-6", "mm": "1e-3", "cm": "1e-2", "m": "1", "in": "0.0254"},
    **{"Pa": "1", "kPa": "1e3", "MPa": "1e6", "GPa": "1e9", "N": "1", "mN": "1e-3", "kg": "1", "J": "1"},
}
"""Units that are a decimal number of SI units."""
UNITS = {name: float(scale) for name, scale in SCALES.items()} | {"deg": math.radians(1), "rad": 1.0}
"""Every unit, in SI units."""
CONSTANTS = {"pi": math.pi}
FUNCTIONS: dict[str, tuple[Callable[..., float], Any]] = {
    "sqrt": (math.sqrt, sympy.sqrt),
    "exp": (math.exp, sympy.exp),
    "log": (math.log, sympy.log),
    "sin": (math.sin, sympy.sin),
    "cos": (math.cos, sympy.cos),
    "tan": (math.tan, sympy.tan),
    "asin": (math.asin, sympy.asin),
    "acos": (math.acos, sympy.acos),
    "atan": (math.atan, sympy.atan),
    "atan2": (math.atan2, sympy.atan2),
    "abs": (abs, sympy.Abs),
    "min": (min, sympy.Min),
    "max": (max, sympy.Max),
}
"""Every function: of floats, and of symbols."""
ARGUMENTS = {"atan2": (2, 2), "min": (2, MOST_ARGUMENTS), "max": (2, MOST_ARGUMENTS)}
"""Least and most arguments, where they are not one."""
WORDS = (*CONSTANTS, *FUNCTIONS, *UNITS)
"""Every name that means something in every expression."""

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def is_name(name: str) -> bool:
    """Tell whether an expression can hold this name: ASCII letters, digits and _, no digit first."""
    return NAME.fullmatch(name) is not None


def is_reserved(name: str) -> bool:
    """Tell whether a name is taken: a unit, a function, pi, x, y or s (so it cannot be a motion's parameter)."""
    return name in WORDS or name in ("x", "y", "s")
