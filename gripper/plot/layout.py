"""Where things stand in a figure of given width: measured, so that nothing overlaps, and the height follows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from gripper.plot.draw import Key
from gripper.plot.style import wrapped
from gripper.plot.units import labelled

_MARGIN, _GAP = 0.06, 0.1
"""Free room around the figure and between its parts, in inches."""
_BAR = 0.08
"""Height of the bar of colours, in inches."""
_MARKS = 0.6
"""Part of a key's width that its marks take beside the bar."""
KEY_WIDTH = 2.1
"""Least width of the key, in inches."""


class Row(NamedTuple):
    """Axes side by side: their height by their width, or, where ``inches`` is given, that height."""

    axes: Sequence[Axes]
    aspect: float = 1.0
    inches: float | None = None


class Overhang(NamedTuple):
    """How far numbers, labels and title stand out of axes, in inches."""

    left: float
    bottom: float
    right: float
    top: float


def overhang(ax: Axes) -> Overhang:
    """Measure it. A title counts by its height only."""
    figure = ax.get_figure(root=True)
    assert figure is not None, "these axes belong to no figure"
    inside, dpi = ax.get_window_extent(), figure.dpi
    boxes = [box for box in (ax.xaxis.get_tightbbox(), ax.yaxis.get_tightbbox(), inside) if box is not None]
    boxes += [box for each in ax.child_axes if (box := each.get_tightbbox()) is not None]
    title = ax.title.get_window_extent().height + 4.0 if ax.get_title() else 0.0
    return Overhang(
        left=(inside.x0 - min(box.x0 for box in boxes)) / dpi,
        bottom=(inside.y0 - min(box.y0 for box in boxes)) / dpi,
        right=(max(box.x1 for box in boxes) - inside.x1) / dpi,
        top=(max(box.y1 for box in boxes) - inside.y1 + title) / dpi,
    )


class Legend:
    """Colours and marks of a key, as a part of a figure: one above the other, or side by side."""

    def __init__(self, figure: Figure, key: Key, width: float) -> None:
        entries = key.handles()
        self.width, self.stacked = width, width < 2.1 * KEY_WIDTH
        self.bar, self.marks = figure.add_axes((0, 0, 1, 0.1)), figure.add_axes((0, 0, 1, 0.1))
        figure.colorbar(key.colours(), cax=self.bar, orientation="horizontal")
        self.bar.set_xlabel(labelled("bending strain of the faces", key.strain))
        self.marks.axis("off")
        self.legend = self.marks.legend(handles=entries, loc="center", ncols=max(1, (len(entries) + 1) // 2))
        if self.stacked or self.legend.get_window_extent().width > _MARKS * width * figure.dpi:
            self.legend = self.marks.legend(handles=entries, loc="center")

    @property
    def heights(self) -> tuple[float, float]:
        """Of the bar with its numbers, and of the marks, in inches."""
        dpi = self.legend.figure.dpi
        return _BAR + overhang(self.bar).bottom, self.legend.get_window_extent().height / dpi

    @property
    def height(self) -> float:
        """In inches."""
        return sum(self.heights) + _GAP if self.stacked else max(self.heights)

    def place(self, page: _Page, left: float, top: float) -> None:
        """Put it there: inches from the figure's left and upper edges."""
        bar, marks = self.heights
        if self.stacked:
            page.put(self.bar, left + 0.08 * self.width, top, 0.84 * self.width, _BAR)
            page.put(self.marks, left, top + bar + _GAP, self.width, marks)
        else:
            page.put(self.bar, left + 0.02 * self.width, top, 0.36 * self.width, _BAR)
            page.put(self.marks, left + (1 - _MARKS) * self.width, top, _MARKS * self.width, self.height)


class _Page(NamedTuple):
    """A figure in inches, from its upper left corner."""

    figure: Figure
    width: float
    height: float

    def put(self, ax: Axes, left: float, top: float, width: float, height: float) -> None:
        bottom = self.height - top - height
        ax.set_position((left / self.width, bottom / self.height, width / self.width, height / self.height))


def _heading(figure: Figure, title: str) -> tuple[Text, float]:
    """Set the title, in as many lines as it needs; where what is below it may begin, in inches."""
    heading = figure.suptitle(title, parse_math=False, va="top")
    extent = heading.get_window_extent()
    if extent.width > 0.97 * figure.bbox.width:
        heading.set_text(wrapped(title, 0.95 * figure.bbox.width / extent.width))
        extent = heading.get_window_extent()
    return heading, _MARGIN + (extent.height / figure.dpi + _GAP) * bool(title)


def arrange(
    figure: Figure, rows: Sequence[Row], title: str, legend: Legend | None = None, *, after: int = 0, spare: int = 0
) -> None:
    """Set the figure's height and the place of all that it holds.

    Parameters
    ----------
    figure
        Its width stays.
    rows
        From top to bottom; axes of one column stand under each other.
    title
        Of the figure, above all.
    legend, after
        The key, below this row; with ``spare`` in that row's last empty columns instead.
    spare
        Number of empty columns that the key takes; 0 for a place of its own.
    """
    width = figure.get_figwidth()
    heading, top = _heading(figure, title)
    out = [[overhang(ax) for ax in row.axes] for row in rows]
    lefts, panel = _columns(out, width)
    tops, heights, beneath = [], [], 0.0
    for i, (row, line) in enumerate(zip(rows, out, strict=True)):
        tops.append(top + max(each.top for each in line))
        heights.append(panel * row.aspect if row.inches is None else row.inches)
        top = tops[-1] + heights[-1] + max(each.bottom for each in line) + _GAP
        if legend and i == after and not spare:
            beneath, top = top, top + legend.height + _GAP
    page = _Page(figure, width, top - _GAP + _MARGIN)
    figure.set_size_inches(page.width, page.height)
    heading.set_y(1 - _MARGIN / page.height)
    for row, start, height in zip(rows, tops, heights, strict=True):
        for ax, left in zip(row.axes, lefts, strict=False):
            page.put(ax, left, start, panel, height)
    if legend and spare:
        legend.place(page, lefts[-spare], tops[after] + heights[after] / 4)
    elif legend:
        legend.place(page, (width - legend.width) / 2, beneath)


def _columns(out: list[list[Overhang]], width: float) -> tuple[list[float], float]:
    """Left edges of the columns' axes, and their one width."""
    columns = max(len(line) for line in out)
    sides = [[line[c] for line in out if c < len(line)] for c in range(columns)]
    before = [max(each.left for each in side) for side in sides]
    behind = [max(each.right for each in side) for side in sides]
    panel = (width - 2 * _MARGIN - sum(before) - sum(behind) - _GAP * (columns - 1)) / columns
    return [_MARGIN + sum(before[: c + 1]) + sum(behind[:c]) + c * (panel + _GAP) for c in range(columns)], panel
