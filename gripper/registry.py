"""What is installed: plugins by their entry points, listed without importing any of them."""

from __future__ import annotations

import dataclasses
import sys
import traceback
from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint, EntryPoints, distributions, entry_points
from typing import Any

from gripper.names import known_names
from gripper.plugin_rules import Kind, unfit

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
    def full_name(self) -> str:
        """The name with its distribution's, which scene files may always write."""
        return f"{self.distribution}:{self.name}"

    @property
    def kind(self) -> str:
        """Object, finger, jaw or load, in lower case."""
        return _KINDS[self.group].word

    def __str__(self) -> str:
        return f"{self.kind} {self.name!r} of {self.distribution} {self.version} ({self.target})"


_KINDS = {
    "gripper.objects": Kind("object", "gripper.objects:Object", frozenset({"surface", "pose"})),
    "gripper.fingers": Kind("finger", "gripper.fingers:Finger", frozenset({"profile", "pose"})),
    "gripper.jaws": Kind("jaw", "gripper.fingers:Jaw", frozenset({"shape"})),
    "gripper.loads": Kind("load", "gripper.loads:Load", frozenset({"type"})),
}
OWN = "gripper"
"""The distribution of this project."""
OWN_PLUGINS = "gripper_plugins"
"""The package of its plugins."""
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
        As a scene file writes it: a name, which is this project's plugin where it has one, or ``distribution:name``.

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
    found = _meant(name, records)
    if not found:
        known = known_names(name, dict.fromkeys(record.name for record in records))
        raise LookupError(f"unknown {_KINDS[group].word} {name!r}; known: {known}")
    return _loaded(found)


def check(record: Record) -> str | None:
    """Tell why a plugin cannot be used; None where it can."""
    try:
        _loaded([record])
    except PluginError as error:
        return error.reason
    return None


def scene_name(record: Record, records: Iterable[Record] | None = None) -> str:
    """Give the name by which a scene file calls a plugin: its own, with its distribution where that is another's.

    Parameters
    ----------
    record
        The plugin.
    records
        All of its group, where they are known already.
    """
    meant = _meant(record.name, installed(record.group) if records is None else records)
    return record.name if meant == [record] else record.full_name


def _meant(name: str, records: Iterable[Record]) -> list[Record]:
    """The plugins that a name can mean: this project's own before any stranger's."""
    found = [record for record in records if name in (record.name, record.full_name)]
    return [record for record in found if record.distribution == OWN] or found


def record_of(cls: type[Any]) -> Record | None:
    """Find the entry point that names a class, this project's own first; None where none does."""
    found = (record for group in GROUPS for record in installed(group) if _is_target(record.target, cls))
    return min(found, key=lambda record: (record.distribution != OWN, record), default=None)


def _is_target(target: str, cls: type[Any]) -> bool:
    """Whether an entry point names a class: where it is written, or where a module that is imported repeats it."""
    module, _, name = target.partition(":")
    return target == f"{cls.__module__}:{cls.__qualname__}" or getattr(sys.modules.get(module), name, None) is cls


def blamed(error: BaseException, *instances: object) -> str | None:
    """Tell which of these plugins' own modules an error came from, and whose it is; None where it came from none."""
    frames = traceback.walk_tb(error.__traceback__)
    modules = {frame.f_globals.get("__name__") for frame, _ in frames}
    for cls in (type(instance) for instance in instances):
        if cls.__module__ in modules and cls.__module__.partition(".")[0] != OWN_PLUGINS:
            return str(record_of(cls) or f"{cls.__module__}:{cls.__qualname__}")
    return None


def fault(group: str, cls: Any) -> str | None:
    """Tell what keeps a class from being a plugin of a group, registered or not; None where nothing does."""
    return unfit(cls, _KINDS[group])


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
        names = " or ".join(repr(record.full_name) for record in found)
        raise PluginError(f"{found[0].kind} {found[0].name!r}", f"offered more than once, by {offers}: write {names}")
    cls = _imported(found[0])
    reason = unfit(cls, _KINDS[found[0].group])
    if reason:
        raise PluginError(str(found[0]), reason)
    return cls  # unfit has checked that it is a class


def _imported(record: Record) -> Any:
    try:
        return EntryPoint(record.name, record.target, record.group).load()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's module may raise anything, SystemExit too; it is kept as the cause
        raise PluginError(str(record), f"its import fails with {_said(error)}") from error
