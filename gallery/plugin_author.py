"""A new object and a new finger, from nothing to a figure: all that a plugin's author writes.

An object writes g(x, y) in its own frame: in m, negative inside, |grad g| = 1 on the outline where it can be. A finger
writes its thickness w(s). Gradients, bounds, contact, certificate and drawing follow from these.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import sympy

import gripper as gr


@dataclass(frozen=True, kw_only=True)
class Egg(gr.ImplicitSurface):
    """An ellipse whose one end is blunter: (x/a)^2 + (y/b)^2 exp(-k x/a) = 1, with a and b in m."""

    semi_axes: tuple[gr.Positive, gr.Positive]
    bluntness: gr.Finite

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        """Write g, in m."""
        a, b = self.semi_axes
        return min(a, b) / 2 * ((x / a) ** 2 + (y / b) ** 2 * sympy.exp(-self.bluntness * x / a) - 1)

    def half_size(self) -> float:
        """Return half the side of a square about the origin that holds the outline, in m."""
        return 1.1 * max(self.semi_axes) * float(sympy.exp(abs(self.bluntness) / 2))


@dataclass(frozen=True, kw_only=True)
class Hinged(gr.Finger):
    """A finger with a soft place: w(s) = w0 (1 - d exp(-((s - c) / l)^2)), with w0, c and l in m."""

    thickness: gr.Positive
    depth: gr.Finite
    center: gr.Positive
    extent: gr.Positive

    def w(self, s: sympy.Expr) -> sympy.Expr:
        """Write the thickness, in m."""
        return self.thickness * (1 - self.depth * sympy.exp(-(((s - self.center) / self.extent) ** 2)))


rubber = gr.Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
hinge = {"thickness": 0.02, "depth": 0.5, "center": 0.05, "extent": 0.04}
scene = gr.Scene(
    title="An egg under a finger with a hinge",
    finger=Hinged(length=0.15, width=0.025, material=rubber, **hinge),
    object=Egg(semi_axes=(0.04, 0.025), bluntness=0.4).at(x=0.11, y=sympy.Symbol("q"), angle=0.3),
    motion=gr.Motion.between("q", -0.045, 0.0, 10),
)


def main(folder: str | Path = "out/plugin_author") -> gr.Result:
    """Trace the motion and draw it into the folder."""
    result = gr.trace(scene)
    Path(folder).mkdir(parents=True, exist_ok=True)
    result.filmstrip([0, 3, 6, 9]).savefig(Path(folder, "plugin_author.png"))
    return result


if __name__ == "__main__":
    print(main(), "Figures: out/plugin_author", sep="\n")
