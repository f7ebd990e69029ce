"""The finger and jaw angles of Lan & Lee's Example I that snap in with the least force.

Retention stays what it was and is at least twice the insertion force; the strain stays below 1.5 %. The finger that
does it is thicker than the gap above the pin and stays bent when closed.
"""

from dataclasses import replace
from math import radians
from pathlib import Path

import sympy

import gripper as gr
from gripper.plot import COLUMN, compare
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle

plastic = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
jaw = Triangle(length=0.019, lead_angle=radians(20), return_angle=radians(60))
scene = gr.Scene(
    title="The hook that is easiest to close",
    finger=Uniform(length=0.057, thickness=0.0032, width=0.0095, material=plastic, jaw=jaw),
    object=Circle(radius=0.0089).at(x=sympy.Symbol("x_o"), y=-0.0105),
    motion=gr.Motion.between("x_o", 0.100, 0.034, 17),
    theory="bending",
    limits=gr.Limits({"min_retention_force": 2.5, "min_retention_ratio": 2.0, "max_strain": 0.015}),
)
FREE = {"finger.thickness": (0.002, 0.006), "finger.length": (0.045, 0.065)}
FREE |= {"finger.jaw.lead_angle": (radians(4), radians(30)), "finger.jaw.return_angle": (radians(45), radians(88))}


def main(folder: str = "out/optimal_hook") -> gr.Optimum:
    """Search, and write the force before and after (PNG) and every design tried (CSV) into the folder."""
    best = gr.optimize(scene, FREE, minimize="insertion_force", starts=1)
    finely, designs = gr.Motion.between("x_o", 0.100, 0.034, 133), {"before": scene, "after": best.scene}
    results = {name: gr.trace(replace(design, motion=finely)) for name, design in designs.items()}
    figure = compare(results, "motion_force", title="It closes from right to left", width=COLUMN)
    figure.savefig(f"{folder}/optimal_hook.png")
    Path(folder, "optimal_hook.csv").write_text(best.history_csv())
    return best


if __name__ == "__main__":
    print(main())
