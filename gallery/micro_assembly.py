"""A finger with a triangular jaw snaps over a round pin (Lan & Lee, Example I): insertion, deflection, assembly.

The paper leaves out the jaw's two angles; 20 and 60 degrees are assumed.
"""

from __future__ import annotations

import math
from pathlib import Path

import sympy

import gripper as gr
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle

x_o = sympy.Symbol("x_o")

plastic = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
jaw = Triangle(length=0.019, lead_angle=math.radians(20), return_angle=math.radians(60))
scene = gr.Scene(
    title="Micro-assembly finger with a triangular jaw on a round pin (Lan & Lee, Example I)",
    finger=Uniform(length=0.057, thickness=0.0032, width=0.0095, material=plastic, jaw=jaw),
    object=Circle(radius=0.0089).at(x=x_o, y=-0.0105),
    motion=gr.Motion.between("x_o", 0.086, 0.050, 37),
    theory="bending",  # as the paper: the finger is thin
)
DRAWN = (8, 14, 22, 36)  # x_o = 78, 72, 64 and 50 mm: before the touch, insertion, deflection, assembly


def main(folder: str | Path = ".") -> gr.Result:
    """Trace the whole motion and write ``micro_assembly.png`` into the folder."""
    result = gr.trace(scene)
    result.filmstrip(DRAWN).savefig(Path(folder) / "micro_assembly.png")
    return result


if __name__ == "__main__":
    print(main())
