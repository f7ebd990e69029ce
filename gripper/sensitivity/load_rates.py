"""What else loads a finger, differentiated by its sections' arc lengths and by the numbers of the scene."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy

from gripper.arrays import Array, Index
from gripper.beam.sections import Sections
from gripper.fingers import Finger
from gripper.loads import Load, PotentialLoad, Section
from gripper.sensitivity.opened import Opened, derivatives
from gripper.statics.acting import Sampled
from gripper.statics.compiled_loads import CompiledLoad, Loads


@dataclass(frozen=True, kw_only=True)
class _Loaded:
    """A load and the finger that it may read: opened together."""

    load: Load
    finger: Finger


@dataclass(frozen=True, eq=False)
class Formulas:
    """A load's stations, and its actions and potential, as expressions."""

    actions: tuple[sympy.Expr, ...]  # three a section, then the potential
    stations: tuple[sympy.Expr, ...]
    sections: tuple[Section, ...]
    symbols: tuple[sympy.Symbol, ...]  # of the numbers


_PARAMETER = sympy.Symbol("the motion's parameter", real=True)


@functools.lru_cache(maxsize=256)
def formulas(load: Load, finger: Finger, values: tuple[tuple[str, float], ...]) -> Formulas:
    """A load's formulas with symbols for numbers, opened once.

    Raises
    ------
    NotOpenError
        Where they do not take symbols.
    """
    opened = Opened(_Loaded(load=load, finger=finger), dict(values))
    opened.name = type(load).__name__
    whole = load.stations(finger) is None
    stations = () if whole else opened.read(lambda part: part.load.stations(part.finger))
    names = [sympy.symbols(f"s{i} x{i} y{i} angle{i}", real=True) for i in range(len(stations) or 1)]
    sections = tuple(Section(*name) for name in names)
    actions = opened.read(lambda part: tuple(tuple(each) for each in part.load.actions(part.finger, *sections)))
    has_one = isinstance(load, PotentialLoad)
    energy = opened.read(lambda part: part.load.potential(part.finger, *sections)) if has_one else sympy.S.Zero
    flat = (*(part for action in actions for part in action), energy)
    own = {symbol for section in sections for symbol in section} | set(opened.symbols.values())
    foreign = {symbol for part in flat for symbol in part.free_symbols} - own
    flat = tuple(part.xreplace(dict.fromkeys(foreign, _PARAMETER)) for part in flat)
    return Formulas(flat, stations, sections, tuple(opened.symbols.values()))


class LoadRate:
    """Derivatives of one load by its sections' arc lengths and by numbers.

    Parameters
    ----------
    part
        The load.
    values
        Its numbers and its finger's, by keys after ``load.`` and ``finger.``.
    rows
        Which of all numbers they are, (p,).
    """

    def __init__(self, part: CompiledLoad, finger: Finger, values: Mapping[str, float], rows: Index) -> None:
        self.part, self.rows, self._values = part, rows, list(values.values())
        found = formulas(part.load, finger, tuple(values.items()))
        marks = tuple(section.s for section in found.sections)
        arguments = (_PARAMETER, *(symbol for section in found.sections for symbol in section), *found.symbols)
        self._function = derivatives(found.actions, (*marks, *found.symbols), arguments)
        self._stations = derivatives(found.stations, found.symbols, found.symbols) if found.stations else None
        self.count = len(found.sections)

    def station_rates(self) -> Array:
        """Rates of its stations by its numbers, (p, k), in m."""
        if self._stations is None:
            return np.zeros((len(self._values), 0))
        table = np.array(self._stations(*self._values), dtype=float).reshape(1 + len(self._values), -1)
        return table[1:]

    def at(self, sampled: Sampled) -> tuple[Array, Array, Array, Array]:
        """Derivatives at fixed places: actions by arc lengths and by numbers, and the potential by both.

        Of k sections (k, 3, k) and (p, k, 3); of the whole axis (k, 3) and (p, k, 3). Potentials (k,), (p, k), those of
        sections as one, (1,), (p, 1).
        """
        place, stage, size = sampled.place, sampled.stage, sampled.s.size
        s = sampled.s * self.part.length
        angle = sampled.angles
        columns = (s, place.real, place.imag, angle)
        if self.part.stations is None:
            given: list[Array | float] = list(columns)
        else:
            given = np.column_stack(columns).ravel().tolist()
        each = size if self.part.stations is None else 1
        found = self._function(stage.parameter, *given, *self._values)
        table = np.array([np.broadcast_to(value, each) for value in found], dtype=float)
        table = table.reshape(1 + self.count + len(self._values), -1, each)
        by_s, by_number = table[1 : 1 + self.count], table[1 + self.count :]
        actions = by_number[:, :-1].reshape(len(by_number), self.count, 3, each)
        if self.part.stations is None:
            return by_s[0, :3].T, actions[:, 0].swapaxes(1, 2), by_s[0, 3], by_number[:, 3]
        marks = by_s[:, :-1, 0].reshape(self.count, self.count, 3).transpose(1, 2, 0)
        return marks, actions[..., 0], by_s[:, -1, 0], by_number[:, -1]


class LoadRates:
    """Derivatives of a scene's loads by its numbers.

    Parameters
    ----------
    loads
        Of the scene; None where there are none.
    sections
        Of its finger.
    values
        Numbers of finger and loads by their keys in the scene.
    rows
        Which of all numbers each is.
    """

    def __init__(
        self, loads: Loads | None, sections: Sections, values: Mapping[str, float], rows: Mapping[str, int]
    ) -> None:
        self.parts: list[LoadRate] = []
        derived = sections.finger.material.shear_modulus is None
        for i, part in enumerate(loads.parts if loads else ()):
            own: dict[str, float] = {}
            keys: list[str] = []
            for key, value in values.items():
                name = self._named(key, i)
                if name and not (derived and name == "finger.material.shear_modulus"):
                    own[name], keys = value, [*keys, key]
            self.parts.append(
                LoadRate(part, sections.finger, own, np.array([rows[key] for key in keys], dtype=np.intp))
            )

    @staticmethod
    def _named(key: str, i: int) -> str | None:
        """A scene's key as this load's formulas have it."""
        head, _, rest = key.partition(".")
        if head == "material":
            return f"finger.{key}"
        if head == "finger":
            return key
        return f"load.{rest}" if head == f"loads[{i}]" else None
