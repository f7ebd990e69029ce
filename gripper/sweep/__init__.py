"""Sweeps: a scene with other numbers, many times over, on as many processes or machines as there are.

    table = gr.sweep(scene, {"finger.thickness": np.linspace(2e-3, 4e-3, 16), "friction.coefficient": (0, 0.2)}, "out")

The table in the folder grows row by row; a sweep that was killed goes on where it was.
"""

from gripper.sweep.plan import Plan, spread
from gripper.sweep.rows import Row
from gripper.sweep.run import Sweep, sweep

__all__ = ["Plan", "Row", "Sweep", "spread", "sweep"]
