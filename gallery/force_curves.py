"""Forces along the two examples' motions, beside finite elements (Lan & Lee, figures 3, 4, 8 and 9).

Of the finger on the object, in the finger's frame. Figures 8 and 9 have the finger as a line too, which touches with
its neutral axis. Where the contact sticks the ground is grey: a beam turns its slip as a whole, the elements point by
point, over twice the way.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

import gripper as gr
from gripper import scenefile
from gripper.plot import compare
from gripper.study.line_model import as_line
from gripper.verify import Verification, verify

ASSEMBLY, ROTATING = (
    scenefile.read(Path(__file__).with_name(f"{n}.toml")) for n in ("micro_assembly", "rotating_finger")
)


class Curves(NamedTuple):
    """A figure and its numbers: gripper's results by the name of their model, and the finite elements."""

    figure: Figure
    results: dict[str, gr.Result]
    elements: Verification


def curves(scenes: dict[str, gr.Scene], places: Iterable[float], mesh: tuple[int, int]) -> Curves:
    """Solve the models of one scene, the first of them with finite elements at these places too, and draw both."""
    results = {name: gr.trace(scene) for name, scene in scenes.items()}
    elements = verify(next(iter(scenes.values())), list(places), elements=mesh, laws=False)
    found = [(p.parameter, p.elements.force) for p in elements.poses if p.elements.force]
    figure = compare(results, "force_on_object_finger_frame", points={"finite elements": found})
    return Curves(figure, results, elements)


def assembly(mu: float = 0.0, poses: int = 73, found: int = 19, mesh: tuple[int, int] = (108, 4)) -> Curves:
    """Figure 3, and with friction figure 4: Example I."""
    scene = replace(ASSEMBLY, friction=gr.Friction(coefficient=mu), motion=gr.Motion.between("x_o", 0.08, 0.05, poses))
    return curves({"bending": scene}, gr.Motion.between("x_o", 0.08, 0.05, found).values, mesh)


def rotating(mu: float = 0.0, poses: int = 71, found: int = 15, mesh: tuple[int, int] = (108, 4)) -> Curves:
    """Figure 8, and with friction figure 9: Example II."""
    motion, friction = gr.Motion.between("x_e", -0.1016, 0.0762, poses), gr.Friction(coefficient=mu)
    scene = replace(ROTATING, friction=friction, motion=motion)
    bending = replace(scene, theory="bending")
    turning = (0.046, 0.048, 0.0495, 0.0521, 0.0535, 0.055) if mu else ()
    places = (*gr.Motion.between("x_e", -0.1016, 0.0762, found).values, *turning)
    return curves({"shear": scene, "bending": bending, "bending, finger as a line": as_line(bending)}, places, mesh)


def main(folder: str | Path = "out/force_curves") -> dict[str, Curves]:
    """Write the four figures and the tables of their finite elements into the folder."""
    drawn = {"figure_3": assembly(), "figure_4": assembly(0.3), "figure_8": rotating(), "figure_9": rotating(0.2)}
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, each in drawn.items():
        each.figure.savefig(Path(folder, f"{name}.png"))
        Path(folder, f"{name}.md").write_text(each.elements.markdown())
    return drawn


if __name__ == "__main__":
    print(*(each.elements for each in main().values()), "Figures: out/force_curves", sep="\n\n")
