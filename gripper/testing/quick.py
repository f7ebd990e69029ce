"""What the solver cannot do without, in milliseconds: a stranger's plugin is checked as a scene file is read."""

from __future__ import annotations

from gripper.fingers import Finger, Jaw
from gripper.loads import Load
from gripper.objects import Object
from gripper.testing.contract import run
from gripper.testing.fingers import (
    has_a_continuous_thickness,
    has_kinks_between_its_ends,
    has_positive_profiles,
    has_profiles_of_s_alone,
)
from gripper.testing.jaws import has_a_polygon_of_finite_points, has_a_simple_polygon
from gripper.testing.loads import has_finite_actions, has_stations_on_its_finger
from gripper.testing.objects import has_a_continuous_g, has_finite_values_of_the_right_shape, has_g_negative_inside


def quick_check(instance: Object | Finger | Jaw | Load) -> None:
    """Check a few properties of a plugin's instance; `check_object` and its like check all.

    Raises
    ------
    gripper.testing.ContractError
        A property fails: one sentence with the instance, the rule and what was got.
    """
    if isinstance(instance, Object):
        run(instance, (has_finite_values_of_the_right_shape, has_a_continuous_g, has_g_negative_inside))
    elif isinstance(instance, Finger):
        known = (has_profiles_of_s_alone, has_positive_profiles, has_kinks_between_its_ends)
        run(instance, (*known, has_a_continuous_thickness))
    elif isinstance(instance, Load):
        run(instance, (has_stations_on_its_finger, has_finite_actions))
    else:
        run(instance, (has_a_polygon_of_finite_points, has_a_simple_polygon))
