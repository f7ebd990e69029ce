"""A sweep as a figure: one of the summary's numbers over one or two keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gripper.expression.vocabulary import UNITS
from gripper.plot.style import COLUMN, FORCE, INCH, INK, STRAIN, Picture, styled
from gripper.results.summary import QUANTITIES

if TYPE_CHECKING:
    from gripper.sweep.run import Sweep

_FEW = 4  # values of a second key that curves can be told apart for
_TICKS = 7  # values of a key that each have their tick
_SIZE = (COLUMN / INCH, 0.8 * COLUMN / INCH)


def drawn(sweep: Sweep, quantity: str) -> Figure:
    """Draw a number over one key as a curve, over two as a map; variants without an answer are crosses.

    A second key of few values gives a curve for each.

    Raises
    ------
    ValueError
        The sweep has more than two keys.
    """
    if len(sweep.plan.over) > 2:
        raise ValueError(f"a sweep must have one key or two to be drawn; got {', '.join(sweep.plan.keys)}")
    with styled():
        figure = Picture(figsize=_SIZE, layout="constrained")
        axes = figure.add_subplot()
        unit = QUANTITIES.get(quantity, "")
        label = f"{quantity.replace('_', ' ')}{unit and f' ({unit})'}"
        few = len(sweep.plan.over) == 1 or len(sweep.plan.over[1][1]) <= _FEW
        draw = _curves if few else _map
        draw(figure, axes, sweep, quantity, label)
    return figure


def _values(sweep: Sweep, quantity: str) -> np.ndarray:
    """The numbers, NaN where there are none, in the plan's shape."""
    numbers = [np.nan if number is None else number for number in sweep.numbers(quantity)]
    return np.array(numbers, dtype=float).reshape([len(values) for _, values in sweep.plan.over])


def _places(sweep: Sweep, i: int) -> np.ndarray:
    """The values of the i-th key, in its unit."""
    unit = sweep.plan.units[i]
    return np.array(sweep.plan.over[i][1]) / (UNITS[unit] if unit else 1.0)


def _label(sweep: Sweep, i: int) -> str:
    """The name of the i-th axis: its key and unit."""
    unit = sweep.plan.units[i].replace("um", "\N{MICRO SIGN}m")
    return f"{sweep.plan.keys[i]}{unit and f' ({unit})'}"


def _curves(figure: Figure, axes: Axes, sweep: Sweep, quantity: str, label: str) -> None:
    (_, places), *second = sweep.plan.over
    order = np.argsort(places)
    x, values = _places(sweep, 0)[order], _values(sweep, quantity)[order].reshape(len(places), -1)
    names = [f"{other} = {sweep.plan.shown(1, value)}" for other, others in second for value in others]
    for y, name in zip(values.T, names or [""], strict=True):
        axes.plot(x, y, marker="o", label=name or None)
    rows, columns = np.nonzero(np.isnan(values))
    if rows.size:
        bottom = 0.03 + 0.03 * columns
        axes.plot(x[rows], bottom, "x", color=INK, transform=axes.get_xaxis_transform(), label="no answer")
    if rows.size or names:
        figure.legend(loc="outside lower center", ncols=2)
    axes.set(xlabel=_label(sweep, 0), ylabel=label)
    axes.margins(x=0.02)
    axes.locator_params(axis="x", nbins=4)  # more would run into one another: 0.00225


def _map(figure: Figure, axes: Axes, sweep: Sweep, quantity: str, label: str) -> None:
    """Colours where both keys are even or not: each variant has a cell around it."""
    x, y = _places(sweep, 0), _places(sweep, 1)
    columns, rows = np.argsort(x), np.argsort(y)
    values = _values(sweep, quantity)[np.ix_(columns, rows)].T
    x_places, y_places = x[columns], y[rows]
    cells = axes.pcolormesh(_edges(x_places), _edges(y_places), np.ma.masked_invalid(values), cmap=STRAIN)
    figure.colorbar(cells, ax=axes, label=label)
    if min(values.shape) > 2 and np.isfinite(values).all() and np.ptp(values) > 0:
        lines = axes.contour(x_places, y_places, values, colors=INK, linewidths=0.5)
        axes.clabel(lines, fontsize=5.5)
    missing = np.argwhere(np.isnan(values))
    axes.plot(x_places[missing[:, 1]], y_places[missing[:, 0]], "x", color=FORCE, linestyle="none")
    axes.set(xlabel=_label(sweep, 0), ylabel=_label(sweep, 1))
    for axis, places in ((axes.xaxis, x_places), (axes.yaxis, y_places)):
        if places.size <= _TICKS:
            axis.set_ticks(places, [f"{place:.4g}" for place in places])


def _edges(places: np.ndarray) -> np.ndarray:
    """Edges of cells around places: half-way between them."""
    if places.size == 1:
        half = 0.5 * abs(places[0]) or 0.5
        return np.array([places[0] - half, places[0] + half])
    middles = (places[1:] + places[:-1]) / 2
    return np.concatenate([[2 * places[0] - middles[0]], middles, [2 * places[-1] - middles[-1]]])
