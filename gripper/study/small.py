"""Small deflections: the straight beam's linear theory, and the handbook's formula."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from gripper.arrays import Array
from gripper.assemble import setting
from gripper.contact.kinematics import Kinematics
from gripper.pose import placed
from gripper.scene import Scene
from gripper.statics.equilibrium import Setting

_CELLS = 200
_FLAT = 1e-9  # relative: a thickness that varies by less is uniform


class NoModelError(Exception):
    """The model has nothing to say about this scene; says why."""


@dataclass(frozen=True)
class Small:
    """What a theory of small deflections says: force on the object in N, clamp's axes."""

    force: complex


@dataclass(frozen=True, eq=False)
class _Bed:
    """How far the object stands above the straight finger's lower side: by L, at places x by L."""

    x: Array
    height: Array
    slope: Array


def _bed(scene: Scene, fixed: Setting, parameter: float | None) -> _Bed:
    """The object's upper side against the lower side of the straight finger and its jaw."""
    if scene.approach[1] <= 0:
        raise NoModelError("small deflections are reckoned for an object that comes from below")
    if fixed.sections.rest is not None:
        raise NoModelError("small deflections are reckoned from a finger that is straight at rest")
    length = fixed.sections.length
    obstacle = fixed.obstacle(Kinematics(scene, length).frame(parameter or 0.0))
    reach = 1.0 if fixed.outline.jaw is None else max(1.0, 1.0 + float(np.max(fixed.outline.jaw.real)))
    cell = reach / _CELLS
    x = np.arange(1, _CELLS + 1) * cell
    lower = np.where(x <= 1, -fixed.sections.thickness(np.minimum(x, 1.0)) / 2, np.inf)
    if fixed.outline.jaw is not None:
        lower = np.minimum(lower, _side(1.0 + fixed.outline.jaw, x, -1.0))
    box = (-3 * length, -3 * length, 3 * length, 3 * length)
    lines = placed(scene.object).body.outline(box, 1e-5 * length)
    upper = np.full(x.size, -np.inf)
    for line in lines:
        upper = np.maximum(upper, _side(obstacle.place(line[:, 0] + 1j * line[:, 1]), x, 1.0))
    known = np.isfinite(upper) & np.isfinite(lower)
    with np.errstate(invalid="ignore"):
        slope = np.gradient(upper, x)
    known &= np.isfinite(slope)
    return _Bed(x[known], (upper - lower)[known], slope[known])


def _side(polygon: Array, x: Array, sign: float) -> Array:
    """The highest (sign 1) or lowest (-1) point of a polygon over each x; infinite where it has none."""
    a, b = polygon, np.roll(polygon, -1)
    left, right = np.minimum(a.real, b.real), np.maximum(a.real, b.real)
    across = (left[None] <= x[:, None]) & (x[:, None] <= right[None]) & (right > left)[None]
    rise = (b.imag - a.imag) / np.where(right > left, b.real - a.real, 1.0)
    y = a.imag[None] + (x[:, None] - a.real[None]) * rise[None]
    return sign * np.max(np.where(across, sign * y, -np.inf), axis=1)


def linear(scene: Scene, parameter: float | None = None) -> Small:
    """The straight beam's linear theory on the object: forces push up only, and only where it would sink in.

    Least bending energy with v >= h at every place: Lawson & Hanson's least distance problem, by `scipy.optimize.nnls`.

    Raises
    ------
    NoModelError
        An object that comes from above.
    """
    fixed = setting(scene, "bending")
    bed = _bed(scene, fixed, parameter)
    if not bed.x.size or bed.height.max() <= 0:
        return Small(0j)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    starts = np.arange(_CELLS // 2) / (_CELLS // 2)
    t = (starts[:, None] + (nodes + 1) / _CELLS).ravel()
    spread = np.sqrt(np.tile(weights / _CELLS, starts.size) / fixed.sections.EI(t))
    arms = np.maximum(bed.x[:, None] - t[None], 0.0) * spread
    table = np.vstack([arms.T, bed.height])
    target = np.append(np.zeros(t.size), 1.0)
    weights_found = nnls(table, target)[0]
    left = table @ weights_found - target
    up = weights_found / -left[-1]
    return Small(-complex(np.sum(up * (1j - bed.slope))) * fixed.sections.force_scale)


def handbook(scene: Scene, parameter: float | None = None) -> Small:
    """P = 3 E I y / a^3 for a uniform arm pushed up by y at a, and P tan(slope) along it (Bonenberger; Bayer).

    Raises
    ------
    NoModelError
        A finger that is not uniform, or an object that comes from above.
    """
    fixed = setting(scene, "bending")
    thickness, stiffness = (f(np.linspace(0, 1, 33)) for f in (fixed.sections.thickness, fixed.sections.EI))
    if np.ptp(thickness) > _FLAT * thickness[0] or np.ptp(stiffness) > _FLAT * stiffness[0]:
        raise NoModelError("the handbook's formula is for a uniform arm")
    bed = _bed(scene, fixed, parameter)
    if not bed.x.size or bed.height.max() <= 0:
        return Small(0j)
    deepest = int(np.argmax(bed.height))
    up = 3 * float(bed.height[deepest]) / float(bed.x[deepest]) ** 3
    return Small(-up * complex(-float(bed.slope[deepest]), 1.0) * fixed.sections.force_scale)
