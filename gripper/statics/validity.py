"""Where the theory ends: what a result must say of itself, with the poses and the numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array
from gripper.beam.sections import Sections
from gripper.fingers import Material
from gripper.result import PoseResult
from gripper.results.extremes import Extreme
from gripper.scene import Scene

if TYPE_CHECKING:
    from gripper.statics.compiled_loads import Loads

STRAIN = 0.1
"""Largest strain up to which a linear law stands for any: there they lie 3 % apart (tests/reference/fem.json)."""
FOLDED = 0.5
"""kappa w / 2 from which sections nearly meet on the inner face (at 1 they do): no beam is left."""
STOUT = 0.25
"""w / L up to which sections may be taken to stay plane; the stoutest finger compared with elements has 0.17."""
_TURNED = 1.2  # rad: a finger whose sections turn by less, and its faces hardly more, does not cross itself
_ALONG = np.linspace(0.0, 1.0, 129)


def plane_difference(material: Material) -> str:
    """What the other plane state would change, in words with its number: E against E / (1 - nu^2)."""
    factor = 1 / (1 - material.poisson_ratio**2)
    if material.plane == "stress":
        return f"plane strain (forces up to {100 * (factor - 1):.2g} % larger)"
    return f"plane stress (forces up to {100 * (1 - 1 / factor):.2g} % smaller)"


def warnings(sections: Sections, poses: Sequence[PoseResult], tolerance: float) -> tuple[str, ...]:
    """Say where a result lies outside what its theory holds, or misses its tolerance; empty where it does not."""
    found = []
    missed = [pose for pose in poses if (pose.error.discretisation or 0.0) > tolerance]
    if missed:
        worst_error = max(pose.error.discretisation or 0.0 for pose in missed)
        found.append(f"the tolerance of {tolerance:.0e} is not met at {len(missed)} poses: {worst_error:.1e} at worst")
    stout = float(np.max(sections.thickness(_ALONG)))
    if stout > STOUT:
        found.append(f"w / L is {stout:.2g}, beyond {STOUT}: sections do not stay plane in so stout a finger")
    bent = [pose for pose in poses if pose.max_strain is not None]
    worst = max(bent, key=lambda pose: pose.max_strain or 0.0, default=None)
    if worst is not None and worst.max_strain is not None:
        strain, where = worst.max_strain, _where(worst)
        if strain > FOLDED:
            found.append(f"kappa w / 2 reaches {strain:.2g}{where}: near 1 the inner face folds and no beam is left")
        elif strain > STRAIN and sections.law is None:
            found.append(f"strains reach {strain:.2g}{where}, beyond {STRAIN}: material laws differ by percents there")
    turned = (pose for pose in poses if pose.shape is not None and pose.shape.turning > _TURNED)
    crossing = next((pose for pose in turned if pose.shape is not None and crosses(pose.shape.outline)), None)
    if crossing is not None:
        found.append(f"the finger crosses itself{_where(crossing)}: contact of the finger with itself is not modelled")
    return tuple(found)


def unmoved(scene: Scene, loads: Loads | None) -> tuple[str, ...]:
    """Say where a motion's parameter moves nothing."""
    if scene.motion is None or scene.posed or (loads is not None and loads.driven):
        return ()
    return (f"the motion moves nothing: its parameter {scene.motion.parameter!r} stands in no pose and in no load",)


def all_free(poses: Sequence[PoseResult]) -> tuple[str, ...]:
    """Say where nothing touches at any pose: a unit may be missing, or a sign wrong."""
    if any(pose.status != "free" for pose in poses):
        return ()
    nearest = min(poses, key=lambda pose: pose.min_gap or 0.0)
    gap = f"{nearest.min_gap or 0.0:.3g} m{_where(nearest)}"
    return (f"nothing touches at any pose: the least distance of finger and object is {gap}",)


def unknown_between(sections: Sections, peak: Extreme | None) -> tuple[str, ...]:
    """Say where strains leave what the material's law knows, also between the poses: peaks there mean nothing."""
    if sections.law is None or peak is None:
        return ()
    least, most = sections.law.fibre.span
    if peak.value <= min(-least, most):
        return ()
    where = "" if peak.parameter is None else f" at {peak.parameter:.6g}"
    known = f"the material's law is known from {least:.3g} to {most:.3g}"
    return (f"strains reach {peak.value:.3g}{where} along the motion: {known}, and peaks there mean nothing",)


def _where(pose: PoseResult) -> str:
    return "" if pose.parameter is None else f" at {pose.parameter:.6g}"


def crosses(outline: Array) -> bool:
    """Whether a closed polygon (n, 2) crosses itself."""
    points = outline[:, 0] + 1j * outline[:, 1]
    half = points[: len(points) // 2]
    turns = np.unwrap(np.angle(np.diff(half)))
    if np.ptp(turns) < np.pi / 2:  # a face that turns by less meets neither itself nor the other face
        return False
    a, b = points, np.roll(points, -1)
    along = b - a

    def side(c: Array) -> Array:
        """On which side of each edge (rows) each point (columns) lies."""
        return np.sign((along.conj()[:, None] * (c[None, :] - a[:, None])).imag)

    apart = (side(a) * side(b)) < 0
    return bool(np.any(apart & apart.T))
