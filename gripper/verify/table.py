"""The comparison as people read it: two tables of words and rounded numbers, as text or Markdown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gripper.friction import Coefficients
from gripper.pose import placed

if TYPE_CHECKING:
    from gripper.verify.report import Verification, VerifiedPose

_ISOTROPIC = 0.01
Rows = list[list[str]]


def text(report: Verification) -> str:
    """Aligned columns, for a terminal."""
    blocks = [_head(report), _aligned(_forces(report)), _aligned(_shapes(report)), _foot(report)]
    return "\n\n".join("\n".join(block) for block in blocks)


def markdown(report: Verification) -> str:
    """The same in Markdown."""
    blocks = [["  \n".join(_head(report))], _piped(_forces(report)), _piped(_shapes(report)), _foot(report)]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def overview(reports: Mapping[str, Verification]) -> str:
    """Compare several comparisons in Markdown: a row for each, by its name."""
    rows = [["", "largest force N", "largest difference", "mesh error at most"]]
    for name, report in reports.items():
        forces = [math.hypot(*pose.gripper.force) for pose in report.poses if pose.gripper.force]
        errors = [pose.mesh_error for pose in report.poses if pose.mesh_error is not None]
        largest = f"{max(forces):.2f}" if forces else "-"
        rows.append([name, largest, _percent(report.largest_difference), _percent(max(errors, default=None))])
    return "\n".join(_piped(rows))


def _head(report: Verification) -> list[str]:
    model, material = report.model, report.material
    along, across = model.elements
    jaw = f", {model.jaw} jaw" if placed(report.scene.finger).body.jaw is not None else ""
    head = [report.scene.title] if report.scene.title else []
    head += [
        f"finite elements: {along} x {across} quadratic, {model.law}, plane {material.plane}{jaw}; "
        f"second mesh {report.second[0]} x {report.second[1]}",
        _friction(report),
        "forces of the finger on the object, and tips, in the finger's frame: the elements', and gripper's beside them",
    ]
    isotropic = material.youngs_modulus / (2 * (1 + material.poisson_ratio))
    if abs(material.G / isotropic - 1) > _ISOTROPIC:
        head.append(f"the elements use G = {isotropic:.4g} Pa of E and nu, gripper {material.G:.4g} Pa as given")
    return head


def _friction(report: Verification) -> str:
    friction = report.scene.friction
    if friction is None or friction.absent:
        return "no friction"
    mu = friction.coefficient
    parts = f"{mu.finger} on the finger, {mu.jaw} on the jaw" if isinstance(mu, Coefficients) else f"{mu}"
    return f"friction {parts}" + (" (gripper's as published)" if friction.model == "published" else "")


def _foot(report: Verification) -> list[str]:
    lines = ["difference: of gripper's force from the elements'; mesh error: how far theirs moves on the second mesh"]
    if report.poses[0].laws:
        names = ", ".join(report.poses[0].laws)
        lines.append(f"{names}: what that material law alone changes in the force; apart: gripper's difference from it")
    for i, pose in enumerate(report.poses):
        for who, one in (("elements", pose.elements), ("gripper", pose.gripper)):
            if one.status == "failed":
                lines.append(f"{_label(report, i)}: {who}: {one.reason}")
        if pose.elements.snapped:
            lines.append(f"{_label(report, i)}: the elements snapped on the way")
    own, ours = (sum(getattr(pose, who).seconds for pose in report.poses) for who in ("elements", "gripper"))
    times = f"CPU: elements {own:.1f} s, the other runs {report.more_seconds:.1f} s, gripper {ours:.2f} s"
    worst = report.worst
    if worst is None:
        return [*lines, f"no forces to compare; {times}"]
    place = _label(report, report.poses.index(worst))
    return [*lines, f"largest difference {_percent(worst.force_difference)}, at {place}; {times}"]


def _label(report: Verification, i: int) -> str:
    parameter = report.poses[i].parameter
    return f"pose {i}" if parameter is None else f"{report.parameter} = {_number(parameter)}"


def _forces(report: Verification) -> Rows:
    columns = ["status", "Fx (N)", "gripper", "Fy (N)", "gripper", "difference", "mesh error"]
    rows = [[report.parameter or "pose", *columns]]
    rows[0] += [word for law in report.poses[0].laws for word in (law, "apart")]
    for i, pose in enumerate(report.poses):
        fem, beam = pose.elements.force or (None, None), pose.gripper.force or (None, None)
        forces = [_number(value, 5) for pair in zip(fem, beam, strict=True) for value in pair]
        relative = [_percent(pose.force_difference), _percent(pose.mesh_error)]
        for law in pose.laws.values():
            relative += [_percent(law.change, "+"), _percent(law.force_difference)]
        rows.append([_place(pose, i), _status(pose), *forces, *relative])
    return rows


def _shapes(report: Verification) -> Rows:
    columns = ["tip (m)", "apart (m)", "contact (m)", "gripper", "max strain", "gripper", "CPU s", "gripper"]
    rows = [[report.parameter or "pose", *columns]]
    for i, pose in enumerate(report.poses):
        fem, beam = pose.elements, pose.gripper
        tip = " ".join(f"{round(x, 5) + 0.0:.5f}" for x in fem.tip or ())
        contacts = [_where(fem.contacts), _where(beam.contacts)]
        numbers = [_number(fem.max_strain, 3), _number(beam.max_strain, 3)]
        seconds = [_number(fem.seconds, 2), _number(beam.seconds, 2)]
        rows.append([_place(pose, i), tip, _number(pose.tip_difference, 2), *contacts, *numbers, *seconds])
    return rows


def _place(pose: VerifiedPose, i: int) -> str:
    return str(i) if pose.parameter is None else _number(pose.parameter)


def _status(pose: VerifiedPose) -> str:
    ours, theirs = pose.elements.status, pose.gripper.status
    return ours if ours == theirs else f"{ours}, {theirs}"


def _where(contacts: Sequence[Any]) -> str:
    stick = {"stick": " stick"}
    return ", ".join(f"{contact.on} {contact.s:.4g}{stick.get(contact.state, '')}" for contact in contacts)


def _number(value: float | None, digits: int = 4) -> str:
    return "" if value is None else f"{round(value, 12) + 0.0:.{digits}g}"


def _percent(value: float | None, sign: str = "") -> str:
    return "" if value is None else f"{round(100 * value, 2) + 0.0:{sign}.2f} %"


def _aligned(rows: Rows) -> list[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return ["  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _piped(rows: Rows) -> list[str]:
    ruled = [rows[0], ["---:"] * len(rows[0]), *rows[1:]]
    return [f"| {' | '.join(row)} |" for row in ruled]
