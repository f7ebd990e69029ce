"""``gripper plugins``: what is installed, from where, and what cannot be loaded and why."""

from __future__ import annotations

import sys

import typer


def plugins() -> None:
    """List the objects, fingers, jaws and loads that are installed, and whether they can be used."""
    from rich.console import Console
    from rich.table import Table

    from gripper.registry import GROUPS, check, installed, unreadable

    table = Table("kind", "name", "distribution", "target", "state", box=None, pad_edge=False, header_style="bold")
    for record in (record for group in GROUPS for record in installed(group)):
        source = f"{record.distribution} {record.version}"
        table.add_row(record.kind, record.name, source, record.target, check(record) or "ok")
    # into a pipe: one line a plugin, however long
    Console(markup=False, highlight=False, emoji=False, width=None if sys.stdout.isatty() else 10_000).print(table)
    for line in unreadable():
        typer.echo(line, err=True)
