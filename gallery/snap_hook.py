"""The handbook's cantilever snap-fit beside its two formulas (Bayer; tests/reference/exact.json).

Deflection force: load the tip on its axis, as the formula does, and large deflection (+2.1 %) and shear (-1.7 %) all
but cancel at the handbook's undercut. Mating force: on the real ramp friction turns the tip, which steepens the ramp,
and bends the thin end back: 1.8 times the formula. Polycarbonate, half as thick at the tip, mu = 0.6.
"""

from __future__ import annotations

from math import pi, radians, tan
from pathlib import Path

import sympy

import gripper as gr
from gripper.plot import COLUMN, INCH, Picture, curve, styled
from gripper_plugins.fingers import Tapered
from gripper_plugins.jaws import PolygonJaw, Triangle
from gripper_plugins.objects import Circle, Ellipse

L, h, b, undercut, lead, mu, E = 0.019, 0.00328, 0.0095, 0.0024, radians(30), 0.6, 1815e6
DEFLECTION_FORCE = b * h**2 / 6 * E * 0.02 / L  # N, at a root strain of 2 %, which is that of the undercut
MATING_FORCE = DEFLECTION_FORCE * (mu + tan(lead)) / (1 - mu * tan(lead))
q, gap, edge, nose, flat = sympy.Symbol("q"), 0.0002, 0.0005, 0.001, 0.00001  # m


def hook(length: float, jaw: gr.Jaw) -> Tapered:
    """The handbook's beam, cut at this length, with a jaw."""
    section, material = {"base_thickness": h, "width": b}, gr.Material(youngs_modulus=E, poisson_ratio=0.37)
    return Tapered(length=length, tip_thickness=h * (1 - length / L / 2), jaw=jaw, material=material, **section)


def lifted(theory: str) -> gr.Result:
    """Lift the tip on its axis, by a rigid nose that replaces its last 1 mm, up to 1.5 times the undercut."""
    plate = Ellipse(semi_axes=(0.0008, flat)).at(x=L, y=q - flat)
    finger = hook(L - nose, PolygonJaw(vertices=((0, 0.0006), (nose, 0), (0, 0.0008))))
    motion = gr.Motion("q", tuple(undercut * part for part in (-0.01, 0.01, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)))
    return gr.trace(gr.Scene(finger=finger, object=plate, motion=motion, theory=theory))


def mated() -> gr.Result:
    """Push a rounded edge over the hook, with friction: along the lead face, over its point, and past it."""
    jaw = Triangle(length=(undercut + gap) / tan(lead), lead_angle=lead, return_angle=pi / 2)
    rod = Circle(radius=edge).at(x=0.0245 - q, y=-h / 4 - gap - edge)
    way = {"motion": gr.Motion.between("q", 0.0, 0.006, 61), "friction": gr.Friction(coefficient=mu)}
    return gr.trace(
        gr.Scene(title="The hook on its mating edge", finger=hook(L, jaw), object=rod, theory="shear", **way)
    )


def main(folder: str | Path = "out/snap_hook") -> dict[str, gr.Result]:
    """Lift it with and without shear, and push it over the edge; draw that into the folder."""
    results = {"bending": lifted("bending"), "bending and shear": lifted("shear"), "mating": mated()}
    Path(folder).mkdir(parents=True, exist_ok=True)
    results["mating"].filmstrip().savefig(Path(folder, "snap_hook.png"))
    with styled():
        force, ratio = (Picture(figsize=(COLUMN / INCH, 2.4), layout="constrained").subplots() for _ in range(2))
        curve(results["mating"], "motion_force", ax=force, label="this edge")
        force.axhline(MATING_FORCE, color="black", linestyle="--", label="handbook")
        for name in ("bending", "bending and shear"):
            poses = results[name].poses[1:]
            linear = [DEFLECTION_FORCE * pose.parameter / undercut for pose in poses]
            over = [-pose.force_on_object[1] / each for pose, each in zip(poses, linear, strict=True)]
            ratio.plot([1e3 * pose.parameter for pose in poses], over, "o-", label=name)
        ratio.axhline(1.0, color="black", linestyle="--", label="handbook")
        ratio.set(xlabel="deflection (mm)", ylabel="force, over the handbook's")
        for ax, name in ((force, "mating"), (ratio, "deflection")):
            ax.legend()
            ax.figure.savefig(Path(folder, f"{name}.png"))
    return results


if __name__ == "__main__":
    print(main()["mating"], f"handbook: {MATING_FORCE:.1f} N", "Figures: out/snap_hook", sep="\n")
