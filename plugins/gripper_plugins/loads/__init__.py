"""Loads: what acts on a finger besides the object."""

from gripper_plugins.loads.following_force import FollowingForce
from gripper_plugins.loads.force import Force
from gripper_plugins.loads.gravity import Gravity
from gripper_plugins.loads.moment import Moment
from gripper_plugins.loads.tendon import Tendon

__all__ = ["FollowingForce", "Force", "Gravity", "Moment", "Tendon"]
