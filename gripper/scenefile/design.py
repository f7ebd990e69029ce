"""The tables of a scene file that design needs: a material by its name, pairs of materials, limits, tolerances."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from gripper.expression import written_kind
from gripper.expression.dimensions import NEWTON, Dimension, unit
from gripper.fingers import Material
from gripper.limits import LIMITS, Limits
from gripper.materials import PLASTICS, friction_range, material
from gripper.parameters import kind
from gripper.results.summary import QUANTITIES
from gripper.scene import Scene
from gripper.scenefile.place import Place, Table, as_table, check_keys, shown
from gripper.scenefile.tables import build
from gripper.scenefile.values import read_number
from gripper.tolerances import Tolerances

_WORK = unit("J")


def read_material(value: Any, place: Place) -> Material:
    """Read a material: ``material = "POM"``, or a table, in which ``name = "POM"`` stands for what is left out."""
    table = {"name": value} if isinstance(value, str) else as_table(value, place)
    if "name" not in table:
        return build(Material, table, place)
    name = table["name"]
    if not isinstance(name, str) or name not in PLASTICS:
        at = place if isinstance(value, str) else place.at("name")
        raise at.error(f"must be one of {', '.join(PLASTICS)}", shown(name))
    known = material(name)
    named = {key: getattr(known, key) for key in ("youngs_modulus", "poisson_ratio", "yield_strain", "repeated_strain")}
    return build(Material, named | {key: given for key, given in table.items() if key != "name"}, place)


def read_pair(value: Any, place: Place) -> float:
    """Read ``pair = ["POM", "steel"]``: the middle of the range of their coefficients of friction."""
    if not (isinstance(value, list) and len(value) == 2 and all(isinstance(item, str) for item in value)):
        raise place.error('must be two materials, as ["POM", "steel"]', shown(value))
    try:
        return sum(friction_range(*value)) / 2
    except LookupError as error:
        raise place.error(f"must be a pair with a known coefficient ({error})", shown(value)) from None


def read_limits(value: Any, place: Place, parameter: Dimension | None = None) -> Limits:
    """Read [limits]: max_ and min_ before the names of the summary's quantities; the motion's parameter has a kind."""
    table = as_table(value, place)
    check_keys(table, LIMITS, place)
    if not table:
        raise place.error(f"must hold at least one of {', '.join(LIMITS)}", shown(table))
    return Limits({name: _bound(name[4:], bound, place.at(name), parameter) for name, bound in table.items()})


def _bound(quantity: str, value: Any, place: Place, parameter: Dimension | None) -> float:
    """Read a limit; forces of a motion are work per unit of its parameter, a length or not."""
    kind: Dimension | None = unit(QUANTITIES[quantity] or "1")
    if quantity in ("insertion_force", "retention_force"):
        kind = _WORK.times(parameter, -1) if parameter is not None else None
    bound = read_number(value, place, kind)
    if kind is None and isinstance(value, str) and written_kind(value) not in (None, NEWTON, _WORK):
        raise place.error("must be a force, in N, or where the motion turns a moment, in N*m", shown(value))
    return bound


def read_tolerances(value: Any, place: Place, scene: Scene) -> Tolerances:
    """Read [tolerance]: half widths of bands, by the keys of the scene's numbers."""
    if not isinstance(value, dict):
        raise place.error("must be a table of half widths by key (the solver's is solver.tolerance)", shown(value))
    bands = {}
    for key, width in _flat(value, ""):
        at = Place(place.file, f"{place.key}.{key}")
        try:
            of = kind(scene, key)
        except LookupError as error:
            raise at.error(f"must be the key of a number ({error})", shown(width)) from None
        bands[key] = read_number(width, at, of)
        if bands[key] <= 0:
            raise at.error(f"must be a positive number, in {of.unit if of else 'SI units'}", shown(width))
    return Tolerances(bands)


def _flat(table: Table, above: str) -> Iterator[tuple[str, Any]]:
    """Keys with dots that TOML has taken apart, put together again."""
    for key, value in table.items():
        whole = f"{above}.{key}" if above else key
        if isinstance(value, dict):
            yield from _flat(value, whole)
        else:
            yield whole, value
