"""A second opinion: two-dimensional finite elements on the user's own scene.

Shares the object's g and the profile with the solver, nothing else. Nothing in the package imports it.

    from gripper.verify import verify

    print(verify(scene))
"""

from gripper.verify.compare import verify
from gripper.verify.material import LawName
from gripper.verify.report import Verification, VerifiedPose
from gripper.verify.table import overview

__all__ = ["LawName", "Verification", "VerifiedPose", "overview", "verify"]
