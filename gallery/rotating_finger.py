"""A tapered rubber finger turns against an ellipse (Lan & Lee, Example II, figure 7): filmstrip, curve and film.

The object passes from left to right while the finger turns clockwise: phi = 102 - 236.22 x_e degrees. The paper leaves
out the finger's length; 7 in is assumed.
"""

import math

import sympy

import gripper as gr
from gripper_plugins.fingers import Tapered
from gripper_plugins.objects import Ellipse

ANGLES = (126, 108, 90, 72, 54)  # phi in the paper's figure, degrees
x_e = sympy.Symbol("x_e")

rubber = gr.Material(youngs_modulus=4.8e6, shear_modulus=1.71e6, poisson_ratio=0.4)
finger = Tapered(length=0.1778, base_thickness=0.030, tip_thickness=0.017, width=0.025, material=rubber)
scene = gr.Scene(
    title="Tapered rubber finger turning against an ellipse (Lan & Lee, Example II)",
    finger=finger.at(angle=math.radians(102) - math.radians(236.22) * x_e),
    object=Ellipse(semi_axes=(0.04953, 0.033655)).at(x=x_e, y=0.12065),
    motion=gr.Motion.between("x_e", -0.1016, 0.2032, 49),
    theory="shear",  # as the paper: the finger is thick
)


def main(folder: str = "out/rotating_finger") -> gr.Result:
    """Trace the whole motion; draw it into the folder."""
    result, places = gr.trace(scene), [(102 - angle) / 236.22 for angle in ANGLES]
    drawn = [min(range(49), key=lambda i: abs(scene.motion.values[i] - place)) for place in places]
    result.filmstrip(drawn).savefig(f"{folder}/rotating_finger.png")
    result.curve().savefig(f"{folder}/force.png")
    result.animate(f"{folder}/rotating_finger.gif", pixels=440)
    return result


if __name__ == "__main__":
    print(main(), "Figures: out/rotating_finger", sep="\n")
