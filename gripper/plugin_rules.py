"""What a class must be to be a plugin of a kind: told by looking at it, without making an instance."""

from __future__ import annotations

import dataclasses
import inspect
import pkgutil
from collections.abc import Callable
from typing import Any

import sympy

from gripper.fields import field_types


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of plugin.

    Parameters
    ----------
    word
        Its name, in lower case.
    base
        ``module:class`` of which every plugin is a subclass.
    keys
        Keys of its table in a scene file that are not its own fields.
    """

    word: str
    base: str
    keys: frozenset[str]


def unfit(cls: Any, kind: Kind) -> str | None:
    """Tell what keeps a class from being a plugin of this kind; None where nothing does."""
    base: type[Any] = pkgutil.resolve_name(kind.base)
    if not inspect.isclass(cls):
        return f"it must be a class; got {type(cls).__name__}"
    if not issubclass(cls, base):
        bases = ", ".join(f"{each.__module__}.{each.__qualname__}" for each in cls.__bases__)
        return f"it must be a subclass of {kind.base.replace(':', '.')}; got {cls.__name__}, a subclass of {bases}"
    own = vars(cls)  # a base's fields do not make its subclass a dataclass
    if "__dataclass_fields__" not in own or not own["__dataclass_params__"].frozen:
        return f"it must be a frozen dataclass; got {cls.__name__}"
    if own["__abstractmethods__"]:
        return f"it must write {', '.join(sorted(own['__abstractmethods__']))}; got none"
    clash = sorted(kind.keys.intersection(own["__dataclass_fields__"]))
    if clash:
        return f"its fields must have other names than the scene file's own keys; got {', '.join(clash)}"
    return _unknown_type(cls) or _unlike(cls) or _unbounded(cls)


def _unknown_type(cls: Any) -> str | None:
    """Tell of a field whose type is a name that nobody knows."""
    try:
        field_types(cls)
    except Exception as error:  # a stranger's annotation may be any expression
        return f"its fields must have types that can be looked up; got {type(error).__name__}: {error}"
    return None


def _unlike(cls: type[Any]) -> str | None:
    """Tell of a method that cannot be called as its base promises."""
    for name, promised in _promised(cls):
        written = inspect.getattr_static(cls, name)
        if not isinstance(promised, property) and not callable(getattr(written, "__func__", written)):
            return f"its {name} must be a method; got a {type(written).__name__}"
        if isinstance(promised, property) and inspect.isfunction(written):
            return f"its {name} must be a property; got a method"
        if not isinstance(promised, property) and not _takes(written, promised):
            asked = inspect.signature(promised)
            return f"its {name} must take {_named(asked)}; got {_named(inspect.signature(written))}"
    return None


def _unbounded(cls: type[Any]) -> str | None:
    """Tell of a surface that is not quadratic and does not say where its outline is, whatever its numbers are."""
    from gripper.objects import ImplicitSurface  # here, because other kinds do without it

    if not issubclass(cls, ImplicitSurface) or cls.half_size is not ImplicitSurface.half_size:
        return None
    instance: Any = object.__new__(cls)
    x, y = sympy.symbols("x y", real=True)
    for field in dataclasses.fields(cls):
        object.__setattr__(instance, field.name, sympy.Symbol(field.name, positive=True))
    try:
        degree = sympy.Poly(instance.g(x, y), x, y).total_degree()
    except sympy.PolynomialError:
        degree = None
    except Exception:  # its g may need numbers, or fields of another kind: nothing is known then
        return None
    return None if degree is not None and degree <= 2 else "it must write half_size, because its g is not quadratic"


def _promised(cls: type[Any]) -> list[tuple[str, Any]]:
    """What its bases leave to be written, by name."""
    found: dict[str, Any] = {}
    for base in reversed(cls.__mro__[1:]):
        found |= {name: item for name, item in vars(base).items() if getattr(item, "__isabstractmethod__", False)}
    return sorted(found.items())


def _takes(written: Any, promised: Callable[..., Any]) -> bool:
    """Whether a method takes the arguments that its base's does; of those counted by *, any number."""
    if not inspect.isfunction(written):
        return True  # nothing is known of its arguments
    parameters = inspect.signature(promised).parameters.values()
    fixed = [p for p in parameters if p.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD]
    several = len(fixed) < len(parameters)
    signature = inspect.signature(written)
    try:
        (signature.bind_partial if several else signature.bind)(*(p.name for p in fixed))
    except TypeError:
        return False
    return True


def _named(signature: inspect.Signature) -> str:
    return ", ".join(str(p).partition(":")[0] for p in signature.parameters.values() if p.name != "self") or "nothing"
