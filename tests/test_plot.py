"""Figures: drawn to scale, whole, and without touching anything global. The finger here is a circular arc."""

from __future__ import annotations

import math
import os
import pathlib
import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import matplotlib
import numpy as np
import pytest
import sympy
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.path import Path
from matplotlib.quiver import Quiver
from matplotlib.text import Text
from PIL import Image
from typer.testing import CliRunner

from gripper import output, plot
from gripper.cli import app
from gripper.fingers import Material
from gripper.objects import Object
from gripper.plot.filmstrip import MOST_SNAPSHOTS
from gripper.result import Contact, Event, Model, PoseResult, Result, Shape
from gripper.results.pose_result import Applied
from gripper.scene import Motion, Scene
from gripper_plugins.fingers.uniform import Uniform
from gripper_plugins.jaws.triangle import Triangle
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.implicit import Implicit

LENGTH, THICKNESS, RADIUS = 0.2, 0.02, 0.03
Q = sympy.Symbol("q")
FINGER = Uniform(
    length=LENGTH, thickness=THICKNESS, width=0.02, material=Material(youngs_modulus=5e6, poisson_ratio=0.4)
)
SCENE = Scene(finger=FINGER, object=Circle(radius=RADIUS))
"""Without a motion."""


def area(points: np.ndarray) -> float:
    x, y = points.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def bent(bend: float, angle: float, jaw: bool) -> Shape:
    """A finger bent to a circular arc through the angle ``bend``: its area is that of the straight one."""
    theta = np.linspace(0.0, bend, 61)
    turned = angle + theta
    across = np.stack([-np.sin(turned), np.cos(turned)], axis=1)
    if bend:
        axis = LENGTH / bend * (np.array([-math.sin(angle), math.cos(angle)]) - across)
    else:
        axis = np.linspace(0.0, LENGTH, 61)[:, None] * [math.cos(angle), math.sin(angle)]
    along = np.array([across[-1, 1], -across[-1, 0]])
    triangle = Triangle(length=0.04, lead_angle=0.4, return_angle=1.0).polygon(THICKNESS)
    hook = np.array([axis[-1] + x * along + y * across[-1] for x, y in triangle]) if jaw else None
    strain = np.full(61, bend / LENGTH * THICKNESS / 2)
    faces = {"lower": axis - across * THICKNESS / 2, "upper": axis + across * THICKNESS / 2}
    return Shape(axis=axis, **faces, strain=strain, jaw=hook, clamp_pose=(0.0, 0.0, angle))


def answer(parameter: float | None, bend: float, angle: float = 0.0, jaw: bool = False) -> PoseResult:
    """A pose that touches a circle below the middle of its lower face."""
    shape = bent(bend, angle, jaw)
    point, normal = shape.lower[30], (shape.upper[30] - shape.lower[30]) / THICKNESS
    shape = replace(shape, object_pose=(*(point - RADIUS * normal), 0.0))
    touching = Contact(
        on="lower", s=0.1, extent=(0.1, 0.1), point=point, normal=normal, normal_force=20 * bend, state="frictionless"
    )
    return PoseResult(
        parameter=parameter,
        status="contact" if bend else "free",
        force_on_object=-20 * bend * normal,
        energy=bend**2,
        max_strain=float(shape.strain.max()),
        contacts=(touching,) if bend else (),
        shape=shape,
    )


def motion(bends: list[float], jaw: bool = False, target: Object | None = None, title: str = "An arc") -> Result:
    scene = Scene(
        finger=FINGER,
        object=(target or Circle(radius=RADIUS)).at(x=Q),
        motion=Motion("q", tuple(0.1 * i for i in range(len(bends)))),
        title=title,
    )
    poses = tuple(answer(0.1 * i, bend, 0.3 * i, jaw) for i, bend in enumerate(bends))
    return Result(scene=scene, model=Model(theory="bending"), poses=poses)


def looped(bends: list[float]) -> Result:
    """Poses there and, from the middle one, the same way back."""
    given = motion(bends)
    half = len(bends) // 2
    places = [0.1 * min(i, len(bends) - 1 - i) for i in range(len(bends))]
    poses = tuple(replace(pose, parameter=place) for pose, place in zip(given.poses, places, strict=True))
    assert places[half] == max(places)
    return replace(given, scene=replace(given.scene, motion=Motion("q", tuple(places))), poses=poses)


def panels(figure: Figure) -> list:
    return [ax for ax in figure.axes if ax.patches]


def test_every_panel_has_equal_axes_and_one_scale() -> None:
    figure = plot.filmstrip(motion([0.2, 0.9, 0.4, 0.0]))
    figure.draw_without_rendering()
    drawn = panels(figure)
    assert len(drawn) == 4
    assert all(ax.get_aspect() == 1 for ax in drawn)  # equal
    widths = [np.ptp(ax.get_xlim()) / ax.get_window_extent().width for ax in drawn]
    heights = [np.ptp(ax.get_ylim()) / ax.get_window_extent().height for ax in drawn]
    assert widths == pytest.approx(heights, rel=1e-6)
    assert widths == pytest.approx([widths[0]] * 4, rel=1e-2)


@pytest.mark.parametrize("bend", [0.0, 0.5, 1.5])
def test_the_outline_drawn_has_the_finger_s_area(bend: float) -> None:
    ax = panels(plot.filmstrip(motion([bend])))[0]
    outlines = [patch for patch in ax.patches if isinstance(patch, Polygon) and not patch.get_fill()]
    exact = 1e6 * LENGTH * THICKNESS  # mm^2
    assert area(outlines[0].get_xy()[:-1]) == pytest.approx(exact, rel=1e-3)
    (body,) = (each for each in ax.collections if isinstance(each, PolyCollection) and not isinstance(each, Quiver))
    assert sum(area(path.vertices[:-1]) for path in body.get_paths()) == pytest.approx(exact, rel=1e-3)
    shades = body.get_array().tolist()
    assert shades == pytest.approx([100 * bend / LENGTH * THICKNESS / 2] * len(shades))


def test_the_arrow_starts_at_the_contact_and_points_into_the_object_to_scale() -> None:
    figure = plot.filmstrip(motion([0.5, 1.0]))
    arrows = [each for ax in panels(figure) for each in ax.collections if isinstance(each, Quiver)]
    lengths = [math.hypot(each.U[0], each.V[0]) for each in arrows]
    assert lengths[1] == pytest.approx(2 * lengths[0])
    pose = motion([0.5, 1.0]).poses[0]
    assert arrows[0].get_offsets()[0] == pytest.approx(1e3 * np.array(pose.contacts[0].point))
    centre = np.array(pose.shape.object_pose[:2]) - pose.contacts[0].point
    assert np.array([arrows[0].U[0], arrows[0].V[0]]) / lengths[0] == pytest.approx(centre / RADIUS)


def test_two_contacts_get_an_arrow_each_that_add_up_to_the_force() -> None:
    one = answer(0.0, 0.5)
    first = one.contacts[0]
    shape = one.shape
    second = replace(first, on="upper", point=shape.upper[45], normal=np.negative(first.normal), tangential_force=2.0)
    along = np.array([first.normal[1], -first.normal[0]])
    force = (second.normal_force - first.normal_force) * np.array(first.normal) + 2.0 * along
    both = replace(one, contacts=(first, second), force_on_object=force)
    given = replace(motion([0.5]), poses=(both,))
    arrows = [each for each in panels(plot.filmstrip(given))[0].collections if isinstance(each, Quiver)]
    total = sum(np.array([each.U[0], each.V[0]]) for each in arrows)
    assert len(arrows) == 2
    assert total / np.linalg.norm(total) == pytest.approx(force / np.linalg.norm(force))


@pytest.mark.parametrize("jaw", [False, True])
@pytest.mark.parametrize("bends", [[0.5], [0.0, 0.0], [0.2, 1.2, 0.4], [0.1 * i for i in range(12)]])
def test_all_that_is_drawn_lies_inside_its_panel(bends: list[float], jaw: bool) -> None:
    for ax in panels(plot.filmstrip(motion(bends, jaw))):
        (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
        points = np.concatenate([patch.get_xy() for patch in ax.patches])
        assert left < points[:, 0].min() < points[:, 0].max() < right
        assert bottom < points[:, 1].min() < points[:, 1].max() < top


def texts(figure: Figure) -> list[Text]:
    figure.draw_without_rendering()
    shown = [each for each in figure.findobj(Text) if each.get_visible() and each.get_text().strip()]
    for ax in figure.axes:  # numbers outside the limits are kept, but not drawn
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            hidden = [tick.label1 for tick in axis.get_major_ticks() if not low <= tick.get_loc() <= high]
            hidden += [tick.label2 for tick in axis.get_major_ticks()]
            shown = [each for each in shown if each not in hidden and (ax.axison or each not in axis.get_ticklabels())]
    return shown


LONG = "A rather long title, " * 12


@pytest.mark.parametrize("jaw", [False, True])
@pytest.mark.parametrize("width", [plot.COLUMN, plot.PAGE])
@pytest.mark.parametrize("poses", [1, 2, 3, 4, 5, 6])
def test_no_texts_of_a_filmstrip_overlap_and_all_lie_on_the_page(poses: int, width: float, jaw: bool) -> None:
    given = motion([0.2, 0.9, 0.4, 0.6, 0.0, 0.3][:poses], jaw, title=LONG if jaw else "An arc")
    assert_legible(plot.filmstrip(given, width=width), width)


@pytest.mark.parametrize("width", [plot.COLUMN, plot.PAGE])
def test_no_texts_of_a_curve_overlap_and_all_lie_on_the_page(width: float) -> None:
    events = tuple(Event(parameter=x, kind="change") for x in (0.0, 0.001, 0.02, 0.03, 0.19))
    assert_legible(plot.curve(replace(motion([0.2, 0.9, 0.4], title=LONG), events=events), width=width), width)


def assert_legible(figure: Figure, width: float) -> None:
    shown = texts(figure)
    assert figure.get_figwidth() * 0.0254 == pytest.approx(width)
    assert min(each.get_fontsize() for each in shown) >= 6  # points: what journals ask for
    boxes = [(each.get_text(), each.get_window_extent()) for each in shown]
    for i, (text, box) in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1, text
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1, text
        assert not [other for other, its in boxes[:i] if box.overlaps(its)], text


def test_the_default_snapshots_hold_the_ends_the_first_contact_and_the_largest_force() -> None:
    bends = [0.0] * 40
    bends[11:20] = [0.1, 0.2, 0.3, 0.4, 0.9, 0.4, 0.3, 0.2, 0.1]
    figure = plot.filmstrip(motion(bends))
    titles = " ".join(ax.get_title() for ax in panels(figure))
    assert len(panels(figure)) == MOST_SNAPSHOTS
    for i in (0, 11, 15, 39):
        assert f"q = {0.1 * i:.4g} m:" in titles


def test_poses_that_failed_are_left_out_and_refused_by_name() -> None:
    whole = motion([0.2, 0.9, 0.4])
    gap = replace(whole, poses=(whole.poses[0], PoseResult.failed(0.1, "no equilibrium"), whole.poses[2]))
    assert len(panels(plot.filmstrip(gap))) == 2
    with pytest.raises(ValueError, match="got 1: no equilibrium"):
        plot.filmstrip(gap, [0, 1])
    with pytest.raises(ValueError, match="indices from 0 to 2; got 7"):
        plot.filmstrip(gap, [7])
    nothing = replace(whole, poses=(PoseResult.failed(0.0, "no equilibrium"),))
    with pytest.raises(ValueError, match="at least one pose"):
        nothing.plot()


WALL = Conic(coefficients=(0, 0, 0, 0, 1, 0))
PARABOLA = Conic(coefficients=(1, 0, 0, 0, 0.1, 0))
STRIP = Conic(coefficients=(0, 1, 0, 0, 0, -(RADIUS**2)))
X, Y = sympy.symbols("x y", real=True)
RING = Implicit(expression=sympy.Abs(sympy.sqrt(X**2 + Y**2) - 0.02) - 0.01, extent=0.04)


@pytest.mark.parametrize("target", [WALL, PARABOLA, STRIP, RING])
def test_an_object_without_bounds_or_with_a_hole_is_filled_inside_and_only_there(target: Object) -> None:
    ax = panels(plot.filmstrip(motion([0.5], target=target)))[0]
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    assert max(right - left, top - bottom) < 1e3 * 5 * LENGTH
    (fill,) = (each for each in ax.collections if isinstance(each, ContourSet))
    loops = [loop for path in fill.get_paths() for loop in path.to_polygons()]
    x, y, _ = motion([0.5]).poses[0].shape.object_pose
    for point in np.random.default_rng(1).uniform((left, bottom), (right, top), (200, 2)):
        g = float(target.gap(point[None] / 1e3 - (x, y))[0])
        if abs(g) > 2e-3 * LENGTH:
            around = sum(Path(loop).contains_point(point) for loop in loops)
            assert around % 2 == (g < 0)


def test_given_axes_take_all_poses_over_each_other() -> None:
    figure = Figure()
    ax = figure.subplots()
    assert plot.filmstrip(motion([0.2, 0.9, 0.4]), ax=ax) is figure
    outlines = [patch for patch in ax.patches if isinstance(patch, Polygon) and not patch.get_fill()]
    assert len(outlines) == 3
    assert ax.get_aspect() == 1


def lines(ax: Axes, name: str) -> list[Line2D]:
    """The lines of a curve of this name: the way there, and then those that follow in its colour."""
    (first,) = (each for each in ax.lines if each.get_label() == name)
    return [each for each in ax.lines if each.get_color() == first.get_color()]


def test_the_curve_shows_both_components_and_marks_the_events() -> None:
    given = replace(
        motion([0.2, 0.9, 0.4]),
        events=(
            Event(parameter=0.05, kind="touch"),
            Event(parameter=0.0501, kind="slip"),
            Event(parameter=0.15, kind="release"),
        ),
    )
    ax = plot.curve(given).axes[0]
    forces = np.array([pose.force_on_object for pose in given.poses])
    for name, expected in zip(("along x", "along y"), forces.T, strict=True):
        (line,) = lines(ax, name)
        assert line.get_ydata() == pytest.approx(expected)
        assert line.get_xdata() == pytest.approx([0.0, 100.0, 200.0])
    assert ax.get_xlabel() == "q (mm)"
    assert [text.get_text() for text in ax.child_axes[0].get_xticklabels()] == ["touch, slip", "release"]


def test_a_snap_breaks_the_curve_there_and_on_the_way_back() -> None:
    snaps = (
        Event(parameter=0.15, kind="snap"),
        Event(parameter=0.12, kind="touch"),
        Event(parameter=0.05, kind="snap"),
    )
    there_and_back = replace(looped([0.2, 0.9, 0.4, 0.3, 0.1]), events=snaps)
    there, back = lines(plot.curve(there_and_back, "energy").axes[0], "_")
    assert there.get_ydata() == pytest.approx([0.04, 0.81, np.nan, 0.16], nan_ok=True)
    assert back.get_ydata() == pytest.approx([0.16, 0.09, np.nan, 0.01], nan_ok=True)


def test_the_way_back_is_dashed_and_said_so() -> None:
    ax = plot.curve(looped([0.2, 0.9, 0.4, 0.3, 0.1])).axes[0]
    for name in ("along x", "along y"):
        there, back = lines(ax, name)
        assert (there.get_linestyle(), back.get_linestyle()) == ("-", "--")
        assert there.get_ydata()[-1] == back.get_ydata()[0]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["along x", "along y", "way there", "way back"]


def test_poses_that_stick_are_hollow_and_those_without_an_answer_are_named() -> None:
    whole = motion([0.2, 0.9, 0.4, 0.1])
    held = replace(whole.poses[1], contacts=(replace(whole.poses[1].contacts[0], state="stick"),))
    locked = PoseResult(parameter=0.2, status="locked", reason="friction")
    given = replace(whole, poses=(whole.poses[0], held, locked, PoseResult.failed(0.3, "no equilibrium")))
    ax = plot.curve(given, "energy").axes[0]
    (hollow,) = (line for line in ax.lines if line.get_color() == "white")
    assert hollow.get_xydata() == pytest.approx(np.array([[100.0, 0.81]]))
    names = {line.get_label(): line.get_xdata() for line in ax.lines}
    assert (names["locked"], names["failed"]) == ([200.0], [pytest.approx(300.0)])
    assert {text.get_text() for text in ax.get_legend().get_texts()} == {"locked", "failed", "sticks"}


@pytest.mark.parametrize("quantity", plot.QUANTITIES)
def test_every_quantity_has_a_curve_with_its_unit(quantity: str) -> None:
    figure = plot.curve(motion([0.2, 0.9, 0.4]), quantity)
    assert re.fullmatch(r".+ \(.+\)", figure.axes[0].get_ylabel())


def test_an_unknown_quantity_lists_the_known_ones() -> None:
    with pytest.raises(LookupError, match="unknown quantity 'force'; known: force_on_object, "):
        motion([0.2, 0.9]).curve("force")


def test_motions_compared_have_a_panel_for_each_component_points_beside_and_breaks_at_snaps() -> None:
    snap = replace(motion([0.2, 0.4, 0.1]), events=(Event(parameter=0.15, kind="snap"),))
    soft, stiff = snap, motion([0.4, 0.8, 0.2])
    points = {"measured": [(0.1, (3.0, -4.0)), (0.2, (1.0, -2.0))]}
    left, right = plot.compare({"soft": soft, "stiff": stiff}, points=points).axes
    for i, ax in enumerate((left, right)):
        drawn = {line.get_label(): line for line in ax.lines}
        assert list(drawn) == ["soft", "stiff", "measured"]
        expected = [pose.force_on_object[i] for pose in soft.poses]
        assert drawn["soft"].get_ydata() == pytest.approx([*expected[:2], np.nan, expected[2]], nan_ok=True)
        assert drawn["measured"].get_xydata() == pytest.approx(
            np.array([(1e3 * x, f[i]) for x, f in points["measured"]])
        )
        assert len({line.get_color() for line in ax.lines}) == len({line.get_linestyle() for line in ax.lines}) == 3
    assert (left.get_ylabel(), right.get_ylabel()) == tuple(f"force on the object, along {x} (N)" for x in "xy")


def test_where_the_first_motion_sticks_the_ground_of_a_comparison_is_grey() -> None:
    events = [Event(parameter=x, kind=kind) for x, kind in ((0.02, "touch"), (0.05, "stick"), (0.12, "slip"))]
    held = replace(motion([0.2, 0.4, 0.1]), events=tuple(events))
    assert plot.sticks(held) == [(0.05, 0.12)]
    (ax,) = plot.compare({"held": held, "free": motion([0.1, 0.2, 0.3])}, "energy", levels={"limit": 0.1}).axes
    (ground,) = ax.patches
    assert (ground.get_x(), ground.get_width()) == pytest.approx((50.0, 70.0))
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["held", "free", "limit", "sticks"]
    (level,) = (line for line in ax.lines if line.get_label() == "limit")
    assert set(level.get_ydata()) == {0.1}


def test_compared_motions_have_one_unit() -> None:
    (ax,) = plot.compare({"soft": motion([0.1, 0.2]), "stiff": motion([0.1, 0.9])}, "energy").axes
    assert ax.get_ylabel() == "strain energy (J)"
    assert [line.get_ydata()[-1] for line in ax.lines] == pytest.approx([0.04, 0.81])
    with pytest.raises(ValueError, match="results must hold at least one result"):
        plot.compare({})


def in_the_clamp_s_frame(given: Result) -> Result:
    poses = tuple(replace(pose, force_on_object_finger_frame=pose.force_on_object) for pose in given.poses)
    return replace(given, poses=poses)


@pytest.mark.parametrize("width", [plot.COLUMN, plot.PAGE])
def test_comparisons_and_charts_are_legible_at_their_width(width: float) -> None:
    bends = ([0.1, 0.2], [0.1, 0.9], [0.3, 0.3])
    several = dict(zip(("soft", "stiff", "as stiff as a line without thickness"), map(motion, bends), strict=True))
    several = {name: in_the_clamp_s_frame(each) for name, each in several.items()}
    for quantity in ("force_on_object", "force_on_object_finger_frame", "energy"):
        assert_legible(plot.compare(several, quantity, title=LONG, width=width), width)
    numbers = {"measured": ([0, 1, 2], [1e3, 2e3, 5e3]), "said": ([0, 1, 2], [1e3, 2e3, 4e3])}
    figure = plot.chart(numbers, "way (mm)", "force (N)", levels={"limit": 4.5e3}, title="A chart", width=width)
    assert_legible(figure, width)
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["measured", "said", "limit"]


@pytest.mark.parametrize(
    ("pose", "unit"),
    [
        ({"x": Q}, "(mm)"),
        ({"y": 0.1 - Q}, "(mm)"),
        ({"angle": 1.0 + Q}, "(deg)"),
        ({"x": 2 * Q}, ""),
        ({"x": sympy.sin(Q)}, ""),
    ],
)
def test_the_parameter_has_a_unit_where_it_is_a_coordinate_itself(pose: dict, unit: str) -> None:
    given = motion([0.2, 0.9])
    scene = replace(given.scene, object=Circle(radius=RADIUS).at(**pose))
    assert plot.curve(replace(given, scene=scene)).axes[0].get_xlabel() == f"q {unit}".strip()


def test_a_curve_needs_a_motion() -> None:
    still = replace(motion([0.5]), scene=SCENE)
    with pytest.raises(ValueError, match="must hold a motion"):
        plot.curve(still)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_figure_s_file_repeats_bit_for_bit(kind: str, tmp_path: pathlib.Path) -> None:
    for draw in (lambda: motion([0.2, 0.9], jaw=True).filmstrip(), lambda: motion([0.2, 0.9]).curve()):
        figure = draw()
        for i, each in enumerate((figure, figure, draw())):
            each.savefig(tmp_path / "made" / f"{i}.{kind}")
        files = [(tmp_path / "made" / f"{i}.{kind}").read_bytes() for i in range(3)]
        assert files[0] == files[1] == files[2]


SOLVED = """
import sys, gripper as gr
from gripper_plugins.fingers import Uniform
from gripper_plugins.objects import Circle
rubber = gr.Material(youngs_modulus=5e6, poisson_ratio=0.4)
finger = Uniform(length=0.1, thickness=0.01, width=0.02, material=rubber)
gr.solve(gr.Scene(finger=finger, object=Circle(radius=0.02).at(x=0.07, y=-0.01))).plot().savefig(sys.argv[1])
"""


def test_another_process_writes_the_same_svg(tmp_path: pathlib.Path) -> None:
    files = []
    for seed in ("1", "2"):
        path = tmp_path / f"{seed}.svg"
        environment = os.environ | {"PYTHONHASHSEED": seed}
        subprocess.run([sys.executable, "-c", SOLVED, str(path)], check=True, env=environment)
        files.append(path.read_bytes())
    assert files[0] == files[1]


def test_the_user_s_own_settings_change_nothing() -> None:
    def drawn() -> bytes:
        return motion([0.2, 0.9]).filmstrip()._repr_png_() + motion([0.2, 0.9]).curve()._repr_png_()

    plain = drawn()
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black", "axes.grid": True, "savefig.dpi": 30}):
        assert drawn() == plain


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_figures_are_written_to_files(kind: str, tmp_path: pathlib.Path) -> None:
    for name, figure in (("snapshots", motion([0.2, 0.9], jaw=True).plot()), ("curve", plot.curve(motion([0.2, 0.9])))):
        path = tmp_path / f"{name}.{kind}"
        figure.savefig(path)
        assert path.stat().st_size > 5000


@pytest.mark.parametrize("status", ["failed", "locked"])
def test_a_run_without_any_answer_still_writes_a_picture(status: str, tmp_path: pathlib.Path) -> None:
    nothing = PoseResult(parameter=0.0, status=status, reason="for any reason")
    paths = output.write(tmp_path, replace(motion([0.2]), poses=(nothing,)))
    with Image.open(paths[-1]) as picture:
        assert picture.size == (800, 200)


def test_a_notebook_can_show_a_figure_without_a_backend() -> None:
    assert plot.filmstrip(motion([0.5]))._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("title", ["costs $5 or $6", "100 % of x_e^2", "<b>", ""])
def test_any_title_can_be_drawn(title: str) -> None:
    plot.filmstrip(motion([0.5], title=title)).draw_without_rendering()


def test_plotting_leaves_pyplot_alone() -> None:
    code = "import gripper.plot, sys; sys.exit(bool({'matplotlib.pyplot', 'matplotlib.animation'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


MIRROR = (0.0, -0.05, 0.0)


def facing(bends: list[float]) -> Result:
    """Fingers that touch a circle at the origin's height below them: the arcs of ``motion``, their object moved."""
    given = motion(bends, jaw=True)
    poses = [replace(p, shape=replace(p.shape, object_pose=(0.1, MIRROR[1], 0.0))) for p in given.poses]
    return replace(given, poses=tuple(poses))


def test_the_second_finger_is_the_mirror_image_of_the_first() -> None:
    ax = panels(facing([0.5]).filmstrip(mirror=MIRROR))[0]
    one, other = (p.get_xy() for p in ax.patches if not p.get_fill())
    assert other == pytest.approx(one * (1, -1) + (0, 2e3 * MIRROR[1]))
    first, second = (each for each in ax.collections if isinstance(each, Quiver))
    assert (second.U[0], second.V[0]) == pytest.approx((first.U[0], -first.V[0]))
    assert "each" in ax.get_title()
    assert sum(p.get_xy().shape[0] > 50 and p.get_fill() for p in ax.patches) == 1  # one object


def test_a_load_that_is_round_off_beside_the_motion_s_largest_has_no_arrow() -> None:
    given = motion([0.0, 0.0, 0.0])
    forces = [(0.0, 5.0), (0.0, 5.0 * math.sin(math.pi)), (0.0, 5e-60)]
    poses = [
        replace(pose, loads=(Applied(load=0, s=LENGTH, point=(0.0, 0.0), force=force, moment=0.0),))
        for pose, force in zip(given.poses, forces, strict=True)
    ]
    drawn = replace(given, poses=tuple(poses)).filmstrip()
    assert [sum(isinstance(p, FancyArrowPatch) for p in ax.patches) for ax in panels(drawn)] == [1, 0, 0]
    alone = replace(given, poses=tuple(poses[2:])).filmstrip()
    assert not [p for p in panels(alone)[0].patches if isinstance(p, FancyArrowPatch)]


def test_next_to_nothing_is_drawn_and_printed_as_zero_but_kept() -> None:
    given = motion([0.0, 0.0])
    tiny = replace(
        given, poses=tuple(replace(p, clamp_moment=1e-61, energy=1e-123, max_strain=2e-63) for p in given.poses)
    )
    for quantity in ("clamp_moment", "energy", "max_strain"):
        assert not np.any(tiny.curve(quantity).axes[0].lines[0].get_ydata())
    assert "e-" not in str(tiny) and "1e-61" in tiny.curve_csv()


@pytest.mark.parametrize(("strain", "unit"), [(0.02, "%"), (2e-6, "10\u207b\u2076"), (3e-9, "10\u207b\u00b9\u00b2")])
def test_small_strains_have_a_unit_of_their_own_and_no_power_beside_the_bar(strain: float, unit: str) -> None:
    figure = motion([strain * 2 * LENGTH / THICKNESS]).filmstrip()
    (bar,) = (ax for ax in figure.axes if "strain" in ax.get_xlabel())
    assert bar.get_xlabel().endswith(f"({unit})")
    figure.canvas.draw()
    assert not bar.xaxis.get_offset_text().get_text()


def test_an_axis_about_which_the_object_is_not_symmetric_is_refused() -> None:
    with pytest.raises(ValueError, match="mirror must be an axis of symmetry of the object"):
        facing([0.5]).filmstrip(mirror=(0.0, -0.04, 0.0))


def test_a_film_has_a_frame_for_every_pose_and_reports_its_progress(tmp_path: pathlib.Path) -> None:
    given, told = motion([0.0, 0.3, 0.6, 0.3]), []
    gap = replace(given, poses=(*given.poses[:2], PoseResult.failed(0.2, "no equilibrium"), given.poses[3]))
    path = gap.animate(tmp_path / "a.gif", seconds=0.5, pixels=300, progress=lambda *done: told.append(done))
    assert [each.name for each in tmp_path.iterdir()] == ["a.gif"]
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    with Image.open(path) as film:
        assert film.n_frames == 4
        assert film.info["loop"] == 0
        assert film.width == 300
        assert film.height % 2 == 0
        pictures = [np.asarray(frame_of(film, i)) for i in range(4)]
    assert all((one != other).any() for one, other in pairwise(pictures))


def frame_of(film: Image.Image, i: int) -> Image.Image:
    film.seek(i)
    return film.convert("RGB")


def test_a_film_repeats_bit_for_bit(tmp_path: pathlib.Path) -> None:
    files = [motion([0.2, 0.5]).animate(tmp_path / f"{i}.gif", pixels=200).read_bytes() for i in range(2)]
    assert files[0] == files[1]


def test_a_film_that_cannot_be_made_says_why_and_leaves_nothing(tmp_path: pathlib.Path, monkeypatch) -> None:
    given = motion([0.0, 0.3])
    still = replace(given, scene=SCENE, poses=given.poses[:1])
    with pytest.raises(ValueError, match=r"path must end in \.gif or \.mp4; got '.*a\.avi'"):
        given.animate(tmp_path / "a.avi")
    monkeypatch.setenv("PATH", str(tmp_path))  # no ffmpeg here
    with pytest.raises(ValueError, match=r"path must end in \.gif, for ffmpeg, which writes \.mp4, is not on the PATH"):
        given.animate(tmp_path / "a.mp4")
    with pytest.raises(ValueError, match="result must hold a motion"):
        still.animate(tmp_path / "a.gif")
    with pytest.raises(ValueError, match="seconds must be a positive number, in s; got 0"):
        given.animate(tmp_path / "a.gif", seconds=0)
    with pytest.raises(ValueError, match="pixels must be at least 100; got 20"):
        given.animate(tmp_path / "a.gif", pixels=20)

    def interrupted(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        given.animate(tmp_path / "a.gif", pixels=200, progress=interrupted)
    assert not list(tmp_path.iterdir())


ENCODER = """#!{python}
import pathlib, sys
given = sys.argv[1:]
if ".none." in given[-1]:
    sys.exit("no such codec")
width, height = map(int, given[given.index("-s") + 1].split("x"))
frames, rest = divmod(len(sys.stdin.buffer.read()), 3 * width * height)
pathlib.Path(given[-1]).write_text(f"{{width}} {{height}} {{frames}} {{rest}} {{given[given.index('-r') + 1]}}")
"""


def test_an_mp4_is_every_frame_given_to_the_ffmpeg_on_the_path(tmp_path: pathlib.Path, monkeypatch) -> None:
    """Whatever program is found there gets raw frames of one even size, and the last one for 0.8 s more."""
    encoder = tmp_path / "bin" / "ffmpeg"
    encoder.parent.mkdir()
    encoder.write_text(ENCODER.format(python=sys.executable))
    encoder.chmod(0o755)
    monkeypatch.setenv("PATH", str(encoder.parent))
    path = motion([0.0, 0.3, 0.6]).animate(tmp_path / "a.mp4", seconds=0.5, pixels=301)
    width, height, frames, rest, rate = map(int, path.read_text().split())
    assert (width, height % 2, rest, rate) == (300, 0, 0, 6)
    assert frames == 3 + round(0.8 * rate)
    with pytest.raises(OSError, match=r"ffmpeg could not write .*\.mp4: no such codec"):
        motion([0.0, 0.3]).animate(tmp_path / "a.none.mp4", pixels=200)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.mp4", "bin"]
    assert motion([0.0, 0.3]).animate(tmp_path / "a.gif", pixels=200).read_bytes().startswith(b"GIF89a")


def test_named_poses_have_their_names_in_the_captions() -> None:
    figure = motion([0.0, 0.3]).filmstrip({1: "bent", 0: "straight"})
    assert [ax.get_title() for ax in panels(figure)] == ["bent, q = 100 mm: 6.00 N", "straight, q = 0 mm: free"]


def test_scenes_of_one_pose_stand_beside_each_other_to_one_scale() -> None:
    still = {name: replace(motion([bend]), scene=SCENE) for name, bend in (("soft", 0.2), ("stiff", 0.4))}
    figure = plot.beside(still, title="Two")
    assert [ax.get_title() for ax in panels(figure)] == ["soft: 4.00 N", "stiff: 8.00 N"]
    arrows = [each for ax in panels(figure) for each in ax.collections if isinstance(each, Quiver)]
    lengths = [math.hypot(each.U[0], each.V[0]) for each in arrows]
    assert lengths[1] == pytest.approx(2 * lengths[0])
    with pytest.raises(ValueError, match="results must hold at least one"):
        plot.beside({})
    with pytest.raises(ValueError, match="must hold one pose"):
        plot.beside({"moving": motion([0.1, 0.2])})


GALLERY = pathlib.Path(__file__).parents[1] / "gallery"


def command(*arguments: object) -> tuple[int, str, str]:
    outcome = CliRunner().invoke(app, ["animate", *(str(each) for each in arguments)])
    return outcome.exit_code, outcome.stdout, outcome.stderr


def test_the_command_animates_a_scene_file(tmp_path: pathlib.Path) -> None:
    scene = (GALLERY / "micro_assembly.toml").read_text().replace("poses = 37", "poses = 4")
    (tmp_path / "scene.toml").write_text(scene)
    path = tmp_path / "films" / "a.gif"
    assert command(tmp_path / "scene.toml", "-o", path, "--pixels", 200) == (0, f"{path}\n", "")
    with Image.open(path) as film:
        assert (film.n_frames, film.width) == (4, 200)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["-o", "a.avi"], "path must end in .gif or .mp4; got 'a.avi'"), (["--seconds", 0], "seconds must be a positive")],
)
def test_the_command_refuses_before_it_solves(arguments: list, said: str, tmp_path: pathlib.Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    status, out, err = command(GALLERY / "micro_assembly.toml", *arguments)
    assert (status, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_the_readme_s_pictures_are_small() -> None:
    for name in ("rotating_finger.png", "rotating_finger.gif"):
        assert (GALLERY / name).stat().st_size < 400_000
