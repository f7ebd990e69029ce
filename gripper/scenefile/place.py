"""Where in a scene file a value stands, and what an error says about it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Mapping
from datetime import date, time
from typing import Any, TypeAlias

from gripper.names import known_names, shortened

Table: TypeAlias = dict[str, Any]

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_FIELD_ERROR = re.compile(r"(?P<field>\w+)(?P<index>[\[\]0-9]*) (?P<rule>must .*)")


class SceneFileError(ValueError):
    """A scene file breaks a rule: file, key, rule and the value got, in one line."""


def shown(value: Any) -> str:
    """Write a value for a message: short, in one line, booleans as TOML writes them."""
    if isinstance(value, dict):
        return f"a table of {', '.join(map(shortened, value))}" if value else "an empty table"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (date, time)):
        return value.isoformat()
    try:
        return shortened(repr(value))
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, tables in tables without end
        return f"one too long to show ({type(value).__name__})"


@dataclasses.dataclass(frozen=True)
class Place:
    """Where in a scene file: what an error names."""

    file: str
    key: str = ""

    def at(self, key: str) -> Place:
        """Name a key of this table."""
        key = key if BARE_KEY.fullmatch(key) else shortened(repr(key))
        return Place(self.file, f"{self.key}.{key}" if self.key else key)

    def entry(self, i: int) -> Place:
        """Name an entry of this array, counted from 0."""
        return Place(self.file, f"{self.key}[{i}]")

    def error(self, rule: str, got: str) -> SceneFileError:
        """Say what the value here must do, and what was got."""
        return SceneFileError(": ".join(filter(None, (self.file, self.key, f"{rule}; got {got}"))))

    def broken(self, error: Exception, keys: Mapping[str, str] | None = None) -> SceneFileError:
        """Repeat an error "<field> must <rule>; got <value>" under the field's key: ``keys`` gives it for each."""
        message = " ".join(str(error).split())
        match = _FIELD_ERROR.fullmatch(message)
        key = (keys or {}).get(match["field"]) if match else None
        if match and key:
            table = f"{self.key}." if self.key else ""
            return SceneFileError(f"{self.file}: {table}{key}{match['index']}: {match['rule']}")
        message = message.removeprefix("expression ")
        return SceneFileError(": ".join(filter(None, (self.file, self.key, message))))


def as_table(value: Any, place: Place) -> Table:
    """Check that a value is a table."""
    if not isinstance(value, dict):
        raise place.error("must be a table", shown(value))
    return value


def check_keys(table: Table, known: Iterable[str], place: Place) -> None:
    """Refuse the keys that are not known, with the known ones."""
    known = list(known)
    for key in table:
        if key not in known:
            raise place.at(key).error(f"must be a known key: {known_names(key, known)}", shortened(repr(key)))


def check_unreserved(table: Table, reserved: Mapping[str, str], place: Place) -> None:
    """Refuse the keys that belong to features not built yet, saying which."""
    for key in reserved.keys() & table.keys():
        raise place.at(key).error(f"must be left out ({reserved[key]})", shown(table[key]))


def check_given(table: Table, needed: Iterable[str], place: Place) -> None:
    """Refuse a table in which keys are missing, naming all of them."""
    missing = [place.at(key).key for key in needed if key not in table]
    if missing:
        raise Place(place.file, ", ".join(missing)).error(
            "must be given", ", ".join(map(shortened, table)) or "nothing"
        )
