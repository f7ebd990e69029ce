"""Compliant grippers: the bent shape and the contact forces of a flexible finger on a rigid outline.

    import gripper as gr

    result = gr.solve(gr.Scene(finger=..., object=...))   # one pose
    result = gr.trace(gr.Scene(..., motion=...))          # a motion
    problem = gr.assemble(scene)                          # the NCO problem, ready for scipy.optimize.minimize

After C.-C. Lan and K.-M. Lee, "An Analytical Method for Design of Compliant Grippers with Macro/Micro Manipulation
and Assembly Applications". SI units and radians throughout.
"""

from gripper.assemble import Problem, assemble
from gripper.bands import Band, linear_bands, sampled_bands
from gripper.fields import Expression, Finite, Point, Positive, Profile, Surface
from gripper.fingers import Finger, Jaw, Material
from gripper.friction import Coefficients, Friction
from gripper.limits import Limits, Verdict, judged
from gripper.loop import Loop
from gripper.materials import material
from gripper.objects import FeatureSurface, ImplicitSurface, Object
from gripper.optimize import Optimum, optimize
from gripper.pose import Placed, Pose
from gripper.result import Contact, Event, PoseResult, Result
from gripper.scene import Motion, Scene
from gripper.solve import solve
from gripper.summary import Summary
from gripper.sweep import Sweep, sweep
from gripper.tolerances import Tolerances
from gripper.trace import trace

__all__ = [
    "Band",
    "Coefficients",
    "Contact",
    "Event",
    "Expression",
    "FeatureSurface",
    "Finger",
    "Finite",
    "Friction",
    "ImplicitSurface",
    "Jaw",
    "Limits",
    "Loop",
    "Material",
    "Motion",
    "Object",
    "Optimum",
    "Placed",
    "Point",
    "Pose",
    "PoseResult",
    "Positive",
    "Problem",
    "Profile",
    "Result",
    "Scene",
    "Summary",
    "Surface",
    "Sweep",
    "Tolerances",
    "Verdict",
    "assemble",
    "judged",
    "linear_bands",
    "material",
    "optimize",
    "sampled_bands",
    "solve",
    "sweep",
    "trace",
]
