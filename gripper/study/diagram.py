"""The work-precision diagram: error across, CPU time up, both logarithmic; lower left is better."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from gripper.study.outcome import QUANTITIES
from gripper.study.precision import Work, WorkPrecision

_WORDS = {
    "force": "error of the force vector, relative",
    "energy": "error of the energy, relative",
    "place": "error of the place of contact, by L",
    "shape": "error of the shape, by L",
    "depth": "deepest penetration, by L",
}
_LEAST, _MOST = 1e-13, 3.0
_COLOURS = ("#b03a2e", "#e08e79", "#8e5ea2", "#c39bd3", "#2e86c1", "#117a3d", "#7f6a00", "#d4ac0d")
_MARKS = "svDP^oX*"


def diagram(study: WorkPrecision) -> Figure:
    """Draw a study: filled marks are cold poses, hollow ones warm; bars reach to the worst of the shifts."""
    figure = Figure(figsize=(15, 9), layout="constrained")
    axes = figure.subplots(2, 3).ravel()
    names = list(dict.fromkeys(work.method for work in study.works))
    for ax, quantity in zip(axes, QUANTITIES, strict=False):
        for i, name in enumerate(names):
            mine = [work for work in study.works if work.method == name]
            _series(ax, mine, quantity, _COLOURS[i % len(_COLOURS)], _MARKS[i % len(_MARKS)])
        _furnish(ax, study, quantity)
    _legend(axes[-1], names, study)
    figure.suptitle(study.scene.title)
    return figure


def _series(ax: Any, works: list[Work], quantity: str, colour: str, mark: str) -> None:
    for kind, face in (("cold", colour), ("warm", "white")):
        known = [(w, 1e3 * t) for w in works if w.median and (t := getattr(w, kind)) is not None]
        x = [max(w.median[quantity], _LEAST) for w, _ in known]
        y = [t for _, t in known]
        ax.plot(x, y, color=colour, lw=1 if kind == "cold" else 0.5, ls="-" if kind == "cold" else ":")
        ax.plot(x, y, mark, color=colour, markerfacecolor=face, ms=6, ls="")
        if kind == "cold":
            for (work, t), place in zip(known, x, strict=True):
                ax.plot([place, max(work.worst[quantity], _LEAST)], [t, t], color=colour, lw=1.2, alpha=0.5)
                text = work.point.split(" = ")[1]
                ax.annotate(text, (place, t), xytext=(3, 4), textcoords="offset points", fontsize=7, color=colour)
    for work in (w for w in works if w.failures or w.warm_failure):
        height = 1e3 * (work.cold or work.warm or 1e-3)
        ax.plot([_MOST], [height], "x", color=colour, ms=8, mew=2, clip_on=False)


def _furnish(ax: Any, study: WorkPrecision, quantity: str) -> None:
    ax.set(xscale="log", yscale="log", xlabel=_WORDS[quantity], ylabel="CPU ms a pose")
    ax.set_xlim(_LEAST / 2, _MOST)
    ax.grid(alpha=0.3)
    if quantity != "depth":
        ax.axvspan(_LEAST / 2, study.uncertainty[quantity], color="0.7", alpha=0.5, lw=0)


def _legend(ax: Any, names: list[str], study: WorkPrecision) -> None:
    ax.axis("off")
    for i, name in enumerate(names):
        ax.plot([], [], _MARKS[i % len(_MARKS)], ls="-", color=_COLOURS[i % len(_COLOURS)], label=name)
    ax.plot([], [], "ko", markerfacecolor="white", ls=":", label="hollow: warm, from the neighbouring pose's answer")
    ax.plot([], [], "kx", ls="", mew=2, label="at the right edge: failed, warm or at a place of the object")
    ax.fill_between([], [], color="0.7", alpha=0.5, label="the reference's own uncertainty")
    ax.legend(loc="upper left", frameon=False, fontsize=9)
    notes = (
        "labels: number of elements, or the tolerance asked for",
        f"marks: median over {study.shifts} places of the object, bars to the worst",
        f"CPU time: median of {study.repeats} after a warm-up, one thread",
        f"not in it: import {study.start_up[0]:.2f} s, compiling finger and object {1e3 * study.start_up[1]:.0f} ms",
        *study.notes,
    )
    ax.text(0.02, 0.02, "\n".join(notes), transform=ax.transAxes, fontsize=8, va="bottom")
