"""Every installed plugin against every property that its kind promises."""

import copy
import dataclasses
import pickle
from importlib.metadata import entry_points

import numpy as np
import pytest
import shapely
import sympy

from gripper.fingers import Finger, Jaw, Material, S
from gripper.objects import Object

RUBBER = Material(youngs_modulus=4.8e6, poisson_ratio=0.4)
ELBOW = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.01), (0.01, 0.01), (0.01, 0.03), (0.0, 0.03))
HEXAGON = tuple((0.05 * np.cos(a), 0.04 * np.sin(a)) for a in np.arange(6) * np.pi / 3)
BEAN = tuple((0.04 * np.cos(a), (0.02 + 0.012 * np.cos(2 * a)) * np.sin(a)) for a in np.arange(14) * np.pi / 7)
BEAM = {"length": 0.1, "width": 0.02, "material": RUBBER}

SAMPLES = {
    "gripper.objects": {
        "circle": [{"radius": 0.03}],
        "ellipse": [{"semi_axes": (0.05, 0.03)}, {"semi_axes": (0.01, 0.04)}],
        "conic": [
            {"coefficients": (1.0, 2.0, 0.5, 0.01, 0.02, -0.001)},
            {"coefficients": (1.0, -1.0, 0.3, 0.0, 0.01, -0.001)},
            {"coefficients": (1.0, -1.0, 0.3, 0.0, 0.01, 0.001)},
            {"coefficients": (1.0, 0.0, 0.0, 0.0, 0.1, 0.0)},
            {"coefficients": (0.0, 0.0, 0.0, 1.0, 2.0, 0.01)},
            {"coefficients": (1.0, 0.0, 0.0, 0.0, 0.0, -0.001)},
        ],
        "implicit": [
            {"expression": "(x/0.05)**4 + (y/0.03)**4 - 1", "extent": 0.07},
            {
                "expression": "sqrt(x**2 + y**2) - 0.03 - 0.004*cos(3*atan2(y, x))*exp(-1e-6/(x**2 + y**2))",
                "extent": 0.05,
            },
            {"expression": "max(abs(x), abs(y)) - 0.03", "extent": 0.05},
            {"expression": sympy.Symbol("x") ** 2 + 2 * sympy.Symbol("y") ** 2 - 0.001, "extent": 0.05},
        ],
        "polygon": [{"vertices": ELBOW}, {"vertices": HEXAGON}, {"vertices": HEXAGON[::-1]}],
        "spline": [{"points": BEAN}, {"points": HEXAGON}, {"points": BEAN[::-1]}],
    },
    "gripper.fingers": {
        "uniform": [{**BEAM, "thickness": 0.01}],
        "tapered": [
            {**BEAM, "base_thickness": 0.02, "tip_thickness": 0.005},
            {**BEAM, "base_thickness": 0.005, "tip_thickness": 0.02, "width": 0.01 + S / 10},
        ],
    },
    "gripper.jaws": {
        "triangle": [
            {"length": 0.019, "lead_angle": np.deg2rad(20), "return_angle": np.deg2rad(60)},
            {"length": 0.019, "lead_angle": 0.3, "return_angle": np.pi / 2, "side": "upper"},
            {"length": 0.019, "lead_angle": 0.3, "return_angle": 1.8},
        ],
        "polygon": [{"vertices": ELBOW}, {"vertices": ((0, -0.01), (0.01, -0.01), (0.0, -0.02))}],
    },
}
BAD = {
    "gripper.objects": {
        "circle": [("radius", 0.0), ("radius", np.inf), ("radius", "0.1")],
        "ellipse": [("semi_axes", (0.1, -0.1)), ("semi_axes", (0.1,)), ("semi_axes", (0.1, np.nan))],
        "conic": [("coefficients", (1, 1, 0, 0, 0, 1)), ("coefficients", (1, 1, 0, 0, 0)), ("coefficients", (0,) * 6)],
        "implicit": [("expression", "x**2 + z"), ("expression", "1"), ("extent", 0.0), ("extent", 0.02)],
        "polygon": [("vertices", ELBOW[:2]), ("vertices", (*ELBOW, (0.0, np.nan))), ("vertices", ((0, 0, 0),) * 3)],
        "spline": [("points", HEXAGON[:2]), ("points", (HEXAGON[0], HEXAGON[0], *HEXAGON[1:]))],
    },
    "gripper.fingers": {
        "uniform": [("thickness", 0.0), ("length", -1.0), ("width", "wide")],
        "tapered": [("tip_thickness", 0.0), ("base_thickness", np.inf), ("length", 0.0)],
    },
    "gripper.jaws": {
        "triangle": [
            ("length", 0.0),
            ("lead_angle", 0.0),
            ("return_angle", np.pi),
            ("lead_angle", 2.5),
            ("side", "left"),
        ],
        "polygon": [("vertices", ELBOW[:2]), ("vertices", ((0, 0), (2, 1), (2, 0), (0, 1.5)))],
    },
}
INSTALLED = [(entry.group, entry.name, entry) for group in SAMPLES for entry in entry_points(group=group)]


def parameters(kinds=tuple(SAMPLES)):
    """Every sample of every installed plugin of these kinds, by its constructor and its arguments."""
    for group, name, entry in INSTALLED:
        for i, arguments in enumerate(SAMPLES[group].get(name, []) if group in kinds else []):
            yield pytest.param(entry.load(), arguments, id=f"{name}-{entry.group.split('.')[1]}-{i}")


def made(kind):
    """Every sample of one kind, built once."""
    return [pytest.param(case.values[0](**case.values[1]), id=case.id) for case in parameters((f"gripper.{kind}",))]


every_plugin = pytest.mark.parametrize(("plugin", "arguments"), list(parameters()))
every_object = pytest.mark.parametrize("surface", made("objects"))
every_finger = pytest.mark.parametrize("finger", made("fingers"))
every_jaw = pytest.mark.parametrize("jaw", made("jaws"))


def window(surface):
    """The box of the outline, or a hand's breadth where it has no bounds."""
    return np.clip(surface.box, -0.1, 0.1)


def around(surface, count=200, margin=0.5):
    """Points in and around the outline."""
    low, high = window(surface).reshape(2, 2)
    return np.random.default_rng(0).uniform(low - margin * (high - low), high + margin * (high - low), (count, 2))


def largest(values):
    """The largest modulus among each point's values."""
    return np.abs(values).reshape(len(values), -1).max(axis=1)


def in_discs(centers, radius, seed, count=12):
    """Points (n, count, 2) in the discs about centers (n, 2)."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 2 * np.pi, (len(centers), count))
    reach = radius * np.sqrt(rng.uniform(0, 1, (len(centers), count)))
    return centers[:, None] + np.stack([reach * np.cos(angle), reach * np.sin(angle)], axis=-1)


def drawn(surface):
    """Its outline, within the window."""
    return surface.outline(box=tuple(window(surface)))


@pytest.mark.parametrize(("group", "name", "entry"), INSTALLED)
def test_every_installed_plugin_has_samples_and_bad_values_here(group, name, entry):
    assert SAMPLES[group].get(name), f"give {group} {name} a sample"
    assert BAD[group].get(name), f"give {group} {name} bad values"
    assert issubclass(entry.load(), {"objects": Object, "fingers": Finger, "jaws": Jaw}[group.split(".")[1]])


@every_plugin
def test_a_plugin_is_frozen_hashable_picklable_and_equal_to_its_copy(plugin, arguments):
    instance = plugin(**arguments)
    for same in (plugin(**arguments), copy.deepcopy(instance), pickle.loads(pickle.dumps(instance))):
        assert same == instance
        assert hash(same) == hash(instance)
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(instance, dataclasses.fields(instance)[0].name, None)
    with pytest.raises(TypeError):
        plugin(*arguments.values())


@every_plugin
def test_a_plugin_takes_lists_as_a_scene_file_gives_them(plugin, arguments):
    as_lists = {
        name: [list(item) if isinstance(item, tuple) else item for item in value] if isinstance(value, tuple) else value
        for name, value in arguments.items()
    }
    assert plugin(**as_lists) == plugin(**arguments)


@pytest.mark.parametrize(
    ("entry", "arguments", "name", "value"),
    [
        pytest.param(entry, SAMPLES[group][plugin][0], name, value, id=f"{plugin}-{name}-{value}")
        for group, plugin, entry in INSTALLED
        for name, value in BAD[group].get(plugin, [])
    ],
)
def test_a_bad_value_is_an_error_that_names_the_argument(entry, arguments, name, value):
    with pytest.raises(ValueError, match=f"{name}|expression must hold known names"):
        entry.load()(**{**arguments, name: value})


@every_object
def test_g_and_its_derivatives_are_finite_everywhere_also_inside_at_corners_and_far_away(surface):
    special = [surface.inner_point[None], surface.corners, np.zeros((1, 2)), np.full((1, 2), 10.0)]
    for points in (around(surface), np.vstack(drawn(surface)), *special):
        for order in range(3):
            values = surface.evaluate(points, order)
            shapes = [(len(points),), (len(points), 2), (len(points), 2, 2)]
            assert [value.shape for value in values] == shapes[: order + 1]
            assert all(np.isfinite(value).all() for value in values)


@every_object
def test_no_points_give_no_values(surface):
    none = np.empty((0, 2))
    assert [len(value) for value in surface.evaluate(none)] == [0, 0, 0]
    assert [len(bound) for bound in surface.bounds(none, np.empty(0))] == [0, 0]
    assert len(surface.at_corner(none)) == 0


@every_object
def test_a_lower_order_gives_the_same_values(surface):
    points = around(surface)
    full = surface.evaluate(points)
    readers = (surface.gap, surface.gradient, surface.hessian)
    for order, (value, reader) in enumerate(zip(full, readers, strict=True)):
        assert surface.evaluate(points, order)[order] == pytest.approx(value, rel=1e-12, abs=1e-14)
        assert reader(points.tolist()) == pytest.approx(value)
    assert full[2] == pytest.approx(full[2].swapaxes(1, 2))


@every_object
def test_g_is_negative_inside_and_positive_outside_its_outline(surface):
    assert surface.gap(surface.inner_point[None])[0] < 0
    if not np.isfinite(surface.box).all():
        return
    points = around(surface)
    region = shapely.Polygon(max(drawn(surface), key=len))
    clear = shapely.distance(region.exterior, shapely.points(points)) > 1e-4
    inside = shapely.contains_xy(region, points)
    assert (surface.gap(points)[clear & inside] < 0).all()
    assert (surface.gap(points)[clear & ~inside] > 0).all()
    assert inside.any()
    assert not inside.all()


@every_object
@pytest.mark.parametrize("order", [1, 2])
def test_each_derivative_is_the_central_difference_of_the_one_below(surface, order):
    """Away from where the nearest feature changes: there the derivative itself jumps."""
    points, step = around(surface), 1e-7
    value = surface.evaluate(points, order)[order]
    size = 1 + largest(value)
    smooth = np.ones(len(points), dtype=bool)
    differences = np.empty_like(value)
    for axis in (0, 1):
        shift = step * np.eye(2)[axis]
        after, before = surface.evaluate(points + shift, order), surface.evaluate(points - shift, order)
        differences[..., axis] = (after[order - 1] - before[order - 1]) / (2 * step)
        smooth &= largest(after[order] - before[order]) < 1e-3 * size
    assert smooth.mean() > 0.9
    assert (largest(differences - value) < 1e-5 * size)[smooth].all()


@every_object
def test_the_slope_is_about_1_on_the_outline(surface):
    slopes = np.linalg.norm(surface.gradient(np.vstack(drawn(surface))), axis=1)
    assert 0.1 < slopes.min()
    assert slopes.max() < 10


@every_object
@pytest.mark.parametrize("radius", [1e-5, 1e-3, 0.02])
def test_bounds_hold_all_over_their_discs(surface, radius):
    """The slope's by the slopes, the Hessian's as a certificate uses it: g above its parabola of least curvature."""
    centers = np.vstack([around(surface, 150, 0.2), np.vstack(drawn(surface))[::7][:50]])
    bounds = surface.bounds(centers, np.full(len(centers), radius))
    if bounds is None:
        return
    steepest, least = bounds
    assert steepest.shape == least.shape == (len(centers),)
    p, q = in_discs(centers, radius, 1), in_discs(centers, radius, 2)
    g, gradient = (value.reshape(p.shape[:2] + value.shape[1:]) for value in surface.evaluate(p.reshape(-1, 2), 1))
    assert (np.linalg.norm(gradient, axis=2) <= steepest[:, None] * (1 + 1e-9)).all()
    d = q - p
    above = surface.gap(q.reshape(-1, 2)).reshape(g.shape) - g - (gradient * d).sum(axis=2)
    known = np.isfinite(least)
    parabola = least[known, None] * (d[known] ** 2).sum(axis=2) / 2
    assert (above[known] >= parabola - 1e-13 - 1e-9 * np.abs(parabola)).all()


@every_object
def test_bounds_of_small_discs_on_a_smooth_outline_are_of_use(surface):
    """Not merely true: a slope near the slope, a least curvature that is finite at most of the outline."""
    outline = np.vstack(drawn(surface))
    bounds = surface.bounds(outline, np.full(len(outline), 1e-5))
    assert bounds is not None
    slopes = np.linalg.norm(surface.gradient(outline), axis=1)
    assert np.median(bounds[0] / slopes) < 1.01
    assert np.isfinite(bounds[1]).mean() > 0.8


@every_object
def test_the_box_holds_the_outline_and_is_no_wider_than_needed(surface):
    if not np.isfinite(surface.box).all():
        return
    outline = np.vstack(surface.outline())
    low, high = np.reshape(surface.box, (2, 2))
    size = (high - low).max()
    assert (outline >= low - 1e-12).all()
    assert (outline <= high + 1e-12).all()
    assert outline.min(axis=0) == pytest.approx(low, abs=5e-3 * size)
    assert outline.max(axis=0) == pytest.approx(high, abs=5e-3 * size)


@every_object
def test_an_outline_has_its_vertices_on_g_0_and_its_chords_within_tolerance(surface):
    box = window(surface)
    size = max(box[2] - box[0], box[3] - box[1])
    for tolerance in (1e-3 * size, 1e-5 * size):
        lines = surface.outline(box=tuple(box), tolerance=tolerance)
        assert lines
        for line in lines:
            assert np.abs(surface.gap(line)).max() < 1e-9 * size
            middle = (line[1:] + line[:-1]) / 2
            g, gradient = surface.evaluate(middle, 1)
            off = np.abs(g) / np.linalg.norm(gradient, axis=1)
            assert off.max() < 1.05 * tolerance + 1e-12
            if np.isfinite(surface.box).all():
                assert (line[0] == line[-1]).all()


@every_object
def test_the_inner_disc_lies_inside_and_touches_the_outline(surface):
    radius, point = surface.inner_radius, surface.inner_point
    assert radius > 0
    if np.isinf(radius):
        return
    distance = shapely.distance(shapely.MultiLineString(drawn(surface)), shapely.Point(point))
    assert distance == pytest.approx(radius, rel=0.03)


@every_object
def test_corners_lie_on_the_outline_between_their_normals(surface):
    corners, normals = surface.corners, surface.corner_normals
    assert corners.shape == (len(corners), 2)
    assert normals.shape == (len(corners), 2, 2)
    if not len(corners):
        assert not surface.at_corner(around(surface)).any()
        return
    assert np.linalg.norm(normals, axis=2) == pytest.approx(np.ones((len(corners), 2)))
    assert surface.gap(corners) == pytest.approx(np.zeros(len(corners)), abs=1e-12)
    middle = normals.sum(axis=1)
    outside = corners + 1e-4 * middle
    assert surface.at_corner(outside).all()
    assert surface.gap(outside) == pytest.approx(1e-4 * np.linalg.norm(middle, axis=1))
    for side in (0, 1):  # beyond the cone of the normals the feature is an edge
        beyond = corners + 1e-4 * normals[:, side] + 1e-5 * (normals[:, side] - normals[:, 1 - side])
        assert not surface.at_corner(beyond).any()


@every_finger
def test_a_finger_s_thickness_and_width_are_positive_expressions_of_s_alone(finger):
    s = np.linspace(0, finger.length, 101)
    for profile in (finger.w(S), finger.b(S)):
        assert sympy.sympify(profile).free_symbols <= {S}
        values = sympy.lambdify(S, profile, "numpy")(s) * np.ones_like(s)
        assert (values > 0).all()
    assert all(0 < kink < finger.length for kink in finger.kinks())


@every_finger
def test_a_finger_s_thickness_is_the_one_named_at_its_ends(finger):
    names = {field.name for field in dataclasses.fields(finger)}
    for name, s in (("thickness", 0.0), ("base_thickness", 0.0), ("tip_thickness", finger.length)):
        if name in names:
            assert float(sympy.sympify(finger.w(S)).subs(S, s)) == pytest.approx(getattr(finger, name))


@every_jaw
@pytest.mark.parametrize("thickness", [0.002, 0.02])
def test_a_jaw_s_polygon_is_simple_and_encloses_an_area(jaw, thickness):
    polygon = shapely.Polygon(jaw.polygon(thickness))
    assert polygon.is_valid
    assert polygon.area > 0
