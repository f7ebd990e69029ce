import time

import numpy as np
import pytest
import shapely
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gripper.objects import FeatureSurface, ImplicitSurface
from gripper.objects.compiled import compiled
from gripper_plugins.objects.circle import Circle
from gripper_plugins.objects.conic import Conic
from gripper_plugins.objects.ellipse import Ellipse
from gripper_plugins.objects.implicit import Implicit
from gripper_plugins.objects.polygon import Polygon
from gripper_plugins.objects.spline import Spline

RNG = np.random.default_rng(7)
SIZES = st.floats(1e-3, 1.0)
ELBOW = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.01), (0.01, 0.01), (0.01, 0.03), (0.0, 0.03))


def star(points, depth, lobes=5, radius=0.05):
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    r = radius * (1 + depth * np.cos(lobes * angle))
    return tuple(map(tuple, np.column_stack([r * np.cos(angle), r * np.sin(angle)]).tolist()))


def signed_distance(vertices, points):
    """shapely's, negative inside."""
    polygon = shapely.Polygon(vertices)
    distance = shapely.distance(polygon.exterior, shapely.points(points))
    return np.where(shapely.contains_xy(polygon, points), -distance, distance)


@given(SIZES, st.floats(0.0, 5.0), st.floats(0, 6.3))
def test_a_circle_s_g_is_its_closed_form(radius, share, angle):
    point = share * radius * np.array([[np.cos(angle), np.sin(angle)]])
    g, gradient, hessian = Circle(radius=radius).evaluate(point)
    assert g[0] == pytest.approx(radius * (share**2 - 1) / 2, abs=1e-12 * radius)
    assert gradient[0] == pytest.approx(point[0] / radius, abs=1e-12)
    assert hessian[0] == pytest.approx(np.eye(2) / radius)


@given(SIZES, SIZES)
def test_an_ellipse_s_slope_is_at_most_1_and_is_1_at_the_ends_of_its_minor_axis(a, b):
    ellipse = Ellipse(semi_axes=(a, b))
    slopes = np.linalg.norm(ellipse.gradient(ellipse.outline()[0]), axis=1)
    assert slopes.max() <= 1 + 1e-9
    end = [0, b] if b <= a else [a, 0]
    assert np.linalg.norm(ellipse.gradient([end])) == pytest.approx(1)
    assert ellipse.inner_radius == pytest.approx(min(a, b))


@settings(deadline=None, max_examples=25)
@given(SIZES, SIZES, st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 3.2))
def test_a_turned_and_shifted_ellipse_as_a_conic_has_g_at_the_moved_points(a, b, x, y, angle):
    """The rigid motion of the points gives what the rigid motion of the coefficients gives."""
    c, s = np.cos(angle), np.sin(angle)
    u, v = (c / a, s / a), (-s / b, c / b)  # (x/a)^2 + (y/b)^2 of the moved frame
    quadratic = [u[0] ** 2 + v[0] ** 2, u[1] ** 2 + v[1] ** 2, 2 * (u[0] * u[1] + v[0] * v[1])]
    linear = [-2 * quadratic[0] * x - quadratic[2] * y, -2 * quadratic[1] * y - quadratic[2] * x]
    constant = quadratic[0] * x**2 + quadratic[1] * y**2 + quadratic[2] * x * y - 1
    conic = Conic(coefficients=(*quadratic, *linear, constant))
    own = RNG.uniform(-1, 1, (20, 2))
    moved = own @ np.array([[c, s], [-s, c]]) + [x, y]
    expected = Ellipse(semi_axes=(a, b)).gap(own)
    assert conic.gap(moved) == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("coefficients", "radius"),
    [
        ((1, -1, 0, 0, 0, -0.01), 0.1),  # between the branches of a hyperbola
        ((1, -1, 0, 0, 0, 0.01), np.inf),  # inside its branches
        ((1, 0, 0, 0, 1, 0), np.inf),  # inside a parabola
        ((-1, 0, 0, 0, 1, 0), np.inf),  # outside it
        ((0, 0, 0, 3, 4, 1), np.inf),  # a wall
        ((1, 0, 0, 0, 0, -0.01), 0.1),  # a strip
        ((-1, 0, 0, 0, 0, 0.01), np.inf),  # two walls
    ],
)
def test_conics_without_bounds_have_a_slope_of_1_at_their_vertices_and_a_point_inside(coefficients, radius):
    conic = Conic(coefficients=coefficients)
    assert conic.gap(conic.inner_point[None])[0] < 0
    assert conic.inner_radius == pytest.approx(radius)
    assert conic.box == (-np.inf, -np.inf, np.inf, np.inf)
    lines = conic.outline(box=(-1, -1, 1, 1))
    slopes = np.linalg.norm(conic.gradient(np.vstack(lines)), axis=1)
    assert slopes.min() == pytest.approx(1, rel=1e-3)
    with pytest.raises(ValueError, match="box must be given"):
        conic.outline()


@pytest.mark.parametrize(
    ("coefficients", "rule"),
    [
        ((0, 0, 0, 0, 0, -1), "not be constant"),
        ((1, 1, 0, 0, 0, 1), "have an outline"),
        ((1, 1, 0, 0, 0, 0), "have an outline"),
        ((-1, -1, 0, 0, 0, -1), "have an outline"),
        ((1, 0, 0, 0, 0, 0), "have an outline"),
        ((1, 0, 0, 0, 0, 1), "have an outline"),
        ((-1, -2, 0, 0, 0, 1), "be negative inside"),
        ((1, -1, 0, 0, 0, 0), "have a gradient all along"),
    ],
)
def test_a_conic_that_is_no_outline_is_refused_with_the_rule(coefficients, rule):
    with pytest.raises(ValueError, match=f"coefficients must {rule}"):
        Conic(coefficients=coefficients)


@settings(deadline=None, max_examples=10)
@given(st.floats(0.01, 0.06), st.floats(0.01, 0.06))
def test_ellipse_conic_and_implicit_of_one_ellipse_have_one_outline(a, b):
    x, y = sympy.symbols("x y")
    outline = Ellipse(semi_axes=(a, b)).outline()[0]
    same = [
        Conic(coefficients=(1 / a**2, 1 / b**2, 0, 0, 0, -1)),
        Implicit(expression=(x / a) ** 2 + (y / b) ** 2 - 1, extent=0.07),
        Implicit(expression=f"({x}/{a!r})**2 + ({y}/{b!r})**2 - 1", extent=0.07),
        Implicit(expression=sympy.sqrt((x / a) ** 2 + (y / b) ** 2) - 1, extent=0.07),
    ]
    for surface in same:
        assert surface.gap(outline) == pytest.approx(np.zeros(len(outline)), abs=1e-12)
        assert surface.box == pytest.approx((-a, -b, a, b), abs=2e-4)


def test_an_implicit_surface_is_in_metres_whatever_the_unit_of_its_expression():
    for power in (2, 4, 6):
        surface = Implicit(expression=f"x**{power} + y**{power} - 0.03**{power}", extent=0.05)
        slopes = np.linalg.norm(surface.gradient(surface.outline()[0]), axis=1)
        assert np.median(slopes) == pytest.approx(1, abs=0.05)


def test_an_implicit_cone_is_finite_at_its_tip():
    g, gradient, hessian = Implicit(expression="sqrt(x**2 + y**2) - 0.03", extent=0.05).evaluate(np.zeros((1, 2)))
    assert g[0] == pytest.approx(-0.03)
    assert np.linalg.norm(gradient) == pytest.approx(1)
    assert np.isfinite(hessian).all()


def test_the_smaller_part_of_an_implicit_surface_bounds_the_room_inside():
    two = "min(sqrt((x - 0.03)**2 + y**2) - 0.02, sqrt((x + 0.03)**2 + y**2) - 0.005)"
    surface = Implicit(expression=two, extent=0.06)
    assert surface.inner_radius == pytest.approx(0.005, rel=0.05)
    assert surface.inner_point == pytest.approx([0.03, 0], abs=2e-3)
    assert len(surface.outline()) == 2


def test_an_implicit_surface_of_branches_has_their_values_and_no_proved_curvature():
    x, y = sympy.symbols("x y")
    r = sympy.sqrt(x**2 + y**2)
    halves = sympy.Piecewise((r - 0.03, x < 0), (sympy.sqrt((x / 2) ** 2 + y**2) - 0.03, True))
    surface = Implicit(expression=halves, extent=0.08)
    assert surface.box == pytest.approx((-0.03, -0.03, 0.06, 0.03), abs=1e-3)
    slopes, least = surface.bounds(np.array([[-0.02, 0.0], [0.0, 0.03]]), np.full(2, 1e-3))
    assert (slopes < 1.2 * np.linalg.norm(surface.gradient([[-0.02, 0.0]]))).all()
    assert (least == -np.inf).all()


def test_an_angle_that_jumps_leaves_nothing_proved():
    spiral = Implicit(expression="sqrt(x**2 + y**2) - 0.03 - 0.001*atan2(y, x)", extent=0.05)
    flower = Implicit(expression="sqrt(x**2 + y**2) - 0.03 - 0.001*cos(3*atan2(y, x))", extent=0.05)
    disc = np.array([[-0.03, 0.0]]), np.array([1e-4])
    assert spiral.bounds(*disc) is None
    assert 1 <= flower.bounds(*disc)[0][0] < 1.2


@pytest.mark.parametrize("vertices", [ELBOW, ELBOW[::-1], star(7, 0.4), star(400, 0.3), star(5, 0.0)])
def test_a_polygon_s_g_is_shapely_s_signed_distance(vertices):
    polygon = Polygon(vertices=vertices)
    points = RNG.uniform(-0.1, 0.1, (500, 2))
    assert polygon.gap(points) == pytest.approx(signed_distance(vertices, points), abs=1e-15)


@pytest.mark.parametrize("count", [6, 40, 300])
@pytest.mark.parametrize("depth", [0.0, 0.1])
def test_a_spline_s_g_is_the_signed_distance_to_its_fine_outline(count, depth):
    points = star(count, depth, lobes=3)
    spline = Spline(points=points)
    queries = RNG.uniform(-0.1, 0.1, (300, 2))
    assert spline.gap(queries) == pytest.approx(signed_distance(spline.outline(tolerance=1e-8)[0], queries), abs=1.1e-8)
    assert spline.gap(points) == pytest.approx(np.zeros(count), abs=1e-15)


def test_a_thin_spline_s_sides_are_told_apart_far_below_the_chords_it_is_searched_by():
    blade = ((0.0, 0.0), (0.03, 4e-6), (0.06, 5e-6), (0.1, 0.0), (0.06, -5e-6), (0.03, -4e-6))
    spline = Spline(points=blade)
    points = RNG.uniform([0.005, -2e-5], [0.095, 2e-5], (200, 2))
    assert spline.gap(points) == pytest.approx(signed_distance(spline.outline(tolerance=1e-10)[0], points), abs=2e-10)


@pytest.mark.parametrize("order", [1, -1])
def test_the_sense_of_the_points_does_not_matter(order):
    queries = RNG.uniform(-0.1, 0.1, (50, 2))
    for kind, name in ((Polygon, "vertices"), (Spline, "points")):
        one, other = (kind(**{name: star(12, 0.2)[::sense]}) for sense in (1, order))
        for value, same in zip(one.evaluate(queries), other.evaluate(queries), strict=True):
            assert value == pytest.approx(same, rel=1e-7, abs=1e-12)


def test_polygons_and_splines_of_many_points_become_the_circle():
    """The polygon's error falls by 4 for twice the corners, the spline's by 16."""
    queries = RNG.uniform(-0.1, 0.1, (200, 2))
    distance = np.linalg.norm(queries, axis=1) - 0.05
    for kind, name, rate in ((Polygon, "vertices", 4), (Spline, "points", 16)):
        errors = [np.abs(kind(**{name: star(n, 0.0)}).gap(queries) - distance).max() for n in (32, 64, 128)]
        assert errors[0] / errors[1] == pytest.approx(rate, rel=0.1)
        assert errors[1] / errors[2] == pytest.approx(rate, rel=0.1)


def test_a_corner_is_where_the_feature_is_a_vertex_and_its_normals_are_its_edges():
    polygon = Polygon(vertices=ELBOW)
    assert sorted(map(tuple, polygon.corners.tolist())) == sorted(set(ELBOW) - {(0.01, 0.01)})
    at = polygon.corners.tolist().index([0.04, 0.0])
    assert polygon.corner_normals[at] == pytest.approx(np.array([[0, -1], [1, 0]]))
    assert polygon.hollows.tolist() == [[0.01, 0.01]]
    assert polygon.hollow_normals[0] == pytest.approx(np.array([[0, 1], [1, 0]]))
    assert not Spline(points=star(9, 0.1)).corners.size


@pytest.mark.parametrize("vertex", ELBOW)
def test_g_at_a_vertex_has_a_unit_gradient_between_the_normals_of_its_edges(vertex):
    polygon = Polygon(vertices=ELBOW)
    g, gradient, hessian = polygon.evaluate(np.array([vertex]))
    assert g[0] == pytest.approx(0, abs=1e-15)
    assert np.linalg.norm(gradient) == pytest.approx(1)
    assert np.isfinite(hessian).all()
    step = 1e-3 * gradient[0]
    assert polygon.gap(np.array([vertex]) - step)[0] < 0 < polygon.gap(np.array([vertex]) + step)[0]


def test_a_hollow_polygon_is_proved_convex_along_its_edges_and_not_at_its_hollow_corner():
    polygon = Polygon(vertices=ELBOW)
    centers = np.array([[0.03, 0.01], [0.04, 0.0], [0.01, 0.01], [0.02, 0.02]])
    slopes, least = polygon.bounds(centers, np.full(4, 2e-3))
    assert slopes.tolist() == [1.0] * 4
    assert least.tolist() == [0.0, 0.0, -np.inf, -np.inf]
    assert Polygon(vertices=star(6, 0.0)).bounds(centers, np.full(4, 1.0))[1].tolist() == [0.0] * 4


def test_a_hollow_spline_s_bound_comes_near_its_curvature():
    spline = Spline(points=star(200, 0.1, lobes=2))
    outline = spline.outline()[0]
    least = spline.bounds(outline, np.full(len(outline), 1e-5))[1]
    curvature = np.linalg.eigvalsh(spline.hessian(outline))[:, 0]
    assert (least <= curvature + 1e-9).all()
    assert (least >= curvature - 0.5).all()


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(0.1, 1.0), min_size=3, max_size=12), st.sampled_from([Polygon, Spline]), st.integers(0, 99))
def test_outlines_of_any_shape_give_shapely_s_distance_and_bounds_that_hold(radii, kind, seed):
    angle = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    corners = 0.05 * np.array(radii)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    try:
        surface = kind(**{"vertices" if kind is Polygon else "points": corners})
    except ValueError:  # a spline that overshoots into itself
        assume(False)
    rng = np.random.default_rng(seed)
    centers, reach = rng.uniform(-0.07, 0.07, (100, 2)), 10 ** rng.uniform(-5, -1.5, 100)
    exact = signed_distance(surface.outline(tolerance=1e-7)[0], centers)
    assert surface.gap(centers) == pytest.approx(exact, abs=1.1e-7)
    least = surface.bounds(centers, reach)[1]
    p = centers + reach[:, None] * rng.uniform(-0.6, 0.6, (100, 2))
    d = reach[:, None] * rng.uniform(-0.1, 0.1, (100, 2))
    g, gradient = surface.evaluate(p, 1)
    above = surface.gap(p + d) - g - (gradient * d).sum(axis=1)
    known = np.isfinite(least)
    assert (above >= np.where(known, least, 0.0) * (d * d).sum(axis=1) / 2 - 1e-13)[known].all()


@pytest.mark.parametrize(
    ("points", "rule"),
    [
        (((0, 0), (1, 0)), "at least 3 points"),
        (((0, 0), (1, 0), (1, 0), (0, 1)), "not repeat a point"),
        (((0, 0), (1, 0), (0, 1), (0, 0)), "not repeat a point"),
        (((0, 0), (1, 0), (2, 0)), "enclose an area"),
        (((0, 0), (2, 1), (2, 0), (0, 1.5)), r"meets itself; got one that does at \(1\.[\d]+, 0\.6[\d]*\), in m"),
    ],
)
def test_points_that_make_no_outline_are_refused_with_the_rule(points, rule):
    with pytest.raises(ValueError, match=f"vertices must .*{rule}"):
        Polygon(vertices=points)
    with pytest.raises(ValueError, match=f"points must .*{rule}"):
        Spline(points=points)


@pytest.mark.parametrize(
    ("expression", "rule"),
    [
        ("2", "expression must depend on x and y"),
        (sympy.Symbol("z") + sympy.Symbol("x"), "expression must depend on x and y"),
        ("x**2 + y**2 + 1", "expression must have an outline"),
        ("0.02**2 - x**2 - y**2", "expression must be negative inside"),
        ("x", "expression must make a g that is positive on the edge"),
        ("x**4 + y**4 + 1", "expression must make a g that is negative inside"),
        ("log(x + 0.01)", "expression must be finite"),
        (sympy.sqrt(-1 - sympy.Symbol("x") ** 2), "expression must be finite"),
        (sympy.I * sympy.Symbol("x"), "expression must be real"),
    ],
)
def test_an_expression_that_is_no_outline_is_refused_with_the_rule(expression, rule):
    with pytest.raises(ValueError, match=rule):
        Implicit(expression=expression, extent=0.05)


def test_an_object_is_differentiated_and_compiled_once_and_not_again_for_its_pose_or_its_copy():
    before = compiled.cache_info().misses
    points = np.ones((3, 2))
    for copy in (Circle(radius=0.0123), Circle(radius=0.0123)):
        for angle in (0.0, 1.0):
            placed = copy.at(x=0.1, angle=angle)
            placed.body.evaluate(points)
            placed.body.evaluate(points)
    assert compiled.cache_info().misses == before + 1


def test_polygons_share_the_formulas_of_an_edge_and_of_a_corner():
    Polygon(vertices=ELBOW).evaluate(RNG.uniform(-1, 1, (50, 2)))
    before = compiled.cache_info().misses
    Polygon(vertices=star(9, 0.1)).evaluate(RNG.uniform(-1, 1, (50, 2)))
    assert compiled.cache_info().misses == before


def test_a_third_party_s_outline_of_arcs_and_edges_needs_only_its_pieces():
    class Lens(FeatureSurface):
        """Two parabolas y = +-(1 - x^2)/2 over [-1, 1]."""

        def pieces(self):
            lower = [[-1.0, 0.0], [2.0, -2.0], [0.0, 2.0]]
            return np.array([lower, [[-x, -y] for x, y in lower]])

    lens = Lens()
    queries = RNG.uniform(-2, 2, (300, 2))
    assert lens.gap(queries) == pytest.approx(signed_distance(lens.outline(tolerance=1e-9)[0], queries), abs=1.1e-9)
    assert sorted(lens.corners.tolist()) == [[-1.0, 0.0], [1.0, 0.0]]
    assert lens.bounds(queries, np.ones(300))[1].tolist() == [0.0] * 300


def test_a_single_piece_that_closes_on_itself_is_an_outline_with_one_corner():
    class Drop(FeatureSurface):
        def pieces(self):
            return np.array([[[0.0, 0.0], [1.0, 1.0], [-1.0, -3.0], [0.0, 2.0]]])

    drop = Drop()
    queries = RNG.uniform(-0.5, 0.5, (300, 2))
    assert drop.gap(queries) == pytest.approx(signed_distance(drop.outline(tolerance=1e-9)[0], queries), abs=1.1e-9)
    assert drop.corners.tolist() == [[0.0, 0.0]]


@pytest.mark.parametrize(
    ("pieces", "rule"),
    [
        (np.zeros((3, 2)), "of shape"),
        (np.full((3, 2, 2), np.nan), "finite pieces"),
        (np.array([[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]]]), "each end where the next begins"),
        (np.array([[[0.0, 0.0], [0.0, 0.0], [1.0, 1.0]], [[1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]]), "with a tangent"),
    ],
)
def test_pieces_that_make_no_chain_are_refused_with_the_rule(pieces, rule):
    class Broken(FeatureSurface):
        def pieces(self):
            return pieces

    with pytest.raises(ValueError, match=rule):
        Broken()


def test_a_surface_that_is_not_quadratic_must_say_where_its_outline_is():
    class Squircle(ImplicitSurface):
        def g(self, x, y):
            return x**4 + y**4 - 1

    with pytest.raises(TypeError, match=r"Squircle\.half_size must be written"):
        Squircle()


@pytest.mark.parametrize("surface", [Circle(radius=0.1), Polygon(vertices=ELBOW)])
def test_a_tolerance_must_be_positive(surface):
    with pytest.raises(ValueError, match="tolerance must be a positive number"):
        surface.outline(tolerance=0)


def test_an_expression_of_thousands_of_terms_is_sampled_and_not_bounded_for_minutes():
    x, y = sympy.symbols("x y", real=True)
    nested = {}
    for depth in (4, 31):
        nested[depth] = x
        for _ in range(depth):
            nested[depth] = sympy.Abs(x - y * nested[depth])
    few, many = (Implicit(expression=e + x**2 + y**2 - 1e-4, extent=0.05) for e in nested.values())
    center, radius = np.array([[0.005, 0.0]]), np.array([1e-3])
    assert few.bounds(center, radius) is not None
    began = time.process_time()
    assert many.bounds(center, radius) is None
    assert time.process_time() - began < 3
