"""Nodes of the finger, structured along and across, with its jaw."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import sympy

from gripper.fingers import Finger, S
from gripper.objects import Array
from gripper.verify.outline import Index, Outline, convex, jaw_polygon

JawKind = Literal["rigid", "elastic"]
_SAME = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """Nodes, elements and outline.

    Node i (2 across + 1) + j is the j-th from the lower face in column i; the first column is the clamp. Behind the
    grid's nodes come the corners and middles of a rigid jaw, which no element holds.

    Parameters
    ----------
    nodes
        (n, 2), in m.
    elements
        Nine nodes each (e, 9), nodes across running fastest.
    across
        Nodes of a column.
    tip
        The node on the neutral axis at s = L.
    jawed
        Whether the finger has a jaw.
    rigid
        Nodes that move as one rigid body; empty without a rigid jaw.
    outline
        Edges, counter-clockwise, and convex corners.
    size
        Of an element along the finger, in m.
    width
        b(s), in m.
    """

    nodes: Array
    elements: Index
    across: int
    tip: int
    jawed: bool
    rigid: Index
    outline: Outline
    size: float
    width: Callable[[Array], Array]


def profile(expression: sympy.Expr) -> Callable[[Array], Array]:
    """A function of s (n,), in m, of an expression in `S`."""
    function = sympy.lambdify([S], sympy.sympify(expression), "numpy")
    return lambda s: np.broadcast_to(np.asarray(function(s), dtype=float), np.shape(s)).copy()


def stations(marks: tuple[float, ...], elements: int) -> Array:
    """Columns of nodes (2 n + 1,), in m, evenly between marks, an element's end at each mark.

    The number of elements n is as asked, but for rounding between the marks: at least one between two of them.
    """
    lengths = np.diff(marks)
    counts = np.maximum(1, np.round(elements * lengths / lengths.sum())).astype(int)
    parts = [np.linspace(a, b, 2 * n + 1)[1:] for a, b, n in zip(marks, marks[1:], counts, strict=False)]
    return np.concatenate([[marks[0]], *parts])


def build(finger: Finger, elements: tuple[int, int], jaw: JawKind = "rigid") -> Mesh:
    """Mesh a finger and its jaw.

    Parameters
    ----------
    finger
        What to mesh.
    elements
        Their number along the finger and across.
    jaw
        "rigid": it moves with the end face. "elastic": of the finger's own material; the finger's section goes on
        above it to its far end.

    Raises
    ------
    ValueError
        A profile that is not positive, or a jaw that "elastic" cannot mesh.
    """
    b, L, (n_along, n_across) = profile(finger.b(S)), finger.length, elements
    s, lower, upper = _faces(finger, n_along)
    end, below = len(s) - 1, True
    polygon = jaw_polygon(finger, float(upper[-1] - lower[-1]))
    if polygon is not None and jaw == "elastic":
        below = bool(np.mean(polygon[:, 1]) < 0)
        s, lower, upper = _with_jaw(polygon, s, lower, upper, L / n_along, below)
    m = 2 * n_across + 1
    y = lower[:, None] + (upper - lower)[:, None] * np.linspace(0, 1, m)
    nodes = np.stack([np.broadcast_to(s[:, None], y.shape), y], axis=-1).reshape(-1, 2)
    grid = np.arange(len(nodes)).reshape(len(s), m)
    outline = Outline(grid, nodes, end, below)
    rigid = np.empty(0, dtype=np.intp)
    if polygon is not None and jaw == "rigid":
        nodes = np.concatenate([nodes, outline.add_rigid(polygon + np.array([L, 0.0]), len(nodes))])
        rigid = np.concatenate([grid[-1], np.arange(grid.size, len(nodes))])
    elif polygon is not None:
        outline.corners += _points_of_jaw(polygon, s[end:] - L, grid[end:, 0 if below else -1])
    patches = np.lib.stride_tricks.sliding_window_view(grid, (3, 3))[::2, ::2].reshape(-1, 9)
    return Mesh(
        nodes=nodes,
        elements=patches,
        across=m,
        tip=int(grid[end, n_across]),
        jawed=polygon is not None,
        rigid=rigid,
        outline=outline,
        size=L / n_along,
        width=lambda at: b(np.clip(at, 0, L)),
    )


def _points_of_jaw(polygon: Array, x: Array, line: Index) -> list[int]:
    """Nodes of a face, from the jaw's heel on (c,), that stand at convex corners of the jaw but its first and last."""
    inner = (polygon[:, 0] > 0) & (polygon[:, 0] < polygon[:, 0].max())
    pointed = polygon[convex(polygon) & inner, 0]
    return [int(node) for node in line[np.isclose(x[:, None], pointed, rtol=_SAME).any(axis=1)]]


def _faces(finger: Finger, n_along: int) -> tuple[Array, Array, Array]:
    """Stations (c,), and y of both faces there (c,), in m."""
    w, L = profile(finger.w(S)), finger.length
    s = stations((0.0, *sorted(k for k in finger.kinks() if 0 < k < L), L), n_along)
    for name, values in (("thickness", w(s)), ("width", profile(finger.b(S))(s))):
        if not np.all(np.isfinite(values) & (values > 0)):
            raise ValueError(f"{name} must be positive along the finger, in m; got {float(values.min())!r}")
    return s, -w(s) / 2, w(s) / 2


def _with_jaw(
    polygon: Array, s: Array, lower: Array, upper: Array, size: float, below: bool
) -> tuple[Array, Array, Array]:
    """Stations and faces of finger and jaw in one piece."""
    sign, face = (-1, lower[-1]) if below else (1, upper[-1])
    chain = polygon[np.argsort(polygon[:, 0], kind="stable")]
    on_face = np.abs(chain[[0, -1], 1] - face) < _SAME * abs(face)
    rising = np.all(np.diff(chain[:, 0]) > 0) and np.all(sign * (chain[1:-1, 1] - face) > 0)
    if chain[0, 0] != 0 or not on_face.all() or not rising:
        raise ValueError(
            "jaw must stand on the finger's face from its end onwards, without undercut, to be meshed; "
            f"got {polygon.tolist()}"
        )
    more = stations(tuple(chain[:, 0]), max(2, round(chain[-1, 0] / size)))[1:]
    edge, other = np.interp(more, *chain.T), np.full(len(more), -face)
    faces = (edge, other) if below else (other, edge)
    return np.append(s, s[-1] + more), np.append(lower, faces[0]), np.append(upper, faces[1])
