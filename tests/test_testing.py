"""The check kit: what is sound passes, and what is broken is told in one sentence that says how."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings

import gripper as gr
from gripper.testing import ContractError, check_finger, check_jaw, check_object
from gripper.testing.strategies import fingers, jaws, objects
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle, Polygon

STEEL = gr.Material(youngs_modulus=2e11, poisson_ratio=0.3)
BEAM = {"length": 0.1, "width": 0.01, "material": STEEL, "thickness": 0.002}


def circle(**changed: Any) -> gr.Object:
    """A circle of which some methods are others."""
    cls = dataclass(frozen=True, kw_only=True)(type("Circle2", (Circle,), changed))
    return cls(radius=0.02)


def evaluated(change: Any) -> Any:
    """Evaluate as a circle does, then change the values, given the points."""

    def evaluate(self: Circle, points: np.ndarray, order: int = 2) -> tuple[np.ndarray, ...]:
        values = list(Circle.evaluate(self, points, order))
        change(values, points)
        return tuple(values)

    return evaluate


def nan(values: list[np.ndarray], points: np.ndarray) -> None:
    values[0][points[:, 0] > 0] = np.nan


def jump(values: list[np.ndarray], points: np.ndarray) -> None:
    values[0][points[:, 0] > 0] += 0.001


def turned(values: list[np.ndarray], points: np.ndarray) -> None:
    for value in values:
        value *= -1


def steep(values: list[np.ndarray], points: np.ndarray) -> None:
    for value in values:
        value *= 100


def wrong_gradient(values: list[np.ndarray], points: np.ndarray) -> None:
    if len(values) > 1:
        values[1] = values[1] * 1.01


def wrong_hessian(values: list[np.ndarray], points: np.ndarray) -> None:
    if len(values) > 2:
        values[2] = values[2] + np.eye(2)


def flat_bounds(self: Circle, centers: np.ndarray, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.full(len(centers), 0.5), np.zeros(len(centers))


def curved_bounds(self: Circle, centers: np.ndarray, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return Circle.bounds(self, centers, radii)[0], np.full(len(centers), 100.0)


BROKEN_OBJECTS = {
    "must have g finite everywhere": {"evaluate": evaluated(nan)},
    "must have a continuous g; got a jump from": {"evaluate": evaluated(jump)},
    "must have g negative at its inner point": {"evaluate": evaluated(turned)},
    r"must have \|grad g\| about 1 on the outline": {"evaluate": evaluated(steep)},
    "must have grad g equal to the differences": {"evaluate": evaluated(wrong_gradient)},
    "must have the Hessian equal to the differences": {"evaluate": evaluated(wrong_hessian)},
    r"must keep \|grad g\| below its bound": {"bounds": flat_bounds},
    "must keep g above the parabola": {"bounds": curved_bounds},
    "must lie within its box": {"box": (-0.01, -0.02, 0.02, 0.02)},
    "must have a box no wider than needed": {"box": (-0.04, -0.02, 0.02, 0.02)},
    "must have its inner point .* m inside": {"inner_radius": 0.03},
    "must have each corner on g = 0": {"corners": np.ones((1, 2)), "corner_normals": np.eye(2)[None]},
    "must not fail where .* is checked; got TypeError": {"evaluate": lambda self, points, order=2: None + 1},
    "its evaluate must take points, order; got points": {"evaluate": lambda self, points: None},
}


@pytest.mark.parametrize("sentence", BROKEN_OBJECTS)
def test_what_is_wrong_with_an_object_is_told_in_one_sentence(sentence: str) -> None:
    with pytest.raises(ContractError, match=sentence) as refusal:
        check_object(circle(**BROKEN_OBJECTS[sentence]))
    assert str(refusal.value).startswith("Circle2(radius=0.02) must ")
    assert len(str(refusal.value).splitlines()) == 1


def finger(**changed: Any) -> gr.Finger:
    return dataclass(frozen=True, kw_only=True)(type("Finger2", (Uniform,), changed))(**BEAM)


BROKEN_FINGERS = {
    r"must have a positive thickness w\(s\), in m": {"w": lambda self, s: 0.05 - s},
    r"must have a thickness w\(s\) of s alone": {"w": lambda self, s: sympy.Symbol("t") + s},
    r"must name in kinks\(\) where the slope of its thickness w\(s\) jumps": {
        "w": lambda self, s: 0.002 + sympy.Abs(s - 0.05),
        "kinks": lambda self: (),
    },
    r"must name in kinks\(\) where the thickness w\(s\) jumps": {
        "w": lambda self, s: sympy.Piecewise((0.002, s < 0.05), (0.003, True)),
        "kinks": lambda self: (),
    },
    r"must have a continuous thickness w\(s\), in m \(a step is a steep flank\); got a jump of 0.001 at s = 0.05": {
        "w": lambda self, s: sympy.Piecewise((0.002, s < 0.05), (0.003, True)),
    },
    "must have kinks that rise between 0 and its length": {"kinks": lambda self: (0.05, 0.2)},
}


@pytest.mark.parametrize("sentence", BROKEN_FINGERS)
def test_what_is_wrong_with_a_finger_is_told_in_one_sentence(sentence: str) -> None:
    with pytest.raises(ContractError, match=sentence):
        check_finger(finger(**BROKEN_FINGERS[sentence]))


BROKEN_JAWS = {
    "must write a polygon that does not meet itself": ((0, 0), (1, 1), (1, 0), (0, 1)),
    "must write at least 3 vertices": ((0, 0), (1, 1)),
    "must write finite vertices": ((0, 0), (1, 1), (np.inf, 0)),
}


@pytest.mark.parametrize("sentence", BROKEN_JAWS)
def test_what_is_wrong_with_a_jaw_is_told_in_one_sentence(sentence: str) -> None:
    cls = dataclass(frozen=True)(type("Jaw2", (gr.Jaw,), {"polygon": lambda self, thickness: BROKEN_JAWS[sentence]}))
    with pytest.raises(ContractError, match=sentence):
        check_jaw(cls())


def test_an_instance_that_can_be_changed_is_refused() -> None:
    class Loose(Polygon):
        def __setattr__(self, name: str, value: object) -> None:
            object.__setattr__(self, name, value)

    with pytest.raises(ContractError, match=r"must be of a class that gripper\.objects takes; got it must be a frozen"):
        check_object(Loose(vertices=((0, 0), (1, 0), (0, 1))))


@given(body=objects())
@settings(deadline=None, max_examples=5, derandomize=True)
def test_the_strategies_objects_are_sound(body: gr.Object) -> None:
    assert body.gap(body.inner_point[None])[0] < 0
    assert len(body.outline())


@given(one=fingers(jaw=jaws()))
@settings(deadline=None, max_examples=5, derandomize=True)
def test_the_strategies_fingers_and_jaws_keep_every_promise(one: gr.Finger) -> None:
    check_finger(one)
    check_jaw(one.jaw)
