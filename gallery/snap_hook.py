"""The handbook's cantilever snap-fit beside its two formulas (Bayer; tests/reference/exact.json).

Deflection force: load the tip on its axis, as the formula does, and large deflection (+2.1 %) and shear (-1.7 %) all
but cancel at the handbook's undercut. Mating force: over a real, sharp edge friction turns the tip, which steepens the
ramp, and bends the thin end back: 1.8 times the formula. Polycarbonate, half as thick at the tip, mu = 0.6.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians, tan
from pathlib import Path

import sympy

import gripper as gr
from gripper.plot import COLUMN, chart, compare
from gripper_plugins.fingers import Tapered
from gripper_plugins.jaws import PolygonJaw, Triangle
from gripper_plugins.objects import Polygon

L, h, b, undercut, lead, mu, E = 0.019, 0.00328, 0.0095, 0.0024, radians(30), 0.6, 1815e6
DEFLECTION_FORCE = b * h**2 / 6 * E * 0.02 / L  # N, at a root strain of 2 %, which is that of the undercut
MATING_FORCE = DEFLECTION_FORCE * (mu + tan(lead)) / (1 - mu * tan(lead))
q, gap, nose = sympy.Symbol("q"), 0.0002, 0.001  # m
SLAB = Polygon(vertices=((-0.0005, 0), (0.001, 0), (0.001, -0.002), (-0.0005, -0.002)))


def hook(length: float, jaw: gr.Jaw) -> Tapered:
    """The handbook's beam, cut at this length, with a jaw."""
    section, material = {"base_thickness": h, "width": b}, gr.Material(youngs_modulus=E, poisson_ratio=0.37)
    return Tapered(length=length, tip_thickness=h * (1 - length / L / 2), jaw=jaw, material=material, **section)


def lifted(theory: str) -> gr.Result:
    """Lift the tip on its axis, by a rigid nose that replaces its last 1 mm, up to 1.5 times the undercut."""
    finger = hook(L - nose, PolygonJaw(vertices=((0, 0.0006), (nose, 0), (0, 0.0008))))
    motion = gr.Motion("q", tuple(undercut * part for part in (-0.01, 0.01, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)))
    return gr.trace(gr.Scene(finger=finger, object=SLAB.at(x=L, y=q), motion=motion, theory=theory))


def mated() -> gr.Result:
    """Push a slab over the hook, with friction: its edge along the lead face, the hook's point over it, and past it."""
    jaw = Triangle(length=(undercut + gap) / tan(lead), lead_angle=lead, return_angle=pi / 2)
    slab, motion = SLAB.at(x=0.025 - q, y=-h / 4 - gap), gr.Motion.between("q", 0.0, 0.0075, 76)
    scene = gr.Scene(title="The hook on its mating edge", finger=hook(L, jaw), object=slab, motion=motion)
    return gr.trace(replace(scene, theory="shear", friction=gr.Friction(coefficient=mu)))


def main(folder: str | Path = "out/snap_hook") -> dict[str, gr.Result]:
    """Lift it with and without shear, and push it over the edge; draw that into the folder."""
    results = {"bending": lifted("bending"), "bending and shear": lifted("shear"), "mating": mated()}
    ratios = {}
    for name in ("bending", "bending and shear"):
        parts = [pose.parameter / undercut for pose in results[name].poses[1:]]
        forces = [-pose.force_on_object[1] / DEFLECTION_FORCE for pose in results[name].poses[1:]]
        ratios[name] = parts, [force / part for force, part in zip(forces, parts, strict=True)]
    mating = compare({"this edge": results["mating"]}, "motion_force", levels={"handbook": MATING_FORCE}, width=COLUMN)
    ratio = chart(ratios, "deflection, over the undercut", "force, over the handbook's", levels={"handbook": 1.0})
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, figure in (("snap_hook", results["mating"].filmstrip()), ("mating", mating), ("deflection", ratio)):
        figure.savefig(Path(folder, f"{name}.png"))
    return results


if __name__ == "__main__":
    print(main()["mating"], f"handbook: {MATING_FORCE:.1f} N", "Figures: out/snap_hook", sep="\n")
