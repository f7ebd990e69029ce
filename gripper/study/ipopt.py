"""The paper's discrete problem by CasADi and IPOPT: sparse, with exact Hessians. Needs the extra ``gripper[casadi]``.

The same nodes, trapezoids and contact nodes as :mod:`gripper.study.published` with one shear angle an element; only
that the nodes' positions are unknowns too, tied by equations, so that IPOPT's matrices are sparse.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.objects import ImplicitSurface
from gripper.scene import Scene
from gripper.study.outcome import NoOutcomeError
from gripper.study.published import PublishedProblem

_QUIET = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-9, "max_iter": 500}}


def available() -> bool:
    """Whether CasADi is installed."""
    return importlib.util.find_spec("casadi") is not None


class Transcription:
    """The problem of one pose, built for IPOPT.

    Parameters
    ----------
    scene
        Of one pose.
    N
        Elements, and contact nodes.
    shear
        Whether there is shear.

    Raises
    ------
    NoOutcomeError
        An object without an expression g(x, y).
    ValueError
        As `PublishedProblem`.
    """

    def __init__(self, scene: Scene, N: int, *, shear: bool) -> None:
        casadi: Any = importlib.import_module("casadi")
        self.problem = problem = PublishedProblem(scene, None, N, "element" if shear else "none")
        body = problem.obstacle.body
        if not isinstance(body, ImplicitSurface):
            raise NoOutcomeError(f"{type(body).__name__} has no expression g(x, y) that CasADi could differentiate")
        psi, gamma = casadi.SX.sym("psi", N), casadi.SX.sym("gamma", N if shear else 0)
        x, y = casadi.SX.sym("x", N), casadi.SX.sym("y", N)
        slide = gamma if shear else casadi.SX.zeros(N)
        before = casadi.vertcat(0, psi[:-1])
        ties = []
        for node, turn in ((x, casadi.cos), (y, casadi.sin)):
            step = (turn(before + slide) + turn(psi + slide)) * (problem.h / 2)
            ties.append(node - casadi.vertcat(0, node[:-1]) - step)
        bend = psi - before
        energy = casadi.dot(casadi.DM(problem.EI / problem.h), bend**2) / 2
        if shear:
            energy += casadi.dot(casadi.DM(problem.GA * problem.h), gamma**2) / 2
        points = _points(casadi, problem, psi, x, y)
        gaps = _gaps(casadi, problem, body, *points)
        self.ties, self.count = 2 * N, int(gaps.shape[0])
        unknowns = casadi.vertcat(psi, gamma, x, y)
        nlp = {"x": unknowns, "f": energy, "g": casadi.vertcat(*ties, gaps)}
        self._solver = casadi.nlpsol("finger", "ipopt", nlp, _QUIET)
        self._upper = np.concatenate([np.zeros(self.ties), np.full(self.count, np.inf)])

    def nodes(self, x: Array) -> Complex:
        """The axis at the nodes after the clamp (N,), for the paper's unknowns."""
        _, start, stop = self.problem.angles(x)
        axis: Complex = np.cumsum(np.exp(1j * start) + np.exp(1j * stop)) * (self.problem.h / 2)
        return axis

    def solve(self, start: Array) -> tuple[Array, Array, int, int]:
        """From the paper's unknowns (n,): unknowns, the gaps' multipliers, iterations, evaluations of the gaps.

        Raises
        ------
        NoOutcomeError
            IPOPT does not report success.
        """
        nodes = self.nodes(start)
        found = self._solver(
            x0=np.concatenate([start, nodes.real, nodes.imag]), lbg=np.zeros(self.ties + self.count), ubg=self._upper
        )
        stats = self._solver.stats()
        if not stats["success"]:
            raise NoOutcomeError(f"IPOPT: {stats['return_status']}")
        x = np.array(found["x"]).ravel()[: self.problem.size]
        multipliers = -np.array(found["lam_g"]).ravel()[self.ties :]
        return x, multipliers, int(stats["iter_count"]), int(stats["n_call_nlp_g"])


def _points(casadi: Any, problem: PublishedProblem, psi: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """The contact nodes (eqs 4, 5, 15)."""
    if problem.jaw is None:
        half = casadi.DM(problem.half_thickness)
        return x + half * casadi.sin(psi), y - half * casadi.cos(psi)
    a, b = casadi.DM(problem.jaw.real), casadi.DM(problem.jaw.imag)
    c, s = casadi.cos(psi[-1]), casadi.sin(psi[-1])
    return x[-1] + a * c - b * s, y[-1] + a * s + b * c


def _gaps(casadi: Any, problem: PublishedProblem, body: ImplicitSurface, x: Any, y: Any) -> Any:
    """G over L at points of the clamp's frame (eq 16)."""
    frame, length = problem.obstacle.frame, problem.obstacle.length
    c, s = float(np.cos(frame.angle)), float(np.sin(frame.angle))
    away = (x - frame.origin.real) * length, (y - frame.origin.imag) * length
    symbols = sympy.symbols("x y", real=True)
    names = [{"Abs": casadi.fabs, "Max": casadi.fmax, "Min": casadi.fmin}, casadi]
    g = sympy.lambdify(symbols, body.g(*symbols), modules=names)
    return g(c * away[0] + s * away[1], c * away[1] - s * away[0]) / length
