"""Records of plain data: frozen, finite, comparable, ready for JSON."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np

_NUMBERS = (tuple, list, np.ndarray, np.generic)  # what may hold any, or is none of Python's own


def _check_finite(name: str, value: Any) -> None:
    for item in value if isinstance(value, tuple) else (value,):
        if isinstance(item, float) and not math.isfinite(item):
            raise ValueError(f"{name} must be finite, or None where there is no answer; got {value!r}")


def plain(value: Any) -> Any:
    """Arrays and lists as tuples, numpy's numbers as Python's, so that results compare and become JSON."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    return tuple([plain(item) for item in value]) if isinstance(value, (list, tuple)) else value


class Record:
    """A frozen record of finite plain numbers."""

    def __post_init__(self) -> None:
        self._settle(self.__dict__)

    def _settle(self, values: Mapping[str, Any]) -> None:
        """Check some of its values, and keep them as plain data."""
        for name, given in values.items():
            if math.isfinite(given) if type(given) is float else not isinstance(given, _NUMBERS):
                continue
            value = plain(given)
            _check_finite(name, value)
            if value is not given:
                object.__setattr__(self, name, value)

    def but(self, **values: Any) -> Self:
        """The same record with other values of some fields: only these are checked."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__, **values)
        other._settle(values)
        return other


def jsonable(value: Any) -> Any:
    """Write records as dictionaries and tuples as lists."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: jsonable(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return [jsonable(item) for item in value] if isinstance(value, (list, tuple)) else value
