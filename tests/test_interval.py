import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gripper.interval import NoEnclosureError, enclose, enclose_all

X, Y = sympy.symbols("x y", real=True)
UNARY = [
    sympy.exp,
    sympy.log,
    sympy.sin,
    sympy.cos,
    sympy.tan,
    sympy.sqrt,
    sympy.asin,
    sympy.acos,
    sympy.atan,
    sympy.Abs,
    sympy.sign,
    lambda u: u**2,
    lambda u: u**3,
    lambda u: u**-1,
    lambda u: u**-2,
    lambda u: u ** sympy.Rational(1, 3),
    lambda u: u ** sympy.Rational(-3, 2),
    lambda u: u**2.5,
    lambda u: sympy.Heaviside(u, sympy.Rational(1, 2)),
]
BINARY = [
    lambda u, v: u + v,
    lambda u, v: u - v,
    lambda u, v: u * v,
    lambda u, v: u / (v**2 + 1),
    lambda u, v: u / v,
    lambda u, v: (u**2 + sympy.Rational(1, 10)) ** v,
    sympy.Min,
    sympy.Max,
    sympy.atan2,
    lambda u, v: sympy.Piecewise((u, X < Y), (v, u >= 1), (u * v, True)),
]
LEAVES = st.one_of(
    st.sampled_from([X, Y, sympy.pi, sympy.Rational(1, 3), sympy.Integer(2)]),
    st.floats(-3, 3, allow_nan=False).map(lambda value: sympy.Float(round(value, 3))),
)


def built(function, *arguments):
    """The expression, or x where sympy refuses to build it (a bound of something that is not real)."""
    try:
        return function(*arguments)
    except (ArithmeticError, TypeError, ValueError):
        return X


def grown(children):
    unary = st.builds(built, st.sampled_from(UNARY), children)
    binary = st.builds(built, st.sampled_from(BINARY), children, children)
    return st.one_of(unary, binary)


EXPRESSIONS = st.recursive(LEAVES, grown, max_leaves=6)
ENDS = st.tuples(st.floats(-3, 3), st.floats(0, 2)).map(lambda pair: (pair[0], pair[0] + pair[1]))
SHARES = st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=1, max_size=5)


def real_value(expression, x, y):
    """The value to 40 digits, or None where there is no real one."""
    with mpmath.workdps(40):
        try:
            value = sympy.lambdify((X, Y), expression, "mpmath")(mpmath.mpf(x), mpmath.mpf(y))
        except (ArithmeticError, AttributeError, TypeError, ValueError):  # mpmath's words for: not real
            return None
        value = mpmath.mpmathify(value)
        if isinstance(value, mpmath.mpc):
            return None if value.imag else value.real
        return None if mpmath.isnan(value) or mpmath.isinf(value) else value


@settings(max_examples=200, deadline=None)
@given(EXPRESSIONS, ENDS, ENDS, SHARES)
def test_a_range_holds_every_value_over_its_box(expression, x_ends, y_ends, shares):
    assume(not expression.has(sympy.zoo, sympy.nan, sympy.oo, sympy.I))
    try:
        low, high = enclose(expression, {X: np.array([x_ends]).T, Y: np.array([y_ends]).T})
    except NoEnclosureError:  # sympy made a complex number of constants
        assume(False)
    assert low.shape == high.shape == (1,)
    assert low[0] <= high[0]
    for along_x, along_y in [*shares, (0, 0), (1, 1)]:
        x = min(x_ends[0] + along_x * (x_ends[1] - x_ends[0]), x_ends[1])
        y = min(y_ends[0] + along_y * (y_ends[1] - y_ends[0]), y_ends[1])
        value = real_value(expression, x, y)
        assert value is None or mpmath.mpf(low[0]) <= value <= mpmath.mpf(high[0]), (x, y)


@given(st.lists(st.tuples(ENDS, ENDS), min_size=1, max_size=8))
def test_many_boxes_at_a_time_give_what_each_gives_alone(boxes):
    expression = X**2 * sympy.sin(Y) - sympy.pi * X * sympy.sqrt(X**2 + Y**2)
    array = np.array(boxes)
    low, high = enclose(expression, {X: (array[:, 0, 0], array[:, 0, 1]), Y: (array[:, 1, 0], array[:, 1, 1])})
    for i, (x, y) in enumerate(array):
        assert (low[i], high[i]) == enclose(expression, {X: (x[0], x[1]), Y: (y[0], y[1])})


@given(ENDS)
def test_linear_terms_are_enclosed_tightly(ends):
    low, high = enclose(3 * X + 1, {X: tuple(map(np.array, ends))})
    assert low == pytest.approx(3 * ends[0] + 1, abs=1e-14, rel=1e-14)
    assert high == pytest.approx(3 * ends[1] + 1, abs=1e-14, rel=1e-14)


@pytest.mark.parametrize(
    ("expression", "ends", "expected"),
    [
        (X**2, (-2, 1), (0, 4)),
        (sympy.Abs(X), (-2, 1), (0, 2)),
        (sympy.sin(X), (1, 2), (np.sin(1), 1)),
        (sympy.cos(X), (-0.5, 0.5), (np.cos(0.5), 1)),
        (1 / X, (0, 2), (0.5, np.inf)),
        (1 / X, (-1, 2), (-np.inf, np.inf)),
        (sympy.tan(X), (1, 2), (-np.inf, np.inf)),
        (sympy.sqrt(X), (-1, 4), (-np.inf, np.inf)),
        (sympy.cos(sympy.log(X)), (-1, 4), (-np.inf, np.inf)),
        (sympy.DiracDelta(X), (-1, 1), (0, np.inf)),
        (sympy.DiracDelta(X), (1, 2), (0, 0)),
    ],
)
def test_ranges_of_single_functions_are_as_in_the_textbook(expression, ends, expected):
    assert enclose(expression, {X: tuple(map(np.array, ends))}) == pytest.approx(expected, rel=1e-14, abs=1e-14)


def test_a_constant_fills_the_shape_of_the_box():
    low, high = enclose_all([sympy.Integer(2), X], {X: (np.zeros(3), np.ones(3))})[0]
    assert low.tolist() == high.tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize("expression", [sympy.gamma(X), sympy.floor(X), X + sympy.Symbol("z")])
def test_what_has_no_known_range_is_an_error_of_its_own(expression):
    with pytest.raises(NoEnclosureError, match="must be of symbols with a range"):
        enclose(expression, {X: (np.array(0.0), np.array(1.0))})
