"""The comparison as data, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from gripper.fingers import Material
from gripper.pose import placed
from gripper.results.pose_result import Contact
from gripper.scene import Scene
from gripper.verify import table
from gripper.verify.run import Found, Model, Place

Vector = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Beam:
    """Gripper's own pose, in the clamp's frame; numbers are None where it failed."""

    status: str
    reason: str | None
    force: Vector | None
    tip: Vector | None
    contacts: tuple[Contact, ...]
    max_strain: float | None
    seconds: float


@dataclass(frozen=True, kw_only=True)
class OtherLaw:
    """What another material law does; None where a force is missing or zero.

    Parameters
    ----------
    change
        How much larger it alone makes the elements' force, relative.
    force_difference
        Distance of gripper's force from the elements' with this law, relative.
    """

    change: float | None
    force_difference: float | None


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
        The same distance between the elements' two meshes: an upper bound, as it is the error of the coarser one.
    laws
        What other material laws do, by name.
    """

    parameter: float | None
    elements: Found
    gripper: Beam
    force_difference: float | None
    tip_difference: float | None
    mesh_error: float | None
    laws: Mapping[str, OtherLaw] = field(default_factory=dict)


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
    more_seconds
        CPU time of the runs on the second mesh and with the other laws.
    """

    scene: Scene
    model: Model
    second: tuple[int, int]
    poses: tuple[VerifiedPose, ...]
    more_seconds: float = 0.0

    @property
    def worst(self) -> VerifiedPose | None:
        """The pose where the forces differ most; None where there is nothing to compare."""
        compared = [pose for pose in self.poses if pose.force_difference is not None]
        return max(compared, key=lambda pose: pose.force_difference or 0.0, default=None)

    @property
    def largest_difference(self) -> float | None:
        """Largest relative difference of the force over all poses; None where there is nothing to compare."""
        return self.worst.force_difference if self.worst else None

    @property
    def failed(self) -> tuple[VerifiedPose, ...]:
        """The poses that the elements or gripper could not solve."""
        return tuple(pose for pose in self.poses if "failed" in (pose.elements.status, pose.gripper.status))

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
                "laws": {name: asdict(law) for name, law in pose.laws.items()},
            }
            for pose in self.poses
        ]
        model = {**asdict(self.model), "second_mesh": self.second, "plane": self.material.plane}
        head = {"schema": 1, "title": self.scene.title, "parameter": self.parameter, "model": model}
        return {**head, "largest_difference": self.largest_difference, "poses": poses}

    @property
    def material(self) -> Material:
        """The finger's."""
        return placed(self.scene.finger).body.material

    def csv(self) -> str:
        """Write one row a pose, units in the column names, empty cells where there is no answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        laws = list(self.poses[0].laws)
        writer.writerow([self.parameter or "pose", *_COLUMNS, *(f"{law}_{name}" for law in laws for name in _OF_A_LAW)])
        for i, pose in enumerate(self.poses):
            changes = [getattr(pose.laws[law], name) for law in laws for name in _OF_A_LAW]
            writer.writerow([i if pose.parameter is None else pose.parameter, *_row(pose), *changes])
        return text.getvalue()

    def markdown(self) -> str:
        """One table of the comparison, in Markdown."""
        return table.markdown(self)

    def __str__(self) -> str:
        return table.text(self)


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
_OF_A_LAW = ("change", "force_difference")


def _row(pose: VerifiedPose) -> list[Any]:
    fem, beam, none = pose.elements, pose.gripper, (None, None)
    forces = [*(fem.force or none), *(beam.force or none), pose.force_difference, pose.mesh_error]
    shape = [*(fem.tip or none), *(beam.tip or none), fem.max_strain, beam.max_strain, fem.depth]
    return [fem.status, *forces, *shape, fem.seconds, beam.seconds]


def _place(contact: Contact) -> Place:
    return Place(on=contact.on, s=contact.s, normal_force=contact.normal_force, state=contact.state)
