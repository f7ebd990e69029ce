"""The check kit for plugin authors: every property that a plugin's kind promises, and what fails of it in a sentence.

    from gripper.testing import check_object

    def test_my_object():
        check_object(MyObject(radius=0.01))

``gripper.testing.strategies`` has hypothesis strategies of materials, fingers, jaws and objects; nothing else here
needs hypothesis.
"""

from gripper.testing.contract import ContractError
from gripper.testing.fingers import FINGER_PROPERTIES, check_finger
from gripper.testing.jaws import JAW_PROPERTIES, check_jaw
from gripper.testing.loads import LOAD_PROPERTIES, check_load
from gripper.testing.objects import OBJECT_PROPERTIES, check_object
from gripper.testing.quick import quick_check

__all__ = [
    "FINGER_PROPERTIES",
    "JAW_PROPERTIES",
    "LOAD_PROPERTIES",
    "OBJECT_PROPERTIES",
    "ContractError",
    "check_finger",
    "check_jaw",
    "check_load",
    "check_object",
    "quick_check",
]
