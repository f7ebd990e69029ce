"""What is foretold of designs near one: its rows as straight lines, curved where curves are flattened, and cuts.

A cut is the straight line of a design that was tried in vain: where a peak passes from one pose to another, or a
contact from edge to corner, a row has a kink, of which one design's slopes know one side only (a bundle method; Makela
2002, Survey of bundle methods for nonsmooth optimization).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from gripper.arrays import Array
from gripper.optimize.rows import LIMIT, LOWER, UPPER, Rows


@dataclass(frozen=True, eq=False)
class Weights:
    """What is minimised: the objective, and at a price the worst violation of a limit."""

    objective: float = 1.0
    violation: float = 20.0

    def merit(self, rows: Rows) -> float:
        """Of a design."""
        return self.objective * rows.objective + self.violation * rows.excess


@dataclass(frozen=True, eq=False)
class Model:
    """Rows foretold around a design.

    Parameters
    ----------
    x
        The design (n,).
    rows
        Of it.
    bends
        Second derivatives of its rows, as far as they are known (m, n, n).
    cuts
        Other designs, and their rows.
    """

    x: Array
    rows: Rows
    bends: Array
    cuts: tuple[tuple[Array, Rows], ...] = ()

    def bent(self, x: Array, rows: Rows) -> Array:
        """Second derivatives that also know the slopes of another design: Powell's symmetric update of Broyden's."""
        step = x - self.x
        length = step @ step
        missing = rows.slopes - self.rows.slopes - self.bends @ step
        along = (missing @ step)[:, None, None] * np.outer(step, step)
        both = missing[:, :, None] * step + step[:, None] * missing[:, None, :]
        found: Array = self.bends + both / length - along / length**2
        return found

    def best(self, reach: float, weights: Weights) -> tuple[Array, float]:
        """The design foretold as the best with each number within reach, and the gain that is foretold."""
        kinds, values, slopes, bends = self._near(reach)
        levels, n = np.eye(3)[kinds], len(self.x)
        cost = np.array([*[0.0] * n, weights.objective, weights.objective, weights.violation])
        begin = np.array([*self.x, self.rows.highest(UPPER), self.rows.highest(LOWER), self.rows.excess])

        def left(y: Array) -> Array:
            step = y[:n] - self.x
            found: Array = levels @ y[n:] - values - (slopes + bends @ step / 2) @ step
            return found

        lower = (None, None) if (kinds == LOWER).any() else (0.0, 0.0)
        answer = minimize(
            lambda y: (float(cost @ y), cost),
            begin,
            jac=True,
            method="SLSQP",
            bounds=[*self._box(reach), (None, None), lower, (0.0, None)],
            constraints=[
                {"type": "ineq", "fun": left, "jac": lambda y: np.hstack([-slopes - bends @ (y[:n] - self.x), levels])}
            ],
            options={"ftol": 1e-10, "maxiter": 200},
        )
        return np.clip(answer.x[:n], 0.0, 1.0), float(cost @ (begin - answer.x))

    def _box(self, reach: float) -> list[tuple[float, float]]:
        return [(max(0.0, at - reach), min(1.0, at + reach)) for at in self.x.tolist()]

    def _near(self, reach: float) -> tuple[Array, Array, Array, Array]:
        """Kinds, values, slopes and bends of the rows and cuts that may decide within reach."""
        parts = [(self.rows.kinds, self.rows.values, self.rows.slopes, self.bends)]
        for place, rows in self.cuts:
            here = np.minimum(rows.values + rows.slopes @ (self.x - place), self.rows.values)
            parts.append((rows.kinds, here, rows.slopes, np.zeros_like(self.bends)))
        kinds, values, slopes, bends = (np.concatenate(part) for part in zip(*parts, strict=True))
        change = reach * np.abs(slopes).sum(axis=1) + reach**2 * np.abs(bends).sum(axis=(1, 2)) / 2
        floors = [float(np.max((values - change)[kinds == kind], initial=least)) for kind, least in _FLOORS]
        decides = values + change >= np.array(floors)[kinds]
        return kinds[decides], values[decides], slopes[decides], bends[decides]


_FLOORS = ((UPPER, -np.inf), (LOWER, -np.inf), (LIMIT, 0.0))
"""Of each kind of row, what lies below which decides nothing."""
