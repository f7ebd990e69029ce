"""``gripper plugins``: what is installed, from where, and what cannot be loaded and why."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from gripper.registry import Record


def _ok(record: Record, name: str) -> str:
    """That a plugin can be used; and by which name where its own is another's."""
    return "ok" if name == record.name else f"ok (under this name: {record.name!r} is another distribution's, too)"


def plugins() -> None:
    """List the objects, fingers, jaws and loads that are installed, and whether they can be used."""
    from rich.console import Console
    from rich.table import Table

    from gripper.registry import GROUPS, check, installed, scene_name, unreadable

    table = Table("kind", "name", "distribution", "target", "state", box=None, pad_edge=False, header_style="bold")
    for records in map(installed, GROUPS):
        for record in records:
            name, source = scene_name(record, records), f"{record.distribution} {record.version}"
            table.add_row(record.kind, name, source, record.target, check(record) or _ok(record, name))
    # into a pipe: one line a plugin, however long
    Console(markup=False, highlight=False, emoji=False, width=None if sys.stdout.isatty() else 10_000).print(table)
    for line in unreadable():
        typer.echo(line, err=True)
