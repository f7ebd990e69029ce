"""The loads of a scene as functions of numbers: compiled once a finger, with the derivatives that Newton needs."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.beam.sections import Sections
from gripper.fingers import Finger
from gripper.loads import Load, PotentialLoad, Section
from gripper.pose import placed

if TYPE_CHECKING:
    from gripper.scene import Scene

_TOLERANCE = 1e-12  # of L: what a station may lie beyond the tip


@dataclass(frozen=True, eq=False)
class CompiledLoad:
    """A load as functions of numbers, in SI.

    Parameters
    ----------
    load
        What was given.
    stations
        By L, (k,); None where it acts along the whole axis, per m.
    """

    load: Load
    stations: Array | None
    length: float
    varies: bool
    """Whether the motion's parameter is in it."""
    _function: Callable[..., list[Any]]
    _count: int

    @property
    def in_world(self) -> bool:
        """Whether its axes are the world's."""
        return self.load.frame == "world"

    def values(self, s: Array, x: Array, y: Array, angle: Array, q: float) -> tuple[Array, Array, Array, float]:
        """Actions (k, 3), their derivatives (k, 3, k, 3), by q (k, 3), and the potential, 0 where there is none.

        Of a load along the whole axis: (k, 3), (k, 3, 3), (k, 3) and potentials (k,), per m.
        """
        k, m = s.size, 3 * self._count
        if self.stations is None:
            found = np.array([np.broadcast_to(v, s.shape) for v in self._function(q, s, x, y, angle)], dtype=float)
            return found[:3].T, found[3:12].reshape(3, 3, k).transpose(2, 0, 1), found[12:15].T, found[15]
        found = np.array(self._function(q, *np.column_stack([s, x, y, angle]).ravel().tolist()), dtype=float)
        slopes = found[m : m + m * m].reshape(k, 3, k, 3)
        return found[:m].reshape(k, 3), slopes, found[m + m * m : -1].reshape(k, 3), float(found[-1])


@functools.lru_cache(maxsize=256)
def compiled(load: Load, finger: Finger, parameter: str | None) -> CompiledLoad:
    """Compile a load on a finger, of which its expressions' symbol is the motion's parameter.

    Raises
    ------
    ValueError
        A station that is not on the finger, or a symbol that is not the motion's parameter.
    """
    stations = load.stations(finger)
    for s in stations or ():
        if not 0 < s <= finger.length * (1 + _TOLERANCE):
            raise ValueError(
                f"s must lie above 0 and up to the finger's length {finger.length!r}, in m; got {s!r} of {load!r}"
            )
    count = 1 if stations is None else len(stations)
    sections = [Section(*sympy.symbols(f"s{i} x{i} y{i} angle{i}", real=True)) for i in range(count)]
    actions = [sympy.sympify(part) for action in load.actions(finger, *sections) for part in action]
    energy = sympy.sympify(load.potential(finger, *sections)) if isinstance(load, PotentialLoad) else sympy.S.Zero
    q = sympy.Symbol("q", real=True)
    own = {symbol for section in sections for symbol in section}
    others = {symbol for part in (*actions, energy) for symbol in part.free_symbols} - own
    foreign = sorted(symbol.name for symbol in others if symbol.name != parameter)
    if foreign:
        known = f"the motion's parameter {parameter!r}" if parameter else "no symbol (no motion)"
        raise ValueError(f"loads must depend on {known}; got {', '.join(foreign)!r} in {load!r}")
    actions = [part.subs(dict.fromkeys(others, q)) for part in actions]
    places = [symbol for section in sections for symbol in section[1:]]
    slopes = _slopes(actions, places, symmetric=isinstance(load, PotentialLoad))
    rates = [_slope(part, q) for part in actions]
    arguments = [q, *(symbol for section in sections for symbol in section)]
    parts = [*actions, *slopes, *rates, energy.subs(dict.fromkeys(others, q))]
    function = sympy.lambdify(arguments, parts, "numpy" if stations is None else "math", cse=True)
    marks = None if stations is None else np.minimum(np.array(stations) / finger.length, 1.0)
    return CompiledLoad(load, marks, finger.length, bool(others), function, count)


def _slopes(actions: list[sympy.Expr], places: list[sympy.Symbol], *, symmetric: bool) -> list[sympy.Expr]:
    """Derivatives of all actions by all places, row by row; where they are symmetric, half of them are derived."""
    count, found = len(places), dict[tuple[int, int], sympy.Expr]()
    for i, j in itertools.product(range(count), repeat=2):
        found[i, j] = found[j, i] if symmetric and j < i else _slope(actions[i], places[j])
    return list(found.values())


def _slope(part: sympy.Expr, symbol: sympy.Symbol) -> sympy.Expr:
    """A derivative; most are of what does not depend on the symbol."""
    return sympy.diff(part, symbol) if part.has(symbol) else sympy.S.Zero


@dataclass(frozen=True, eq=False)
class Loads:
    """The loads of a scene.

    Parameters
    ----------
    sections
        Of the finger.
    parts
        Each load, compiled.
    steady
        Whether they stay the same over a motion: no parameter in them, and no turning of the clamp under those that
        keep to the world's axes.
    """

    sections: Sections
    parts: tuple[CompiledLoad, ...]
    steady: bool

    @property
    def conservative(self) -> bool:
        """Whether all have a potential."""
        return all(isinstance(part.load, PotentialLoad) for part in self.parts)

    @property
    def closed(self) -> bool:
        """Whether the drive's work is all that changes strain energy and potential."""
        return self.steady and self.conservative

    @property
    def driven(self) -> bool:
        """Whether the motion's parameter stands in any."""
        return any(part.varies for part in self.parts)

    @functools.cached_property
    def marks(self) -> tuple[float, ...]:
        """Where strains jump, by L."""
        found = {float(s) for part in self.parts if part.stations is not None for s in part.stations}
        return tuple(sorted(found - {1.0}))


def compiled_loads(scene: Scene, sections: Sections) -> Loads:
    """The loads of a scene, each compiled once a finger.

    Raises
    ------
    ValueError
        A load that does not act on the finger, depends on what is not the motion's parameter, or does not go with
        friction.
    """
    finger, parameter = placed(scene.finger), scene.motion.parameter if scene.motion else None
    parts = tuple(compiled(load, finger.body, parameter) for load in scene.loads)
    turns = parameter is not None and bool(sympy.sympify(finger.pose.angle).free_symbols)
    found = Loads(sections, parts, not any(part.varies or (turns and part.in_world) for part in parts))
    if scene.friction is not None and not scene.friction.absent and not found.closed:
        changing = next(
            part.load
            for part in parts
            if part.varies or (turns and part.in_world) or not isinstance(part.load, PotentialLoad)
        )
        rule = "must have a potential that stays as it is along the motion where there is friction"
        raise ValueError(f"loads {rule} (the work is booked by it); got {changing!r}")
    return found
