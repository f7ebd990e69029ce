"""A new object and a new finger, from nothing to a figure: all that a plugin's author writes.

An object writes g(x, y) in its own frame: in m, negative inside, |grad g| = 1 on the outline where it can be; and half
the side of a square about the origin that holds the outline. A finger writes its thickness w(s). Gradients, bounds,
contact, certificate and drawing follow from these.
"""

from dataclasses import dataclass

import sympy

import gripper as gr


@dataclass(frozen=True, kw_only=True)
class Egg(gr.ImplicitSurface):
    """An ellipse whose one end is blunter: (x/a)^2 + (y/b)^2 exp(-k x/a) = 1, with a and b in m."""

    semi_axes: tuple[gr.Length, gr.Length]
    bluntness: gr.Finite

    def g(self, x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
        a, b = self.semi_axes
        return min(a, b) / 2 * ((x / a) ** 2 + (y / b) ** 2 * sympy.exp(-self.bluntness * x / a) - 1)

    def half_size(self) -> float:
        return 1.1 * max(self.semi_axes) * float(sympy.exp(abs(self.bluntness) / 2))


@dataclass(frozen=True, kw_only=True)
class Hinged(gr.Finger):
    """A finger with a soft place at a third of its length: w0 (1 - d exp(-((15 s/L - 5) / 4)^2)), with w0 in m."""

    thickness: gr.Length
    depth: gr.Finite

    def w(self, s: sympy.Expr) -> sympy.Expr:
        return self.thickness * (1 - self.depth * sympy.exp(-(((15 * s / self.length - 5) / 4) ** 2)))


rubber = gr.Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
finger = Hinged(length=0.15, width=0.025, material=rubber, thickness=0.02, depth=0.5)
egg = Egg(semi_axes=(0.04, 0.025), bluntness=0.4).at(x=0.11, y=sympy.Symbol("q"), angle=0.3)
motion = gr.Motion.between("q", -0.045, 0.0, 10)
scene = gr.Scene(title="An egg under a finger with a hinge", finger=finger, object=egg, motion=motion)


def main(folder: str = "out/plugin_author") -> gr.Result:
    """Trace the motion and draw it into the folder."""
    result = gr.trace(scene)
    result.filmstrip([0, 3, 6, 9]).savefig(f"{folder}/plugin_author.png")
    return result


if __name__ == "__main__":
    print(main(), "Figures: out/plugin_author", sep="\n")
