"""What a sweep's rows depend on: written beside them, and compared before another run goes on with them."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from typing import Any

from gripper.describe import describe
from gripper.fingers import Finger, Jaw
from gripper.loads import Load
from gripper.names import shortened
from gripper.objects import Object
from gripper.scene import Scene
from gripper.sweep.plan import Plan

_BESIDE = ("title", "limits", "tolerance")
"""Tables of a scene that no row depends on."""
_NAMES = re.compile(r"object(\..*)?\.surface|finger\.profile|finger\.jaw\.shape|loads\[\d+\]\.type")
"""Keys of plugins' names, which depend on what else is installed; their classes do not."""
_SHOWN = 3


def about(scene: Scene, plan: Plan) -> dict[str, Any]:
    """Say what is swept, as plain data: values by key, the scene, the classes of its parts, and this version."""
    return {
        "over": {key: list(values) for key, values in plan.over},
        "scene": describe(scene),
        "classes": list(_classes(scene)),
        "gripper": version("gripper"),
    }


def _classes(part: Any) -> Iterator[str]:
    """Where the class of each plugin in a scene is written."""
    if dataclasses.is_dataclass(part) and not isinstance(part, type):
        if isinstance(part, (Finger, Jaw, Object, Load)):
            yield f"{type(part).__module__}:{type(part).__qualname__}"
        for field in dataclasses.fields(part):
            if field.name not in ("limits", "tolerances"):
                yield from _classes(getattr(part, field.name))
    elif isinstance(part, tuple):
        for item in part:
            yield from _classes(item)


def difference(text: str, swept: Mapping[str, Any]) -> str:
    """Say in what that rows depend on a folder's sweep differs from another; empty where it does not.

    Parameters
    ----------
    text
        That a folder holds, of :func:`about`.
    swept
        What is wanted now.
    """
    try:
        found = json.loads(text)
        there, here = _basis(found, found), _basis(json.loads(json.dumps(swept)), found)
    except (ValueError, AttributeError, TypeError):
        return "what was swept cannot be read"
    keys = [key for key in {**there, **here} if there.get(key) != here.get(key)]
    said = [f"{key} is {_said(there, key)}, now {_said(here, key)}" for key in keys[:_SHOWN]]
    return "; ".join(said + [f"{len(keys) - _SHOWN} more differ"] * (len(keys) > _SHOWN))


def _basis(swept: dict[str, Any], known: Mapping[str, Any]) -> dict[str, Any]:
    """What rows depend on, flat; of what ``known``, perhaps of an earlier version, says too."""
    scene = {key: table for key, table in swept["scene"].items() if key not in _BESIDE}
    flat = dict(_flat(scene))
    if "classes" in known:
        flat = {key: value for key, value in flat.items() if not _NAMES.fullmatch(key)}
    flat = {key: value for key, value in flat.items() if key not in swept["over"]}
    flat |= {f"over {key}": value for key, value in swept["over"].items()}
    return flat | {key: swept[key] for key in ("classes", "gripper") if key in known}


def _flat(part: Any, above: str = "") -> Iterator[tuple[str, Any]]:
    """Numbers and texts of nested tables, by the keys of a scene file."""
    items = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else None
    if items is None:
        yield above, part
        return
    for key, value in items:
        step = f"[{key}]" if isinstance(part, list) else f".{key}" if above else str(key)
        yield from _flat(value, above + step)


def _said(basis: Mapping[str, Any], key: str) -> str:
    return shortened(json.dumps(basis[key], ensure_ascii=False)) if key in basis else "not given"
