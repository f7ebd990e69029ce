"""A profile that presses an ellipse with an almost constant force while the finger turns from 120 to 100 degrees.

Lan & Lee's Example II, its taper replaced by five thicknesses; the clamp's place is free too.
"""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Literal

import sympy
from matplotlib.figure import Figure

import gripper as gr
from gripper_plugins.fingers.stepped import Stepped
from gripper_plugins.objects.ellipse import Ellipse

x_e, L = sympy.Symbol("x_e"), 0.1778
rubber = gr.Material(youngs_modulus=4.8e6, shear_modulus=1.71e6, poisson_ratio=0.4)
TAPER = (0.030, 0.02675, 0.0235, 0.02025, 0.017)
finger = Stepped(length=L, stations=(0, L / 4, L / 2, 3 * L / 4, L), thicknesses=TAPER, width=0.025, material=rubber)
scene = gr.Scene(
    title="An almost constant force",
    finger=finger.at(angle=radians(102) - radians(236.22) * x_e),
    object=Ellipse(semi_axes=(0.04953, 0.033655)).at(x=x_e, y=0.12065),
    motion=gr.Motion("x_e", tuple((102 - phi) / 236.22 for phi in range(120, 98, -2))),
    theory="shear",
)
FREE = {f"finger.thicknesses[{i}]": (0.006, 0.045) for i in range(5)}
FREE |= {"finger.pose.x": (-0.03, 0.03), "finger.pose.y": (-0.03, 0.03)}


def search(gradients: Literal["exact", "differences"]) -> gr.Optimum:
    """The profile and the place of the clamp, on exact gradients or, to compare, on SciPy's differences."""
    return gr.optimize(scene, FREE, flatten="force_on_object", starts=1, gradients=gradients)


def main(folder: str | Path = ".") -> gr.Optimum:
    """Search, and write every design tried (CSV) and the force before and after (PNG) into the folder."""
    best = search("exact")
    Path(folder, "constant_force.csv").write_text(best.history_csv())
    figure = Figure(figsize=(5.5, 3.5), layout="constrained")
    axes = figure.add_subplot(xlabel="angle of the finger in degrees, falling", ylabel="force over its mean")
    axes.invert_xaxis()
    for name, result in (("before", best.before), ("after", best.result)):
        angles = [102 - 236.22 * (pose.parameter or 0.0) for pose in result.poses]
        forces = [sum(f**2 for f in pose.force_on_object or ()) ** 0.5 for pose in result.poses]
        mean = sum(forces) / len(forces)
        axes.plot(angles, [force / mean for force in forces], label=f"{name}: {mean:.2f} N")
    axes.legend()
    figure.savefig(Path(folder) / "constant_force.png", dpi=150)
    return best


if __name__ == "__main__":
    print(main())
    print(f"{search('differences').evaluations} designs solved with SciPy's differences instead")
