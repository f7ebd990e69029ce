"""The handbook's cantilever snap-fit beside its two formulas (Bayer; tests/reference/exact.json).

Deflection force: load the tip on its axis, as the formula does, and large deflection (+2.1 %) and shear (-1.7 %) all
but cancel at the handbook's undercut. Mating force: over a real, sharp edge friction turns the tip, which steepens the
ramp, and bends the thin end back: 1.8 times the formula. Polycarbonate, half as thick at the tip, mu = 0.6.
"""

from dataclasses import replace
from math import pi, radians, tan

import sympy

import gripper as gr
from gripper.plot import COLUMN, chart, compare
from gripper_plugins.fingers import Tapered
from gripper_plugins.jaws import PolygonJaw, Triangle
from gripper_plugins.objects import Polygon

L, h, b, undercut, lead, mu, E = 0.019, 0.00328, 0.0095, 0.0024, radians(30), 0.6, 1815e6
DEFLECTION_FORCE = b * h**2 / 6 * E * 0.02 / L  # N, at a root strain of 2 %, which is that of the undercut
MATING_FORCE = DEFLECTION_FORCE * (mu + tan(lead)) / (1 - mu * tan(lead))
PARTS = (0.01, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)  # of the undercut: how far the tip is lifted
q, gap, nose = sympy.Symbol("q"), 0.0002, 0.001  # m
slab = Polygon(vertices=((-0.0005, 0), (0.001, 0), (0.001, -0.002), (-0.0005, -0.002)))
plastic = gr.Material(youngs_modulus=E, poisson_ratio=0.37)
jaw = Triangle(length=(undercut + gap) / tan(lead), lead_angle=lead, return_angle=pi / 2)
hook = Tapered(length=L, base_thickness=h, tip_thickness=h / 2, width=b, material=plastic, jaw=jaw)

tip = PolygonJaw(vertices=((0, 0.0006), (nose, 0), (0, 0.0008)))  # rigid, for the last 1 mm: it is loaded on its axis
nosed = replace(hook, length=L - nose, tip_thickness=h * (1 + nose / L) / 2, jaw=tip)
heights = gr.Motion("q", tuple(undercut * part for part in (-0.01, *PARTS)))
lifted = gr.Scene(finger=nosed, object=slab.at(x=L, y=q), motion=heights, theory="bending")
mated = gr.Scene(
    title="The hook on its mating edge",  # which goes along the lead face, under the hook's point, and past it
    finger=hook,
    object=slab.at(x=0.025 - q, y=-h / 4 - gap),
    motion=gr.Motion.between("q", 0.0, 0.0075, 76),
    theory="shear",
    friction=gr.Friction(coefficient=mu),
)


def main(folder: str = "out/snap_hook") -> dict[str, gr.Result]:
    """Lift it with and without shear, and push it over the edge; draw that into the folder."""
    results = {"bending": gr.trace(lifted), "bending and shear": gr.trace(replace(lifted, theory="shear"))}
    ratios, levels = {}, {"handbook": MATING_FORCE}
    for name, result in results.items():
        forces = [-pose.force_on_object[1] / DEFLECTION_FORCE for pose in result.poses[1:]]
        ratios[name] = PARTS, [force / part for force, part in zip(forces, PARTS, strict=True)]
    ratio = chart(ratios, "deflection, over the undercut", "force, over the handbook's", levels={"handbook": 1.0})
    ratio.savefig(f"{folder}/deflection.png")
    mating = gr.trace(mated)
    compare({"this edge": mating}, "motion_force", levels=levels, width=COLUMN).savefig(f"{folder}/mating.png")
    mating.filmstrip().savefig(f"{folder}/snap_hook.png")
    return results | {"mating": mating}


if __name__ == "__main__":
    print(main()["mating"], f"handbook: {MATING_FORCE:.1f} N", "Figures: out/snap_hook", sep="\n")
