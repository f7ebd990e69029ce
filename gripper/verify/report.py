"""The comparison as data, a table, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from gripper.fingers import Material
from gripper.pose import placed
from gripper.pose_result import Contact
from gripper.scene import Scene
from gripper.verify.friction import is_rough
from gripper.verify.run import Found, Model, Place

Vector = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Beam:
    """Gripper's own pose, in the clamp's frame; numbers are None where it failed."""

    status: str
    force: Vector | None
    tip: Vector | None
    contacts: tuple[Contact, ...]
    max_strain: float | None
    seconds: float


@dataclass(frozen=True, kw_only=True)
class VerifiedPose:
    """One pose, solved twice.

    Parameters
    ----------
    parameter
        The motion's parameter; None without a motion.
    elements, gripper
        Both answers, in the clamp's frame.
    force_difference
        Distance of the two force vectors, relative to the elements' force; None where one is missing or zero.
    tip_difference
        Distance of the two tips, in m.
    mesh_error
        The same distance between the elements' two meshes: the error of the coarser one.
    laws
        How much larger the force is with other material laws, relative, on the second mesh.
    """

    parameter: float | None
    elements: Found
    gripper: Beam
    force_difference: float | None
    tip_difference: float | None
    mesh_error: float | None
    laws: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Verification:
    """A scene solved by finite elements, beside gripper's own result.

    Parameters
    ----------
    scene
        What was given.
    model
        The elements.
    second
        Number of elements of the second mesh, along and across.
    poses
        In the motion's order.
    """

    scene: Scene
    model: Model
    second: tuple[int, int]
    poses: tuple[VerifiedPose, ...]

    @property
    def largest_difference(self) -> float | None:
        """Largest relative difference of the force over all poses; None where there is nothing to compare."""
        if not self.same_friction:
            return None
        return max((p.force_difference for p in self.poses if p.force_difference is not None), default=None)

    @property
    def failed(self) -> tuple[VerifiedPose, ...]:
        """The poses that the elements could not solve."""
        return tuple(pose for pose in self.poses if pose.elements.status == "failed")

    @property
    def rough(self) -> bool:
        """Whether the elements have friction."""
        return is_rough(self.scene, self.model.friction)

    @property
    def same_friction(self) -> bool:
        """Whether elements and gripper both have friction, or neither."""
        states = {contact.state for pose in self.poses for contact in pose.gripper.contacts}
        return not states or self.rough == bool(states - {"frictionless"})

    @property
    def parameter(self) -> str | None:
        """The name of the motion's parameter."""
        return self.scene.motion.parameter if self.scene.motion else None

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers in SI units, None where there is no answer."""
        poses = [
            {
                "parameter": pose.parameter,
                "elements": asdict(pose.elements),
                "gripper": {**asdict(pose.gripper), "contacts": [asdict(_place(c)) for c in pose.gripper.contacts]},
                "force_difference": pose.force_difference,
                "tip_difference": pose.tip_difference,
                "mesh_error": pose.mesh_error,
                "laws": dict(pose.laws),
            }
            for pose in self.poses
        ]
        model = {**asdict(self.model), "second_mesh": self.second, "plane": self.material.plane}
        return {"schema": 1, "title": self.scene.title, "parameter": self.parameter, "model": model, "poses": poses}

    @property
    def material(self) -> Material:
        """The finger's."""
        return placed(self.scene.finger).body.material

    def csv(self) -> str:
        """Write one row a pose, units in the column names, empty cells where there is no answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        laws = list(self.poses[0].laws)
        writer.writerow([self.parameter or "pose", *_COLUMNS, *(f"force_change_{law}" for law in laws)])
        for i, pose in enumerate(self.poses):
            changes = [pose.laws[law] for law in laws]
            writer.writerow([i if pose.parameter is None else pose.parameter, *_row(pose), *changes])
        return text.getvalue()

    def __str__(self) -> str:
        return "\n\n".join("\n".join(block) for block in _blocks(self) if block)


_ISOTROPIC = 0.01
_COLUMNS = (
    "status",
    "elements_force_x_N",
    "elements_force_y_N",
    "gripper_force_x_N",
    "gripper_force_y_N",
    "force_difference",
    "mesh_error",
    "elements_tip_x_m",
    "elements_tip_y_m",
    "gripper_tip_x_m",
    "gripper_tip_y_m",
    "elements_max_strain",
    "gripper_max_strain",
    "elements_depth_m",
    "elements_seconds",
    "gripper_seconds",
)


def _row(pose: VerifiedPose) -> list[Any]:
    fem, beam, none = pose.elements, pose.gripper, (None, None)
    forces = [*(fem.force or none), *(beam.force or none), pose.force_difference, pose.mesh_error]
    shape = [*(fem.tip or none), *(beam.tip or none), fem.max_strain, beam.max_strain, fem.depth]
    return [fem.status, *forces, *shape, fem.seconds, beam.seconds]


def _place(contact: Contact) -> Place:
    return Place(on=contact.on, s=contact.s, normal_force=contact.normal_force)


def _number(value: float | None, digits: int = 4) -> str:
    return "" if value is None else f"{round(value, 12) + 0.0:.{digits}g}"


def _percent(value: float | None, sign: str = "") -> str:
    return "" if value is None else f"{100 * value:{sign}.2f} %"


def _where(contacts: Sequence[Place | Contact]) -> str:
    return ", ".join(f"{contact.on} {contact.s:.4g}" for contact in contacts)


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return ["  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _blocks(report: Verification) -> list[list[str]]:
    model = report.model
    along, across = model.elements
    friction = "friction" if report.rough else "no friction"
    jaw = f"{model.jaw} jaw, " if placed(report.scene.finger).body.jaw is not None else ""
    head = [report.scene.title] if report.scene.title else []
    head += [
        f"finite elements: {along} x {across} quadratic, {model.law}, plane {report.material.plane}, "
        f"{jaw}{friction}; mesh error from {report.second[0]} x {report.second[1]}",
        "force of the finger on the object and tip in the finger's frame; gripper's in brackets",
    ]
    material = report.material
    isotropic = material.youngs_modulus / (2 * (1 + material.poisson_ratio))
    if abs(material.G / isotropic - 1) > _ISOTROPIC:
        head.append(f"the elements use G = {isotropic:.4g} Pa of E and nu, gripper {material.G:.4g} Pa as given")
    if not report.same_friction:
        head.append("the forces are not compared: one of the two has no friction")
    failures = [f"pose {i}: {p.elements.reason}" for i, p in enumerate(report.poses) if p.elements.reason]
    snaps = [f"pose {i}: the elements snapped on the way" for i, p in enumerate(report.poses) if p.elements.snapped]
    return [head, _aligned(_forces(report)), _aligned(_shapes(report)), snaps + failures]


def _name(report: Verification, i: int) -> str:
    parameter = report.poses[i].parameter
    return str(i) if parameter is None else _number(parameter)


def _forces(report: Verification) -> list[list[str]]:
    laws = list(report.poses[0].laws)
    header = [report.parameter or "pose", "status", "Fx (N)", "", "Fy (N)", "", "difference", "mesh"]
    rows = [[*header, *laws]]
    for i, pose in enumerate(report.poses):
        fem, beam = pose.elements.force or (None, None), pose.gripper.force or (None, None)
        pairs = [_number(fem[0], 5), f"({_number(beam[0], 5)})", _number(fem[1], 5), f"({_number(beam[1], 5)})"]
        relative = [_percent(pose.force_difference) if report.same_friction else "", _percent(pose.mesh_error)]
        changes = [_percent(pose.laws[law], "+") for law in laws]
        rows.append([_name(report, i), pose.elements.status, *pairs, *relative, *changes])
    return rows


def _shapes(report: Verification) -> list[list[str]]:
    rows = [[report.parameter or "pose", "tip (m)", "apart (m)", "contact", "", "strain", "", "CPU s", ""]]
    for i, pose in enumerate(report.poses):
        fem, beam = pose.elements, pose.gripper
        tip = " ".join(f"{round(x, 5) + 0.0:.5f}" for x in fem.tip or ())
        places = [_where(fem.contacts), f"({_where(beam.contacts)})"]
        strains = [_number(fem.max_strain, 3), f"({_number(beam.max_strain, 3)})"]
        seconds = [_number(fem.seconds, 3), f"({_number(beam.seconds, 2)})"]
        rows.append([_name(report, i), tip, _number(pose.tip_difference, 2), *places, *strains, *seconds])
    return rows
