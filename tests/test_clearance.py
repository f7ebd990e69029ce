"""The distance of finger and object, against outlines sampled as finely as the assertion says."""

from __future__ import annotations

import numpy as np
import pytest

import gripper as gr
from gripper.contact.obstacle import Frame, Obstacle
from gripper.objects import Object
from gripper.statics.clearance import distances
from gripper_plugins.objects import Circle, Ellipse
from tests.scenes import rotating_finger

ANGLES = np.linspace(0.0, 2 * np.pi, 40_001)


@pytest.mark.parametrize("body", [Circle(radius=0.3), Ellipse(semi_axes=(0.3, 0.1)), Ellipse(semi_axes=(0.3, 0.02))])
@pytest.mark.parametrize("far", [0.5, 3.0, 50.0])
def test_the_distance_of_any_point_outside_is_the_least_to_any_point_of_the_outline(body: Object, far: float) -> None:
    a, b = body.semi_axes if isinstance(body, Ellipse) else (body.radius, body.radius)  # type: ignore[attr-defined]
    outline = a * np.cos(ANGLES) + 1j * b * np.sin(ANGLES)
    rng = np.random.default_rng(4)
    points = far * (rng.uniform(-1, 1, 400) + 1j * rng.uniform(-1, 1, 400))
    obstacle = Obstacle(body, 1.0, Frame(0j, 0.0, 0j, 0.0))
    points = points[obstacle.gap(points) > 1e-3]
    least = np.array([np.abs(outline - point).min() for point in points])
    assert distances(obstacle, points) == pytest.approx(least, rel=1e-6, abs=1e-6)


def test_distances_of_a_motion_are_those_of_its_poses_alone() -> None:
    """Free poses of a motion are measured together."""
    values = np.linspace(0.08, 0.2032, 5).tolist()
    for value, pose in zip(values, gr.trace(rotating_finger(*values)).poses, strict=True):
        alone = gr.trace(rotating_finger(value)).poses[0]
        assert pose.status == alone.status == "free"
        assert pose.min_gap == pytest.approx(alone.min_gap, rel=1e-8)
