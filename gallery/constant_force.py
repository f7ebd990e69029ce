"""A profile that presses an ellipse with an almost constant force while the finger turns from 120 to 100 degrees.

Lan & Lee's Example II, its taper replaced by five thicknesses; the clamp's place is free too.
"""

from math import hypot, radians
from pathlib import Path

import sympy

import gripper as gr
from gripper.plot import chart
from gripper_plugins.fingers.stepped import Stepped
from gripper_plugins.objects.ellipse import Ellipse

x_e, L, ANGLES = sympy.Symbol("x_e"), 0.1778, range(120, 98, -2)
rubber = gr.Material(youngs_modulus=4.8e6, shear_modulus=1.71e6, poisson_ratio=0.4)
TAPER = (0.030, 0.02675, 0.0235, 0.02025, 0.017)
finger = Stepped(length=L, stations=(0, L / 4, L / 2, 3 * L / 4, L), thicknesses=TAPER, width=0.025, material=rubber)
scene = gr.Scene(
    title="An almost constant force",
    finger=finger.at(angle=radians(102) - radians(236.22) * x_e),
    object=Ellipse(semi_axes=(0.04953, 0.033655)).at(x=x_e, y=0.12065),
    motion=gr.Motion("x_e", tuple((102 - angle) / 236.22 for angle in ANGLES)),
    theory="shear",
)
FREE = {f"finger.thicknesses[{i}]": (0.006, 0.045) for i in range(5)}
FREE |= {"finger.pose.x": (-0.03, 0.03), "finger.pose.y": (-0.03, 0.03)}


def main(folder: str = "out/constant_force") -> gr.Optimum:
    """Search, and write the force before and after (PNG) and every design tried (CSV) into the folder."""
    best, lines = gr.optimize(scene, FREE, flatten="force_on_object", starts=1), {}
    for name, result in {"before": best.before, "after": best.result}.items():
        forces = [hypot(*pose.force_on_object) for pose in result.poses]
        mean = sum(forces) / len(forces)
        lines[f"{name}: {mean:.2f} N"] = ANGLES, [force / mean for force in forces]
    chart(lines, "angle of the finger (deg)", "force over its mean").savefig(f"{folder}/constant_force.png")
    Path(folder, "constant_force.csv").write_text(best.history_csv())
    return best


if __name__ == "__main__":
    print(main())
