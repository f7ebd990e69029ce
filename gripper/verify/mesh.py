"""Nodes of the finger, structured along and across, and the edges of its real outline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import sympy
from numpy.typing import NDArray

from gripper.fingers import Finger, S
from gripper.objects import Array

Index = NDArray[np.intp]
Part = Literal["lower", "upper", "tip", "jaw"]
PARTS: tuple[Part, ...] = ("lower", "upper", "tip", "jaw")
JawKind = Literal["rigid", "elastic"]


@dataclass(frozen=True, eq=False)
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
    edges
        Three nodes each (k, 3), counter-clockwise around finger and jaw.
    part
        Of each edge: an index into `PARTS`, (k,).
    along
        What each edge's nodes are called in a report (k, 3): s, or the arc length along the jaw's outline, in m.
    corners
        Nodes at convex corners of the outline.
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
    edges: Index
    part: Index
    along: Array
    corners: Index
    size: float
    width: Callable[[Array], Array]


def profile(expression: sympy.Expr) -> Callable[[Array], Array]:
    """A function of s (n,), in m, of an expression in `S`."""
    function = sympy.lambdify([S], sympy.sympify(expression), "numpy")
    return lambda s: np.broadcast_to(np.asarray(function(s), dtype=float), np.shape(s)).copy()


def stations(marks: tuple[float, ...], elements: int) -> Array:
    """Columns of nodes (2 n + 1,), in m, evenly between marks, an element's end at each mark.

    The number of elements is at least one between two marks, else as given.
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
    n_along, n_across = elements
    w, b, L = profile(finger.w(S)), profile(finger.b(S)), finger.length
    marks = (0.0, *sorted(k for k in finger.kinks() if 0 < k < L), L)
    s = stations(marks, n_along)
    for name, values in (("thickness", w(s)), ("width", b(s))):
        if not np.all(np.isfinite(values) & (values > 0)):
            raise ValueError(f"{name} must be positive along the finger, in m; got {values.min()!r}")
    lower, upper = -w(s) / 2, w(s) / 2
    end = len(s) - 1
    size = L / n_along
    polygon = _polygon(finger, float(w(np.array([L]))[0]))
    if polygon is not None and jaw == "elastic":
        s, lower, upper = _with_jaw(polygon, s, lower, upper, size)
    m = 2 * n_across + 1
    share = np.linspace(0, 1, m)
    y = lower[:, None] + (upper - lower)[:, None] * share
    nodes = np.stack([np.broadcast_to(s[:, None], y.shape), y], axis=-1).reshape(-1, 2)
    grid = np.arange(len(nodes)).reshape(len(s), m)
    outline = _Outline(grid, s)
    rigid = np.empty(0, dtype=np.intp)
    if polygon is not None and jaw == "rigid":
        nodes = outline.add_jaw(nodes, polygon + [L, 0])
        rigid = np.concatenate([grid[-1], np.arange(grid.size, len(nodes))])
    patches = np.lib.stride_tricks.sliding_window_view(grid, (3, 3))[::2, ::2].reshape(-1, 9)

    def width(at: Array) -> Array:
        return b(np.minimum(at, L))

    return Mesh(nodes, patches, m, int(grid[end, n_across]), polygon is not None, rigid, *outline.arrays(), size, width)


class _Outline:
    """Edges in counter-clockwise order, collected part by part."""

    def __init__(self, grid: Index, s: Array) -> None:
        tip = np.full(grid.shape[1], s[-1])
        self._edges, self._parts, self._along = [], [], []  # type: list[Index], list[int], list[Array]
        self._add(0, grid[:, 0], s)
        self._add(2, grid[-1], tip)
        self._add(1, grid[::-1, -1], s[::-1])
        self._corners = [int(grid[-1, 0]), int(grid[-1, -1])]

    def _add(self, part: int, nodes: Index, along: Array) -> None:
        window = np.lib.stride_tricks.sliding_window_view
        self._edges.append(window(nodes, 3)[::2])
        self._along.append(window(along, 3)[::2])
        self._parts += [part] * len(self._edges[-1])

    def add_jaw(self, nodes: Array, polygon: Array) -> Array:
        """Append a rigid polygon's corners and middles to the nodes, and its edges to the outline."""
        following = np.roll(polygon, -1, axis=0)
        first, k = len(nodes), len(polygon)
        ring = np.stack([polygon, (polygon + following) / 2], axis=1).reshape(-1, 2)
        ids = first + np.append(np.arange(2 * k), 0)
        lengths = np.linalg.norm(following - polygon, axis=1)
        arc = np.append(0.0, np.cumsum(np.repeat(lengths / 2, 2)))
        self._add(3, ids, arc)
        before = polygon - np.roll(polygon, 1, axis=0)
        after = following - polygon
        convex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0
        self._corners += [int(first + 2 * i) for i in np.flatnonzero(convex)]
        return np.concatenate([nodes, ring])

    def arrays(self) -> tuple[Index, Index, Array, Index]:
        """Edges, their parts, their nodes' places, and the corners."""
        edges = np.concatenate(self._edges)
        return edges, np.array(self._parts), np.concatenate(self._along), np.array(self._corners)


def _polygon(finger: Finger, thickness: float) -> Array | None:
    """The jaw's corners (k, 2), counter-clockwise, in the jaw frame, in m."""
    if finger.jaw is None:
        return None
    polygon = np.array(finger.jaw.polygon(thickness), dtype=float)
    x, y = polygon.T
    area = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    return np.roll(polygon[::-1], 1, axis=0) if area < 0 else polygon


def _with_jaw(polygon: Array, s: Array, lower: Array, upper: Array, size: float) -> tuple[Array, Array, Array]:
    """Stations and faces of finger and jaw in one piece."""
    below = bool(np.mean(polygon[:, 1]) < 0)
    face = lower[-1] if below else upper[-1]
    chain = polygon[np.argsort(polygon[:, 0], kind="stable")]
    flat = np.abs(chain[[0, -1], 1] - face) < 1e-9 * abs(face)
    if len(chain) != 3 or not flat.all() or chain[0, 0] != 0 or not 0 < chain[1, 0] < chain[2, 0]:
        raise ValueError(
            "jaw must be a triangle on the finger's face that starts at its end, to be meshed; got another"
        )
    more = stations(tuple(chain[:, 0]), max(2, round(chain[-1, 0] / size)))[1:]
    edge = np.interp(more, chain[:, 0], chain[:, 1])
    other = np.full(len(more), upper[-1] if below else lower[-1])
    faces = (edge, other) if below else (other, edge)
    return np.append(s, s[-1] + more), np.append(lower, faces[0]), np.append(upper, faces[1])
