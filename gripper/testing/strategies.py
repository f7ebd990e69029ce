"""Hypothesis strategies of what a scene is made of: numbers of few digits, so that a failing scene can be copied."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

from gripper.fingers import Finger, Jaw, Material
from gripper.objects import Object
from gripper.pose import Placed
from gripper.registry import load


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """A thousand numbers, evenly spread from low to high, rounded to four significant digits of the range."""
    digits = 4 - math.ceil(math.log10(max(high - low, 1e-300)))
    return st.integers(0, 1000).map(lambda i: round(low + (high - low) * i / 1000, digits))


def materials() -> st.SearchStrategy[Material]:
    """Rubbers, plastics and metals, in plane stress or strain."""
    return st.builds(
        Material,
        youngs_modulus=st.sampled_from([1e6, 4.8e6, 2.6e9, 7e10]),
        poisson_ratio=numbers(0.2, 0.48),
        plane=st.sampled_from(["stress", "strain"]),
    )


def jaws(length: float = 1.0) -> st.SearchStrategy[Jaw]:
    """Hooks on either side, and blocks, for a finger of this length, in m."""
    hooks = st.builds(
        load("gripper.jaws", "triangle"),
        length=numbers(0.05 * length, 0.4 * length),
        lead_angle=numbers(0.3, 1.2),
        return_angle=numbers(0.5, 1.6),
        side=st.sampled_from(["lower", "upper"]),
    )
    block = load("gripper.jaws", "polygon")
    blocks = st.builds(
        lambda a, b: block(vertices=((-0.01 * length, -b), (a, -b), (a, b), (-0.01 * length, b))),
        numbers(0.05 * length, 0.3 * length),
        numbers(0.06 * length, 0.2 * length),
    )
    return st.one_of(hooks, blocks)


def fingers(length: float = 1.0, jaw: st.SearchStrategy[Any] | None = None) -> st.SearchStrategy[Finger]:
    """Thin to thick, even and tapered, of this length, in m; without jaw unless a strategy is given."""
    common: dict[str, Any] = {
        "length": st.just(length),
        "width": numbers(0.02 * length, 0.2 * length),
        "material": materials(),
        "jaw": st.none() if jaw is None else jaw,
    }
    even = st.builds(load("gripper.fingers", "uniform"), thickness=numbers(0.01 * length, 0.2 * length), **common)
    tapered = st.builds(
        load("gripper.fingers", "tapered"),
        base_thickness=numbers(0.04 * length, 0.2 * length),
        tip_thickness=numbers(0.02 * length, 0.15 * length),
        **common,
    )
    return st.one_of(even, tapered)


def objects(size: float = 0.3) -> st.SearchStrategy[Object]:
    """Bounded objects of about this size, in m: round, cornered, hollow, in two pieces, notched and rounded."""
    lengths = numbers(0.2 * size, size)
    circle, ellipse, polygon = (load("gripper.objects", name) for name in ("circle", "ellipse", "polygon"))
    radii = st.lists(lengths, min_size=3, max_size=7)
    stars = st.builds(lambda radii, turn: polygon(vertices=_star(radii, turn)), radii, numbers(0, 6))
    plain = st.one_of(
        st.builds(circle, radius=lengths),
        st.builds(ellipse, semi_axes=st.tuples(lengths, lengths)),
        st.builds(
            load("gripper.objects", "superellipse"), semi_axes=st.tuples(lengths, lengths), exponent=numbers(2, 8)
        ),
        stars,
    )
    union, difference, grown = (load("gripper.objects", name) for name in ("union", "difference", "grown"))
    return st.one_of(
        plain,
        st.builds(lambda one, other: union(parts=(one, other)), plain, placed(plain, size)),
        st.builds(lambda one, r: difference(parts=(one, circle(radius=0.1 * r).at(x=0.1 * r))), plain, lengths),
        st.builds(lambda one, d: grown(part=one, distance=0.2 * d), stars, lengths),
    )


def placed(bodies: st.SearchStrategy[Object], reach: float = 1.0) -> st.SearchStrategy[Placed[Object]]:
    """Bodies anywhere within reach of the origin, in m, turned anyhow."""
    return st.builds(
        lambda body, x, y, angle: body.at(x=x, y=y, angle=angle),
        bodies,
        numbers(-reach, reach),
        numbers(-reach, reach),
        numbers(-math.pi, math.pi),
    )


def _star(radii: list[float], turn: float) -> tuple[tuple[float, float], ...]:
    angles = [turn + 2 * math.pi * i / len(radii) for i in range(len(radii))]
    return tuple((round(r * math.cos(a), 6), round(r * math.sin(a), 6)) for r, a in zip(radii, angles, strict=True))
