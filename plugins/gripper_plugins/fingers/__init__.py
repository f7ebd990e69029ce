"""Fingers: profiles w(s)."""

from gripper_plugins.fingers.formula import Formula
from gripper_plugins.fingers.stepped import Stepped
from gripper_plugins.fingers.tapered import Tapered
from gripper_plugins.fingers.uniform import Uniform

__all__ = ["Formula", "Stepped", "Tapered", "Uniform"]
