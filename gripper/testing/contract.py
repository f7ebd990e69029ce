"""How a property is checked: what it says where it fails, whatever a plugin does."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import sys
import tomllib
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import sympy

from gripper.names import shortened
from gripper.registry import fault, record_of

Plugin = TypeVar("Plugin")
Property = Callable[[Plugin], None]


class ContractError(AssertionError):
    """A plugin breaks a property that its kind promises: one sentence that says which, and what was got."""


def require(holds: bool, rule: str, got: object) -> None:
    """Raise "must <rule>; got <got>" unless it holds.

    Raises
    ------
    ContractError
        It does not hold.
    """
    if not holds:
        raise ContractError(f"must {rule}; got {shortened(str(got))}")


def run(instance: Plugin, properties: Sequence[Property[Plugin]]) -> None:
    """Check an instance against properties, in their order, up to the first that fails.

    Raises
    ------
    ContractError
        Names plugin, distribution, instance, rule and what was got; or what the plugin raised.
    """
    for each in properties:
        try:
            each(instance)
        except ContractError as error:
            raise ContractError(f"{_called(instance)} {error}") from None
        except Exception as error:  # a plugin may raise anything; it is kept as the cause
            what = " ".join(f"{type(error).__name__}: {error}".split())
            sentence = f"must not fail where {_sentence(each)} is checked; got {shortened(what)}"
            raise ContractError(f"{_called(instance)} {sentence}") from error


def _called(instance: object) -> str:
    """The instance, and whose plugin it is where its class is one that is installed."""
    try:
        shown = shortened(repr(instance))
    except Exception:  # a plugin's own repr may raise anything
        shown = f"a {type(instance).__name__}"
    record = record_of(type(instance))
    return shown if record is None else f"{record}: {shown}"


def _sentence(each: Callable[..., None]) -> str:
    return each.__name__.removeprefix("has_").replace("_", " ")


def fits(group: str) -> Property[Any]:
    """Return the property that the class can be offered in a group of plugins."""

    def has_a_class_that_can_be_offered(instance: object) -> None:
        reason = fault(group, type(instance))
        require(reason is None, f"be of a class that {group} takes", reason)

    return has_a_class_that_can_be_offered


def has_the_manners_of_data(instance: Any) -> None:
    """Frozen, hashable, equal to its copies, made of lists or pickled (where its class can be imported)."""
    copies = {
        "a deep copy": copy.deepcopy(instance),
        "one made of lists": dataclasses.replace(instance, **_lists(instance)),
    }
    if getattr(sys.modules.get(type(instance).__module__), type(instance).__qualname__, None) is type(instance):
        copies["its pickle"] = pickle.loads(pickle.dumps(instance))
    for name, same in copies.items():
        require(same == instance and hash(same) == hash(instance), f"equal {name}, also in its hash", same)
    try:
        instance.something = 1
    except dataclasses.FrozenInstanceError:
        return
    raise ContractError("must be frozen; got one that can be changed")


def _lists(instance: Any) -> dict[str, Any]:
    values = {field.name: getattr(instance, field.name) for field in dataclasses.fields(instance) if field.init}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


def survives_a_scene_file(group: str, *given: str) -> Property[Any]:
    """Return the property that an instance comes back from a scene file's table (fields ``given`` left out).

    It needs pydantic, as scene files do.
    """

    def has_the_same_values_after_a_scene_file(instance: Any) -> None:
        from gripper.describe import table
        from gripper.scenefile.sections import rebuilt
        from gripper.scenefile.toml import written

        made = {name: getattr(instance, name) for name in given}

        symbols = tuple(sorted(symbols_of(instance)))

        def trip(one: Any) -> Any:
            own = {name: value for name, value in table(group, one).items() if name not in given}
            return rebuilt(type(one), tomllib.loads(written({"table": own}))["table"], made, symbols)

        back = trip(instance)
        require(trip(back) == back, "come back from a scene file as it was written", back)
        for field in dataclasses.fields(instance):
            was, value = getattr(instance, field.name), getattr(back, field.name)
            kept = value == was or bool(_expressions(was))  # an expression comes back in other words
            require(kept, f"come back from a scene file with its {field.name} {was!r}", value)

    return has_the_same_values_after_a_scene_file


def _expressions(value: Any) -> list[sympy.Expr]:
    """The expressions in a field, its entries' too."""
    return [item for item in (value if isinstance(value, tuple) else (value,)) if isinstance(item, sympy.Expr)]


def symbols_of(instance: Any) -> set[str]:
    """Names of all symbols in an instance's expressions."""
    found = [each for field in dataclasses.fields(instance) for each in _expressions(getattr(instance, field.name))]
    return {symbol.name for each in found for symbol in each.free_symbols}
