"""The robustness study's figure: every scene with its verdict and its time, a panel for each map."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gripper.plot import INCH, PAGE, Picture, styled
from gripper.study.robustness import Judged

_LOOKS = {"solved": ("#0072B2", "o"), "refused": ("#E69F00", "^"), "wrong": ("#D55E00", "X")}
_COLUMNS, _ROW = 3, 1.5  # inches
_DECADES = 30.0  # ratio of the largest value to the least from which an axis is logarithmic


def verdicts(found: Sequence[Judged]) -> Figure:
    """Draw scenes: CPU time, with that of all judges, over what their map varies, or over their numbers.

    Raises
    ------
    ValueError
        No scene.
    """
    families = list(dict.fromkeys(judged.family for judged in found))
    if not families:
        raise ValueError("found must hold at least one scene; got none")
    rows = math.ceil((len(families) + 1) / _COLUMNS)
    with styled():
        figure = Picture(figsize=(PAGE / INCH, _ROW * rows), layout="constrained")
        axes = figure.subplots(rows, _COLUMNS, squeeze=False, sharey=True).ravel()
        for i, (ax, family) in enumerate(zip(axes, families, strict=False)):
            _map(ax, family, [judged for judged in found if judged.family == family])
            ax.set_ylabel("" if i % _COLUMNS else "CPU time (s)")
        for ax in axes[len(families) :]:
            ax.axis("off")
        for verdict, (colour, mark) in _LOOKS.items():
            number = sum(judged.verdict == verdict for judged in found)
            axes[-1].plot([], [], mark, color=colour, linewidth=0, label=f"{verdict}: {number}")
        axes[-1].legend(loc="center", title=f"{len(found)} scenes")
    return figure


def _map(ax: Axes, family: str, found: list[Judged]) -> None:
    name, values = _varied(found)
    for verdict, (colour, mark) in _LOOKS.items():
        mine = [(x, each.seconds) for x, each in zip(values, found, strict=True) if each.verdict == verdict]
        ax.plot([x for x, _ in mine], [t for _, t in mine], mark, color=colour, linewidth=0, zorder=2 + (mark != "o"))
    ax.set(title=family, xlabel=name, yscale="log")
    if min(values) > 0 and max(values) > _DECADES * min(values):
        ax.set_xscale("log")


def _varied(found: list[Judged]) -> tuple[str, list[float]]:
    """What the map varies and its values, where its scenes are called so; else their numbers."""
    parts = [judged.name.partition(" = ") for judged in found]
    if len({name for name, *_ in parts}) == 1 and all(_number(value) is not None for *_, value in parts):
        return parts[0][0], [float(value) for *_, value in parts]
    return "scene", [float(i) for i in range(len(found))]


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
