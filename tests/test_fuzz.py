"""Anything may stand in a scene file: it is a scene, or one line that says what is wrong.

``HYPOTHESIS_PROFILE=long python -m pytest tests/test_fuzz.py`` looks at thousands of new examples of each.
"""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gripper.cli.run import solved
from gripper.describe import describe as resolved
from gripper.expression import parse
from gripper.expression.vocabulary import FUNCTIONS, UNITS
from gripper.scenefile import SceneFileError, dumps, loads
from gripper.scenefile.toml import written

short = settings(derandomize=True, deadline=None, max_examples=25, suppress_health_check=list(HealthCheck))
searched = settings() if "HYPOTHESIS_PROFILE" in os.environ else short

GALLERY = Path(__file__).parent.parent / "gallery"
SHAPES = (
    'surface = "circle"\nradius = "8.9 mm"',
    'surface = "ellipse"\nsemi_axes = ["9 mm", 0.004]',
    'surface = "conic"\ncoefficients = [1, 1, 0, 0, 0, -0.0001]',
    'surface = "polygon"\nvertices = [[0, 0], ["1 cm", 0], [0.01, 0.01], [0, 0.01]]',
    'surface = "spline"\npoints = [[0.01, 0], [0, 0.01], [-0.01, 0], [0, -0.01]]',
    'surface = "implicit"\nexpression = "x**4 + y**4 - (1 cm)**4"\nextent = 0.02',
)
MICRO = (GALLERY / "micro_assembly.toml").read_text()
TABLES = [tomllib.loads((GALLERY / "rotating_finger.toml").read_text())] + [
    tomllib.loads(MICRO) | {"object": tomllib.loads(shape) | {"pose": {"x": "x_o", "y": "-10.5 mm"}}}
    for shape in SHAPES
]
KEYS = sorted({key for table in TABLES for sub in (table, *table.values()) if isinstance(sub, dict) for key in sub})

words = st.sampled_from(
    [*FUNCTIONS, *UNITS, "pi", "x", "y", "s", "x_o", "__import__", "lambda", "1", "0", "2.5", "1e308"]
)
signs = st.sampled_from(["(", ")", "+", "-", "*", "/", "**", ",", " ", "^", ".", "'", "[", "\n", "0.5"])
expressions = st.lists(st.one_of(words, signs), max_size=12).map("".join) | st.recursive(
    words,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/,"), inner).map(" ".join),
        st.tuples(inner, inner).map(lambda pair: f"({pair[0]})**({pair[1]})"),
        st.tuples(st.sampled_from(sorted(FUNCTIONS)), inner).map(lambda pair: f"{pair[0]}({pair[1]})"),
        st.tuples(st.sampled_from(["min", "max", "atan2"]), inner, inner).map(lambda t: f"{t[0]}({t[1]}, {t[2]})"),
    ),
    max_leaves=8,
)
scalars = st.one_of(
    st.floats(),
    st.integers(),
    st.booleans(),
    expressions,
    st.text(max_size=8),
    st.sampled_from([0, -1, 1e300, 1e-300, 1e31, 1e-31, 2**70, "1 mm", "20 deg", "circle", "polygon", "shear", []]),
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(KEYS), inner, max_size=3),
    max_leaves=6,
)


def paths(table: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every place in nested tables and arrays."""
    items = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    return [path for key, inner in items for path in [(*at, key), *paths(inner, (*at, key))]]


def changed(table: Any, path: tuple[Any, ...], change: Any) -> Any:
    """A copy in which the container of a place is changed by ``change(container, key)``."""
    copy = dict(table) if isinstance(table, dict) else list(table)
    if len(path) == 1:
        change(copy, path[0])
    else:
        copy[path[0]] = changed(copy[path[0]], path[1:], change)
    return copy


@st.composite
def mutations(draw: st.DrawFn) -> dict[str, Any]:
    """A valid scene with keys dropped, renamed, copied elsewhere, or holding something else."""
    table = draw(st.sampled_from(TABLES))
    for _ in range(draw(st.integers(1, 3))):
        places = paths(table)
        if not places:
            break
        path, kind = draw(st.sampled_from(places)), draw(st.sampled_from(["drop", "rename", "copy", "set", "scale"]))
        value, name = draw(values), draw(st.one_of(st.sampled_from(KEYS), st.text(min_size=1, max_size=6)))

        def change(container: Any, key: Any, kind: str = kind, value: Any = value, name: str = name) -> None:
            old = container[key]
            if kind in ("drop", "rename"):
                del container[key]
            if kind in ("rename", "copy") and isinstance(container, dict):
                container[name] = old
            if kind == "copy" and isinstance(container, list):
                container.append(old)
            if kind == "scale" and isinstance(old, float):
                container[key] = old * 10.0 ** (7 * len(name) - 21)
            elif kind in ("set", "scale"):
                container[key] = value

        table = changed(table, path, change)
    return table


def read(text: str) -> None:
    """Read a scene; what is refused is refused in one line, what is read is written and read again the same."""
    try:
        scene = loads(text, "fuzz.toml")
    except SceneFileError as error:
        message = str(error)
        assert message.startswith("fuzz.toml: ")
        assert len(message.splitlines()) == 1 and len(message) < 1000
        return
    assert resolved(loads(dumps(scene))) == resolved(scene)


@searched
@given(mutations())
def test_a_scene_that_was_changed_anywhere_is_a_scene_or_refused_in_one_line(table: dict[str, Any]) -> None:
    read(written(table))


@searched
@given(mutations())
def test_what_can_be_read_is_solved_or_refused_in_one_line(table: dict[str, Any]) -> None:
    motion = table.get("motion")
    if isinstance(motion, dict) and "poses" in motion:
        table = table | {"motion": motion | {"poses": 2}}
    try:
        scene = loads(written(table), "fuzz.toml")
        if scene.motion is None or len(scene.motion.values) < 9:
            solved(scene, Path("fuzz.toml"), None)
    except SceneFileError as error:
        assert len(str(error).splitlines()) == 1


@searched
@given(st.text(max_size=200) | st.lists(st.sampled_from(MICRO.splitlines()), max_size=30).map("\n".join))
def test_any_text_is_a_scene_or_refused_in_one_line(text: str) -> None:
    read(text)


@searched
@given(st.data())
def test_a_text_that_was_changed_anywhere_is_a_scene_or_refused_in_one_line(data: st.DataObject) -> None:
    text = MICRO
    for _ in range(data.draw(st.integers(1, 4))):
        i = data.draw(st.integers(0, len(text)))
        j = data.draw(st.integers(i, min(i + 12, len(text))))
        text = text[:i] + data.draw(st.text(max_size=4) | st.sampled_from(list("[]{}=.'\"#\n9e-"))) + text[j:]
    read(text)


@searched
@given(expressions)
def test_an_expression_anywhere_is_a_scene_or_refused_in_one_line(text: str) -> None:
    for key, header in (("x", "object.pose"), ("width", "finger"), ("lead_angle", "finger.jaw")):
        table = tomllib.loads(MICRO)
        inner = table
        for part in header.split("."):
            inner = inner[part]
        inner[key] = text
        read(written(table))


@searched
@given(expressions)
def test_an_expression_is_a_finite_real_value_or_a_value_error(text: str) -> None:
    try:
        value = parse(text, ("x", "y", "s"))
    except ValueError as error:
        assert len(str(error).splitlines()) == 1
        return
    assert {symbol.name for symbol in value.free_symbols} <= {"x", "y", "s"}


@searched
@given(expressions)
def test_a_surface_of_any_expression_is_a_scene_or_refused_in_one_line(text: str) -> None:
    table = TABLES[-1] | {"object": TABLES[-1]["object"] | {"expression": text}}
    read(written(table))
