"""Example II with rubber's laws for large strain, each beside finite elements of the same law.

The figure is the force over the linear law's, less 1: at strains up to 10 % the laws lie 3 % apart, and each law's beam
within 0.3 % of its elements. That takes the stretch of the axis, which depends on the bending where stress is no line.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import hypot
from pathlib import Path

import gripper as gr
from gripper import scenefile
from gripper.plot import PAGE, chart
from gripper.verify import Verification, overview, verify

ROTATING = scenefile.read(Path(__file__).with_name("rotating_finger.toml"))
LAWS = ("logarithmic", "neo_hookean", "st_venant_kirchhoff")
DRAWN = ("logarithmic", "st_venant_kirchhoff")  # neo-Hookean rubber would cover the logarithmic one
PLACES = (-0.1016, -0.0762, -0.0508, -0.0254, 0.0, 0.0254, 0.0508)  # x_e, in m


def scene(law: str, places: Sequence[float]) -> gr.Scene:
    """Example II, of this material, at these places of the ellipse."""
    body = ROTATING.finger.body
    finger = replace(ROTATING.finger, body=replace(body, material=replace(body.material, law=law)))
    return replace(ROTATING, finger=finger, motion=gr.Motion("x_e", tuple(places)), theory="stretch")


def main(
    folder: str | Path = "out/material_laws", places: Sequence[float] = PLACES, mesh: tuple[int, int] = (108, 6)
) -> dict[str, Verification]:
    """Compare every law with its elements; draw the forces into the folder."""
    found = {law: verify(scene(law, places), elements=mesh, laws=False) for law in LAWS}
    linear = [hypot(*pose.force_on_object) for pose in gr.trace(scene("linear", places)).poses]
    lines = {}
    for law in DRAWN:
        for name, who in ((law, "gripper"), (f"{law}, elements", "elements")):
            forces = [hypot(*getattr(pose, who).force) for pose in found[law].poses]
            more = [100 * (force / known - 1) for force, known in zip(forces, linear, strict=True)]
            lines[name] = [1000 * place for place in places], more
    figure = chart(lines, "x_e (mm)", "force over the linear law's, less 1 (%)", width=PAGE)
    figure.savefig(f"{folder}/material_laws.png")
    return found


if __name__ == "__main__":
    print(overview(main()), "Figure: out/material_laws", sep="\n\n")
