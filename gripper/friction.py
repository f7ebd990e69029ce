"""Friction as a scene gives it: the coefficient, the model, and the sense where no motion tells it."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping
from typing import Annotated, Literal, get_args

import numpy as np
import sympy

from gripper.expression.dimensions import PURE
from gripper.fields import Profile, check_fields

Model = Literal["coulomb", "published"]
Sense = Literal["tipward", "baseward"]
_SAMPLES = 201


@dataclasses.dataclass(frozen=True, kw_only=True)
class Coefficients:
    """Coefficients of friction that differ between finger and jaw.

    Parameters
    ----------
    finger
        mu on the finger: a number, or an expression in the arc length s (m).
    jaw
        mu on the jaw: a number.
    """

    finger: Annotated[Profile, PURE]
    jaw: Annotated[float, PURE]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Friction:
    """Coulomb friction between finger and object.

    Parameters
    ----------
    coefficient
        mu: a number, an expression in the arc length s (m; on the jaw its value at s = L), or
        ``{"finger": ..., "jaw": ...}``.
    model
        "coulomb": slip, stick and sense are found, with memory along a motion. "published": the shape without
        friction, forces split afterwards (Lan & Lee, section 2.4, eqs 6 to 10), for one contact.
    sense
        Of the friction force on the OBJECT: "tipward", towards the finger's tip, or "baseward". Needed by "published"
        and by scenes without motion, whose contacts then slip that way; refused otherwise.
    """

    coefficient: float | sympy.Expr | Coefficients | Mapping[str, float | sympy.Expr]
    model: Model = "coulomb"
    sense: Sense | None = None

    def __post_init__(self) -> None:
        given = self.coefficient
        if isinstance(given, Mapping):
            if set(given) != {"finger", "jaw"}:
                raise ValueError(f"coefficient must have the keys finger and jaw; got {', '.join(map(str, given))!r}")
            object.__setattr__(self, "coefficient", Coefficients(finger=given["finger"], jaw=given["jaw"]))
        elif not isinstance(given, Coefficients):
            Coefficients(finger=given, jaw=0.0)  # checks it
        if self.model not in get_args(Model):
            raise ValueError(f"model must be one of {', '.join(get_args(Model))}; got {self.model!r}")
        if self.sense is not None and self.sense not in get_args(Sense):
            raise ValueError(f"sense must be one of {', '.join(get_args(Sense))}; got {self.sense!r}")

    @property
    def finger(self) -> float | sympy.Expr:
        """Mu on the finger."""
        return self.coefficient.finger if isinstance(self.coefficient, Coefficients) else self.coefficient

    def on_jaw(self, length: float) -> float:
        """Mu on the jaw; length is the finger's, in m."""
        if isinstance(self.coefficient, Coefficients):
            return self.coefficient.jaw
        return float(self.along(np.array([length]))[0])

    def along(self, s: np.ndarray) -> np.ndarray:
        """Mu at places of the finger (n,), in m: (n,); nan where it is not real."""
        mu = sympy.sympify(self.finger)
        symbols = sorted(mu.free_symbols, key=str)
        values = [mu.subs({symbol: v for symbol in symbols}) for v in np.asarray(s).tolist()]
        return np.array([float(value) if value.is_real else math.nan for value in values])

    @functools.cached_property
    def absent(self) -> bool:
        """Whether the coefficient is 0 everywhere."""
        jaw = self.coefficient.jaw if isinstance(self.coefficient, Coefficients) else 0
        return sympy.sympify(self.finger).is_zero is True and jaw == 0

    @functools.cached_property
    def published(self) -> bool:
        """Whether the frictionless shape is taken, and its force split afterwards, as the paper does."""
        return self.model == "published" and not self.absent

    def check(self, length: float, *, moving: bool) -> None:
        """Check what depends on the scene: mu over the finger's length (m), and whether a sense is needed.

        Raises
        ------
        ValueError
            A coefficient that is negative or not finite somewhere, or a sense that is missing or has no use.
        """
        names = {symbol.name for symbol in sympy.sympify(self.finger).free_symbols}
        if names - {"s"}:
            raise ValueError(f"coefficient must be a number or an expression in s; got {self.finger!r}")
        s = np.linspace(0.0, length, _SAMPLES) if names else np.array([length])
        for mu in (*self.along(s).tolist(), self.on_jaw(length)):
            if not (math.isfinite(mu) and mu >= 0):
                raise ValueError(f"coefficient must be at least 0; got {mu!r}")
        if self.absent:
            return
        needed = self.model == "published" or not moving
        if needed and self.sense is None:
            if self.model == "published":
                raise ValueError("sense must be 'tipward' or 'baseward' in the published model; got None")
            given = "a motion, along which slip is found, or sense = 'tipward' or 'baseward'"
            raise ValueError(f"friction must come with {given}; got neither")
        if self.sense is not None and not needed:
            raise ValueError(f"sense must be left out: in a motion, the coulomb model finds it; got {self.sense!r}")
