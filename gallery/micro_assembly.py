"""A gripper with two jawed fingers snaps over a round pin and is pulled off again (Lan & Lee, Example I).

Insertion, deflection, assembly, extraction, with friction; figure 5's pose; the loop of force there and back. One
finger is solved, the other is its mirror image. The paper leaves out the jaw's angles: 20 and 60 degrees are assumed.
"""

from dataclasses import replace
from math import radians

import sympy

import gripper as gr
from gripper_plugins.fingers import Uniform
from gripper_plugins.jaws import Triangle
from gripper_plugins.objects import Circle

MIRROR = (0.0, -0.0105, 0.0)  # through the pin's middle: x, y in m, and an angle
STAGES = {14: "insertion", 24: "deflection", 36: "assembly", 42: "extraction"}  # x_o = 72, 62, 50 and 56 mm

plastic = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
jaw = Triangle(length=0.019, lead_angle=radians(20), return_angle=radians(60))
scene = gr.Scene(
    title="Micro-assembly gripper on a round pin (Lan & Lee, Example I)",
    finger=Uniform(length=0.057, thickness=0.0032, width=0.0095, material=plastic, jaw=jaw),
    object=Circle(radius=0.0089).at(x=sympy.Symbol("x_o"), y=-0.0105),
    motion=gr.Motion.between("x_o", 0.086, 0.050, 37),
    theory="bending",  # as the paper: the finger is thin
)
there_and_back = gr.Motion.between("x_o", 0.086, 0.050, 37, back=True)
loop = replace(scene, motion=there_and_back, friction=gr.Friction(coefficient=0.3))
fifth = replace(scene, motion=None, object=Circle(radius=0.0089).at(x=0.06781, y=-0.0105))


def main(folder: str = "out/micro_assembly") -> tuple[gr.Result, gr.Result, gr.Result]:
    """Solve the insertion without friction, the loop with friction, and figure 5's pose; draw them into the folder."""
    insertion, rubbing, pose = gr.trace(scene), gr.trace(loop), gr.solve(fifth)
    rubbing.filmstrip(STAGES, mirror=MIRROR).savefig(f"{folder}/micro_assembly.png")
    rubbing.curve("motion_force").savefig(f"{folder}/loop.png")
    insertion.curve().savefig(f"{folder}/insertion.png")
    pose.filmstrip({0: "x_o = 67.81 mm"}, mirror=MIRROR).savefig(f"{folder}/figure_5.png")
    return insertion, rubbing, pose


if __name__ == "__main__":
    print(main()[1], "Figures: out/micro_assembly", sep="\n")
