"""A finger's segments: where they lie, their Gauss points, and what makes |z|^2 / 2 of the strain fields' energy."""

from __future__ import annotations

import functools

import numpy as np
from scipy.linalg.lapack import dpotrf, dtrtri

from gripper.arrays import Array, Index
from gripper.beam.legendre import rule
from gripper.beam.sections import Sections


class Segments:
    """Segments with the Gauss points of fields of an order, and these fields' whitening.

    Parameters
    ----------
    sections
        The finger's dimensionless sections.
    breaks
        Ends of the segments, from 0 to 1.
    order
        Of the fields, which the number of Gauss points follows from.
    fields
        How many: kappa; kappa and gamma; kappa, gamma and eps.
    modes
        The most that a field on them has.
    """

    def __init__(self, sections: Sections, breaks: tuple[float, ...], order: int, fields: int, modes: int) -> None:
        self.sections, self.breaks, self.order, self.modes = sections, breaks, order, modes
        self.count, self.fields = len(breaks) - 1, fields
        self.rule = rule(order, modes)
        self.marks = np.array(breaks)
        self.starts = self.marks[:-1]
        self.lengths = self.marks[1:] - self.starts
        self.halves = self.lengths / 2
        self.gauss = (self.starts[:, None] + self.lengths[:, None] * self.rule.along).ravel()
        self.weights = self.halves[:, None] * self.rule.weights  # the length that each Gauss point stands for
        self.upper, self.whiten = self._whitening()

    def _whitening(self) -> tuple[Array, Array]:
        """Cholesky factors of each field's stiffness on each segment, and their inverses: (fields, segments, m, m).

        Those of fewer modes are their upper left corners. LAPACK's own routines: numpy's take twice as long.
        """
        shape = self.fields, self.count, self.modes, self.modes
        stiffness = np.array(self.sections.stiffness(self.gauss)[: self.fields]).reshape(self.fields, self.count, -1)
        grams = ((stiffness * self.halves[:, None]) @ self.rule.grams).reshape(-1, self.modes, self.modes)
        factors, inverses = [], []
        for gram in grams:
            upper, failed = dpotrf(gram.T)
            if failed:
                raise np.linalg.LinAlgError("a segment has no stiffness")
            factors.append(upper)
            inverses.append(dtrtri(upper)[0])
        return np.array(factors).reshape(shape), np.array(inverses).reshape(shape)


@functools.lru_cache(maxsize=64)
def turning(segments: int, fields: int, order: int, modes: int) -> Array:
    """What the fields' coefficients on each segment turn r' by at the Gauss points, (fields, segments, g, m).

    Of kappa by half the segment's length; with stretch only kappa turns it.
    """
    own = rule(order, modes)
    turns = np.zeros((fields, segments, segments, own.x.size, modes))
    each = np.arange(segments)
    turns[0, :, :, :, 0] = 2 * np.tri(segments, k=-1).T[:, :, None]  # all that lies beyond a segment
    turns[0, each, each] = own.integrals
    if fields == 2:
        turns[1, each, each] = own.modes
    return turns.reshape(fields, segments, -1, modes)


@functools.cache
def shared(segments: int, fields: int, modes: int, first: int, base: bool) -> Index:
    """Which unknowns are of the first modes: of all segments and fields, and the base's."""
    numbers = np.arange(segments * fields * modes).reshape(segments, fields, modes)
    return np.append(numbers[:, :, :first].ravel(), [numbers.size] if base else []).astype(np.intp)
