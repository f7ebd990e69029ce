"""Scene files: TOML in SI units, where a string may stand for a number, to scenes and back."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from gripper.scenefile import toml
from gripper.scenefile.place import Place, SceneFileError, Table, as_table

if TYPE_CHECKING:
    from gripper.scene import Scene

__all__ = ["SceneFileError", "dumps", "loads", "read"]

LARGEST_FILE = 5_000_000
"""Bytes; a scene of as many listed poses as a motion may have has 2 million."""


def read(path: str | os.PathLike[str]) -> Scene:
    """Read a scene file, or the scene of a result.

    Parameters
    ----------
    path
        Of a TOML file, in UTF-8; or of a result.json, whose scene it is to be.

    Raises
    ------
    SceneFileError
        The file cannot be read, or breaks a rule: one line with file, key, rule and the value got.
    """
    place = Place(os.fspath(path))
    try:
        with Path(path).open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # ValueError: no path can hold a null character
        raise place.error("must be a file that can be read", getattr(error, "strerror", None) or str(error)) from None
    if len(data) > LARGEST_FILE:
        raise place.error(f"must have at most {LARGEST_FILE} bytes", "more")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise place.error("must be UTF-8", f"byte 0x{data[error.start]:02x} in line {line}") from None
    return _of_result(text, place) if Path(path).suffix == ".json" else loads(text, place.file)


def _of_result(text: str, place: Place) -> Scene:
    """Read the scene that a result answers, as it was resolved."""
    try:
        result = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise place.error("must be JSON, as result.json is", f"{type(error).__name__}: {error}") from None
    tables = result.get("scene") if isinstance(result, dict) else None
    place = place.at("scene")
    return _made(as_table(tables, place), place)


def _made(tables: Table, place: Place) -> Scene:
    """Make the scene of a file's tables; what that needs is imported once they are seen to be tables."""
    import numpy as np

    from gripper.scenefile import sections

    with np.errstate(all="ignore"):  # what is not finite is refused by its value
        return sections.scene(tables, place)


def loads(text: str, name: str = "scene") -> Scene:
    """Read the text of a scene file.

    Parameters
    ----------
    text
        TOML.
    name
        What errors call it.

    Raises
    ------
    SceneFileError
        It breaks a rule: one line with name, key, rule and the value got.
    """
    place = Place(name)
    return _made(toml.tables(text, place), place)


def dumps(scene: Scene) -> str:
    """Write a scene as the text of a scene file: SI units, defaults filled in, motions as lists of values.

    Reading it back gives the same scene, whose parts all have poses and whose material has its shear modulus.
    Plugins must be registered, as ``gripper plugins`` lists them: a class without a name reads back as an error.
    """
    from gripper.describe import describe

    return toml.written(describe(scene))
