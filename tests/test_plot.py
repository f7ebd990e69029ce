"""Figures: drawn to scale, whole, and without touching anything global. The finger here is a circular arc."""

from __future__ import annotations

import math
import pathlib
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import sympy
from matplotlib.collections import PolyCollection
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.path import Path
from matplotlib.quiver import Quiver

from gripper import plot
from gripper.plot.filmstrip import MOST_SNAPSHOTS
from gripper.fingers import Material
from gripper.objects import Object
from gripper.result import Contact, Event, Model, PoseResult, Result, Shape
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


def panels(figure: Figure) -> list:
    return [ax for ax in figure.axes if ax.patches]


def test_every_panel_has_equal_axes_and_one_scale() -> None:
    figure = plot.filmstrip(motion([0.2, 0.9, 0.4, 0.0]))
    figure.draw_without_rendering()
    drawn = panels(figure)
    assert len(drawn) == 4
    assert all(ax.get_aspect() == 1 for ax in drawn)
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
    assert list(body.get_array()) == pytest.approx([100 * bend / LENGTH * THICKNESS / 2] * 60)


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


def test_no_texts_of_a_figure_overlap() -> None:
    figure = plot.filmstrip(motion([0.2, 0.9, 0.4, 0.6, 0.0], title="A rather long title, " * 12))
    figure.draw_without_rendering()
    titles = [figure._suptitle, *(ax.title for ax in panels(figure))]
    boxes = [text.get_window_extent() for text in titles if text is not None]
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:i])
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1


def test_the_default_snapshots_hold_the_ends_the_first_contact_and_the_largest_force() -> None:
    bends = [0.0] * 40
    bends[11:20] = [0.1, 0.2, 0.3, 0.4, 0.9, 0.4, 0.3, 0.2, 0.1]
    figure = plot.filmstrip(motion(bends))
    titles = " ".join(ax.get_title() for ax in panels(figure))
    assert len(panels(figure)) == MOST_SNAPSHOTS
    for i in (0, 11, 15, 39):
        assert f"q = {0.1 * i:.4g}:" in titles


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


def test_the_curve_shows_both_components_and_marks_the_events() -> None:
    given = replace(
        motion([0.2, 0.9, 0.4]),
        events=(
            Event(parameter=0.05, kind="touch"),
            Event(parameter=0.0501, kind="slip"),
            Event(parameter=0.15, kind="snap"),
        ),
    )
    ax = plot.curve(given).axes[0]
    labelled = [line for line in ax.lines if line.get_label() in ("along x", "along y")]
    forces = np.array([pose.force_on_object for pose in given.poses])
    for line, expected in zip(labelled, forces.T, strict=True):
        assert line.get_ydata() == pytest.approx(expected)
    assert [text.get_text() for text in ax.child_axes[0].get_xticklabels()] == ["touch, slip", "snap"]


def test_a_curve_needs_a_motion() -> None:
    still = replace(motion([0.5]), scene=Scene(finger=FINGER, object=Circle(radius=RADIUS)))
    with pytest.raises(ValueError, match="must hold a motion"):
        plot.curve(still)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_figures_are_written_to_files(kind: str, tmp_path: pathlib.Path) -> None:
    for name, figure in (("snapshots", motion([0.2, 0.9], jaw=True).plot()), ("curve", plot.curve(motion([0.2, 0.9])))):
        path = tmp_path / f"{name}.{kind}"
        figure.savefig(path)
        assert path.stat().st_size > 5000


def test_a_notebook_can_show_a_figure_without_a_backend() -> None:
    assert plot.filmstrip(motion([0.5]))._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("title", ["costs $5 or $6", "100 % of x_e^2", "<b>", ""])
def test_any_title_can_be_drawn(title: str) -> None:
    plot.filmstrip(motion([0.5], title=title)).draw_without_rendering()


def test_plotting_leaves_pyplot_alone() -> None:
    code = "import gripper.plot, sys; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
