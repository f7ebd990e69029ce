"""The one style of all figures: widths, type, colours, and files that repeat bit for bit."""

from __future__ import annotations

import io
import os
import textwrap
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib.style
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLUMN, PAGE = 0.085, 0.180
"""Widths of figures, in m: one column of a journal, and its page."""
INCH = 0.0254

FORCE, SECOND, THIRD, FOURTH = "#D55E00", "#0072B2", "#009E73", "#CC79A7"
"""Colours that the colour-blind tell apart (Okabe & Ito 2008)."""
JAW, OBJECT, INK = "#A6A6A6", "#E4E4E4", "#222222"
"""What is rigid is grey."""
STRAIN = "YlGnBu"
"""Colours of strain: pale at rest, and darker with it, on a screen as on a grey print."""

_STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same everywhere
    "font.size": 7.5,
    "axes.titlesize": 7.5,
    "axes.labelsize": 7.5,
    "figure.titlesize": 8.5,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "hatch.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.0,
    "axes.prop_cycle": cycler(color=[SECOND, FORCE, THIRD, FOURTH, INK]),
    "savefig.dpi": 200,
    "svg.hashsalt": "gripper",  # else the names inside an SVG are drawn by lot
}
_UNDATED = {"svg": {"Date": None}, "svgz": {"Date": None}, "pdf": {"CreationDate": None}}


def styled() -> AbstractContextManager[None]:
    """Draw in this style, whatever the user's own settings are: ``with styled(): ...``."""
    return matplotlib.style.context(["default", _STYLE])


class Picture(Figure):
    """A figure in this style, which a notebook shows by itself, whatever backend it has chosen."""

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write it, and its folder; the same figure gives the same SVG, PDF or PNG, bit for bit."""
        ending = ""
        if isinstance(fname, (str, os.PathLike)):
            Path(fname).parent.mkdir(parents=True, exist_ok=True)
            ending = Path(fname).suffix[1:]
        kind = str(options.get("format") or ending).lower()
        metadata = _UNDATED.get(kind, {}) | (options.pop("metadata", None) or {})
        with styled():
            super().savefig(fname, metadata=metadata, **options)

    def _repr_png_(self) -> bytes:
        data = io.BytesIO()
        self.savefig(data, format="png")
        return data.getvalue()


def figure_of(ax: Axes) -> Figure:
    """Give the figure that holds these axes."""
    figure = ax.get_figure(root=True)
    assert figure is not None, "these axes belong to no figure"
    return figure


def wrapped(text: str, part: float) -> str:
    """Break a text into lines of about this part of its length."""
    return textwrap.fill(text, max(20, int(part * len(text))))
