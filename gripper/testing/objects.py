"""What every object promises: g, its derivatives, its bounds, its corners and its outline."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from gripper.contact.obstacle import Frame, Obstacle
from gripper.objects import Array, Object
from gripper.testing.contract import Property, fits, has_the_manners_of_data, require, run, survives_a_scene_file
from gripper.testing.places import around, drawn, in_discs, largest, segments, size_of, window

STEP = 1e-7  # m: of central differences
SMOOTH = 1e-3  # relative: a derivative that changes by more over such a step jumps there


def check_object(instance: Object) -> None:
    """Check that an object keeps all that `gripper.objects.Object` promises.

    Parameters
    ----------
    instance
        Of the plugin's class; check several, of different kinds and sizes.

    Raises
    ------
    gripper.testing.ContractError
        A property fails: one sentence with the instance, the rule and what was got.
    """
    run(instance, OBJECT_PROPERTIES)


def has_finite_values_of_the_right_shape(surface: Object) -> None:
    """Everywhere: around, on the outline, at the centre, at corners and far away; also of no points."""
    special = [surface.inner_point[None], surface.corners, surface.hollows, np.zeros((1, 2)), np.full((1, 2), 10.0)]
    for points in (around(surface), np.vstack(drawn(surface)), *special, np.empty((0, 2))):
        for order in range(3):
            values = surface.evaluate(points, order)
            shapes = [(len(points),), (len(points), 2), (len(points), 2, 2)][: order + 1]
            found = [np.shape(value) for value in values]
            require(found == shapes, f"evaluate {len(points)} points to arrays of shapes {shapes}", found)
            for name, value in zip(("g", "grad g", "the Hessian"), values, strict=False):
                finite = np.isfinite(value).all(axis=tuple(range(1, value.ndim)))
                where = points[~finite][:1].tolist()
                require(
                    bool(finite.all()), f"have {name} finite everywhere", f"{value[~finite][:1].tolist()} at {where}"
                )


def has_the_same_values_at_every_order(surface: Object) -> None:
    """A lower order gives the same values, and the Hessian is symmetric."""
    points = around(surface)
    full = surface.evaluate(points, 2)
    for order in (0, 1):
        for low, high in zip(surface.evaluate(points, order), full, strict=False):
            require(np.allclose(low, high, rtol=1e-12, atol=1e-14), f"give the same at order {order} as at 2", low[:3])
    require(np.allclose(full[2], full[2].swapaxes(1, 2)), "have a symmetric Hessian", full[2][:1].tolist())


def has_a_continuous_g(surface: Object) -> None:
    """Along straight lines g nowhere jumps: halved again and again, the half with the larger change kept."""
    ends, size = segments(surface), size_of(surface)
    values = [surface.gap(points) for points in ends]
    for _ in range(48):
        middle = (ends[0] + ends[1]) / 2
        g = surface.gap(middle)
        first = np.abs(g - values[0]) > np.abs(g - values[1])
        ends = [np.where(first[:, None], ends[0], middle), np.where(first[:, None], middle, ends[1])]
        values = [np.where(first, values[0], g), np.where(first, g, values[1])]
    jump = np.abs(values[1] - values[0])
    worst = int(jump.argmax())
    rule = "have a continuous g"
    require(
        jump[worst] < 1e-6 * size, rule, f"a jump from {values[0][worst]} to {values[1][worst]} at {ends[0][worst]}"
    )


def has_derivatives_that_are_differences(surface: Object, order: int) -> None:
    """Away from where the nearest feature changes, at few places only: there the derivative itself jumps."""
    points = around(surface)
    value = surface.evaluate(points, order)[order]
    size = 1 + largest(value)
    smooth, differences = np.ones(len(points), dtype=bool), np.empty_like(value)
    for axis in (0, 1):
        shift = STEP * np.eye(2)[axis]
        after, before = surface.evaluate(points + shift, order), surface.evaluate(points - shift, order)
        differences[..., axis] = (after[order - 1] - before[order - 1]) / (2 * STEP)
        smooth &= largest(after[order] - before[order]) < SMOOTH * size
    name = ("g", "grad g", "the Hessian")[order]
    require(smooth.mean() > 0.9, f"have {name} continuous at most places", f"jumps at {1 - smooth.mean():.0%} of them")
    off = np.where(smooth, largest(differences - value) / size, 0.0)
    at = int(off.argmax())
    got = f"{value[at].tolist()} where the differences are {differences[at].tolist()}, at {points[at].tolist()}"
    require(off[at] < 1e-5, f"have {name} equal to the differences of the derivative below it", got)


def has_g_negative_inside(surface: Object) -> None:
    """And positive outside its outline."""
    import shapely

    inner = surface.gap(surface.inner_point[None])[0]
    require(inner < 0, "have g negative at its inner point", inner)
    if not np.isfinite(surface.box).all():
        return
    rings, points = drawn(surface), around(surface)
    inside = np.sum([shapely.contains_xy(shapely.Polygon(ring), points) for ring in rings], axis=0) % 2 == 1
    clear = shapely.distance(_lines(rings), shapely.points(points)) > 1e-3 * size_of(surface)
    g = surface.gap(points)
    for side, wrong in (("negative inside", inside & (g >= 0)), ("positive outside", ~inside & (g <= 0))):
        at = np.flatnonzero(clear & wrong)[:1]
        require(not len(at), f"have g {side} its outline", f"{g[at].tolist()} at {points[at].tolist()}")


def has_a_slope_near_1_on_the_outline(surface: Object) -> None:
    """So that g is about a distance, in m: a factor of 10 either way."""
    outline = np.vstack(drawn(surface))
    slopes = np.linalg.norm(surface.gradient(outline), axis=1)
    at = int(np.abs(np.log(np.maximum(slopes, 1e-300))).argmax())
    require(0.1 < slopes[at] < 10, "have |grad g| about 1 on the outline", f"{slopes[at]} at {outline[at].tolist()}")


def has_bounds_that_hold(surface: Object, radius: float) -> None:
    """Over discs: of the slope, and of g above and below its parabolas, as the certificate uses them."""
    centers = np.vstack([around(surface, 150, 0.2), np.vstack(drawn(surface))[::7][:50]])
    radii = np.full(len(centers), radius)
    bounds = surface.bounds(centers, radii)
    if bounds is None:
        return
    steepest, least = bounds
    p, q = in_discs(centers, radius, 1), in_discs(centers, radius, 2)
    g, gradient = (value.reshape(p.shape[:2] + value.shape[1:]) for value in surface.evaluate(p.reshape(-1, 2), 1))
    slopes = np.linalg.norm(gradient, axis=2).max(axis=1)
    at = int((slopes / steepest).argmax())
    got = f"{slopes[at]} within {radius} m of {centers[at].tolist()}, where {steepest[at]} is promised"
    require(slopes[at] <= steepest[at] * (1 + 1e-9), "keep |grad g| below its bound", got)
    d = q - p
    above = surface.gap(q.reshape(-1, 2)).reshape(g.shape) - g - (gradient * d).sum(axis=2)
    for name, curvature, sign in (("above", least, 1), ("below", surface.largest_curvature(centers, radii), -1)):
        known = np.isfinite(curvature)
        parabola = curvature[known, None] * (d[known] ** 2).sum(axis=2) / 2
        slack = sign * (above[known] - parabola) + 1e-13 + 1e-9 * np.abs(parabola)
        rule = f"keep g {name} the parabola of its curvature's bound"
        require(bool((slack >= 0).all()), rule, f"{slack.min(initial=0.0)} m beyond it, over {radius} m")


def has_bounds_of_use(surface: Object) -> None:
    """Where there are any: a slope near the slope, a least curvature that is finite at most of the outline."""
    outline = np.vstack(drawn(surface))
    bounds = surface.bounds(outline, np.full(len(outline), 1e-5))
    if bounds is None:
        return
    ratio = float(np.median(bounds[0] / np.linalg.norm(surface.gradient(outline), axis=1)))
    require(ratio < 1.01, "bound |grad g| over small discs near its value, or return None", f"{ratio} times as much")
    known = float(np.isfinite(bounds[1]).mean())
    require(known > 0.8, "bound the curvature at most of the outline, or return None", f"{known:.0%} of it")


def has_a_box_about_the_outline(surface: Object) -> None:
    """No wider than needed."""
    if not np.isfinite(surface.box).all():
        return
    outline, size = np.vstack(surface.outline()), size_of(surface)
    low, high = np.reshape(surface.box, (2, 2))
    off = np.concatenate([outline.min(axis=0) - low, high - outline.max(axis=0)])
    require(bool((off > -1e-12 * size).all()), "lie within its box", f"{-off.min()} m outside {surface.box}")
    require(
        bool((off < 5e-3 * size).all()), "have a box no wider than needed", f"{off.max()} m too wide: {surface.box}"
    )


def has_its_outline_on_g_0(surface: Object) -> None:
    """Vertices on it, chords within the tolerance of it, closed where it has bounds."""
    box, size = window(surface), size_of(surface)
    for tolerance in (1e-3 * size, 1e-5 * size):
        lines = surface.outline(box, tolerance)
        require(bool(lines), "have an outline", lines)
        for line in lines:
            off = float(np.abs(surface.gap(line)).max())
            require(off < 1e-9 * size, "have the outline's vertices on g = 0", f"g = {off}")
            g, gradient = surface.evaluate((line[1:] + line[:-1]) / 2, 1)
            off = float((np.abs(g) / np.linalg.norm(gradient, axis=1)).max())
            require(off < 1.05 * tolerance + 1e-12, f"have the outline's chords within {tolerance} m of it", off)
            closed = bool((line[0] == line[-1]).all()) or not np.isfinite(surface.box).all()
            require(closed, "have closed outlines, the first vertex repeated", line[[0, -1]].tolist())


def has_its_inner_point_well_inside(surface: Object) -> None:
    """At least by the radius of the largest disc inside its smallest part."""
    import shapely

    radius, point = surface.inner_radius, surface.inner_point
    require(radius > 0, "have an inner radius above 0, in m", radius)
    if np.isinf(radius):
        return
    distance = float(shapely.distance(_lines(drawn(surface)), shapely.Point(point)))
    require(distance > 0.97 * radius, f"have its inner point {radius} m inside", distance)
    if len(drawn(surface)) == 1:
        require(
            distance < 1.03 * radius, "have the radius of the largest disc inside", f"{radius}, less than {distance}"
        )


def has_its_corners_on_the_outline(surface: Object) -> None:
    """Between unit normals: outside along their cone, inside against it; the other way at re-entrant ones."""
    near = 1e-4 * size_of(surface)
    for kind, points, normals, sign in (
        ("corner", surface.corners, surface.corner_normals, 1.0),
        ("re-entrant corner", surface.hollows, surface.hollow_normals, -1.0),
    ):
        shapes = (np.shape(points), np.shape(normals))
        require(shapes == ((len(points), 2), (len(points), 2, 2)), f"give each {kind} two normals", shapes)
        if not len(points):
            continue
        lengths = np.linalg.norm(normals, axis=2)
        require(np.allclose(lengths, 1), f"have unit normals at each {kind}", lengths.tolist())
        g = surface.gap(points)
        require(float(np.abs(g).max()) < 1e-8 * size_of(surface), f"have each {kind} on g = 0", g.tolist())
        turn = normals[:, 0, 0] * normals[:, 1, 1] - normals[:, 0, 1] * normals[:, 1, 0]
        require(
            bool((sign * turn > 0).all()), f"have the normals of a {kind} in order, what is inside on the left", turn
        )
        middle = normals.sum(axis=1) / np.linalg.norm(normals.sum(axis=1), axis=1, keepdims=True)
        beside = surface.gap(points + near * middle), surface.gap(points - near * middle)
        require(bool((beside[0] > 0).all() and (beside[1] < 0).all()), f"be outside before each {kind}", beside)


def has_a_pose_that_is_a_rigid_motion(surface: Object) -> None:
    """Placed, it is the same object at moved points: g the same, its derivatives turned."""
    points, length, frame = around(surface, 40), 0.3, Frame(0.2 - 0.7j, 2.1, 0j, 0.0)
    placed = surface.at(x=0.06, y=-0.21, angle=2.1)
    require(placed.body == surface, "be the same body wherever it is placed", placed.body)
    seen = Obstacle(placed.body, length, frame)
    moved = seen.place(points[:, 0] + 1j * points[:, 1])
    g, gradient = surface.evaluate(points, 1)
    found, slope = seen.slope(moved)
    require(
        np.allclose(found * length, g, rtol=1e-9, atol=1e-12), "have the same g at moved points", found[:3] * length
    )
    turned = (gradient[:, 0] + 1j * gradient[:, 1]) * np.exp(1j * frame.angle)
    require(np.allclose(slope, turned, rtol=1e-6, atol=1e-9), "have its gradient turned with it", slope[:3])


def _lines(rings: list[Array]) -> Any:
    import shapely

    return shapely.multilinestrings([shapely.linestrings(ring) for ring in rings])


def _named(name: str, function: Any, *arguments: float) -> Property[Object]:
    each = partial(function, **dict(zip(("order",) if name == "differences" else ("radius",), arguments, strict=True)))
    each.__name__ = f"{function.__name__}_{arguments[0]}"  # type: ignore[attr-defined]
    return each


OBJECT_PROPERTIES: tuple[Property[Object], ...] = (
    fits("gripper.objects"),
    has_the_manners_of_data,
    has_finite_values_of_the_right_shape,
    has_a_continuous_g,
    has_the_same_values_at_every_order,
    _named("differences", has_derivatives_that_are_differences, 1),
    _named("differences", has_derivatives_that_are_differences, 2),
    has_g_negative_inside,
    has_a_slope_near_1_on_the_outline,
    _named("bounds", has_bounds_that_hold, 1e-5),
    _named("bounds", has_bounds_that_hold, 1e-3),
    _named("bounds", has_bounds_that_hold, 0.02),
    has_bounds_of_use,
    has_its_outline_on_g_0,
    has_a_box_about_the_outline,
    has_its_inner_point_well_inside,
    has_its_corners_on_the_outline,
    has_a_pose_that_is_a_rigid_motion,
    survives_a_scene_file("gripper.objects"),
)
"""What `check_object` checks, in its order."""
