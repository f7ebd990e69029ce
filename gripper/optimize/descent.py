"""From one start to where nothing more is foretold to be gained."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.optimize.evaluation import SLACK, Evaluator
from gripper.optimize.model import Model, Weights
from gripper.optimize.rows import LIMIT, Rows

_REACH = 0.3  # of a number's range: how far the first step may go
_LEAST = 1e-5  # the same: nearer designs are not told apart
_PATIENCE = 6  # steps that together must gain something
_CUTS = 3  # designs tried in vain that are kept
_DEARER = 10.0  # the price of a violation, where limits can be kept and the first price did not do it
_LEAST_VIOLATION = Weights(objective=0.0, violation=1.0)


@dataclass
class Descent:
    """A search from one start: each step goes to where a model foretells the best design within its reach.

    What was foretold and what came of it decide how far the next step may go (a trust region; Conn, Gould and Toint
    2000, Trust-Region Methods, chapter 11).

    Parameters
    ----------
    evaluator
        Of designs.
    sharp
        Gain of the objective, relative, below which the search ends.
    most
        Steps, at most.
    """

    evaluator: Evaluator
    sharp: float
    most: int
    _left: int = 0

    def __call__(self, x: Array) -> str:
        """Search from a design; how it ended."""
        before, self._left = len(self.evaluator.history), self.most
        rows, trial = self.evaluator.at(x)
        if rows is None:
            return f"no answer: {trial.reason}"
        model, weights = Model(x, rows, np.zeros((*rows.slopes.shape, len(x)))), Weights()
        for weights in _prices():
            model, said = self._ended(model, weights)
            if model.rows.excess <= SLACK:
                break
            model, least = self._ended(model, _LEAST_VIOLATION)
            if model.rows.excess > SLACK:
                said = f"no design near keeps all limits; {least}"
                break
        return f"{said}, {len(self.evaluator.history) - before} designs"

    def _ended(self, model: Model, weights: Weights) -> tuple[Model, str]:
        """Step by step, until nothing is gained."""
        reach, merits = _REACH, [weights.merit(model.rows)]
        while self._left > 0:
            x, gain = model.best(reach, weights)
            sharp = self.sharp * (weights.violation if model.rows.excess > SLACK else 1.0)
            if gain < sharp:
                return model, f"nothing more to gain ({max(gain, 0.0):.0e} foretold)"
            model, reach = self._stepped(model, weights, x, gain, reach)
            merits.append(weights.merit(model.rows))
            if reach < _LEAST or (len(merits) > _PATIENCE and merits[-1 - _PATIENCE] - merits[-1] < sharp):
                return model, f"nothing gained by the last {min(_PATIENCE, len(merits) - 1)} steps"
        return model, f"stopped after {self.most} steps"

    def _stepped(self, model: Model, weights: Weights, x: Array, gain: float, reach: float) -> tuple[Model, float]:
        """Go to a design if it is better; the model there, and how far the next step may go."""
        self._left -= 1
        step = float(np.max(np.abs(x - model.x)))
        rows, _ = self.evaluator.at(x)
        if rows is None:
            return model, 0.35 * step
        share = (weights.merit(model.rows) - weights.merit(rows)) / gain
        bends = self._bends(model, x, rows)
        if share > 0.05:
            model = Model(x, rows, bends, model.cuts)
        else:
            model = replace(model, bends=bends, cuts=((x, rows), *model.cuts)[:_CUTS])
        if share < 0.25:
            reach = (0.4 if share > 0.05 else 0.7) * step
        elif share > 0.7 and step > 0.9 * reach:
            reach *= 2
        near = tuple(cut for cut in model.cuts if np.max(np.abs(cut[0] - model.x)) < 2 * reach)
        return replace(model, cuts=near), reach

    def _bends(self, model: Model, x: Array, rows: Rows) -> Array:
        """Second derivatives: of curves that are to be flat. Peaks have kinks, and straight lines in logarithms do."""
        if self.evaluator.goal.sense != "flatten":
            return model.bends
        smooth = (rows.kinds != LIMIT)[:, None, None]
        return np.where(smooth, model.bent(x, rows), 0.0)


def _prices() -> Iterator[Weights]:
    """Prices of a violation, one after the other."""
    first = Weights()
    for power in range(3):
        yield replace(first, violation=first.violation * _DEARER**power)
