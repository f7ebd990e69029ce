"""What is installed: plugins by their entry points, listed without importing any of them."""

from __future__ import annotations

import dataclasses
import inspect
import pkgutil
import traceback
from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint, EntryPoints, distributions, entry_points
from typing import Any

from gripper.names import known_names

LONGEST_MESSAGE = 300
"""Characters of a stranger's error that are repeated."""
_UNKNOWN = ("unknown", "unknown")


class PluginError(RuntimeError):
    """A plugin is installed but cannot be used; ``reason`` says why, without its name."""

    def __init__(self, plugin: str, reason: str) -> None:
        super().__init__(f"{plugin} cannot be used: {reason}")
        self.reason = reason


@dataclasses.dataclass(frozen=True, order=True)
class Record:
    """One entry point.

    Parameters
    ----------
    group
        gripper.objects, gripper.fingers, gripper.jaws or gripper.loads.
    name
        As a scene file writes it.
    distribution, version
        Of the package that offers it.
    target
        ``module:class``.
    """

    group: str
    name: str
    distribution: str
    version: str
    target: str

    @property
    def kind(self) -> str:
        """Object, finger, jaw or load, in lower case."""
        return _KINDS[self.group].word

    def __str__(self) -> str:
        return f"{self.kind} {self.name!r} of {self.distribution} {self.version} ({self.target})"


@dataclasses.dataclass(frozen=True)
class _Kind:
    word: str
    base: str
    keys: frozenset[str]
    """Keys of its table in a scene file that are not its own fields."""


_KINDS = {
    "gripper.objects": _Kind("object", "gripper.objects:Object", frozenset({"surface", "pose"})),
    "gripper.fingers": _Kind("finger", "gripper.fingers:Finger", frozenset({"profile", "pose"})),
    "gripper.jaws": _Kind("jaw", "gripper.fingers:Jaw", frozenset({"shape"})),
    "gripper.loads": _Kind("load", "gripper.loads:Load", frozenset({"type"})),
}
OWN = "gripper"
"""The distribution of this project."""
GROUPS = tuple(_KINDS)
"""The groups of entry points, in which anyone can offer plugins."""


def installed(group: str) -> list[Record]:
    """List the plugins of a group, by name, without importing them.

    Raises
    ------
    LookupError
        No such group.
    """
    if group not in _KINDS:
        raise LookupError(f"unknown group {group!r}; known: {known_names(group, GROUPS)}")
    try:
        return _records(entry_points(group=group))
    except Exception:  # one distribution's list cannot be read, and takes all others down
        readable = (points for points, _ in _each() if not isinstance(points, Exception))
        return _records(point for points in readable for point in points.select(group=group))


def unreadable() -> list[str]:
    """Name the distributions whose list of entry points cannot be read, each with the reason."""
    return sorted(
        f"{name}: its entry points cannot be read ({_said(p)})" for p, name in _each() if isinstance(p, Exception)
    )


def _each() -> Iterator[tuple[EntryPoints | Exception, str]]:
    """Every distribution's entry points, or why they cannot be read, and its name and version."""
    for distribution in distributions():
        name = f"{distribution.name} {distribution.version}"
        try:
            yield distribution.entry_points, name
        except Exception as error:  # a stranger's metadata may be anything
            yield error, name


def _said(error: BaseException) -> str:
    """Write an exception in one line, whatever it is."""
    try:
        message = " ".join(str(error).split())
    except Exception as broken:  # its own __str__ fails
        message = f"its message cannot be read, {type(broken).__name__}"
    return f"{type(error).__name__}: {message[:LONGEST_MESSAGE]}"


def load(group: str, name: str) -> type[Any]:
    """Import a plugin.

    Parameters
    ----------
    group
        gripper.objects, gripper.fingers, gripper.jaws or gripper.loads.
    name
        As a scene file writes it.

    Returns
    -------
    type
        A frozen dataclass, a subclass of the group's base.

    Raises
    ------
    LookupError
        No such group or name; lists the known ones.
    PluginError
        It cannot be imported, is not what the group asks for, or two distributions offer the name.
    """
    records = installed(group)
    found = [record for record in records if record.name == name]
    if not found:
        known = known_names(name, dict.fromkeys(record.name for record in records))
        raise LookupError(f"unknown {_KINDS[group].word} {name!r}; known: {known}")
    return _loaded(found)


def check(record: Record) -> str | None:
    """Tell why a plugin cannot be used; None where it can."""
    same = [other for other in installed(record.group) if other.name == record.name]
    try:
        _loaded(same or [record])
    except PluginError as error:
        return error.reason
    return None


def record_of(cls: type[Any]) -> Record | None:
    """Find the entry point that names a class; None where none does."""
    target = f"{cls.__module__}:{cls.__qualname__}"
    return next((record for group in GROUPS for record in installed(group) if record.target == target), None)


def blamed(error: BaseException, *instances: object) -> str | None:
    """Tell which of these plugins' own modules an error came from, and whose it is; None where it came from none."""
    frames = traceback.walk_tb(error.__traceback__)
    modules = {frame.f_globals.get("__name__") for frame, _ in frames}
    for cls in (type(instance) for instance in instances):
        if cls.__module__ in modules and cls.__module__.partition(".")[0] != "gripper_plugins":
            return str(record_of(cls) or f"{cls.__module__}:{cls.__qualname__}")
    return None


def fault(group: str, cls: Any) -> str | None:
    """Tell what keeps a class from being a plugin of a group, registered or not; None where nothing does."""
    return _unfit(cls, _KINDS[group])


def _records(points: Iterable[EntryPoint]) -> list[Record]:
    """Entry points by name; each distribution's metadata is read once, which takes most of the time."""
    points = list(points)  # keeps their distributions, so that no other gets the id of one
    sources: dict[int, tuple[str, str]] = {}
    records = set()
    for point in points:
        if id(point.dist) not in sources:
            sources[id(point.dist)] = (str(point.dist.name), str(point.dist.version)) if point.dist else _UNKNOWN
        records.add(Record(point.group, point.name, *sources[id(point.dist)], point.value))
    return sorted(records)


def _loaded(found: list[Record]) -> type[Any]:
    if len(found) > 1:
        offers = " and ".join(f"{record.distribution} {record.version} ({record.target})" for record in found)
        raise PluginError(f"{found[0].kind} {found[0].name!r}", f"offered more than once, by {offers}: uninstall one")
    cls = _imported(found[0])
    reason = _unfit(cls, _KINDS[found[0].group])
    if reason:
        raise PluginError(str(found[0]), reason)
    return cls  # _unfit has checked that it is a class


def _imported(record: Record) -> Any:
    try:
        return EntryPoint(record.name, record.target, record.group).load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's module may raise anything, SystemExit too; it is kept as the cause
        raise PluginError(str(record), f"its import fails with {_said(error)}") from error


def _unfit(cls: Any, kind: _Kind) -> str | None:
    """Tell what keeps a class from being a plugin of this kind; None where nothing does."""
    base: type[Any] = pkgutil.resolve_name(kind.base)
    if not inspect.isclass(cls):
        return f"it must be a class; got {type(cls).__name__}"
    if not issubclass(cls, base):
        return f"it must be a subclass of {kind.base.replace(':', '.')}; got {cls.__name__}"
    own = vars(cls)  # a base's fields do not make its subclass a dataclass
    if "__dataclass_fields__" not in own or not own["__dataclass_params__"].frozen:
        return f"it must be a frozen dataclass; got {cls.__name__}"
    if own["__abstractmethods__"]:
        return f"it must write {', '.join(sorted(own['__abstractmethods__']))}; got none"
    clash = sorted(kind.keys.intersection(own["__dataclass_fields__"]))
    if clash:
        return f"its fields must have other names than the scene file's own keys; got {', '.join(clash)}"
    return None
