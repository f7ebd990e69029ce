"""How many designs a search solves with exact gradients, and how many with differences.

On both optimisations of the gallery, from the same start to the same tolerance; every design that is followed counts.
Beside this project's search, with exact gradients, forward and central differences: SciPy's SLSQP with its own forward
differences, on the same limits, and levels above and below the same curves. A step of 1e-6 of a number's range is what
its differences need: the default, 1.5e-8, is too near to what a peak is located to.
"""

import numpy as np
from scipy.optimize import minimize

import gripper as gr
from gallery import constant_force, optimal_hook
from gripper.parameters import number, replaced
from gripper.sensitivity.curves import curve

CASES = {
    "optimal_hook": (optimal_hook, {"minimize": "insertion_force"}),
    "constant_force": (constant_force, {"flatten": "force_on_object"}),
}


def asked(result: gr.Result, goal: dict[str, str]) -> list[tuple[int, float]]:
    """Of a result what shall be below an upper level (0), above a lower one (1, negative), and below 0 (2)."""
    ((sense, quantity),), summary = goal.items(), result.summary()
    forces, limits = curve(result, quantity), result.scene.limits.bounds if result.scene.limits else ()
    forces = forces / forces.mean() if sense == "flatten" else [*forces, getattr(summary, quantity)]
    over = [(getattr(summary, name[4:]) / bound - 1, 1 if name.startswith("max") else -1) for name, bound in limits]
    lower = [(1, -force) for force in forces] if sense == "flatten" else []
    return [*((0, force) for force in forces), *lower, *((2, by * sign) for by, sign in over)]


def slsqp(scene: gr.Scene, free: dict[str, tuple[float, float]], goal: dict[str, str]) -> list[float]:
    """Objectives of all designs that SLSQP solves, in order; infinite where there is no answer or a limit is broken."""
    (low, high), n, known, tried = np.array(list(free.values())).T, len(free), {}, []

    def rows(x: np.ndarray) -> np.ndarray:
        if (key := x.tobytes()) not in known:
            result = gr.trace(replaced(scene, dict(zip(free, (low + (high - low) * x).tolist(), strict=True))))
            known[key] = np.array([value for _, value in asked(result, goal)]) if not result.failed else 10 + 0 * zero
            tried.append(
                np.inf if result.failed or max(known[key][kinds == 2], default=0) > 1e-4 else level(known[key])
            )
        return known[key]

    def level(values: np.ndarray) -> float:
        return float(sum(max(values[kinds == kind], default=0) for kind in (0, 1)))

    kinds, zero = (np.array(column) for column in zip(*asked(gr.trace(scene), goal), strict=True))
    first = (np.array([number(scene, key) for key in free]) - low) / (high - low)
    levels, cost = np.eye(3)[kinds], np.array([*[0.0] * n, 1.0, 1.0 * (1 in kinds), 100.0])
    minimize(
        lambda y: float(cost @ y),
        [*first, *(max(zero[kinds == kind], default=0) for kind in range(3))],
        jac=lambda y: cost,
        method="SLSQP",
        bounds=[(0, 1)] * n + [(None, None)] * 2 + [(0, None)],
        constraints=[{"type": "ineq", "fun": lambda y: levels @ y[n:] - rows(y[:n])}],
        options={"ftol": scene.tolerance, "maxiter": 40, "eps": 1e-6},
    )
    return tried


def main() -> dict[tuple[str, str], tuple[int, float]]:
    """Print, and return, for each case and search how many designs it solves and what it ends at."""
    found = {}
    for name, (case, goal) in CASES.items():
        for gradients in ("exact", "forward", "central"):
            best = gr.optimize(case.scene, case.FREE, starts=1, gradients=gradients, **goal)
            found[name, gradients] = best.evaluations, best.objective
        tried = slsqp(case.scene, case.FREE, goal)
        found[name, "SLSQP, forward"] = len(tried), min(tried)
    print("| design | free numbers | search | designs solved | objective |\n|---|---|---|---|---|")
    for (name, search), (designs, objective) in found.items():
        print(f"| {name} | {len(CASES[name][0].FREE)} | {search} | {designs} | {objective:.4f} |")
    return found


if __name__ == "__main__":
    main()
