"""The tornado chart: what each number with a tolerance changes, the largest on top."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from gripper.plot.style import COLUMN, FORCE, INCH, INK, SECOND, Picture, styled
from gripper.results.summary import QUANTITIES

if TYPE_CHECKING:
    from gripper.bands import Band

_BAR, _REST = 0.22, 0.9  # in: a bar, and what is around all of them


def drawn(band: Band) -> Figure:
    """Draw the changes of one number: at the upper ends of the others' bands and at the lower ones."""
    order = np.argsort(np.abs(band.changes))
    changes = np.array(band.changes)[order]
    unit = QUANTITIES[band.quantity]
    with styled():
        figure = Picture(figsize=(COLUMN / INCH, _REST + _BAR * changes.size), layout="constrained")
        axes = figure.add_subplot()
        places = np.arange(changes.size)
        axes.barh(places, changes, left=band.value, color=FORCE, height=0.7, label="upper end of its band")
        axes.barh(places, -changes, left=band.value, color=SECOND, height=0.7, label="lower end")
        axes.axvline(band.value, color=INK, linewidth=0.6)
        axes.set_yticks(places, [band.keys[i] for i in order])
        value = f"{band.value:.4g} {unit}".strip()
        title = f"{value}: $\\pm$ {band.worst:.2g} at worst, $\\pm$ {band.likely:.2g} likely"
        axes.set(xlabel=f"{band.quantity.replace('_', ' ')}{unit and f' ({unit})'}", title=title)
        figure.legend(loc="outside lower center", ncols=2)
    return figure
