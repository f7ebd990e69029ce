"""Forces along the two examples' motions, beside finite elements (Lan & Lee, figures 3, 4, 8 and 9).

Of the finger on the object, in the finger's frame. Figures 8 and 9 have the finger as a line too, which touches with
its neutral axis. Where the contact sticks the ground is grey: a beam turns its slip as a whole, the elements point by
point, over twice the way.
"""

from dataclasses import replace
from pathlib import Path

import gripper as gr
from gripper import scenefile
from gripper.study.beside import Beside, beside_elements
from gripper.study.line_model import as_line

HERE, MESH = Path(__file__).parent, (108, 4)
ASSEMBLY, ROTATING = scenefile.read(HERE / "micro_assembly.toml"), scenefile.read(HERE / "rotating_finger.toml")
TURNING = (0.046, 0.048, 0.0495, 0.0521, 0.0535, 0.055)  # x_e in m, where slip turns with friction


def assembly(mu: float = 0.0, poses: int = 73, found: int = 19, mesh: tuple[int, int] = MESH) -> Beside:
    """Figure 3, and with friction figure 4: Example I."""
    scene = replace(ASSEMBLY, friction=gr.Friction(coefficient=mu), motion=gr.Motion.between("x_o", 0.08, 0.05, poses))
    return beside_elements({"bending": scene}, gr.Motion.between("x_o", 0.08, 0.05, found).values, mesh)


def rotating(mu: float = 0.0, poses: int = 71, found: int = 15, mesh: tuple[int, int] = MESH) -> Beside:
    """Figure 8, and with friction figure 9: Example II."""
    motion, friction = gr.Motion.between("x_e", -0.1016, 0.0762, poses), gr.Friction(coefficient=mu)
    scene = replace(ROTATING, friction=friction, motion=motion)
    bending = replace(scene, theory="bending")
    places = gr.Motion.between("x_e", -0.1016, 0.0762, found).values + (TURNING if mu else ())
    models = {"shear": scene, "bending": bending, "bending, finger as a line": as_line(bending)}
    return beside_elements(models, places, mesh)


def main(folder: str | Path = "out/force_curves") -> dict[str, Beside]:
    """Write the four figures and the tables of their finite elements into the folder."""
    drawn = {"figure_3": assembly(), "figure_4": assembly(0.3), "figure_8": rotating(), "figure_9": rotating(0.2)}
    for name, each in drawn.items():
        each.figure.savefig(Path(folder, f"{name}.png"))
        Path(folder, f"{name}.md").write_text(each.elements.markdown())
    return drawn


if __name__ == "__main__":
    print(*(each.elements for each in main().values()), "Figures: out/force_curves", sep="\n\n")
