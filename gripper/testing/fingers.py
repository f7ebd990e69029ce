"""What every finger promises: positive profiles of s alone, smooth between the kinks that it names."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.beam.sections import largest_jump, sections
from gripper.fingers import Finger, S
from gripper.kinks import beside_kinks
from gripper.testing.contract import Property, fits, has_the_manners_of_data, require, run, survives_a_scene_file

SAMPLES = 64  # between two kinks
HALVINGS = 40
JUMP = 1e-6  # relative: a change over less than a nanometre that counts


def check_finger(instance: Finger) -> None:
    """Check that a finger keeps all that `gripper.fingers.Finger` promises; see `check_object` for what is raised."""
    run(instance, FINGER_PROPERTIES)


def _profiles(finger: Finger) -> dict[str, sympy.Expr]:
    return {"thickness w(s)": sympy.sympify(finger.w(S)), "width b(s)": sympy.sympify(finger.b(S))}


def has_profiles_of_s_alone(finger: Finger) -> None:
    """Thickness and width are expressions in s, and in nothing else."""
    for name, profile in _profiles(finger).items():
        require(profile.free_symbols <= {S}, f"have a {name} of s alone", profile)


def has_positive_profiles(finger: Finger) -> None:
    """Thickness and width are positive and finite from the clamp to the tip."""
    s = np.linspace(0.0, finger.length, 2001)
    for name, profile in _profiles(finger).items():
        values = _compiled(profile)(s)
        wrong = np.flatnonzero(~(np.isfinite(values) & (values > 0)))[:1]
        require(not len(wrong), f"have a positive {name}, in m", f"{values[wrong].tolist()} at s = {s[wrong].tolist()}")


def has_kinks_between_its_ends(finger: Finger) -> None:
    """The arc lengths where its profiles have kinks rise, and lie between 0 and L."""
    kinks = np.array([0.0, *finger.kinks(), finger.length])
    require(bool((np.diff(kinks) > 0).all()), "have kinks that rise between 0 and its length, in m", finger.kinks())


def has_a_continuous_thickness(finger: Finger) -> None:
    """The thickness does not jump, not at the kinks either: the faces would be torn there."""
    jump = largest_jump(finger, _compiled(_profiles(finger)["thickness w(s)"]))
    rule = "have a continuous thickness w(s), in m (a step is a steep flank)"
    require(jump is None, rule, jump and f"a jump of {jump[1]:g} at s = {jump[0]:g}")


def has_no_kinks_but_those_named(finger: Finger) -> None:
    """Between them thickness, width and their slopes do not jump."""
    marks = np.array([0.0, *finger.kinks(), finger.length])
    inset = 1e-9 * finger.length
    ends = [np.linspace(a + inset, b - inset, SAMPLES) for a, b in pairwise(marks)]
    for name, profile in _profiles(finger).items():
        for order, what in ((0, name), (1, f"slope of its {name}")):
            place, jump, size = _jump(_compiled(sympy.diff(profile, S, order)), ends)
            rule = f"name in kinks() where the {what} jumps"
            require(jump < JUMP * size, rule, f"a jump of {jump} at s = {place}")


def _jump(function: Callable[[Array], Array], stretches: list[Array]) -> tuple[float, float, float]:
    """Where the function changes most over almost nothing, by how much, and how large it is."""
    a = np.concatenate([stretch[:-1] for stretch in stretches])
    b = np.concatenate([stretch[1:] for stretch in stretches])
    at_a, at_b = function(a), function(b)
    size = 1e-12 + float(np.abs(at_a).max())
    for _ in range(HALVINGS):
        middle = (a + b) / 2
        value = function(middle)
        first = np.abs(value - at_a) > np.abs(value - at_b)
        a, b = np.where(first, a, middle), np.where(first, middle, b)
        at_a, at_b = np.where(first, at_a, value), np.where(first, value, at_b)
    jump = np.abs(at_b - at_a)
    return float(a[jump.argmax()]), float(jump.max()), size


def _compiled(profile: sympy.Expr) -> Callable[[Array], Array]:
    function = sympy.lambdify([S], beside_kinks(profile), "numpy")
    return lambda s: np.asarray(function(s), dtype=float) * np.ones_like(s)


def has_bounds_of_its_thickness(finger: Finger) -> None:
    """What is proved of the thickness and of its derivatives, for the certificate, holds."""
    found, w = sections(finger), _profiles(finger)["thickness w(s)"]
    marks = np.array([0.0, *finger.kinks(), finger.length])
    s = np.concatenate([np.linspace(a, b, 202)[1:-1] for a, b in pairwise(marks)])
    for order, bound in enumerate(found.thickness_bounds):
        value = float(np.abs(_compiled(sympy.diff(w, S, order))(s)).max()) * finger.length ** (order - 1)
        require(value <= bound * (1 + 1e-9), f"keep derivative {order} of its thickness below {bound}", value)


FINGER_PROPERTIES: tuple[Property[Finger], ...] = (
    fits("gripper.fingers"),
    has_the_manners_of_data,
    has_profiles_of_s_alone,
    has_positive_profiles,
    has_kinks_between_its_ends,
    has_a_continuous_thickness,
    has_no_kinks_but_those_named,
    has_bounds_of_its_thickness,
    survives_a_scene_file("gripper.fingers", "material", "jaw"),
)
"""What `check_finger` checks, in its order."""
