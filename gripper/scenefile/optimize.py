"""Design files: a scene with an [optimize] table."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path
from typing import Any

from gripper.parameters import kind
from gripper.scene import Scene
from gripper.scenefile import sections, toml
from gripper.scenefile.place import Place, shown
from gripper.scenefile.values import read_count, read_number

_SENSES = ("minimize", "maximize", "flatten")
_KEYS = (*_SENSES, "free", "starts", "seed")


@dataclasses.dataclass(frozen=True)
class Task:
    """What a design file asks for: arguments of :func:`gripper.optimize.optimize`."""

    scene: Scene
    free: dict[str, tuple[float, float]]
    goal: dict[str, str]
    starts: int = 3
    seed: int = 0


def read_design(path: str | os.PathLike[str]) -> Task:
    """Read a design file.

    Raises
    ------
    SceneFileError
        The file cannot be read, or breaks a rule: one line with file, key, rule and the value got.
    """
    place = Place(os.fspath(path))
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a null character in the path
        raise place.error(
            "must be a file that can be read, in UTF-8", getattr(error, "strerror", None) or str(error)
        ) from None
    tables = dict(toml.tables(text, place))
    table, at = tables.pop("optimize", None), place.at("optimize")
    if not isinstance(table, dict):
        got = "nothing" if table is None else shown(table)
        raise at.error("must be a table, [optimize], with minimize, maximize or flatten, and free", got)
    unknown = [key for key in table if key not in _KEYS]
    if unknown:
        raise at.at(unknown[0]).error(f"must be one of {', '.join(_KEYS)}", shown(unknown[0]))
    goal = {key: table[key] for key in _SENSES if key in table}
    for key, quantity in goal.items():
        if not isinstance(quantity, str):
            raise at.at(key).error("must be the name of a quantity of the summary", shown(quantity))
    starts, seed = (read_count(table.get(key, default), at.at(key)) for key, default in (("starts", 3), ("seed", 0)))
    if not 1 <= starts <= 1000:
        raise at.at("starts").error("must lie between 1 and 1000", str(starts))
    made = sections.scene(tables, place)
    return Task(made, _free(table.get("free"), at.at("free"), made), goal, starts, seed)


def _free(table: Any, place: Place, scene: Scene, above: str = "") -> dict[str, tuple[float, float]]:
    """Bounds by key; a key of several parts may be written as tables."""
    if not isinstance(table, dict) or not table:
        raise place.error('must be a table of bounds, as "finger.thickness" = ["2 mm", "5 mm"]', shown(table))
    found: dict[str, tuple[float, float]] = {}
    for key, value in table.items():
        at = place.at(key)
        if isinstance(value, dict):
            found |= _free(value, at, scene, f"{above}{key}.")
            continue
        if not isinstance(value, list) or len(value) != 2:
            raise at.error("must be two numbers, least and largest", shown(value))
        try:
            of = kind(scene, above + key)
        except LookupError as error:
            raise at.error(f"must be the key of a number ({error})", shown(value)) from None
        low, high = (read_number(item, at.entry(i), of) for i, item in enumerate(value))
        if not low < high:
            raise at.error("must be two numbers, the first smaller", shown(value))
        found[above + key] = (low, high)
    return found
