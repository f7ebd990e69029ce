"""Forces along the two examples' motions, beside finite elements (Lan & Lee, figures 3, 4, 8 and 9).

Of the finger on the object, in the finger's frame. Figure 8 has the finger as a line too: contact on the neutral axis,
as if it had no thickness. Where the contact sticks the ground is grey; there a beam turns its slip as a whole, the
elements turn theirs point by point over twice the way.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import gripper as gr
from gripper import scenefile
from gripper.plot import PAGE, Picture, styled
from gripper.verify import Verification, verify

HERE = Path(__file__).parent
ASSEMBLY, ROTATING = (scenefile.read(HERE / f"{name}.toml") for name in ("micro_assembly", "rotating_finger"))


class Curves(NamedTuple):
    """A figure and its numbers: gripper's results by the name of their model, and the finite elements."""

    figure: Picture
    results: dict[str, gr.Result]
    elements: Verification


def line(scene: gr.Scene, share: float = 1e-4) -> gr.Scene:
    """Make a tapered finger a line without shear: a share of its thickness, and as stiff in bending, EI, as it was."""
    finger = scene.finger.body
    thickness = {name: share * getattr(finger, name) for name in ("base_thickness", "tip_thickness")}
    thin = replace(finger, **thickness, width=finger.width / share**3)
    return replace(scene, finger=replace(scene.finger, body=thin), theory="bending")


def curves(scenes: dict[str, gr.Scene], places: Iterable[float], mesh: tuple[int, int]) -> Curves:
    """Solve the models of one scene, the first of them with finite elements at these places too, and draw both."""
    results = {name: gr.trace(scene) for name, scene in scenes.items()}
    first = next(iter(scenes.values()))
    elements = verify(first, list(places), elements=mesh, laws=False)
    with styled():
        figure = Picture(figsize=(PAGE / 0.0254, 0.4 * PAGE / 0.0254), layout="constrained")
        for i, (ax, axis) in enumerate(zip(figure.subplots(1, 2), "xy", strict=True)):
            for (name, result), dashes in zip(results.items(), ("-", "--", ":"), strict=False):
                known = [pose for pose in result.poses if pose.force_on_object is not None]
                forces = [pose.force_on_object_finger_frame[i] for pose in known]
                ax.plot([1e3 * pose.parameter for pose in known], forces, dashes, label=name)
            found = [pose for pose in elements.poses if pose.elements.force]
            at, forces = [1e3 * pose.parameter for pose in found], [pose.elements.force[i] for pose in found]
            ax.plot(at, forces, "o", color="black", markerfacecolor="none", label="finite elements")
            for begin, end in sticks(results[next(iter(results))]):
                ax.axvspan(1e3 * begin, 1e3 * end, color="0.8", linewidth=0, label="sticks")
            ax.set(xlabel=f"{first.motion.parameter} (mm)", ylabel=f"force on the object along {axis} (N)")
        ax.legend()
    return Curves(figure, results, elements)


def sticks(result: gr.Result) -> list[tuple[float, float]]:
    """Where a contact comes to stick, and where it slips again."""
    changes = [event for event in result.events if event.kind in ("stick", "slip")]
    return [(a.parameter, b.parameter) for a, b in pairwise(changes) if (a.kind, b.kind) == ("stick", "slip")]


def assembly(mu: float = 0.0, poses: int = 73, found: int = 19, mesh: tuple[int, int] = (108, 4)) -> Curves:
    """Figure 3, and with friction figure 4: Example I."""
    scene = replace(ASSEMBLY, friction=gr.Friction(coefficient=mu), motion=gr.Motion.between("x_o", 0.08, 0.05, poses))
    return curves({"bending": scene}, gr.Motion.between("x_o", 0.08, 0.05, found).values, mesh)


def rotating(mu: float = 0.0, poses: int = 71, found: int = 15, mesh: tuple[int, int] = (108, 4)) -> Curves:
    """Figure 8, and with friction figure 9: Example II."""
    motion, friction = gr.Motion.between("x_e", -0.1016, 0.0762, poses), gr.Friction(coefficient=mu)
    scene = replace(ROTATING, friction=friction, motion=motion)
    scenes = {"shear": scene, "bending": replace(scene, theory="bending"), "bending, finger as a line": line(scene)}
    turning = (0.046, 0.048, 0.0495, 0.0521, 0.0535, 0.055) if mu else ()
    return curves(scenes, (*gr.Motion.between("x_e", -0.1016, 0.0762, found).values, *turning), mesh)


def main(folder: str | Path = ".") -> dict[str, Curves]:
    """Write the four figures and the tables of their finite elements into the folder."""
    four = {"3": (assembly, 0.0), "4": (assembly, 0.3), "8": (rotating, 0.0), "9": (rotating, 0.2)}
    drawn = {f"figure_{name}": draw(mu) for name, (draw, mu) in four.items()}
    for name, each in drawn.items():
        each.figure.savefig(Path(folder) / f"{name}.png")
        (Path(folder) / f"{name}.md").write_text(each.elements.markdown())
        print(each.elements, end="\n\n")
    return drawn


if __name__ == "__main__":
    main(*sys.argv[1:2])
