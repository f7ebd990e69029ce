"""The paper's own scheme, for comparison only: node angles, trapezoids, contact at nodes (Lan & Lee section 2.5).

Corrected where it could not work as printed: the section's offset turns by psi (eq 5), the jaw by the ordinary rotation
matrix (eq 4), the shear term of eq 12 has its coefficient and its square. Left as it is: the angles Psi and Gamma
at N nodes are the unknowns and go unscaled to SLSQP, whose first, unit Hessian is therefore far from the energy's;
contact is asked for at M = N nodes alone, so that the force is off by up to 4 % and does not converge regularly. Only
what SLSQP sees is made dimensionless (energy by EI(0) / L, gaps by L): its ``ftol`` is absolute, and in J it would
stop wherever the energy happens to be small.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from gripper.beam.sections import sections
from gripper.contact.kinematics import Kinematics
from gripper.contact.obstacle import Obstacle
from gripper.fingers import Jaw
from gripper.pose import placed
from gripper.scene import Scene

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Shear = Literal["none", "averaged", "averaged_free", "element"]
Gradients = Literal["differences", "exact"]
Start = Literal["straight", "arc"]
_ARCS = np.concatenate([[0.0], np.geomspace(0.02, 3.0, 24)])
_MOST_ITERATIONS = 5000


@dataclass(frozen=True, kw_only=True)
class PublishedResult:
    """What the published scheme says of one pose.

    Parameters
    ----------
    force_on_object
        Of the finger on the object, from SLSQP's multipliers, in N, axes of the clamp.
    moment_force
        The same from the clamp's moment and one contact point (Lan & Lee eqs 6-8), in N.
    energy
        Strain energy, in J.
    success
        What SLSQP reports; no proof of anything.
    iterations, evaluations
        Of SLSQP, and of the energy (those spent on differences included).
    seconds
        CPU time with the start, without compiling finger and object.
    x
        The unknowns.
    multipliers
        Of the gaps.
    """

    force_on_object: tuple[float, float]
    moment_force: tuple[float, float]
    energy: float
    success: bool
    iterations: int
    evaluations: int
    seconds: float
    x: Array = field(repr=False, compare=False)
    multipliers: Array = field(repr=False, compare=False)


class PublishedProblem:
    """Equations 11 to 16 of one pose, dimensionless; vectors of the plane are complex numbers x + iy.

    The unknowns x are Psi_1..N, followed by the shear angles that ``shear`` asks for.

    Parameters
    ----------
    scene
        What is given; its theory and tolerance are not looked at.
    parameter
        Value of the motion's parameter; None in a scene without motion.
    N
        Number of elements, and of contact nodes: of the lower face, or of the jaw's lead face where there is one.
    shear
        "none"; "averaged": Gamma_1..N at the nodes, their means in the energy (as published; a zig-zag costs
        nothing); "averaged_free": the same with Gamma_0; "element": one value an element, which cures it.

    Raises
    ------
    ValueError
        An argument out of its range, a scene approached from above, or a pose that is not finite.
    """

    def __init__(self, scene: Scene, parameter: float | None, N: int, shear: Shear) -> None:
        _check(scene, parameter, N, shear)
        finger = placed(scene.finger).body
        self.N, self.shear, self.h = N, shear, 1.0 / N
        self.sections = sections(finger)
        nodes = np.arange(N + 1) / N
        self.half_thickness = self.sections.thickness(nodes[1:]) / 2
        self.EI, self.GA = (_midway(stiffness(nodes)) for stiffness in (self.sections.EI, self.sections.GA))
        tip = 2 * float(self.half_thickness[-1]) * finger.length
        self.jaw = None if finger.jaw is None else _lead_face(finger.jaw, tip, N) / finger.length
        frame = Kinematics(scene, finger.length).frame(parameter or 0.0)
        self.obstacle = Obstacle(placed(scene.object).body, finger.length, frame)
        self._before = np.tri(N) if self.jaw is None else np.ones((N + 1, N))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.N + {"none": 0, "averaged": self.N, "averaged_free": self.N + 1, "element": self.N}[self.shear]

    def angles(self, x: Array) -> tuple[Array, Array, Array]:
        """Psi at the nodes (N + 1,), and the axis' angle at the start and at the end of each element (N,)."""
        psi = np.concatenate([[0.0], x[: self.N]])
        if self.shear in ("none", "element"):
            gamma = x[self.N :] if self.shear == "element" else 0.0
            return psi, psi[:-1] + gamma, psi[1:] + gamma
        theta = psi + self._nodal_shear(x)
        return psi, theta[:-1], theta[1:]

    def energy(self, x: Array) -> tuple[float, Array]:
        """Strain energy over EI(0) / L (eqs 12, 13) and its gradient (n,)."""
        bend = np.diff(x[: self.N], prepend=0.0)
        moment = self.EI * bend / self.h
        value, slopes = moment @ bend / 2, [moment - np.append(moment[1:], 0.0)]
        if self.shear != "none":
            gamma = x[self.N :] if self.shear == "element" else _midway(self._nodal_shear(x))
            force = self.h * self.GA * gamma
            value += force @ gamma / 2
            slopes.append(force if self.shear == "element" else self._from_means(force))
        return float(value), np.concatenate(slopes)

    def contact_points(self, x: Array) -> Complex:
        """Nodes of the lower face (N,) (eqs 5, 15), or of the jaw's lead face (N + 1,) (eq 4), over L."""
        psi, start, stop = self.angles(x)
        axis = np.cumsum(np.exp(1j * start) + np.exp(1j * stop)) * (self.h / 2)
        if self.jaw is not None:
            return axis[-1] + self.jaw * np.exp(1j * psi[-1])
        return axis - 1j * self.half_thickness * np.exp(1j * psi[1:])

    def gaps(self, x: Array) -> Array:
        """G over L at the contact points (m,) (eq 16)."""
        return self.obstacle.gap(self.contact_points(x))

    def gap_gradients(self, x: Array) -> Array:
        """Gradients of the gaps over L (m, n)."""
        psi, start, stop = self.angles(x)
        normal = self.obstacle.slope(self.contact_points(x))[1]
        at_start, at_stop = (self._turning(normal, angle) for angle in (start, stop))
        by_psi = at_stop.copy()
        by_psi[:, :-1] += at_start[:, 1:]
        if self.jaw is None:
            turn = self.half_thickness * np.exp(1j * psi[1:])
            by_psi.flat[:: self.N + 1] += (normal.conj() * turn).real
        else:
            by_psi[:, -1] += (normal.conj() * 1j * self.jaw * np.exp(1j * psi[-1])).real
        if self.shear == "none":
            return by_psi
        by_gamma = at_start + at_stop if self.shear == "element" else self._from_ends(at_start, at_stop)
        return np.concatenate([by_psi, by_gamma], axis=1)

    def start(self, kind: Start) -> Array:
        """Unknowns of the straight finger, or of the least circular arc, away from the object, that clears it.

        The straight finger stands in for an arc where none clears.
        """
        ramp = np.zeros(self.size)
        ramp[: self.N] = np.arange(1, self.N + 1) / self.N
        arcs = (curvature * ramp for curvature in (_ARCS if kind == "arc" else ()))
        return next((arc for arc in arcs if self.gaps(arc).min() >= 0), 0 * ramp)

    def force_on_object(self, x: Array, multipliers: Array) -> complex:
        """Force of the finger on the object, in N, from the gaps' multipliers (m,)."""
        normal = self.obstacle.slope(self.contact_points(x))[1]
        return complex(-(multipliers @ normal) * self.sections.force_scale)

    def moment_force(self, x: Array, multipliers: Array) -> complex:
        """The same from eqs 6-8: one point, here that of the largest multiplier; 0 without contact."""
        touching = int(np.argmax(multipliers))
        if multipliers[touching] <= 0:
            return 0j
        point = self.contact_points(x)[touching : touching + 1]
        normal = self.obstacle.slope(point)[1]
        lever = (point.conj() * normal).imag  # P x n
        moment = self.EI[0] * x[0] / self.h
        return complex((-moment / lever * normal)[0] * self.sections.force_scale)

    def _nodal_shear(self, x: Array) -> Array:
        gamma = x[self.N :]
        return gamma if self.shear == "averaged_free" else np.concatenate([[0.0], gamma])

    def _from_means(self, values: Array) -> Array:
        """Transpose of the means of neighbours: (N,) to the nodal unknowns."""
        nodal = (np.append(values, 0.0) + np.append(0.0, values)) / 2
        return nodal if self.shear == "averaged_free" else nodal[1:]

    def _from_ends(self, at_start: Array, at_stop: Array) -> Array:
        """Derivatives in the angles at the elements' ends (m, N), gathered at the nodal unknowns."""
        nodal = np.pad(at_start, ((0, 0), (0, 1))) + np.pad(at_stop, ((0, 0), (1, 0)))
        return nodal if self.shear == "averaged_free" else nodal[:, 1:]

    def _turning(self, normal: Complex, angles: Array) -> Array:
        """Change of the gaps (m, N) with one end angle of each element that lies before the point."""
        along = np.outer(normal.imag, np.cos(angles)) - np.outer(normal.real, np.sin(angles))
        return along * self._before * (self.h / 2)


def solve_as_published(
    scene: Scene,
    parameter: float | None = None,
    *,
    N: int = 90,
    shear: Shear = "element",
    gradients: Gradients = "exact",
    ftol: float = 1e-9,
    start: Start | Array = "arc",
) -> PublishedResult:
    """One pose by the published scheme and SciPy's SLSQP: raw node angles, no check of what comes back.

    Parameters
    ----------
    scene, parameter, N, shear
        As for `PublishedProblem`.
    gradients
        "exact", or SciPy's own "differences".
    ftol
        SLSQP's, absolute, in units of EI(0) / L.
    start
        "arc", the least one that clears the object, so that it lands on the right side; the "straight" finger; or
        unknowns (n,), as those of a neighbouring pose.

    Raises
    ------
    ValueError
        As for `PublishedProblem`, and for a word that is none of those above.

    Source: C.-C. Lan and K.-M. Lee, section 2.5 and section 3.
    """
    _check_word("gradients", gradients, Gradients)
    if isinstance(start, str):
        _check_word("start", start, Start)
    problem = PublishedProblem(scene, parameter, N, shear)
    began = time.process_time()
    solution = minimize(
        x0=problem.start(start) if isinstance(start, str) else start,
        method="SLSQP",
        options={"ftol": ftol, "maxiter": _MOST_ITERATIONS},
        **_arguments(problem, gradients),
    )
    seconds = time.process_time() - began
    forces = [f(solution.x, solution.multipliers) for f in (problem.force_on_object, problem.moment_force)]
    return PublishedResult(
        force_on_object=(forces[0].real, forces[0].imag),
        moment_force=(forces[1].real, forces[1].imag),
        energy=float(solution.fun) * problem.sections.energy_scale,
        success=bool(solution.success),
        iterations=int(solution.nit),
        evaluations=int(solution.nfev),
        seconds=seconds,
        x=solution.x,
        multipliers=solution.multipliers,
    )


def _arguments(problem: PublishedProblem, gradients: Gradients) -> dict[str, Any]:
    if gradients == "exact":
        constraint = {"type": "ineq", "fun": problem.gaps, "jac": problem.gap_gradients}
        return {"fun": problem.energy, "jac": True, "constraints": [constraint]}
    return {"fun": lambda x: problem.energy(x)[0], "constraints": [{"type": "ineq", "fun": problem.gaps}]}


def _midway(nodal: Array) -> Array:
    """Means of neighbours (eq 13)."""
    return (nodal[:-1] + nodal[1:]) / 2


def _lead_face(jaw: Jaw, thickness: float, N: int) -> Complex:
    """N + 1 points in the jaw frame, in m, from the vertex furthest from the axis to the furthest along the finger."""
    vertices = np.array([complex(x, y) for x, y in jaw.polygon(thickness)])
    apex, end = vertices[np.argmax(np.abs(vertices.imag))], vertices[np.argmax(vertices.real)]
    return np.linspace(apex, end, N + 1)


def _check(scene: Scene, parameter: float | None, N: int, shear: Shear) -> None:
    _check_word("shear", shear, Shear)
    if N < 2:
        raise ValueError(f"N must be at least 2 elements; got {N!r}")
    if (parameter is None) != (scene.motion is None):
        raise ValueError(f"parameter must be given where the scene has a motion, and only there; got {parameter!r}")
    bent = placed(scene.finger).body.rest_curvature
    if bent:
        raise ValueError(f"rest_curvature must be left out (the paper's finger is straight at rest); got {bent!r}")
    law = placed(scene.finger).body.material.law
    if law != "linear":
        raise ValueError(f"law must be 'linear', as the paper's is; got {law!r}")
    if scene.approach[1] < 0:
        raise ValueError(f"approach must come from below: contact is on the lower face; got {scene.approach!r}")


def _check_word(name: str, value: str, words: Any) -> None:
    if value not in get_args(words):
        raise ValueError(f"{name} must be one of {', '.join(get_args(words))}; got {value!r}")
