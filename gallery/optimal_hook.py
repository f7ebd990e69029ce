"""The finger and jaw angles of Lan & Lee's Example I that snap in with the least force.

Retention stays what it was and is at least twice the insertion force; the strain stays below 1.5 %. The finger that
does it is thicker than the gap above the pin and stays bent when closed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import sympy
from matplotlib.figure import Figure

import gripper as gr
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle

plastic = gr.Material(youngs_modulus=2.6e9, poisson_ratio=0.35)
jaw = Triangle(length=0.019, lead_angle=math.radians(20), return_angle=math.radians(60))
scene = gr.Scene(
    title="The hook that is easiest to close",
    finger=Uniform(length=0.057, thickness=0.0032, width=0.0095, material=plastic, jaw=jaw),
    object=Circle(radius=0.0089).at(x=sympy.Symbol("x_o"), y=-0.0105),
    motion=gr.Motion.between("x_o", 0.100, 0.034, 17),
    theory="bending",
    limits=gr.Limits({"min_retention_force": 2.5, "min_retention_ratio": 2.0, "max_strain": 0.015}),
)
FREE = {
    "finger.thickness": (0.002, 0.006),
    "finger.length": (0.045, 0.065),
    "finger.jaw.lead_angle": (math.radians(4), math.radians(30)),
    "finger.jaw.return_angle": (math.radians(45), math.radians(88)),
}


def search(gradients: Literal["exact", "differences"]) -> gr.Optimum:
    """The finger and the jaw's angles, on exact gradients or, to compare, on SciPy's differences."""
    return gr.optimize(scene, FREE, minimize="insertion_force", starts=1, gradients=gradients)


def main(folder: str | Path = ".") -> gr.Optimum:
    """Search, and write every design tried (CSV) and the force before and after (PNG) into the folder."""
    best = search("exact")
    Path(folder, "optimal_hook.csv").write_text(best.history_csv())
    figure = Figure(figsize=(5.5, 3.5), layout="constrained")
    axes = figure.add_subplot(xlabel="place of the pin in mm, falling: insertion", ylabel="force of the motion in N")
    axes.invert_xaxis()
    finely = gr.Motion.between("x_o", 0.100, 0.034, 133)
    for name, design in (("before", scene), ("after", best.scene)):
        poses = gr.trace(replace(design, motion=finely)).poses
        axes.plot([1e3 * (p.parameter or 0) for p in poses], [-(p.motion_force or 0) for p in poses], label=name)
    axes.axhline(0, color="0.7", zorder=0)
    axes.legend()
    figure.savefig(Path(folder) / "optimal_hook.png", dpi=150)
    return best


if __name__ == "__main__":
    print(main())
    print(f"{search('differences').evaluations} designs solved with SciPy's differences instead")
