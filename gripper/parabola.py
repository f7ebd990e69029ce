"""The extreme value beside an extreme sample."""

from __future__ import annotations

from gripper.arrays import Array

_EVEN = 1e-6  # relative: how much the two steps beside a sample may differ


def vertex(x: Array, y: Array, i: int) -> tuple[float, float]:
    """Where the parabola through sample i and its neighbours has its vertex, and its value there.

    The sample itself where it has no two neighbours at even distances, or lies on no bend.

    Parameters
    ----------
    x, y
        Places and values of the samples, (k,).
    i
        The extreme one.
    """
    if not 0 < i < x.size - 1:
        return float(x[i]), float(y[i])
    step, fall, rise = float(x[i + 1] - x[i]), float(y[i] - y[i - 1]), float(y[i] - y[i + 1])
    if step <= 0 or abs(float(x[i] - x[i - 1]) - step) > _EVEN * step or fall * rise <= 0:
        return float(x[i]), float(y[i])
    off = (fall - rise) / (2 * (fall + rise))
    return float(x[i]) + off * step, float(y[i]) + (fall - rise) * off / 4
