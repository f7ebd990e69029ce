"""The public names and where they are: for type checkers, for editors, and for ``__init__.py``, which reads this."""

from gripper.assemble import assemble as assemble
from gripper.bands import Band as Band
from gripper.bands import linear_bands as linear_bands
from gripper.bands import sampled_bands as sampled_bands
from gripper.expression.dimensions import unit as unit
from gripper.fields import (
    Angle as Angle,
)
from gripper.fields import (
    Coordinate as Coordinate,
)
from gripper.fields import (
    Expression as Expression,
)
from gripper.fields import (
    Finite as Finite,
)
from gripper.fields import (
    Length as Length,
)
from gripper.fields import (
    LengthProfile as LengthProfile,
)
from gripper.fields import (
    Point as Point,
)
from gripper.fields import (
    Positive as Positive,
)
from gripper.fields import (
    Profile as Profile,
)
from gripper.fields import (
    Ratio as Ratio,
)
from gripper.fields import (
    Stress as Stress,
)
from gripper.fields import (
    Surface as Surface,
)
from gripper.fields import (
    Varying as Varying,
)
from gripper.fields import (
    VaryingForce as VaryingForce,
)
from gripper.fingers import Base as Base
from gripper.fingers import Finger as Finger
from gripper.fingers import Jaw as Jaw
from gripper.fingers import Material as Material
from gripper.friction import Coefficients as Coefficients
from gripper.friction import Friction as Friction
from gripper.limits import Limits as Limits
from gripper.limits import Verdict as Verdict
from gripper.limits import judged as judged
from gripper.loads import Load as Load
from gripper.loads import PotentialLoad as PotentialLoad
from gripper.materials import material as material
from gripper.objects import FeatureSurface as FeatureSurface
from gripper.objects import ImplicitSurface as ImplicitSurface
from gripper.objects import Object as Object
from gripper.optimize import Optimum as Optimum
from gripper.optimize import optimize as optimize
from gripper.pose import Placed as Placed
from gripper.pose import Pose as Pose
from gripper.result import Contact as Contact
from gripper.result import Event as Event
from gripper.result import PoseResult as PoseResult
from gripper.result import Result as Result
from gripper.results.loop import Loop as Loop
from gripper.results.summary import Summary as Summary
from gripper.scene import Motion as Motion
from gripper.scene import Scene as Scene
from gripper.solve import solve as solve
from gripper.statics.problem import Problem as Problem
from gripper.sweep import Sweep as Sweep
from gripper.sweep import sweep as sweep
from gripper.tolerances import Tolerances as Tolerances
from gripper.trace import trace as trace
