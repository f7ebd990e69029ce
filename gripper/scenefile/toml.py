"""TOML in and out: text to tables with errors that name the line, plain tables to text."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

from gripper.names import shortened
from gripper.scenefile.place import BARE_KEY, Place, SceneFileError, Table

MOST_DOTS = 1000
"""In a line, between the signs that end a name: more than the longest expression can have."""
_ENDS = re.compile(r"[,=\[\]{}]")
_UNQUOTED = re.compile(r"[=\[,]\s*[-+]?[.\d][-+.\deE]*\s*[A-Za-z]+\s*(?:[],#]|$)")
_LINE = re.compile(r"\(at line (\d+), column (\d+)\)")


def tables(text: str, place: Place) -> Table:
    """Read TOML.

    Raises
    ------
    SceneFileError
        It is not TOML; names the line.
    """
    _check_dots(text, place)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise place.error("must be TOML with few levels of arrays and tables", "too many levels") from None
    except ValueError as error:  # tomllib's own, and Python's for integers of thousands of digits
        raise _syntax_error(text, str(error), place) from None


def _check_dots(text: str, place: Place) -> None:
    """Refuse names of so many parts that reading them takes for ever: tomllib's time grows as their square."""
    for i, line in enumerate(text.splitlines() if text.count(".") > MOST_DOTS else (), start=1):
        if line.count(".") > MOST_DOTS and max(part.count(".") for part in _ENDS.split(line)) > MOST_DOTS:
            raise SceneFileError(f"{place.file}: line {i}: must be TOML with few dots in a name; got too many")


def _syntax_error(text: str, message: str, place: Place) -> SceneFileError:
    lines = text.splitlines() or [""]
    match = _LINE.search(message)
    i = min(int(match[1]), len(lines)) if match else len(lines)
    reason = " ".join(_LINE.sub("", message).split())
    if _UNQUOTED.search(lines[i - 1]):
        reason = 'a quantity with a unit stands in quotes, as "60 mm"'
    where = f"line {i}" if match or "end of document" in message else "somewhere"
    got = repr(shortened(lines[i - 1])) if where != "somewhere" else f"{len(lines)} lines"
    return SceneFileError(f"{place.file}: {where}: must be TOML ({reason}); got {got}")


def written(tables: Table, path: str = "") -> str:
    """Write nested dictionaries of numbers, texts, booleans and lists as TOML, each table with its header."""
    plain = [f"{_key(key)} = {_value(value)}" for key, value in tables.items() if not isinstance(value, dict)]
    parts = ["\n".join([f"[{path}]"] * bool(path) + plain)] if plain or path else []
    for key, value in tables.items():
        if isinstance(value, dict):
            parts.append(written(value, f"{path}.{key}" if path else key).rstrip("\n"))
    return "\n\n".join(parts) + "\n"


def _key(key: str) -> str:
    return key if BARE_KEY.fullmatch(key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):  # within an array
        return f"{{{', '.join(f'{key} = {_value(item)}' for key, item in value.items())}}}"
    if isinstance(value, str):  # JSON's escapes are TOML's, but for DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value).lower() if isinstance(value, bool) else repr(value)
