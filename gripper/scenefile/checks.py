"""What shows only when the parts of a scene are put together: said before anything is solved or written."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.beam.sections import Sections, sections
from gripper.fingers import Finger
from gripper.objects import Object
from gripper.pose import Pose, placed
from gripper.scene import Motion, Scene
from gripper.scenefile.place import Place

THINNEST, THICKEST = 1e-9, 100.0
"""Of a finger's length: beyond these a float loses the finger's shape or its bending."""
FARTHEST = 1e9
"""Of a finger's length: an object farther off is placed no better than its contact is deep."""
LEAST, MOST = 1e-200, 1e200
"""Of stiffnesses, in SI units: their products stay within a float."""


def check_whole(scene: Scene, place: Place) -> None:
    """Refuse a scene whose finger, object or poses cannot be computed with.

    Raises
    ------
    SceneFileError
        Names the key.
    """
    finger, target = placed(scene.finger), placed(scene.object)
    profile = _profile(finger.body, place.at("finger"))
    _check_room(target.body, place.at("object"))
    driven = _check_loads(scene, profile, place.at("loads"))
    if scene.motion and not (scene.posed or driven or len(set(scene.motion.values)) == 1):
        rule = "must stand in an expression of finger.pose, object.pose or a load, to move something"
        raise place.at("motion").at("parameter").error(rule, f"{scene.motion.parameter!r}, which stands in none")
    clamp = _poses(finger.pose, scene.motion, place.at("finger"))
    body = _poses(target.pose, scene.motion, place.at("object"))
    away = (body - clamp)[:, :2]
    far = np.hypot(*away.T) > FARTHEST * profile.length
    if far.any():
        rule = f"must stay within {FARTHEST:g} finger lengths of the clamp, in m"
        raise place.at("object").at("pose").error(rule, f"{tuple(away[far][0].tolist())} from it")


def _check_loads(scene: Scene, profile: Sections, place: Place) -> bool:
    """Compile the loads on their finger; tell whether the motion drives one."""
    if not scene.loads:
        return False
    from gripper.statics.compiled_loads import compiled, compiled_loads  # here, because most scenes have none

    parameter = scene.motion.parameter if scene.motion else None
    for i, load in enumerate(scene.loads):
        try:
            compiled(load, profile.finger, parameter)
        except ValueError as error:
            fields = {field.name: field.name for field in dataclasses.fields(load)}
            raise place.entry(i).broken(error, fields) from None
    try:
        return compiled_loads(scene, profile).driven
    except ValueError as error:
        raise Place(place.file).broken(error, {"loads": "loads"}) from None


def _profile(finger: Finger, place: Place) -> Sections:
    fields = {name: name for name in ("length", "width", "material", "thickness") if hasattr(finger, name)}
    try:
        profile = sections(finger)
        slenderness = profile.thickness(np.linspace(0.0, 1.0, 65))
        scales = (profile.bending_stiffness, profile.force_scale, profile.energy_scale)
    except ValueError as error:
        raise place.broken(error, fields) from None
    except ArithmeticError as error:
        raise place.error("must have a stiffness that a float can hold, in SI units", str(error)) from None
    if not (slenderness.min() >= THINNEST and slenderness.max() <= THICKEST):
        rule = f"must have a thickness of {THINNEST:g} to {THICKEST:g} of its length"
        raise place.error(rule, f"{slenderness.min():g} to {slenderness.max():g}")
    if not all(LEAST <= scale <= MOST for scale in scales):
        raise place.error("must have a stiffness EI, EI/L and EI/L^2 that a float can hold", f"{scales}, in SI units")
    return profile


def _check_room(body: Object, place: Place) -> None:
    """Compile the object, and see that what is known of it are numbers."""
    try:
        known = (*body.box, body.inner_radius, *np.ravel(body.inner_point))
        gap = float(body.gap(np.array([body.inner_point]))[0])
    except Exception as error:  # a plugin's own code may raise anything; it is kept as the cause
        if isinstance(error, ValueError) and " must " in str(error):
            raise place.broken(error) from None
        what = " ".join(f"{type(error).__name__}: {error}".split())
        raise place.error(
            f"must be a {type(body).__name__} that can be computed (it fails with {what})", "it"
        ) from error
    if np.isnan(known).any() or not body.inner_radius > 0 or not gap < 0:
        got = f"a box {body.box}, and g = {gap:g} at the inner point of radius {body.inner_radius:g}"
        raise place.error("must have an outline with room inside, where g is negative", got)


def _poses(pose: Pose, motion: Motion | None, place: Place) -> Array:
    """World poses (n, 3): x, y in m and angle in rad, at every value of the motion's parameter."""
    values = np.array(motion.values if motion else [0.0])
    columns = [_values(getattr(pose, key), motion, values, place.at("pose").at(key)) for key in ("x", "y", "angle")]
    return np.column_stack(columns)


def _values(expression: Any, motion: Motion | None, values: Array, place: Place) -> Array:
    expression = sympy.sympify(expression)
    if not expression.free_symbols:
        return np.full(len(values), float(expression))
    compute = sympy.lambdify(list(expression.free_symbols), expression, "numpy")
    found = np.broadcast_to(np.asarray(compute(values)), len(values))
    wrong = ~np.isfinite(found) | (np.iscomplexobj(found) & (np.imag(found) != 0))
    if wrong.any():
        name, at = motion.parameter if motion else "", values[wrong][0]
        raise place.error("must be a finite number in every pose", f"{found[wrong][0]} at {name} = {at:g}")
    return np.real(found)
