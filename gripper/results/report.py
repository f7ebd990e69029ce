"""A result as text, HTML and CSV. Reads results only by their public names."""

from __future__ import annotations

import csv
import html
import io
import math
import textwrap
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gripper.friction import Coefficients, Friction
from gripper.results.nothing import Least, least

if TYPE_CHECKING:
    from gripper.result import Checks, Contact, PoseResult, Result

WIDTH = 100
"""Columns of a screen."""
MOST_ROWS = 20
"""Poses in a table; of a longer motion the table shows its ends, events and extremes."""
_MOST_LINES = 8
_HEADLINES = (
    *("insertion_force", "retention_force", "retention_ratio", "dissipation", "locking_margin"),
    *("strain", "strain_margin", "clearance", "force_on_object"),
)
"""The numbers of a summary that are printed with a motion."""
_HEADER = ("pose", "status", "Fx (N)", "Fy (N)", "clamp (N m)", "energy (J)", "strain", "gap (m)", "contacts")


def as_csv(result: Result) -> str:
    """Write one row a pose, units in the column names, empty cells where a pose failed."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    forces = ["force_on_object_x_N", "force_on_object_y_N", "motion_force", "clamp_moment_Nm", "energy_J"]
    shape = ["tip_x_m", "tip_y_m", "tip_rotation_rad", "max_strain", "min_gap_m", "contacts"]
    writer.writerow(["pose", result.parameter or "parameter", "status", *forces, *shape])
    writer.writerows(_csv_row(i, pose) for i, pose in enumerate(result.poses))
    return text.getvalue()


def _csv_row(i: int, pose: PoseResult) -> list[Any]:
    force, tip = pose.force_on_object or (None, None), pose.tip or (None, None)
    contacts = None if pose.status == "failed" else len(pose.contacts)
    forces = [*force, pose.motion_force, pose.clamp_moment, pose.energy]
    return [i, pose.parameter, pose.status, *forces, *tip, pose.tip_rotation, pose.max_strain, pose.min_gap, contacts]


def _number(value: float | None, none: float = 0.0) -> str:
    """Write it in four digits; a number no larger than ``none`` is 0."""
    return "" if value is None else f"{value if abs(value) > none else 0.0:.4g}"


def _where(contact: Contact) -> str:
    return f"{contact.on} {contact.s:.4g}"


def _cells(i: int, pose: PoseResult, parameter: str | None, none: Least) -> list[str]:
    force = pose.force_on_object or (None, None)
    numbers = (*force, pose.clamp_moment, pose.energy, pose.max_strain, pose.min_gap)
    limits = (none.force, none.force, none.moment, none.energy, none.ratio, none.length)
    place = [_number(pose.parameter and round(pose.parameter, 12) + 0.0)] if parameter else []
    contacts = ", ".join(_where(contact) for contact in pose.contacts)
    return [str(i), *place, pose.status, *map(_number, numbers, limits), contacts]


def _header(result: Result) -> list[str]:
    return [_HEADER[0], *([result.parameter] if result.parameter else []), *_HEADER[1:]]


def _force(pose: PoseResult) -> float:
    return math.hypot(*pose.force_on_object) if pose.force_on_object else 0.0


def _telling(poses: Sequence[PoseResult]) -> list[int]:
    """Choose which poses of a long motion a table shows: ends, extremes, changes of status, some between."""
    numbers = range(len(poses))
    changes = {i for i in numbers[1:] if poses[i].status != poses[i - 1].status}
    extremes = {max(numbers, key=lambda i: _force(poses[i])), max(numbers, key=lambda i: poses[i].max_strain or 0.0)}
    spread = {round(i * numbers[-1] / 6) for i in range(7)}
    both = spread | extremes
    return sorted(both | set(sorted(changes | {i - 1 for i in changes})[: MOST_ROWS - 1 - len(both)]))


def _rows(result: Result) -> list[list[str]]:
    """Build the table's rows; of many poses, a last one of a single cell says how many are shown."""
    poses, none = result.poses, least(result.scene)
    shown = list(range(len(poses))) if len(poses) <= MOST_ROWS else _telling(poses)
    rows = [_cells(i, poses[i], result.parameter, none) for i in shown]
    return rows if len(shown) == len(poses) else [*rows, [f"({len(shown)} of {len(poses)} poses)"]]


def _table(result: Result) -> list[str]:
    header, rows = _header(result), _rows(result)
    full = [row for row in (header, *rows) if len(row) > 1]
    widths = [max(len(row[column]) for row in full) for column in range(len(header))]
    lines = ("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=False)) for row in (header, *rows))
    return [line.rstrip() for line in lines]


def _contact(contact: Contact) -> str:
    extent = f"{contact.extent[0]:.6g} to {contact.extent[1]:.6g}"
    forces = f"N = {contact.normal_force:.6g} N, T = {contact.tangential_force:.6g} N"
    return f"{contact.on}, s = {contact.s:.6g} m ({extent}): {forces}, {contact.state}"


def _checks(checks: Checks) -> str:
    firmness = "stability" if checks.singularity is None else "singularity"
    names = ("stationarity", "force_balance", "moment_balance", firmness)
    values = [f"{name.replace('_', ' ')} {_number(getattr(checks, name)) or 'none'}" for name in names]
    return f"{', '.join(values)}, penetration at most {_number(checks.penetration_bound)} m ({checks.certificate})"


def _details(pose: PoseResult) -> list[str]:
    """Say what there is to say of a single pose."""
    if pose.status == "failed":
        return []
    error = ", ".join(f"{name} {_number(value)}" for name, value in _errors(pose) if value is not None)
    lines = [f"contact: {_contact(contact)}" for contact in pose.contacts]
    return [*lines, f"checks: {_checks(pose.checks)}", f"relative error of the force: {error or 'not estimated'}"]


def _errors(pose: PoseResult) -> list[tuple[str, float | None]]:
    return [("discretisation", pose.error.discretisation), ("next theory", pose.error.next_theory)]


def _capped(lines: list[str], what: str) -> list[str]:
    more = len(lines) - _MOST_LINES
    return lines if more <= 0 else [*lines[:_MOST_LINES], f"... and {more} more {what}"]


def _events(result: Result, where: str) -> list[str]:
    name = result.parameter or "parameter"
    lines = [
        f"{event.kind} at {name} = {event.parameter:.6g}{event.detail and f' ({event.detail})'}"
        for event in result.events
    ]
    rest = result.events[_MOST_LINES:]
    if not rest:
        return lines
    kinds = Counter(event.kind for event in rest)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    more = f"... and {len(rest)} more, the last at {name} = {rest[-1].parameter:.6g} ({counts}): see {where}"
    return [*lines[:_MOST_LINES], more]


def _headlines(result: Result) -> list[str]:
    """The numbers of a motion that a designer asks for, located between the poses; of one pose the table has them."""
    if len(result.poses) == 1:
        return []
    summary = result.summary().rounded(least(result.scene))
    rough = result.scene.friction is not None and not result.scene.friction.absent
    lines = summary.lines(name for name in _HEADLINES if rough or name not in ("dissipation", "locking_margin"))
    if summary.locked:
        lines.append(f"locked: friction holds the finger for any force at {summary.locked} of {summary.poses} poses")
    return lines


def _failures(result: Result) -> list[str]:
    failed = [(i, pose) for i, pose in enumerate(result.poses) if pose.status == "failed"]
    if not failed:
        return []
    lines = _capped([f"  pose {i}: {pose.reason}" for i, pose in failed], "failed poses")
    return [f"WARNING: {len(failed)} of {len(result.poses)} poses failed", *lines]


def _others(result: Result) -> list[str]:
    """Say where friction leaves more than one answer."""
    found = [(i, pose.checks.other_solutions) for i, pose in enumerate(result.poses) if pose.checks.other_solutions]
    if not found:
        return []
    which = sorted({name for _, names in found for name in names})
    places = f"pose {found[0][0]}" if len(found) == 1 else f"{len(found)} poses, {found[0][0]} to {found[-1][0]}"
    return [f"Coulomb's law has more than one solution at {places}: the finger might also be {' or '.join(which)}"]


def _model(result: Result) -> list[str]:
    model = result.model
    changes = [pose.error.next_theory for pose in result.poses if pose.error.next_theory is not None]
    chosen = (
        f" (the next one would change forces by up to {100 * round(max(changes), 12):.2g} %)" if any(changes) else ""
    )
    lines = [f"theory: {model.theory}{chosen}"]
    friction = result.scene.friction
    lines += [f"friction: {_friction(friction)}"] if friction and not friction.absent else []
    lines += ["left out: " + "; ".join(f"{part.what} ({part.why})" for part in model.left_out)] * bool(model.left_out)
    return lines + [f"not modelled: {', '.join(model.not_modelled)}"] * bool(model.not_modelled)


def _friction(friction: Friction) -> str:
    mu = friction.coefficient
    said = f"{mu.finger} (jaw: {mu.jaw})" if isinstance(mu, Coefficients) else f"{mu}"
    return f"{friction.model}, mu = {said}"


def _warnings(result: Result) -> list[str]:
    return [f"WARNING: {warning}" for warning in result.model.warnings]


def _wrapped(lines: list[str]) -> list[str]:
    return [piece for line in lines for piece in textwrap.wrap(line, WIDTH, subsequent_indent="  ")]


def as_text(result: Result, events: str = "result.events") -> str:
    """Fill one screen: title, model, table of poses, events, peaks or the details of a single pose, what is wrong.

    ``events`` says where all events are, if there are more than are shown.
    """
    blocks = [
        _wrapped([result.title] if result.title else []) + _wrapped(_model(result)),
        _table(result),
        _wrapped([*_events(result, events), *_others(result)]),
        _wrapped(_details(result.poses[0])) if len(result.poses) == 1 else _headlines(result),
        _wrapped([*_warnings(result), *_failures(result)]),
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def as_html(result: Result) -> str:
    """Write the same as a compact table for notebooks; every text escaped."""
    header = "".join(f"<th>{html.escape(cell)}</th>" for cell in _header(result))
    rows = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in _rows(result))
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    details = _details(result.poses[0]) if len(result.poses) == 1 else _headlines(result)
    happened = [*_events(result, "result.events"), *_others(result)]
    notes = [*_model(result), *happened, *details, *_warnings(result), *_failures(result)]
    text = "".join(f"<div>{html.escape(note)}</div>" for note in notes)
    return f"<div><b>{html.escape(result.title)}</b><table><tr>{header}</tr>{body}</table>{text}</div>"
