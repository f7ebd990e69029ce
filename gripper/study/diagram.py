"""The studies' figures: error against run time, and extreme scenes with their verdicts."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from gripper.plot import INCH, PAGE, Picture, styled
from gripper.study.outcome import QUANTITIES
from gripper.study.work import Work, WorkPrecision

_WORDS = {
    "force": "error of the force vector, relative",
    "energy": "error of the energy, relative",
    "place": "error of the place of contact, by L",
    "shape": "error of the shape, by L",
    "depth": "deepest penetration, by L",
}
_MOST = 3.0
_LOOKS = {
    "paper as published": ("#D55E00", "s"),
    "paper as published, exact gradients": ("#D55E00", "v"),
    "paper, shear cured": ("#CC79A7", "D"),
    "paper, shear cured, exact gradients": ("#CC79A7", "P"),
    "gripper, p = 0": ("#56B4E9", "^"),
    "gripper": ("#0072B2", "o"),
    "CasADi/IPOPT, the paper's problem": ("#009E73", "X"),
    "CasADi/IPOPT as a whole (model built)": ("#E69F00", "*"),
}
"""Okabe & Ito's colours and a mark for each method; schemes that differ in their gradients alone share a colour."""


def diagram(study: WorkPrecision) -> Figure:
    """Draw a work-precision study: error across, CPU time up, both logarithmic; lower left is better.

    Filled marks are cold poses, hollow ones warm; bars reach to the worst of the shifts.
    """
    looks = {work.method: _LOOKS[work.method] for work in study.works}
    with styled():
        figure = Picture(figsize=(PAGE / INCH, 1.3 * PAGE / INCH), layout="constrained")
        axes = figure.subplots(3, 2).ravel()
        for ax, quantity in zip(axes, QUANTITIES, strict=False):
            for name, look in looks.items():
                _series(ax, [work for work in study.works if work.method == name], study, quantity, *look)
            _furnish(ax, study, quantity)
        _legend(axes[-1], looks, study)
        figure.suptitle(study.scene.title, parse_math=False)
    return figure


def _series(ax: Any, works: list[Work], study: WorkPrecision, quantity: str, colour: str, mark: str) -> None:
    for kind, face in (("cold", colour), ("warm", "white")):
        known = [(w, 1e3 * t) for w in works if w.median and (t := getattr(w, kind)) is not None]
        x = [study.told(w.median)[quantity] for w, _ in known]
        y = [t for _, t in known]
        ax.plot(x, y, color=colour, linewidth=0.9 if kind == "cold" else 0.5, linestyle="-" if kind == "cold" else ":")
        ax.plot(x, y, mark, color=colour, markerfacecolor=face, markersize=3.5, markeredgewidth=0.7, linewidth=0)
        if kind == "cold":
            for i, (work, t) in enumerate(known):
                ax.plot([x[i], study.told(work.worst)[quantity]], [t, t], color=colour, linewidth=0.9, alpha=0.5)
                if i in (0, len(known) - 1):
                    _label(ax, work.point, (x[i], t), colour, coarsest=i == 0)
    for work in (w for w in works if w.failures or w.warm_failure):
        ax.plot([_MOST], [1e3 * (work.cold or work.warm or 1e-3)], "x", color=colour, clip_on=False)


def _label(ax: Any, point: str, place: tuple[float, float], colour: str, *, coarsest: bool) -> None:
    """Name a method's ends: the finest above its point; the coarsest below it, or of N elements beside it."""
    symbol, text = point.split(" = ")
    look: dict[str, Any] = {"xytext": (0, -4 if coarsest else 3), "ha": "center", "va": "top" if coarsest else "bottom"}
    if coarsest and symbol == "N":  # other methods' points are above and below it
        look = {"xytext": (4, 0), "va": "center"}
    ax.annotate(text, place, textcoords="offset points", fontsize=6, color=colour, **look)


def _furnish(ax: Any, study: WorkPrecision, quantity: str) -> None:
    least = min((study.told(work.median)[quantity] for work in study.works if work.median), default=1.0)
    ax.set(xscale="log", yscale="log", xlabel=_WORDS[quantity], ylabel="CPU time a pose (ms)")
    ax.set_xlim(min(least, study.uncertainty[quantity]) / 5, _MOST)
    ax.margins(y=0.1)
    ax.grid(alpha=0.3, linewidth=0.4)
    ax.axvspan(study.uncertainty[quantity] / 1e6, study.uncertainty[quantity], color="0.85", linewidth=0, zorder=0)


def _legend(ax: Any, looks: dict[str, tuple[str, str]], study: WorkPrecision) -> None:
    ax.axis("off")
    for name, (colour, mark) in looks.items():
        ax.plot([], [], mark, linestyle="-", color=colour, label=name)
    ax.plot([], [], "ko", markerfacecolor="white", linestyle=":", label="hollow: warm, from the neighbouring pose")
    ax.plot([], [], "kx", linewidth=0, label="at the right edge: failed, warm or at a shift")
    ax.fill_between([], [], color="0.85", label="the reference's own uncertainty")
    ax.legend(loc="upper left")
    import_s, compile_s = study.start_up
    notes = (
        "numbers: of elements, or the tolerance asked for",
        f"marks: median over {study.shifts} shifts of the object, bars to the worst,",
        "none below ten times the reference's uncertainty",
        f"CPU time: median of {study.repeats} after a warm-up, one thread;",
        f"not in it: import {import_s:.2f} s, compiling {1e3 * compile_s:.0f} ms",
        *study.notes,
    )
    ax.text(0.02, 0.0, "\n".join(notes), transform=ax.transAxes, fontsize=6.5, va="bottom")
