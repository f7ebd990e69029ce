"""Fingers: profiles w(s)."""

from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform

__all__ = ["Tapered", "Uniform"]
