"""The extreme value beside an extreme sample."""

from __future__ import annotations

from gripper.arrays import Array

_EVEN = 1e-6  # relative: how much the two steps beside a sample may differ


def vertex(x: Array, y: Array, i: int, *, beyond: bool = False) -> tuple[float, float]:
    """Where the parabola through sample i and its neighbours has its vertex, and its value there.

    The sample itself where it has no two neighbours at even distances, or lies on no bend.

    Parameters
    ----------
    x, y
        Places and values of the samples, (k,).
    i
        The extreme one.
    beyond
        Whether a neighbour may be as extreme: the vertex then lies up to one step aside, or further (and is none).
    """
    if not 0 < i < x.size - 1:
        return float(x[i]), float(y[i])
    step, fall, rise = float(x[i + 1] - x[i]), float(y[i] - y[i - 1]), float(y[i] - y[i + 1])
    even = step > 0 and abs(float(x[i] - x[i - 1]) - step) <= _EVEN * step
    if beyond:
        if not even or fall + rise <= 0:
            return float("inf"), float(y[i])
    elif not even or fall * rise <= 0:
        return float(x[i]), float(y[i])
    off = (fall - rise) / (2 * (fall + rise))
    return float(x[i]) + off * step, float(y[i]) + (fall - rise) * off / 4
