"""From a table of a scene file to an instance of a dataclass; pydantic judges what is no number."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any, TypeVar, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from gripper.expression import Names
from gripper.registry import record_of
from gripper.scenefile.place import Place, SceneFileError, Table, check_given, check_keys, shown
from gripper.scenefile.values import Nest, converted

Instance = TypeVar("Instance")

_CONFIG = ConfigDict(arbitrary_types_allowed=True, extra="forbid", allow_inf_nan=False)


def build(
    cls: type[Instance],
    table: Table,
    place: Place,
    made: Table | None = None,
    other: Iterable[str] = (),
    nest: Nest | None = None,
    names: Names = (),
) -> Instance:
    """Make an instance of a frozen dataclass, a plugin or the material, from a table.

    Parameters
    ----------
    cls
        The dataclass.
    table
        As TOML gave it.
    place
        Of the table.
    made
        Fields that are made already.
    other
        Keys of the table that are not fields.
    nest
        Makes the plugins that stand in fields of this one.
    names
        The motion's parameter, with its kind, which expressions may hold where a field says so.

    Raises
    ------
    SceneFileError
        A key is unknown or missing, or a value breaks its rule.
    """
    made, other = made or {}, list(other)
    fields = [field for field in dataclasses.fields(cls) if field.init and field.name not in made]  # type: ignore[arg-type]
    check_keys(table, [*other, *(field.name for field in fields)], place)
    check_given(table, [field.name for field in fields if _is_required(field)], place)
    own = {key: value for key, value in table.items() if key not in other}
    try:
        annotations = get_type_hints(cls, include_extras=True)
        values = {name: converted(annotations[name], value, place.at(name), nest, names) for name, value in own.items()}
        return _validated(cls, made | values)
    except ValidationError as error:
        raise _translated(error, own, place) from None
    except SceneFileError:
        raise
    except Exception as error:  # a plugin's own code may raise anything; it is kept as the cause
        what = " ".join(f"{type(error).__name__}: {error}".split())
        name = record_of(cls) or cls.__name__
        raise place.error(f"must be what {name} can be made of (it fails with {what})", shown(own)) from error


def _is_required(field: dataclasses.Field[Any]) -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _validated(cls: type[Instance], values: Table) -> Instance:
    # pydantic gives a plain dataclass no config but its container's: hence the tuple
    adapter = TypeAdapter(tuple[cls], config=_CONFIG)  # type: ignore[valid-type]
    return adapter.validate_python((values,))[0]


def _translated(error: ValidationError, table: Table, place: Place) -> SceneFileError:
    """Put pydantic's first error in the house's words."""
    first = error.errors(include_url=False)[0]
    if first["type"] == "value_error":
        return place.broken(first["ctx"]["error"], {key: key for key in table})
    for part in first["loc"][1:]:
        place = place.entry(part) if isinstance(part, int) else place.at(part)
    if first["type"] == "literal_error":
        return place.error(f"must be {first['ctx']['expected']}", shown(first["input"]))
    return place.error(first["msg"].replace("Input should", "must", 1), shown(first["input"]))
